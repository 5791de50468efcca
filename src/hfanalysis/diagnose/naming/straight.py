"""What is compared at last, by engines of the laws that each candidate has.

The search takes what laws add as linear. Where they depart far what is wrong with that is more than the noise of quiet
sensors, and an effect may be named for it.
"""

from __future__ import annotations

from hfanalysis.inference.candidate import Bench, Candidate
from hfanalysis.inference.fitting.threads import each


def all_straightened(
    base: Candidate, others: list[Candidate], near: float, bench: Bench
) -> dict[tuple[str, ...], Candidate]:
    """The base model, and those of the ``others`` that come to lie within ``near`` [natural log] of the most probable,
    straightened; by their keys. The rest are as they were."""
    now = {c.key: c for c in (*others, base)}
    done, todo = set[tuple[str, ...]](), [base.key]
    while todo:
        now |= zip(todo, each(bench.straightened, [now[key] for key in todo]), strict=True)
        done |= set(todo)
        best = max(c.log_evidence for c in now.values())
        todo = [key for key, c in now.items() if c.log_evidence > best - near and key not in done]
    return now
