"""How a number reads: its name in words, the unit people use, and no more digits than it deserves."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

NAMES: dict[str, str] = {
    "C_i": "injector coefficient",
    "m": "polytropic exponent",
    "Z": "vapour compressibility",
    "K_loss": "feed loss coefficient",
    "p_loss_liquid": "liquid-phase feed loss",
    "p_loss_vapor": "vapour-phase feed loss",
    "t_open": "valve opens (log time)",
    "t_feed": "feed line full",
    "t_v": "liquid gone",
    "t_purge": "nitrogen enters",
    "t_fuel_out": "solid fuel gone",
    "t_end": "chamber unchokes",
    "a": "regression coefficient",
    "n": "regression exponent",
    "oxidizer_flow_peak": "peak oxidizer flow",
    "oxidizer_mass_liquid_phase": "oxidizer used as liquid",
    "mass_at_t_feed": "oxidizer at t_feed",
    "vapor_mass_at_t_v": "vapour left at t_v",
}
"""The quantities of the products, in the order in which they are shown."""

EVENTS = ("t_open", "t_feed", "t_v", "t_purge", "t_fuel_out", "t_end")
MASTHEAD = ("C_i", "m", "Z", "K_loss", "p_loss_liquid", "p_loss_vapor")
"""What a calibration is asked for first."""

SOURCES: dict[str, str] = {
    "replica": "REPLICA: generated, not measured",
    "synthetic": "SYNTHETIC: generated, not measured",
    "measured": "measured",
}
"""What is said of a test's source wherever its results show."""

KINDS: dict[str, str] = {"hot_fire": "hot fire", "cold_flow": "cold flow"}

_PEOPLE: dict[str, tuple[float, str]] = {"Pa": (1e-5, "bar"), "m^2": (1e6, "mm²"), "m^3": (1e3, "L")}
_FINEST: dict[str, int] = {"s": 4}
"""Decimals beyond which nobody reads."""
_NOTHING = 1e-200
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MINUS = "\N{MINUS SIGN}"


@dataclass(frozen=True)
class Shown:
    """A quantity as text: each part empty where it is not known."""

    value: str
    std: str
    interval: str
    unit: str
    verdict: str
    why: str

    @property
    def with_unit(self) -> str:
        """Value and unit, for a line of text."""
        return f"{self.value} {self.unit}".strip()


def people_unit(unit: str) -> tuple[float, str]:
    """(factor, unit): multiply an SI value to have it in the unit people at a test stand use."""
    return _PEOPLE.get(unit, (1.0, pretty_unit(unit)))


def pretty_unit(unit: str) -> str:
    """The unit with real superscripts.

    >>> pretty_unit("1/m^4")
    '1/m⁴'
    """
    head, *powers = unit.split("^")
    for power in powers:
        digits = len(power) - len(power.lstrip("-0123456789"))
        head += power[:digits].translate(_SUPERSCRIPT) + power[digits:]
    return "" if head == "1" else head


def shown(quantity: Mapping[str, Any]) -> Shown:
    """A quantity of a product (``{"value": …}``) as people read it."""
    verdict = str(quantity.get("verdict") or "")
    if quantity.get("value") is None:
        return Shown("–", "", "", "", verdict or "absent", str(quantity.get("reason") or ""))
    factor, unit = people_unit(str(quantity.get("unit") or ""))
    value, std = factor * quantity["value"], factor * (quantity.get("std") or 0.0)
    exponent = 0 if unit == "s" else _exponent(max(abs(value), std))
    if exponent:
        factor, unit = factor / 10.0**exponent, f"×10{str(exponent).translate(_SUPERSCRIPT)} {unit}".strip()
        value, std = value / 10.0**exponent, std / 10.0**exponent
    decimals = min(decimals_for(value, std), _FINEST.get(unit, 8))
    interval = [fixed(factor * end, decimals) for end in quantity.get("ci95") or ()]
    return Shown(
        fixed(value, decimals),
        fixed(std, decimals) if quantity.get("std") else "",
        " … ".join(interval),
        unit,
        verdict,
        str(quantity.get("why") or ""),
    )


def _exponent(size: float) -> int:
    """The power of ten to take out of numbers that are awkward to read: 0 for most."""
    if size < _NOTHING or 1e-3 <= size < 1e5:
        return 0
    return math.floor(math.log10(size))


def decimals_for(value: float, std: float) -> int:
    """Decimals that show two digits of the standard deviation, or four digits of a value that has none."""
    scale = std if std > 0.0 else abs(value) * 1e-2
    if not (scale > 0.0 and math.isfinite(scale)):
        return 3
    return min(8, max(0, 1 - math.floor(math.log10(scale))))


def fixed(value: float, decimals: int) -> str:
    """The number with a true minus sign.

    >>> fixed(-1.25, 1)
    '−1.2'
    """
    text = f"{value:.{decimals}f}"
    return text.replace("-", _MINUS) if float(text) else text.replace("-", "")


def tidy(value: float, digits: int = 4) -> str:
    """A number without uncertainty, to a few digits.

    >>> tidy(-0.001234567)
    '−0.001235'
    """
    return f"{value:.{digits}g}".replace("-", _MINUS)


def is_quantity(data: Any) -> bool:
    """Whether a part of a product is a quantity."""
    return isinstance(data, Mapping) and "value" in data and ("unit" in data or "reason" in data)


def quantities(product: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """The quantities of a product, the known ones in their usual order, then the others as they come."""
    found = {name: data for name, data in product.items() if is_quantity(data)}
    order = [*(name for name in NAMES if name in found), *(name for name in found if name not in NAMES)]
    return {name: found[name] for name in order}


def in_words(name: str) -> str:
    """The name of a quantity in words.

    >>> in_words("t_v"), in_words("tank_rest_pressure")
    ('liquid gone', 'tank rest pressure')
    """
    return NAMES.get(name, name.replace("_", " "))
