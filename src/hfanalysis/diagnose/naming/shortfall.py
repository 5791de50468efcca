"""Whether the search came to its end: an effect at strength zero is the base model, and may be no better than it.

Where one is, the base model's fit ended in a valley that is not its deepest, and whatever bends it out of there poses
as an explanation.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.inference.candidate import SHORT, Bench, Candidate, attempted, candidate
from hfanalysis.inference.fitting.threads import each

MOST = 0.5
"""Log evidence by which a child at strength zero may stand above the base model."""

NEAREST = 4
"""Children, of those with most evidence, from whose constants the base model is fitted again."""


class NotConvergedError(AssertionError):
    """A search that did not converge where that must not be: in tests and benchmarks."""


def deeper(found: Naming) -> tuple[str, Candidate] | None:
    """The child at strength zero that stands more than MOST above the base model, and the base model there; None where
    the search converged."""
    children = [c for c in found.singles if c.log_evidence > found.base.log_evidence][:NEAREST]
    fitted = each(partial(_at_zero, base=found.base, bench=found.bench), children)
    told = [(c.names[0], there) for c, there in zip(children, fitted, strict=True) if there is not None]
    best = max(told, key=lambda one: one[1].log_evidence, default=None)
    return best if best is not None and best[1].log_evidence > found.base.log_evidence + MOST else None


def _at_zero(child: Candidate, base: Candidate, bench: Bench) -> Candidate | None:
    """A child without its effect, at the base model's form; None where it cannot be run."""
    start = child.fit.x[: base.fit.x.size]
    again = attempted(base.fit.hypothesis, bench.at(base.form), start, SHORT)
    return None if again is None else candidate((), again, base.form)


def on_firm_ground(found: Naming) -> tuple[Naming, str | None]:
    """The same on the deeper base model, where a child leads to one, and why the search did not converge; else None."""
    better = deeper(found)
    if better is None:
        return found, None
    name, base = better
    gain = base.log_evidence - found.base.log_evidence
    why = f"{name} at strength zero, which is the base model, is more probable than it by {gain:.1f} in log evidence"
    return replace(found, base=base), why


def assert_converged(why: str | None) -> None:
    """Raises NotConvergedError where a search did not converge, for ``why``."""
    if why is not None:
        raise NotConvergedError(why)
