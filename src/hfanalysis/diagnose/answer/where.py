"""In which equation something is missing, whatever its name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from hfanalysis.diagnose.answer.posterior import counts_as_unknown, kind
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.observations.observed import Observed

ALIKE = ("tank_energy", "tank_volume"), ("grain", "chamber_mass", "chamber_energy")
"""Equations whose sources show in one pressure, and may be taken for each other."""

ORIFICES = "injector", "feed"
"""The same where the pressure between them was not recorded."""


def elsewhere(found: Naming) -> float | None:
    """Log evidence [natural log], that of none being 0, of the best unknown source alone that acts in no equation of
    the best name's effects, nor in one like it: it is no part of these that their closures get wrong. None without
    one."""
    taken = {e for name in found.named.names for e in _with_alike(found.equations[name], found.bench.observed)}
    apart = [c for c in found.unknown if len(c.names) == 1 and c.source is not None and not c.source.equations & taken]
    best = max((c.log_evidence for c in apart), default=None)
    return None if best is None else best - found.base.log_evidence


def near(some: Iterable[str], others: Iterable[str], found: Naming) -> bool:
    """Whether some effects act where others do, in the same equation or in one like it; a sensor's show where what it
    reads does."""
    taken = {e for name in others for e in _with_alike(found.equations[name], found.bench.observed)}
    mine = {found.equations[name] for name in some}
    return "sensor" in taken | mine or bool(taken & mine)


def _with_alike(equation: str, observed: Observed) -> set[str]:
    groups = ALIKE if "p_run" in observed.names else (*ALIKE, ORIFICES)
    return {equation}.union(*(group for group in groups if equation in group))


def by_equation(posterior: Mapping[str, float], found: Naming) -> dict[str, float]:
    """Probability [-] that the first of what is missing is in an equation; the most probable first.

    That of ``unknown`` goes to the equation of its likeliest source.
    """
    out: dict[str, float] = {}
    for label, p in posterior.items():
        if kind(label) == "named":
            out[found.equations[label]] = out.get(found.equations[label], 0.0) + p
    if (source := likeliest_source(found)) is not None:
        equation = equation_of(source, found)
        out[equation] = out.get(equation, 0.0) + posterior["unknown"]
    return dict(sorted(out.items(), key=lambda item: (-item[1], item[0])))


def equation_of(candidate: Candidate, found: Naming) -> str:
    """The equation of an unknown source, or of the first effect of a candidate."""
    if candidate.unknown:
        return candidate.history(found.bench.observed).place.equation
    return found.equations[candidate.names[0]]


def likeliest_source(found: Naming) -> Candidate | None:
    """The unknown source with most evidence, of those that count as an answer."""
    strange = [c for c in found.unknown if counts_as_unknown(c, found)]
    return max(strange, key=lambda c: c.log_evidence, default=None)


def likeliest_of(
    equations: Iterable[str], posterior: Mapping[str, float], evidences: Mapping[str, float], found: Naming
) -> Candidate | None:
    """Of the first of ``equations`` in which a single effect or a source explains anything, the most probable one."""
    source = likeliest_source(found)
    rivals = {c.names[0]: c for c in reversed(found.singles)} | ({} if source is None else {"unknown": source})
    seen = {label: c for label, c in rivals.items() if evidences[label] > 0.0}
    for equation in equations:
        here = [label for label, c in seen.items() if equation_of(c, found) == equation]
        if here:
            return seen[max(here, key=lambda label: (posterior[label], label))]
    return None
