"""Where and when the model lacks what, and how much: the rows of what is claimed, or of what is likeliest."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.answer.effect_source import Acting, acting
from hfanalysis.diagnose.answer.verdict import Verdict
from hfanalysis.diagnose.answer.where import likeliest_of
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.unknown import History
from hfanalysis.products.diagnosis import Place, SourceHistory
from hfanalysis.quantity import NORMAL_95, Quantity


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
