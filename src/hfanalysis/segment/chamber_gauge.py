"""How far the chamber's gauge can be believed near ambient: its zero, its noise, and how the limit of t_end reads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.noise import Noise
from hfanalysis.record.quiet import Trace, level
from hfanalysis.record.signals import Signal
from hfanalysis.segment.end_of_burn import CRITICAL_RATIO, QUIET, WANDERS

LARGEST_OFFSET = 3e5
"""Reading of an open chamber this far from ambient [Pa] is no bias: the chamber was not open."""

MUCH_MORE = 4.0
"""Times the usual wander of the pressures at rest above which one is not at rest."""


def offset(chamber: Signal, ambient: float) -> float:
    """How far the open ``chamber`` reads from ``ambient`` before the opening [Pa]: a bias, where it may be one.

    Of readings that are coarse the mean says more than the median, which is one of them.
    """
    quiet = chamber.between(*QUIET)
    rest = level(Trace(quiet.time, quiet.value))
    off = rest.value - ambient if rest is not None else 0.0
    return off if abs(off) < LARGEST_OFFSET else 0.0


def noise(signals: Mapping[str, Signal]) -> Noise:
    """The chamber sensor's, its wander judged with that of the other pressures: the quiet time alone is short."""
    noises = {n: Noise.of(s, s.between(*WANDERS)) for n, s in signals.items() if n.startswith("p_")}
    all_of_them = np.array([noise.flicker for noise in noises.values()])
    usual = float(all_of_them[all_of_them <= MUCH_MORE * np.median(all_of_them)].mean())
    return replace(noises["p_chamber"], flicker=0.5 * (noises["p_chamber"].flicker + usual))


def limit_std(definition: TestDefinition, zero_std: float) -> float:
    """Standard deviation [Pa] of how 1.8 times ambient reads: the chamber's zero, and the air's pressure."""
    of_air = (CRITICAL_RATIO - 1.0) * (definition.ambient_pressure.std or 0.0)
    return float(np.hypot(of_air, zero_std))
