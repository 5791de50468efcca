"""In which unit a column's readings are possible for a channel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.drafting.shapes import Shape
from hfanalysis.record.channels import CANONICAL
from hfanalysis.units import unit_factor

HIGHEST: dict[str, tuple[float, float]] = {
    "p_tank": (15e5, 110e5),
    "p_run": (4e5, 110e5),
    "p_chamber": (2e5, 80e5),
    "p_purge": (4e5, 350e5),
    "p_fill": (15e5, 110e5),
    "thrust": (20.0, 40e3),
    "m_tank": (0.3, 150.0),
    "T_tank": (263.0, 330.0),
    "T_run": (255.0, 340.0),
    "T_chamber": (260.0, 1600.0),
    "port_radius": (4e-3, 0.2),
    "valve": (0.0, np.inf),
}
"""Channel -> between what its highest reading is on a stand [SI]. Source: nitrous oxide in a tank has 15 to 72 bar (-30
degC to its critical point), more under nitrogen; stands of student teams push 20 N to 40 kN."""

TYPICAL: dict[str, float] = {
    "p_tank": 50e5, "p_run": 40e5, "p_chamber": 25e5, "p_purge": 50e5, "p_fill": 55e5, "thrust": 1500.0, "m_tank": 8.0,
    "T_tank": 290.0, "T_run": 288.0, "T_chamber": 320.0, "port_radius": 0.04,
}  # fmt: skip
"""A usual highest reading [SI], by which units are ranked that are all possible. Evidence: within a factor of two of
most stands whose logs are published."""

UNITS = {
    "pressure": ("psi", "bar", "kPa", "MPa", "Pa"),
    "force": ("N", "lbf", "kgf"),
    "mass": ("kg", "lb", "g"),
    "temperature": ("degC", "degF", "K"),
    "length": ("mm", "cm", "m", "in"),
    "dimensionless": ("",),
}
"""Dimension -> units in which loggers write it, the likelier first."""
RARE = 0.4
"""Points that rarer units (all but the first two) are behind. Evidence: no published log was in kPa, MPa or Pa."""

AIR = (80e3, 110e3)
"""[Pa] between which a transducer in the open air reads. Evidence: chambers of published logs rest at 14.2 to 15.8 psi;
stands may be 1500 m high (ISO 2533: 84.6 kPa)."""
AT_ZERO = 0.35e5
"""[Pa] about zero within which an absolute pressure is impossible for what is open to the air. Evidence: zeros of
transducers on real stands are off by up to 0.3 bar."""
OPEN = ("p_run", "p_chamber")
"""Channels that are open to the air before the firing."""

AT_AIR = "the open air in"
"""What a reason says of a pressure that rests where it must."""


@dataclass(frozen=True)
class Fit:
    """A unit in which a column can be a channel; ``points`` speak for it, ``reason`` says what does. ``gauge``: it
    counts from the ambient pressure.
    """

    unit: str
    points: float
    reason: str
    gauge: bool = False


def units_for(channel: str, shape: Shape, stated: str = "") -> tuple[Fit, ...]:
    """The units in which a column of this shape can be ``channel``, the likeliest first; only the ``stated`` one where
    there is one.

    >>> tank = Shape("falls", rest=951.0, end=14.0, low=14.0, high=952.0)
    >>> [fit.unit for fit in units_for("p_tank", tank)], units_for("p_tank", tank, "bar")
    (['psi'], ())
    """
    fits = [_fit(channel, shape, unit) for unit in ((stated,) if stated else UNITS[CANONICAL[channel]])]
    return tuple(sorted((fit for fit in fits if fit is not None), key=lambda fit: -fit.points))


def _fit(channel: str, shape: Shape, unit: str) -> Fit | None:
    dimension = CANONICAL[channel]
    if dimension == "dimensionless" or not np.isfinite(shape.high):
        return Fit(unit, 0.0, "")
    scale, offset = unit_factor(unit, dimension, channel)
    highest, rest = scale * shape.high + offset, scale * shape.rest + offset
    least, most = HIGHEST[channel]
    if not least <= highest <= most:
        return None
    far = abs(float(np.log10(highest / TYPICAL[channel]))) if channel in TYPICAL and highest > 0.0 else 0.0
    rare = RARE if unit in UNITS[dimension][2:] or unit == "degF" else 0.0
    points, reason, gauge = (_of_pressure if dimension == "pressure" else _of_other)(channel, shape, unit, rest)
    return Fit(unit, points - 0.5 * far - rare, reason, gauge)


def _of_pressure(channel: str, shape: Shape, unit: str, rest: float) -> tuple[float, str, bool]:
    if channel in OPEN and AIR[0] <= rest <= AIR[1]:
        return 1.0, f"it rests at {shape.rest:.4g}, which is {AT_AIR} {unit}, absolute", False
    if channel in OPEN and abs(rest) <= AT_ZERO:
        return 0.5, f"it rests at {shape.rest:.3g} {unit}, where the open air is: a gauge pressure", True
    if channel == "p_tank" and AIR[0] <= unit_factor(unit, "pressure", "")[0] * shape.end <= AIR[1]:
        return 0.8, f"it ends at {shape.end:.4g}, which is {AT_AIR} {unit}, absolute", False
    return 0.0, "", False


def _of_other(channel: str, shape: Shape, unit: str, rest: float) -> tuple[float, str, bool]:
    """Cells rest near zero; a tank that empties ends there."""
    reach = max(abs(shape.high), abs(shape.low))
    if channel == "thrust" and abs(shape.rest) < 0.1 * reach:
        return 0.3, "it rests at zero", False
    if channel == "m_tank" and abs(min(shape.end, shape.rest)) < 0.25 * reach:
        return 0.3, "empty it reads nearly zero", False
    if CANONICAL[channel] == "temperature" and 258.0 < rest < 316.0:
        return 0.3, f"it rests at {shape.rest:.3g} {unit}, as the air does", False
    return 0.0, "", False
