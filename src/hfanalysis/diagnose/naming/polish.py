"""A base model that no other fit stands above: fitted again from where its children have come to.

A base model in a wrong valley is beaten by each of its children, whatever they are of, for they have come out of it:
that is no evidence for what they add. So the base model is fitted again with the constants of every child that stands
above it, and where one of these fits is deeper it is the base model, from which all is looked for anew.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from hfanalysis.diagnose.naming.base_model import in_one_valley
from hfanalysis.inference.candidate import SHORT, Bench, Candidate, attempted, by_evidence, candidate
from hfanalysis.inference.fitting.threads import each

DEEPER = 0.5
"""Log evidence [natural log] by which a fit from a child's constants has to stand above the base model to take its
place: fits end within a tenth of that."""

ABOVE = 2.0
"""Log evidence above the base model from which on a child's constants are tried."""

ROUNDS = 2
"""Times that all is looked for anew at most."""


def polished(base: Candidate, children: Iterable[Candidate], bench: Bench) -> Candidate:
    """The base model, or the deepest fit of it from the constants of its ``children``, told as it is."""
    starts = _starts(base, [c for c in children if c.log_evidence > base.log_evidence + ABOVE])
    hypothesis, observed = base.fit.hypothesis, bench.at(base.form)
    fits = each(lambda x: attempted(hypothesis, observed, x, SHORT), starts)
    tried = [candidate((), f, base.form) for f in fits if f is not None and not in_one_valley(f.x, base.fit.x)]
    best = max(tried, key=lambda c: c.log_evidence, default=base)
    if best.log_evidence <= base.log_evidence + DEEPER:
        return base
    return max(base, bench.told(bench.judged(best)), key=lambda c: c.log_evidence)


def _starts(base: Candidate, children: Sequence[Candidate]) -> list[np.ndarray]:
    """Constants of children (parameters of the base model,), each valley once, that of the best first."""
    size, out = base.fit.x.size, list[np.ndarray]()
    for child in by_evidence(children):
        x = child.fit.x[:size]
        if not any(in_one_valley(x, other) for other in (base.fit.x, *out)):
            out.append(x)
    return out


class NotConvergedError(AssertionError):
    """A search that did not converge where that must not be: in tests and benchmarks."""


def not_converged(risen: float) -> str | None:
    """Why a search did not converge of which the base model has ``risen`` in log evidence after all had been compared
    with it; None where it did."""
    if risen <= DEEPER:
        return None
    return f"the base model came to lie {risen:.1f} deeper in log evidence after all had been compared with it"


def assert_converged(why: str | None) -> None:
    """Raises NotConvergedError where a search did not converge, for ``why``."""
    if why is not None:
        raise NotConvergedError(why)
