"""Units at the edge: what an engineer writes becomes a number in SI; nothing inside the package carries a unit.

One table holds the units met at a test stand, so that no unit library has to be loaded for them; a test checks every
entry against pint. Any other unit is looked up in pint, which is imported only then.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from hfanalysis.errors import InputError


@dataclass(frozen=True)
class Value:
    """A number in SI as an engineer states it; ``std`` is its standard deviation, None where none is stated."""

    value: float
    std: float | None = None


@dataclass(frozen=True)
class Dimension:
    """A physical dimension: its SI unit, as the products and as pint write it, and an example for messages."""

    si: str
    pint: str
    example: str
    of: str | None = None
    """The dimension whose units a difference shares (without zero points)."""


DIMENSIONS: dict[str, Dimension] = {
    "pressure": Dimension("Pa", "Pa", "55.2 bar"),
    "pressure_difference": Dimension("Pa", "Pa", "0.345 bar", of="pressure"),
    "mass": Dimension("kg", "kg", "8.35 kg"),
    "length": Dimension("m", "m", "610 mm"),
    "area": Dimension("m^2", "m**2", "3.142 mm^2"),
    "volume": Dimension("m^3", "m**3", "16.5 L"),
    "time": Dimension("s", "s", "5.27 s"),
    "frequency": Dimension("1/s", "1/s", "1 kHz"),
    "temperature": Dimension("K", "K", "20 degC"),
    "temperature_difference": Dimension("K", "delta_degC", "2 K", of="temperature"),
    "force": Dimension("N", "N", "2.78 kN"),
    "density": Dimension("kg/m^3", "kg/m**3", "900 kg/m^3"),
    "angle": Dimension("rad", "rad", "6 deg"),
    "mass_flow": Dimension("kg/s", "kg/s", "2.5 kg/s"),
    "velocity": Dimension("m/s", "m/s", "30 m/s"),
    "power": Dimension("W", "W", "0.9 kW"),
    "heat_capacity": Dimension("J/K", "J/K", "900 J/K"),
    "specific_energy": Dimension("J/kg", "J/kg", "-1.96 MJ/kg"),
    "molar_energy": Dimension("J/mol", "J/mol", "-554 kJ/mol"),
    "loss_coefficient": Dimension("1/m^4", "1/m**4", "6.4e8 1/m^4"),
    "voltage": Dimension("V", "V", "5 V"),
    "current": Dimension("A", "A", "20 mA"),
    "dimensionless": Dimension("1", "dimensionless", "0.529"),
}

_PSI = 4.4482216152605 / 0.0254**2
"""[Pa]. Source: definition: one lbf on a square inch."""
_LB = 0.45359237
"""[kg]. Source: definition (international avoirdupois pound, 1959)."""
_LBF = 4.4482216152605
"""[N]. Source: definition: one lb at standard gravity."""
_G = 9.80665
"""[m/s^2]. Source: standard gravity (CGPM 1901)."""
_INCH = 0.0254
"""[m]. Source: definition (international inch, 1959)."""
_FAHRENHEIT = 5.0 / 9.0
"""[K]. Source: definition: 180 degrees Fahrenheit are 100 K."""

TABLE: dict[str, dict[str, tuple[float, float]]] = {
    "pressure": {
        "Pa": (1.0, 0.0), "hPa": (100.0, 0.0), "kPa": (1e3, 0.0), "MPa": (1e6, 0.0), "bar": (1e5, 0.0),
        "mbar": (100.0, 0.0), "atm": (101325.0, 0.0), "psi": (_PSI, 0.0), "mmHg": (133.322387415, 0.0),
        "inHg": (3386.38864034, 0.0), "torr": (101325.0 / 760.0, 0.0),
    },
    "mass": {"kg": (1.0, 0.0), "g": (1e-3, 0.0), "lb": (_LB, 0.0), "oz": (_LB / 16, 0.0)},
    "length": {
        "m": (1.0, 0.0), "mm": (1e-3, 0.0), "cm": (1e-2, 0.0), "km": (1e3, 0.0), "um": (1e-6, 0.0), "in": (_INCH, 0.0),
        "ft": (0.3048, 0.0),
    },
    "area": {
        "m^2": (1.0, 0.0), "mm^2": (1e-6, 0.0), "cm^2": (1e-4, 0.0), "in^2": (_INCH**2, 0.0), "ft^2": (0.3048**2, 0.0),
    },
    "volume": {
        "m^3": (1.0, 0.0), "L": (1e-3, 0.0), "mL": (1e-6, 0.0), "cm^3": (1e-6, 0.0), "mm^3": (1e-9, 0.0),
        "in^3": (_INCH**3, 0.0), "ft^3": (0.3048**3, 0.0), "gal": (231 * _INCH**3, 0.0),
    },
    "time": {
        "s": (1.0, 0.0), "ms": (1e-3, 0.0), "us": (1e-6, 0.0), "ns": (1e-9, 0.0), "min": (60.0, 0.0),
        "h": (3600.0, 0.0),
    },
    "frequency": {"Hz": (1.0, 0.0), "kHz": (1e3, 0.0), "1/s": (1.0, 0.0)},
    "temperature": {
        "K": (1.0, 0.0), "degC": (1.0, 273.15), "degF": (_FAHRENHEIT, 459.67 * _FAHRENHEIT), "degR": (_FAHRENHEIT, 0.0),
    },
    "force": {"N": (1.0, 0.0), "kN": (1e3, 0.0), "lbf": (_LBF, 0.0), "kgf": (_G, 0.0)},
    "density": {"kg/m^3": (1.0, 0.0), "g/cm^3": (1e3, 0.0), "kg/L": (1e3, 0.0)},
    "angle": {"rad": (1.0, 0.0), "deg": (math.pi / 180.0, 0.0)},
    "mass_flow": {"kg/s": (1.0, 0.0), "g/s": (1e-3, 0.0), "lb/s": (_LB, 0.0)},
    "velocity": {"m/s": (1.0, 0.0), "ft/s": (0.3048, 0.0)},
    "power": {"W": (1.0, 0.0), "kW": (1e3, 0.0)},
    "heat_capacity": {"J/K": (1.0, 0.0), "kJ/K": (1e3, 0.0)},
    "specific_energy": {"J/kg": (1.0, 0.0), "kJ/kg": (1e3, 0.0), "MJ/kg": (1e6, 0.0), "J/g": (1e3, 0.0)},
    "molar_energy": {"J/mol": (1.0, 0.0), "kJ/mol": (1e3, 0.0), "cal/mol": (4.184, 0.0), "kcal/mol": (4184.0, 0.0)},
    "loss_coefficient": {"1/m^4": (1.0, 0.0)},
    "voltage": {"V": (1.0, 0.0), "mV": (1e-3, 0.0)},
    "current": {"A": (1.0, 0.0), "mA": (1e-3, 0.0)},
    "dimensionless": {"": (1.0, 0.0), "1": (1.0, 0.0), "-": (1.0, 0.0), "%": (0.01, 0.0)},
}  # fmt: skip
"""Per dimension: unit -> (scale, offset) with SI = scale * x + offset. Source: definitions; test_units.py checks every
entry against pint."""

GAUGE: dict[str, str] = {"psig": "psi", "barg": "bar", "kPag": "kPa", "MPag": "MPa", "mbarg": "mbar", "bar(g)": "bar",
                         "psi(g)": "psi"}  # fmt: skip
"""Units that count from the ambient pressure."""

ALIASES: dict[str, dict[str, str]] = {
    "pressure": {
        "psia": "psi", "lbf/in^2": "psi", "bara": "bar", "bar(a)": "bar", "psi(a)": "psi", "kPaa": "kPa", "MPaa": "MPa",
        "millibar": "mbar", "bars": "bar", "N/m^2": "Pa",
    } | GAUGE,
    "mass": {"lbs": "lb", "lbm": "lb", "pound": "lb", "pounds": "lb", "gram": "g", "grams": "g", "kilogram": "kg",
             "kilograms": "kg", "kgs": "kg"},
    "length": {"inch": "in", "inches": "in", '"': "in", "feet": "ft", "foot": "ft", "meter": "m", "metre": "m",
               "meters": "m", "metres": "m", "micron": "um"},
    "area": {"m2": "m^2", "mm2": "mm^2", "cm2": "cm^2", "in2": "in^2", "sqin": "in^2", "ft2": "ft^2"},
    "volume": {"m3": "m^3", "l": "L", "liter": "L", "litre": "L", "liters": "L", "litres": "L", "ml": "mL",
               "cc": "cm^3", "cm3": "cm^3", "mm3": "mm^3", "in3": "in^3", "ft3": "ft^3", "gallon": "gal", "dm^3": "L"},
    "time": {"sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "millisecond": "ms",
             "milliseconds": "ms", "usec": "us", "microsecond": "us", "microseconds": "us", "minute": "min",
             "minutes": "min", "hour": "h", "hours": "h"},
    "temperature": {"C": "degC", "F": "degF", "R": "degR", "celsius": "degC", "fahrenheit": "degF", "kelvin": "K",
                    "deg C": "degC", "deg F": "degF", "deg_C": "degC", "deg_F": "degF"},
    "force": {"newton": "N", "newtons": "N", "lbsf": "lbf", "pound_force": "lbf"},
    "density": {"kg/m3": "kg/m^3", "g/cc": "g/cm^3", "g/cm3": "g/cm^3"},
    "angle": {"degree": "deg", "degrees": "deg", "radian": "rad", "radians": "rad"},
    "mass_flow": {"lbm/s": "lb/s", "lbs/s": "lb/s"},
    "loss_coefficient": {"m^-4": "1/m^4", "1/m4": "1/m^4"},
    "dimensionless": {"percent": "%", "dimensionless": ""},
}  # fmt: skip
"""Per dimension: other ways to write a unit of the table. Where pint reads a name differently (C, F, R) the dimension
decides."""

_ANY_CASE = {
    name.casefold(): name
    for name in (
        "psi", "psia", "psig", "bar", "bara", "barg", "kPa", "atm", "mmHg", "inHg", "kg", "lb", "lbm", "lbf", "kgf",
        "kN", "degC", "degF", "deg", "sec", "in", "ft",
    )
}  # fmt: skip
"""Names that nobody can mean differently whatever the case (unlike MPa and mPa)."""

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_SPREAD = re.compile(rf"^\s*({_NUMBER})\s*(.*?)\s*(?:(?:\+/-|\+-|±)\s*({_NUMBER})\s*(.*?)\s*)?$")
_BRACKETED = re.compile(rf"^\s*\(\s*({_NUMBER}\s*(?:\+/-|\+-|±)\s*{_NUMBER})\s*\)")


def near(word: str, among: Iterable[str]) -> str:
    """The phrase that offers near misses of ``word``, empty where there are none."""
    names = {name.casefold(): name for name in among}
    close = difflib.get_close_matches(word.casefold(), list(names), n=2, cutoff=0.6)
    return "; did you mean " + " or ".join(repr(names[c]) for c in close) + "?" if close else ""


def is_gauge(unit: str) -> bool:
    """Whether the unit counts pressure from the ambient one (psig, barg)."""
    return _tidy(unit, "pressure") in GAUGE


def si_unit(dimension: str) -> str:
    """The SI unit of a dimension, as products write it."""
    return DIMENSIONS[dimension].si


@lru_cache(maxsize=1024)
def unit_factor(unit: str, dimension: str, where: str) -> tuple[float, float]:
    """(scale [SI / unit], offset [SI]) with SI = scale * x + offset; a gauge unit gives its absolute twin's.

    Raises :class:`InputError` where the unit is unknown or of another dimension.

    >>> unit_factor("bar", "pressure", "tank"), unit_factor("degC", "temperature", "tank")
    ((100000.0, 0.0), (1.0, 273.15))
    """
    base = DIMENSIONS[dimension].of or dimension
    scale, offset = _in_table(unit, base) or _in_pint(unit, base, where)
    return scale, 0.0 if base != dimension else offset


def dimension_of(unit: str, where: str) -> str:
    """The dimension of a unit met on a channel whose name does not say it; raises :class:`InputError` if unknown."""
    order = sorted(TABLE, key=lambda name: name != "temperature")  # "C" and "F" on a channel are temperatures
    found = next((name for name in order if _in_table(unit, name)), None)
    return found or _pint_dimension(unit, where)


def parse(text: str | float | int, dimension: str, where: str) -> Value:
    """A value [SI] from a text with its unit, and +/- one standard deviation where stated.

    Raises :class:`InputError` naming ``where``, what was found and what was expected.

    >>> parse("8.35 +/- 0.05 kg", "mass", "tank.oxidizer_mass")
    Value(value=8.35, std=0.05)
    >>> parse("5 degC", "temperature", "tank.temperature").value
    278.15
    >>> parse("0.3 +/- 10 %", "dimensionless", "injector.C_i")
    Value(value=0.3, std=0.03)
    """
    if isinstance(text, bool) or not isinstance(text, (str, int, float)):
        raise _refused(text, dimension, where)
    if not isinstance(text, str):
        return _bare(text, dimension, where)
    number, unit, spread, spread_unit = _split(text, dimension, where)
    if is_gauge(unit) and dimension == "pressure":
        raise InputError(f"{where}: found {text!r}, a gauge pressure; expected an absolute one")
    value = _convert(number, unit, dimension, where)
    if spread is None:
        return Value(value)
    if spread_unit == "%" and not unit:  # of a pure number: of itself, as of any other
        return Value(value, abs(value) * spread / 100.0)
    return Value(value, _spread(spread, spread_unit or unit, value, dimension, where))


def parse_as(text: str | float | int, unit: str, where: str) -> float:
    """A value [``unit``, one of SI as products have it] from a text with any unit of that kind.

    Raises :class:`InputError` as :func:`parse`.

    >>> parse_as("40 bar", "Pa", "limit"), parse_as("9 kN s", "N s", "limit")
    (4000000.0, 9000.0)
    """
    dimension = next((name for name, d in DIMENSIONS.items() if unit in (d.si, d.si if d.si != "1" else "")), None)
    if dimension is not None:
        return parse(text, dimension, where).value
    found = re.match(rf"^\s*({_NUMBER})\s*(\S.*)$", text) if isinstance(text, str) else None
    given = _pint_unit(found[2]) if found else None
    wanted = _pint_unit(unit)
    if found is None or given is None or wanted is None or given.dimensionality != wanted.dimensionality:
        raise InputError(f"{where}: found {text!r}; expected a number with a unit such as '1 {unit}'")
    return float(_registry().Quantity(float(found[1]), given).to(wanted).magnitude)


def _split(text: str, dimension: str, where: str) -> tuple[float, str, float | None, str]:
    """Number, unit, spread and the spread's own unit ("" where it has none)."""
    found = _SPREAD.match(_BRACKETED.sub(r"\1", text))
    if not found or re.match(r"[.,]|\d(?!/)", found[2]):
        raise _refused(text, dimension, where)
    number, unit, spread, spread_unit = float(found[1]), found[2], found[3], found[4] or ""
    if not math.isfinite(number):
        raise _refused(text, dimension, where)
    if spread is None:
        return number, unit, None, ""
    if float(spread) < 0:
        raise InputError(f"{where}: found {text!r}; expected a standard deviation that is not negative")
    own = "" if dimension == "dimensionless" and spread_unit == "%" else spread_unit
    return number, unit or own, float(spread), spread_unit


def _spread(spread: float, unit: str, value: float, dimension: str, where: str) -> float:
    """The standard deviation in SI; a spread in percent is of the value."""
    if unit == "%" and dimension != "dimensionless":
        return abs(value) * spread / 100.0
    if not unit and dimension != "dimensionless":
        raise _refused(spread, dimension, where)
    return abs(spread * unit_factor(unit, dimension, where)[0])


def _convert(number: float, unit: str, dimension: str, where: str) -> float:
    if not unit and dimension != "dimensionless":
        raise _refused(f"{number:g}", dimension, where)
    scale, offset = unit_factor(unit, dimension, where)
    return number * scale + offset


def _bare(number: float | int, dimension: str, where: str) -> Value:
    try:
        value = float(number)
    except OverflowError:  # a whole number of more digits than a float has
        value = math.inf
    if dimension != "dimensionless" or not math.isfinite(value):
        raise _refused(number, dimension, where)
    return Value(value)


def _refused(found: Any, dimension: str, where: str) -> InputError:
    """What a value that cannot be read says."""
    spec = DIMENSIONS[dimension]
    expected = f"a {dimension.replace('_', ' ')} with its unit such as {spec.example!r}"
    if dimension == "dimensionless":
        expected = f"a finite number such as {spec.example}"
    comma = "; write decimals with a point" if isinstance(found, str) and re.search(r"\d,\d", found) else ""
    return InputError(f"{where}: found {found!r}; expected {expected}{comma}")


def _tidy(unit: str, dimension: str) -> str:
    """The spelling the table uses, where there is one."""
    text = unit.strip().replace("**", "^").replace("²", "^2").replace("³", "^3").replace("µ", "u").replace("μ", "u")
    text = text.replace("°", "deg").replace("℃", "degC") if text != "°" else "deg"
    text = text.strip("[]") if text.startswith("[") else text
    names = TABLE[dimension].keys() | ALIASES.get(dimension, {}).keys()
    if text not in names:
        text = _ANY_CASE.get(text.casefold(), text)
    return text if text in names else re.sub(r"\s+", "", text)


def _in_table(unit: str, dimension: str) -> tuple[float, float] | None:
    name = _tidy(unit, dimension)
    return TABLE[dimension].get(ALIASES.get(dimension, {}).get(name, name))


@lru_cache(maxsize=1)
def _registry() -> Any:
    """Pint's registry: half a second to load, hence only for units outside the table."""
    import pint

    return pint.UnitRegistry()


def _pint_unit(unit: str) -> Any | None:
    try:
        return _registry().Unit(unit.replace("^", "**"))
    except Exception:  # pint and its tokenizer raise a dozen kinds for text that is no unit
        return None


def _in_pint(unit: str, dimension: str, where: str) -> tuple[float, float]:
    found, wanted = _pint_unit(unit), _registry().Unit(DIMENSIONS[dimension].pint)
    offer = near(unit, sorted(TABLE[dimension].keys() | ALIASES.get(dimension, {}).keys()))
    if found is None:
        raise _not_a(unit, dimension, where, f"is not a known unit{offer}")
    if found.dimensionality != wanted.dimensionality:
        raise _not_a(unit, dimension, where, f"is a unit of {_spoken(found)}{offer}")
    zero, one = (_registry().Quantity(x, found).to(wanted).magnitude for x in (0.0, 1.0))
    return float(one - zero), float(zero)


def _not_a(unit: str, dimension: str, where: str, fault: str) -> InputError:
    known = ", ".join(name for name in TABLE[dimension] if name)
    kind = dimension.replace("_", " ")
    return InputError(f"{where}: unit {unit!r} {fault}; expected a unit of {kind} ({known}, ...)")


def _spoken(unit: Any) -> str:
    for name, dimension in DIMENSIONS.items():
        if not dimension.of and _registry().Unit(dimension.pint).dimensionality == unit.dimensionality:
            return name
    return str(unit.dimensionality)


def _pint_dimension(unit: str, where: str) -> str:
    found = _pint_unit(unit)
    known = {name for group in (TABLE, ALIASES) for names in group.values() for name in names}
    if found is None:
        raise InputError(f"{where}: unit {unit!r} is not a known unit{near(unit, known)}")
    dimension = _spoken(found)
    if dimension not in DIMENSIONS:
        raise InputError(f"{where}: unit {unit!r} is of no dimension met here; expected one of {', '.join(DIMENSIONS)}")
    return dimension
