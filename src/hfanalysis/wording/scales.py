"""The two systems of units a page is read in: SI as people at a stand use it, and the team's psi, lbf and ft."""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.units import TABLE

SYSTEMS = ("si", "team")
"""How the page names them: SI (bar, N, m) and the team's (psi, lbf, ft)."""

_SUPERSCRIPT = str.maketrans("-0123456789n", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹ⁿ")

SLOW = "m/s, slow"
"""The key of velocities of a burning surface, which nobody gives in m/s."""


@dataclass(frozen=True)
class Scale:
    """From an SI value to the number shown: ``factor * value + zero`` in ``unit``; a difference leaves ``zero`` out."""

    factor: float
    unit: str
    zero: float = 0.0

    def __call__(self, value: float) -> float:
        return self.factor * value + self.zero


def _per(dimension: str, unit: str) -> float:
    return 1.0 / TABLE[dimension][unit][0]


_SI: dict[str, Scale] = {
    "Pa": Scale(1e-5, "bar"),
    "m^2": Scale(1e6, "mm²"),
    "m^3": Scale(1e3, "L"),
    "N s": Scale(1.0, "N s"),
    SLOW: Scale(1e3, "mm/s"),
}
_TEAM: dict[str, Scale] = {
    **_SI,
    "Pa": Scale(_per("pressure", "psi"), "psi"),
    "N": Scale(_per("force", "lbf"), "lbf"),
    "N s": Scale(_per("force", "lbf"), "lbf s"),
    "m": Scale(_per("length", "ft"), "ft"),
    "m/s": Scale(_per("velocity", "ft/s"), "ft/s"),
    "m/s^2": Scale(_per("length", "ft"), "ft/s²"),
    "K": Scale(1.0, "°C", -273.15),
}
"""Masses and flows stay in kg: so the team weighs."""

_BY_SYSTEM = {"si": _SI, "team": _TEAM}
_SPELLED = {"N*s": "N s", "N.s": "N s", "N·s": "N s", "N-s": "N s", "1": ""}
_SLOW_NAMES = ("regression_rate",)


def scale(unit: str, system: str = "si") -> Scale:
    """How values in the SI unit ``unit`` are shown in a system.

    >>> round(scale("Pa", "team")(6894757.0)), scale("kg/m^3").unit
    (1000, 'kg/m³')
    """
    unit = _SPELLED.get(unit, unit)
    return _BY_SYSTEM[system].get(unit) or Scale(1.0, pretty_unit(unit))


def reading_unit(name: str, unit: str) -> str:
    """The key under which a named quantity finds its scale.

    >>> reading_unit("regression_rate_reference", "m/s") == SLOW
    True
    """
    return SLOW if unit == "m/s" and name.startswith(_SLOW_NAMES) else unit


def superscript(number: int) -> str:
    """A whole number as an exponent.

    >>> superscript(-4)
    '⁻⁴'
    """
    return str(number).translate(_SUPERSCRIPT)


def pretty_unit(unit: str) -> str:
    """The unit with real superscripts.

    >>> pretty_unit("1/m^4")
    '1/m⁴'
    >>> pretty_unit("m/s (kg/m^2/s)^-n")
    'm/s (kg/m²/s)⁻ⁿ'
    """
    head, *powers = unit.split("^")
    for power in powers:
        digits = len(power) - len(power.lstrip("-0123456789n"))
        head += power[:digits].translate(_SUPERSCRIPT) + power[digits:]
    return "" if head == "1" else head
