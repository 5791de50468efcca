"""The firings and flows of a log: where run line, chamber or thrust leave their rest and come back to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from hfanalysis.record.signals import Signal
from hfanalysis.segment.opening import SMALLEST_CHANGE, despiked

LEADS = ("p_run", "p_chamber", "thrust")
"""Channels at rest before a valve opens and after what it let through."""

BLOCK = 0.1
"""Seconds of the means that are looked at. Evidence: with the running median of five over them a spike is no firing."""

LARGE, OVER = 0.5, 0.25
"""Parts of a channel's largest rise from which on it is a firing's, and below which that firing is over. Evidence:
test_firings.py: a pulse of purge gas is none; a chamber that swings within a firing does not end it."""

SHORTEST = 0.3
"""Seconds for which a rise is held at least: less is an igniter's or a valve's stroke."""

APART = 1.0
"""Seconds of rest between two firings; a fire that chuffs comes back sooner."""

AS_LARGE = 0.8
"""Part of the largest from which on an earlier firing counts as large: two alike differ by some per cent."""


@dataclass(frozen=True)
class Flow:
    """From when to when [s, log time] something flows, and the stretch [s] in which its events are looked for."""

    start: float
    end: float
    since: float
    until: float


def find_flows(signals: Mapping[str, Signal]) -> list[Flow]:
    """All that flows in a log, in order of time; the stretches in which their events lie do not overlap.

    A channel that is up already in the first sample does not say when something began.
    """
    found = [stretch for name in LEADS if name in signals for stretch in _stretches(signals[name])]
    merged = _merged(found)
    between = [0.5 * (before[1] + after[0]) for before, after in pairwise(merged)]
    since, until = [-np.inf, *between], [*between, np.inf]
    return [Flow(*span, since[i], until[i]) for i, span in enumerate(merged)]


def largest(flows: Sequence[Flow], signals: Mapping[str, Signal], fire: bool) -> int:
    """Index of the first of the largest flows: by what the chamber or the cell sees of a ``fire``, else the line."""
    names = ("p_chamber", "thrust", "p_run") if fire else ("p_run", "p_chamber", "thrust")
    name = next(name for name in names if name in signals)
    sizes = np.array([_size(signals[name], flow) for flow in flows])
    return int(np.flatnonzero(sizes >= AS_LARGE * sizes.max())[0])


def _stretches(signal: Signal) -> list[tuple[float, float]]:
    coarse = signal.reduced(BLOCK)
    value = despiked(coarse.value)
    rest, top = float(np.percentile(value, 2.0)), float(value.max())
    if top - rest < max(SMALLEST_CHANGE[signal.name], 12.0 * coarse.noise):
        return []
    state = np.where(value > rest + LARGE * (top - rest), 1, np.where(value < rest + OVER * (top - rest), -1, 0))
    known = np.maximum.accumulate(np.where(state != 0, np.arange(state.size), 0))
    up = np.r_[state[known] > 0, False]
    turns = np.diff(up.astype(int))
    begins = np.flatnonzero(turns > 0) + 1
    ends = np.flatnonzero(turns < 0)
    ends = ends[ends.size - begins.size :]  # a first end without a beginning is of what was on from the first sample
    spans = [(float(coarse.time[a]), float(coarse.time[b])) for a, b in zip(begins, ends, strict=True)]
    return [(a, b) for a, b in spans if b - a >= SHORTEST]


def _merged(spans: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    merged: list[tuple[float, float]] = []
    for start, end in sorted(spans):
        if merged and start < merged[-1][1] + APART:
            merged[-1] = (merged[-1][0], max(end, merged[-1][1]))
        else:
            merged.append((start, end))
    return merged


def _size(signal: Signal, flow: Flow) -> float:
    part = signal.between(flow.start, flow.end)
    rest = float(np.percentile(signal.value, 2.0))
    return float(np.trapezoid(part.value - rest, part.time)) if part.time.size > 1 else 0.0
