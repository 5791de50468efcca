"""The verdict: what is named, with which probability, and what it rests on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import prod

from hfanalysis.diagnose.answer.borne_out import borne_out
from hfanalysis.diagnose.answer.effect_source import acting_in
from hfanalysis.diagnose.answer.limits import limits
from hfanalysis.diagnose.answer.plausible import judged, sized
from hfanalysis.diagnose.answer.posterior import (
    LEAST_EVIDENCE,
    SET,
    evidences_of,
    partners_of,
    poor_fit,
    scale,
    smallest_set,
    weights_of,
)
from hfanalysis.diagnose.answer.standing import (
    against,
    among_partners,
    among_twins,
    believed_share,
    beside_a_curve,
    best_with,
    by_laws,
    left_by_laws,
    withheld,
)
from hfanalysis.diagnose.answer.tried_on import mixed
from hfanalysis.diagnose.answer.where import elsewhere, likeliest_source, near
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.engine.effect import Parameter
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.products.diagnosis import NamedEffect
from hfanalysis.quantity import NORMAL_95, Quantity

CLAIM = 0.15
"""Probability of none from which on nothing is claimed: a wrong alarm costs more than an effect left unnamed."""

FEWER = 0.3
"""Probability of fewer effects from which on no more of them are claimed; more have paid a price before."""

LIKELIER = 1.5
"""How much more probable than none a label has to be to be mentioned where nothing is claimed."""

NAMED_FROM = 0.5
"""Probability from which on one name is the verdict; below, several are."""


@dataclass(frozen=True)
class Verdict:
    """``label``: none, named, ambiguous or unknown; probabilities of all labels; the candidate that is the answer.

    ``partners``: probabilities of effects beside the first that is named. ``elsewhere``: evidence of an unknown source
    in another equation than the best name's. ``doubts``: why what is ``chosen`` is not the whole story, where that is
    why the verdict is unknown: it is then unknown beside the names that are chosen.
    ``held_out``: log probability of held-out data beyond the base model's [natural log], by the key of a candidate.
    """

    label: str
    posterior: dict[str, float]
    evidences: dict[str, float]
    set90: list[str]
    chosen: Candidate
    partners: dict[str, float] = field(default_factory=dict)
    elsewhere: float | None = None
    doubts: tuple[str, ...] = ()
    held_out: Mapping[tuple[str, ...], float | None] = field(default_factory=dict)

    @property
    def added(self) -> tuple[str, ...]:
        """The effects in the answer; an unknown source has the name of its site and is none."""
        return self.chosen.names[: -1 if self.chosen.unknown else None]

    @property
    def top(self) -> str:
        """The label that the answer rests on: what is claimed, or none."""
        claimed = {k: p for k, p in self.posterior.items() if (k == "none") == (self.label == "none")}
        return max(claimed, key=lambda k: (claimed[k], k))


NO_TWINS: Mapping[str, tuple[str, ...]] = {}


def verdict_of(found: Naming, twins: Mapping[str, tuple[str, ...]] = NO_TWINS, misled: float = 0.0) -> Verdict:
    """Probabilities, and what they amount to.

    ``twins``: by name, those that the channels hardly tell from it. ``misled``: share [-] of tests such as this one in
    which evidence misleads, beyond that of the tests by which probabilities were fitted. Evidence counts as far as
    held-out data bear it out (:func:`hfanalysis.diagnose.answer.borne_out.borne_out`); what a name does not keep, for
    its size or for what its model misses, is unknown.
    """
    weighed = replace(
        found,
        singles=tuple(_believed(c, found.bench.observed) for c in found.singles),
        sets=tuple(_believed(c, found.bench.observed) for c in found.sets),
    )
    of_all = evidences_of(weighed)
    weighed = borne_out(weighed, _by_evidence)
    evidences, apart = evidences_of(weighed), elsewhere(weighed)
    posterior = scale().probabilities(evidences, found.named.leftover, apart)
    heat = scale().heat(found.named.leftover)
    posterior = among_twins(beside_a_curve(posterior, evidences, apart, heat), evidences, of_all, twins, heat)
    posterior = mixed(posterior, misled)
    plain = _verdict(weighed, posterior, evidences, twins)
    if plain.label in ("none", "unknown"):
        return replace(plain, elsewhere=apart, held_out=weighed.held_out)
    kept = withheld(posterior, {n: _chosen(weighed, n) for n in _tried(weighed)}, found.base, found.bench.observed)
    return replace(_with_doubts(weighed, posterior, kept, evidences, twins), elsewhere=apart, held_out=weighed.held_out)


def _tried(found: Naming) -> list[str]:
    """The first names of all candidates."""
    return list(dict.fromkeys(c.names[0] for c in (*found.singles, *found.sets)))


def _by_evidence(found: Naming) -> Verdict:
    """What the evidences alone amount to."""
    evidences = evidences_of(found)
    return _verdict(found, scale().probabilities(evidences, found.named.leftover, elsewhere(found)), evidences)


def _with_doubts(
    found: Naming, before: Mapping[str, float], kept: dict[str, float], evidences: dict[str, float],
    twins: Mapping[str, tuple[str, ...]],
) -> Verdict:  # fmt: skip
    """The verdict by what names keep; where that makes it unknown, it is so beside the name that was first."""
    top = max((n for n in before if n not in ("none", "unknown")), key=lambda n: (before[n], n))
    stands = kept[top] == before[top] or kept["unknown"] <= max(p for n, p in kept.items() if n != "unknown")
    if stands:
        return _verdict(found, kept, evidences, twins)
    chosen = _chosen(found, top)
    beside = [c for c in found.unknown if c.names[:-1] == chosen.names and c.names[:-1]]
    doubts = against(chosen, found.base, found.bench.observed) or (_size_of(chosen, found.bench.observed),)
    return Verdict("unknown", kept, evidences, smallest_set(kept), next(iter(beside), chosen), doubts=doubts)


def _size_of(chosen: Candidate, observed: Observed) -> str:
    """What is to be said of the size of a candidate's first effect."""
    return judged(sized(chosen.fit, chosen.names[0], observed)).why


def _verdict(
    found: Naming,
    posterior: dict[str, float],
    evidences: dict[str, float],
    twins: Mapping[str, tuple[str, ...]] = NO_TWINS,
) -> Verdict:
    """What probabilities amount to."""
    set90 = smallest_set(posterior)
    top = _claimed(posterior, evidences, poor_fit(found.named.leftover))
    chosen = _chosen(found, top)
    if top in ("none", "unknown"):
        return Verdict(top, posterior, evidences, set90, chosen)
    heat = scale().heat(found.named.leftover)
    others = (*found.singles, *found.sets)
    partners = by_laws(partners_of(top, found), top, found.base, others, heat, partial(near, found=found))
    partners = among_partners(partners, chosen, others, twins, heat)
    partners = {n: p * _size_beside(n, top, others, found.bench.observed) for n, p in partners.items()}
    chosen = _likeliest_beside(partners, chosen, others)
    rivals = [name for name in set90 if name not in (top, "none")]
    sure = posterior[top] >= NAMED_FROM and not rivals and all(partners[n] >= SET for n in chosen.names[1:])
    beside = {name: posterior[top] * p for name, p in partners.items()}
    return Verdict("named" if sure else "ambiguous", posterior, evidences, set90, chosen, beside)


def _size_beside(name: str, first: str, others: Sequence[Candidate], observed: Observed) -> float:
    """Part [-] of its probability that a name beside the first keeps by its size, in the best set that has both."""
    best = best_with(first, name, others)
    return 1.0 if best is None else believed_share(best, name, observed)


def _likeliest_beside(partners: Mapping[str, float], chosen: Candidate, others: Sequence[Candidate]) -> Candidate:
    """The set of as many effects with the same first whose other names are the most probable: a twin may be more so
    than the one with which the data are more probable, by its size."""
    alike = [c for c in others if c.names[0] == chosen.names[0] and len(c.names) == len(chosen.names)]
    return max(alike, key=lambda c: (prod(partners.get(n, 0.0) for n in c.names[1:]), c.log_evidence), default=chosen)


def _claimed(posterior: Mapping[str, float], evidences: Mapping[str, float], poor: bool = False) -> str:
    """The most probable label but none, where it may be claimed, or else none.

    Where all models are ``poor`` and no unknown source was found, a name is what there is to go by.
    """
    labels = [k for k in posterior if k != "none"]
    if poor and evidences.get("unknown", 0.0) < LEAST_EVIDENCE:
        labels = [k for k in labels if k != "unknown"]
    top = max(labels, key=lambda k: (posterior[k], k))
    return top if posterior["none"] < CLAIM and evidences[top] >= LEAST_EVIDENCE else "none"


def _believed(candidate: Candidate, observed: Observed) -> Candidate:
    """The candidate with what impossible sizes cost it."""
    sizes = (sized(candidate.fit, name, observed) for name in candidate.names)
    cost = sum(size.lost for size in sizes if size is not None)
    return replace(candidate, log_evidence=candidate.log_evidence - cost)


def _chosen(found: Naming, top: str) -> Candidate:
    """The candidate behind the most probable label."""
    if top == "none":
        return found.base
    if top == "unknown":
        source = likeliest_source(found)
        assert source is not None
        return source
    named = [c for c in (*found.singles, *found.sets) if c.names[0] == top]
    best = max(named, key=lambda c: c.log_evidence)
    weights = weights_of(named, found)
    while True:
        less = [(c, w) for c, w in zip(named, weights, strict=True) if len(c.names) < len(best.names)]
        least = max((c for c, _ in less), key=lambda c: c.log_evidence, default=None)
        if least is None:
            return best
        heat = scale().heat(found.named.leftover)
        left = left_by_laws(least, best, found.base, heat, partial(near, found=found))
        if max(sum(w for _, w in less), left) < FEWER:
            return best
        best = least


def effects_product(verdict: Verdict, observed: Observed) -> tuple[NamedEffect, ...]:
    """What was added to the model: name, probability [-], equation, parameters in their SI units, and how large that
    is."""
    return effects_in(verdict, observed) if verdict.label in ("named", "ambiguous") else ()


def effects_in(verdict: Verdict, observed: Observed) -> tuple[NamedEffect, ...]:
    """The effects of the library in the answer, also where it is unknown beside them; as :func:`effects_product`."""
    found = verdict.chosen.fit
    values, stds = found.values, found.stds
    out = []
    for name in verdict.added:
        active = acting_in(found)[name]
        parameters = {
            p.name: _within(p, values[full], stds[full])
            for p in active.effect.parameters
            if (full := f"{name}.{p.name}") in values
        }
        out.append(
            NamedEffect(
                name=name,
                probability=verdict.partners.get(name, verdict.posterior.get(name, verdict.posterior[verdict.top])),
                equation=active.effect.equation,
                meaning=active.effect.meaning,
                parameters=parameters,
                plausibility=judged(sized(found, name, observed)),
            )
        )
    return tuple(out)


def _within(parameter: Parameter, value: float, std: float) -> Quantity:
    """A parameter of an effect, its interval inside its bounds."""
    low, high = value - NORMAL_95 * std, value + NORMAL_95 * std
    unit = "" if parameter.unit == "-" else parameter.unit
    return Quantity(value, unit, std, (max(low, min(parameter.low, value)), min(high, max(parameter.high, value))))


def upper_limits(verdict: Verdict, found: Naming, catalogue: Catalogue) -> dict[str, Quantity]:
    """The size below which each effect that is not in the model stays with 95 % probability, in its SI unit."""
    return {
        name: Quantity.absent(UNLIMITED)
        if value is None
        else Quantity(value, unit, ci95=(0.0, abs(value)) if value >= 0 else (value, 0.0))
        for name, (value, unit) in limits(verdict.chosen, verdict.added, found.bench, catalogue).items()
    }


UNLIMITED = "these channels would not show it at any size that it can have"
"""Why an effect has no upper limit."""
