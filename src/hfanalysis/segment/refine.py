"""From a rough instant to a fitted one: windows and candidate grids for the break search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal
from hfanalysis.segment.breaks import RELAXATIONS, Break, Design, combine, find_break, kink, relaxation, rounded_kink

COARSE, FINE = 41, 61
"""Instants tried over the reach of a search, and around the best of them."""

ROUNDINGS = (0.05, 0.1, 0.2, 0.35, 0.5, 0.7)
"""Seconds over which a real knee may spread: the last liquid leaves as froth. Evidence: test_breaks.py: a rounded knee
is dated at its middle with its width as doubt."""


def refine_kink(
    signal: Signal,
    rough: float,
    before: float,
    after: float,
    reach: float,
    flat: bool = False,
    noise: Noise | None = None,
) -> Break | None:
    """A change of slope near ``rough`` [s]: window [rough - ``before``, rough + ``after``], searched within ``reach``
    [s].

    All in seconds [s] of the signal's time. ``flat`` says that the signal is constant before the break; ``noise`` is
    that of its sensor. None where the window holds too few samples.
    """
    design = kink(order=2, before=0 if flat else 2)
    return _search([signal], rough, before, after, reach, [design], (0.0,), noise)


def refine_knee(signal: Signal, rough: float, before: float, after: float, reach: float, noise: Noise) -> Break | None:
    """A change of slope near ``rough`` [s] that may take its time: sharp, or spread over one of ROUNDINGS seconds.

    Looked for within ``reach`` [s] in [rough - ``before``, rough + ``after``] [s]. The break's ``relaxation`` [s] is
    that time; the instant is its middle and its deviation grows with it.
    """
    designs = [kink(order=2), *(rounded_kink(w) for w in ROUNDINGS)]
    found = _search([signal], rough, before, after, reach, designs, (0.0, *ROUNDINGS), noise)
    if found is None:
        return None
    return replace(found, std=float(np.hypot(found.std, found.relaxation / np.sqrt(12.0))))


def refine_step(
    signals: Sequence[Signal],
    rough: float,
    before: float,
    after: float,
    reach: float,
    order: int = 1,
    jumps: Sequence[float] = (),
) -> Break | None:
    """A sudden change that relaxes, in one or several signals at the same instant; ``order`` of the curve before it.

    ``jumps`` are time constants [s] with which it may relax after a part of it has come at once.

    Looked for within ``reach`` [s] of ``rough`` [s] in [rough - ``before``, rough + ``after``] [s]. None where the
    window holds too few samples.
    """
    simple: list[Design] = [relaxation(c, before=order) for c in RELAXATIONS]
    designs = simple + [relaxation(c, order, jumps=True) for c in jumps]
    return _search(signals, rough, before, after, reach, designs, (*RELAXATIONS, *jumps), richer=len(jumps))


def _search(
    signals: Sequence[Signal],
    rough: float,
    before: float,
    after: float,
    reach: float,
    designs: Sequence[Design],
    constants: Sequence[float],
    noise: Noise | None = None,
    richer: int = 0,
) -> Break | None:
    windows = [s.between(rough - before, rough + after) for s in signals]
    windows = [w for w in windows if _enough(w, rough)]
    if not windows:
        return None
    found = _profile(windows, np.linspace(rough - reach, rough + reach, COARSE), designs, constants, noise, richer)
    step = min(w.step for w in windows)
    zoom = min(max(5.0 * found.std, 2.5 * step, 2.0 * reach / COARSE), reach)
    return _profile(windows, np.linspace(found.time - zoom, found.time + zoom, FINE), designs, constants, noise, richer)


def _profile(
    windows: Sequence[Signal],
    candidates: Array,
    designs: Sequence[Design],
    constants: Sequence[float],
    noise: Noise | None,
    richer: int,
) -> Break:
    breaks = [find_break(w, candidates, designs, constants, noise, richer) for w in windows]
    return combine(breaks, min(w.step for w in windows))


def _enough(window: Signal, rough: float) -> bool:
    left = int(np.searchsorted(window.time, rough))
    return left >= 4 and window.time.size - left >= 4
