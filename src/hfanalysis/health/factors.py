"""A factor that is off: what it may be, and whether it is that of a unit mistaken for another."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, sqrt

from hfanalysis.units import TABLE, unit_factor

MET = {"pressure": ("psi", "bar", "kPa", "MPa", "Pa"), "force": ("N", "kN", "lbf", "kgf"), "mass": ("kg", "g", "lb")}
"""Units that loggers write. Source: definition."""
FAR = 3.0
"""Factor from which on a unit is more likely mistaken than a scale [-]: below, kgf for lbf is the only one."""
WIDEST = 8.0
"""Ratio of a factor's bounds up to which it tells units apart [-]: psi and bar are a factor of 14.5 apart."""
SLACK = 0.04
"""Relative error with which a factor may be met by that of two units [-]."""


@dataclass(frozen=True)
class Factor:
    """What a channel's readings have to be multiplied by to become possible: from ``low`` to ``high`` [-]."""

    low: float
    high: float

    @property
    def middle(self) -> float:
        """Geometric mean of its bounds."""
        return sqrt(self.low * self.high)

    @property
    def off(self) -> bool:
        """Whether it cannot be one."""
        return not self.low <= 1.0 <= self.high

    def over(self, other: Factor) -> Factor:
        """What a quotient has to be multiplied by whose denominator is off by ``other``'s inverse."""
        return Factor(self.low / other.high, self.high / other.low)

    @property
    def inverse(self) -> Factor:
        """Of what divides."""
        return Factor(1.0 / self.high, 1.0 / self.low)

    def both(self, other: Factor) -> Factor | None:
        """What fits the two; None where nothing does."""
        low, high = max(self.low, other.low), min(self.high, other.high)
        return Factor(low, high) if low <= high else None


def unit_for(factor: Factor, unit: str, dimension: str, least: float = FAR) -> str | None:
    """The unit that the readings seem to be in, where they are stated in ``unit``; None where it is none of a few.

    ``least``: factor from which on a unit is thought of. A factor that may be nearly anything is no unit's.

    >>> unit_for(Factor(800.0, 1200.0), "N", "force")
    'kN'
    >>> unit_for(Factor(1.8, 2.2), "N", "force") is None
    True
    """
    known = dimension in MET and dimension in TABLE
    if not factor.off or not known or factor.high > WIDEST * factor.low:
        return None
    stated = unit_factor(unit, dimension, "")[0]
    ratios = {u: unit_factor(u, dimension, "")[0] / stated for u in MET[dimension]}
    fits = [u for u, r in ratios.items() if abs(log(r)) > log(least) and _within(r, factor)]
    return min(fits, key=lambda u: abs(log(ratios[u] / factor.middle))) if fits else None


def _within(ratio: float, factor: Factor) -> bool:
    return factor.low * (1.0 - SLACK) <= ratio <= factor.high * (1.0 + SLACK)
