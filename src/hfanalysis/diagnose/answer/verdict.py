"""The verdict: what is named, with which probability, and what it rests on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import prod

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.answer.borne_out import borne_out
from hfanalysis.diagnose.answer.effect_source import Acting, acting, acting_in
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
    best_with,
    by_laws,
    less_likely,
    withheld,
)
from hfanalysis.diagnose.answer.where import elsewhere, likeliest_of, likeliest_source
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.engine.effect import Parameter
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknown import History
from hfanalysis.products.diagnosis import NamedEffect, Place, SourceHistory
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


def verdict_of(found: Naming, twins: Mapping[str, tuple[str, ...]] = NO_TWINS) -> Verdict:
    """Probabilities, and what they amount to.

    ``twins``: by name, those that the channels hardly tell from it. Evidence counts as far as held-out data bear it out
    (:func:`hfanalysis.diagnose.answer.borne_out.borne_out`); what a name does not keep, for its size or for what its
    model misses, is unknown.
    """
    weighed = replace(
        found,
        singles=tuple(_believed(c, found.bench.observed) for c in found.singles),
        sets=tuple(_believed(c, found.bench.observed) for c in found.sets),
    )
    weighed = borne_out(weighed, _by_evidence)
    evidences, apart = evidences_of(weighed), elsewhere(weighed)
    posterior = scale().probabilities(evidences, found.named.leftover, apart)
    posterior = among_twins(posterior, evidences, twins, scale().heat(found.named.leftover))
    plain = _verdict(weighed, posterior, evidences, twins)
    if plain.label in ("none", "unknown"):
        return replace(plain, elsewhere=apart, held_out=weighed.held_out)
    kept = withheld(posterior, {n: _chosen(weighed, n) for n in _tried(weighed)}, found.bench.observed)
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
    doubts = against(chosen, found.bench.observed) or (_size_of(chosen, found.bench.observed),)
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
    partners = by_laws(partners_of(top, found), top, found.base, others, heat)
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
        if least is None or max(sum(w for _, w in less), _behind(least, best, found)) < FEWER:
            return best
        best = least


def _behind(fewer: Candidate, best: Candidate, found: Naming) -> float:
    """Probability [-] of fewer effects, whose laws may get wrong what the best explains beyond them."""
    explained, heat = fewer.log_evidence - found.base.log_evidence, scale().heat(found.named.leftover)
    return less_likely(best.log_evidence - fewer.log_evidence, explained, heat)


def effects_product(verdict: Verdict, observed: Observed) -> tuple[NamedEffect, ...]:
    """What was added to the model: name, probability [-], equation, parameters in their SI units, and how large that
    is."""
    if verdict.label not in ("named", "ambiguous"):
        return ()
    found = verdict.chosen.fit
    values, stds = found.values, found.stds
    out = []
    for name in verdict.chosen.names:
        active = acting_in(found)[name]
        parameters = {
            p.name: _within(p, values[full], stds[full])
            for p in active.effect.parameters
            if (full := f"{name}.{p.name}") in values
        }
        out.append(
            NamedEffect(
                name=name,
                probability=verdict.partners.get(name, verdict.posterior[verdict.top]),
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


def places(verdict: Verdict, found: Naming) -> tuple[Place, ...]:
    """Where, when [s after the opening] and how much, in the unit of its equation: the source of every named effect, or
    the unknown one."""
    observed, chosen = found.bench.observed, verdict.chosen
    if verdict.label == "none":
        return ()
    gain = chosen.log_evidence - found.base.log_evidence
    out: list[Place] = []
    if chosen.unknown:
        out.append(of_unknown(chosen.history(observed), gain, observed.phases))
    for name in verdict.added:
        source = acting(chosen.fit, name, observed)
        out.append(of_acting(name, source, gain / (len(out) + 1), observed.phases))
    beside = next((c for c in found.unknown if c.names[:-1] == chosen.names and c.names[:-1]), None)
    if beside is not None and (rest := beside.log_evidence - chosen.log_evidence) > 0.0:
        row = of_unknown(beside.history(observed), rest, observed.phases)
        out.append(row.but(beside=True, significance=min(rest, 0.5 * out[-1].significance)))
    return tuple(out)


def likeliest_place(verdict: Verdict, found: Naming, equations: Iterable[str]) -> Place | None:
    """Where nothing is claimed, the place at which something would most likely be; None where nothing is seen at all.

    ``equations``: the most probable first.
    """
    if verdict.label != "none":
        return None
    likeliest = likeliest_of(equations, verdict.posterior, verdict.evidences, found)
    if likeliest is None:
        return None
    return Place(**{name: v for name, v in _of_candidate(likeliest, found).content.items() if name != "history"})


def _of_candidate(candidate: Candidate, found: Naming) -> Place:
    """The row of a single effect or a source that is not claimed."""
    observed, gain = found.bench.observed, candidate.log_evidence - found.base.log_evidence
    if candidate.unknown:
        return of_unknown(candidate.history(observed), gain, observed.phases)
    return of_acting(candidate.names[0], acting(candidate.fit, candidate.names[0], observed), gain, observed.phases)


def of_unknown(history: History, gain: float, phases: Mapping[str, float]) -> Place:
    """A row for an unknown source, in the unit of its place.

    ``gain``: log evidence for it [natural log]; ``phases``: where each begins [s after the opening].
    """
    place = history.place
    made = Acting(place.equation, place.unit, history.time, history.mean, history.std, place.sensor)
    row = of_acting(place.name, made, gain, phases, history.blur, history.stretch)
    return row.but(phase=_phase(history.time, history.of_equation, phases), **history.sizes)


SEEN = 0.05
"""Part of its largest size from which on a source is there."""

FULL = 0.9
"""Part of its largest size from which on a source has risen."""

AVERAGED = 0.75
"""Part of a source's deviation that is left in its mean over the time in which it acts: what its shape is wrong by does
not all go to one side. Evidence: chosen on the calibration split, where 0.875 of 120 intervals of sizes hold with it
(docs/blind.md)."""

Z90 = 1.6449
"""Half-width of the 90 % interval of a normal distribution, in standard deviations. Source: its quantile of 95 %."""


def of_acting(
    name: str, source: Acting, gain: float, phases: Mapping[str, float],
    blur: float | None = None, stretch: tuple[float, float] | None = None,
) -> Place:  # fmt: skip
    """A row of the localization: equation, phase, from when to when [s after the opening], how much [unit of the
    source], with bands of 90 %.

    Args:
        name: of the effect or the place.
        source: what acts, over time.
        gain: log evidence for it [natural log].
        phases: where each phase begins [s after the opening].
        blur: standard deviation of its beginning and end [s], of an unknown source.
        stretch: from when to when it acts [s after the opening], where its size does not tell.
    """
    size = np.abs(source.mean)
    there = size > SEEN * size.max()
    if blur is not None:
        there &= size > 2.0 * source.std
    if not there.any():
        there = size >= size.max()
    step = float(source.time[1] - source.time[0])
    first, last = stretch or (float(source.time[there][0]), float(source.time[there][-1]))
    inside = (source.time >= first) & (source.time <= last)
    off = max(blur or 0.0, step)
    risen = float(source.time[inside & (size >= FULL * size[inside].max())][0])
    since = _since(first, off, risen) if blur is not None and stretch is None else None
    half = Z90 * source.std
    return Place(
        equation=source.equation,
        site=name,
        phase=_phase(source.time, source.mean, phases),
        t_start=Quantity(first, "s", off, since),
        t_end=Quantity(last, "s", off),
        source=Quantity(float(source.mean[inside].mean()), source.unit, AVERAGED * float(source.std[inside].mean())),
        rms=Quantity(float(np.sqrt(np.mean(source.mean[inside] ** 2))), source.unit),
        channel=source.channel,
        significance=gain,
        history=SourceHistory(
            unit=source.unit,
            time=tuple(source.time.tolist()),
            mean=tuple(source.mean.tolist()),
            low90=tuple((source.mean - half).tolist()),
            high90=tuple((source.mean + half).tolist()),
        ),
    )


def _since(first: float, std: float, risen: float) -> tuple[float, float]:
    """When a source of unknown shape began (95 %) that is first seen at ``first`` and has ``risen`` later, all in s.

    What rises slowly was there before it could be seen: for as long, at most, as it then takes to rise.
    """
    half = NORMAL_95 * std
    unseen = max(risen - first - 2.0 * std, 0.0)
    return (max(first - half - unseen, min(first - half, 0.0)), first + half)


PHASE_NAMES = {"filling": "liquid", "nitrogen": "purge"}
"""Phases as products call them: the filling is part of the liquid phase; from t_purge on nitrogen could enter."""


def _phase(time: Array, source: Array, phases: Mapping[str, float]) -> str:
    """The phase that holds most of the squared source."""
    names = [n for n in phases if n != "end"]
    number = np.searchsorted([phases[n] for n in names], time, side="right") - 1
    weight: dict[str, float] = {}
    for i, name in enumerate(names):
        label = PHASE_NAMES.get(name, name)
        weight[label] = weight.get(label, 0.0) + float((source[number == i] ** 2).sum())
    return max(weight, key=lambda n: weight[n])


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
