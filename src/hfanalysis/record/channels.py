"""The canonical channels and what is assumed of a sensor where nobody says.

The class defaults of accuracy are one standard deviation of a sensor's bias. They are those of ordinary test-stand
hardware (pressure transducers of 0.5 % of what they read, S-beam cells, bare thermocouples of tolerance class 2) and
are marked as defaults wherever they are used.
"""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.units import DIMENSIONS

CANONICAL: dict[str, str] = {
    "p_tank": "pressure",
    "p_run": "pressure",
    "p_chamber": "pressure",
    "p_purge": "pressure",
    "p_fill": "pressure",
    "thrust": "force",
    "m_tank": "mass",
    "T_tank": "temperature",
    "T_run": "temperature",
    "T_chamber": "temperature",
    "port_radius": "length",
    "valve": "dimensionless",
}
"""Canonical channel -> dimension. Other channels are carried through under their own names."""

LONG_NAMES: dict[str, str] = {
    "p_tank": "run tank pressure",
    "p_run": "run line pressure",
    "p_chamber": "chamber pressure",
    "p_purge": "nitrogen purge line pressure",
    "p_fill": "fill line pressure",
    "thrust": "thrust",
    "m_tank": "tank mass",
    "T_tank": "tank temperature",
    "T_run": "run line temperature",
    "T_chamber": "chamber temperature",
    "port_radius": "radius of the grain's port",
    "valve": "main valve position",
}


def unit_of(channel: str) -> str:
    """The SI unit of a canonical channel.

    >>> unit_of("thrust")
    'N'
    """
    return DIMENSIONS[CANONICAL[channel]].si


@dataclass(frozen=True)
class AccuracyClass:
    """A default accuracy: a share of the largest reading, but no less than ``least`` [SI]."""

    least: float
    share: float = 0.0

    def of(self, largest: float) -> float:
        """One standard deviation of the bias [SI] of a sensor whose largest reading is ``largest`` [SI]."""
        return max(self.least, self.share * largest)


ACCURACY: dict[str, AccuracyClass] = {
    "pressure": AccuracyClass(20e3, 0.005),
    "force": AccuracyClass(5.0, 0.01),
    "mass": AccuracyClass(0.05, 0.005),
    "temperature": AccuracyClass(2.5),
    "length": AccuracyClass(5e-4),
    "dimensionless": AccuracyClass(0.0),
}
"""Dimension -> default accuracy [Pa, N, kg, K, m]. Source: ordinary hardware: pressure transducers of 0.5 % of what
they read, S-beam cells, bare thermocouples of tolerance class 2 (IEC 60584-1: 2.5 K up to 333 degC); of a port by
ultrasound half a millimeter, by choice."""

OTHER_ACCURACY = AccuracyClass(0.0, 0.01)
"""For every other dimension: 1 % of the largest reading."""


def default_accuracy(dimension: str, largest: float) -> float:
    """The documented class default [SI] for a sensor of this dimension whose ``largest`` reading is given [SI].

    >>> default_accuracy("pressure", 60e5), default_accuracy("force", 3000.0)
    (30000.0, 30.0)
    """
    return ACCURACY.get(dimension, OTHER_ACCURACY).of(abs(largest))
