"""How a number reads: its name in words, the unit people use, and no more digits than it deserves."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from hfanalysis.products.model import AdoptedEffect
from hfanalysis.quantity import Quantity
from hfanalysis.sentences import Text, rounded, said
from hfanalysis.wording.scales import reading_unit, scale, superscript

NAMES: dict[str, str] = {
    "C_i": "effective injector coefficient",
    "m": "polytropic exponent",
    "m_choked": "polytropic exponent if the vapor chokes",
    "vapor_C_d": "discharge coefficient of the vapor",
    "subcooling": "subcooling at the injector",
    "quality": "vapor by mass at the injector",
    "density": "density at the injector",
    "back_pressure": "pressure behind the injector over that before it",
    "spi": "C_d, incompressible mixture",
    "hem": "C_d, homogeneous equilibrium",
    "dyer": "C_d, mean of both (Dyer)",
    "Z": "vapor compressibility",
    "K_loss": "feed loss coefficient",
    "p_loss_liquid": "liquid-phase feed loss",
    "p_loss_vapor": "vapor-phase feed loss",
    "t_open": "valve opens (log time)",
    "t_feed": "feed line full",
    "t_v": "liquid gone",
    "t_purge": "nitrogen enters",
    "t_fuel_out": "solid fuel begins to run out",
    "t_fuel_gone": "solid fuel gone",
    "t_end": "p_c below 1.8 p_a for good",
    "a": "regression coefficient",
    "n": "regression exponent",
    "regression_rate_reference": "regression rate at the reference flux",
    "oxidizer_flow_peak": "peak oxidizer flow",
    "oxidizer_mass_liquid_phase": "oxidizer used as liquid",
    "mass_at_t_feed": "oxidizer at t_feed",
    "vapor_mass_at_t_v": "vapor left at t_v",
    "burn_time": "burn time",
    "total_impulse": "total impulse",
    "specific_impulse": "specific impulse, expended",
    "specific_impulse_to_purge": "specific impulse until nitrogen enters",
    "specific_impulse_loaded": "specific impulse, loaded",
    "peak_chamber_pressure": "peak chamber pressure",
    "largest_chamber_pressure": "largest sample of chamber pressure",
    "mean_chamber_pressure": "mean chamber pressure",
    "peak_thrust": "peak thrust",
    "average_thrust": "average thrust",
    "oxidizer_mass": "oxidizer loaded, less left",
    "oxidizer_mass_fitted": "load that the model needs",
    "tank_temperature": "oxidizer's temperature at the opening",
    "fuel_mass": "fuel loaded, less left",
    "of_ratio": "O/F",
    "total_impulse_of_file": "the file's whole integral",
    "burn_time_5_percent": "burn time, by 5 % of the thrust",
    "action_time": "action time, by 10 % of the thrust",
    "impulse_liquid": "impulse of the liquid phase",
    "specific_impulse_liquid": "specific impulse of the liquid phase",
    "pressure_lag": "lag of the chamber pressure behind the thrust",
    "impulse_vapor": "impulse of the vapor phase",
    "impulse_nitrogen": "impulse from nitrogen on",
    "tail_impulse": "impulse after the liquid",
    "injector_drop_liquid": "injector's drop over p_c, liquid",
    "injector_drop_vapor": "injector's drop over p_c, vapor",
    "c_star": "characteristic velocity c*",
    "c_star_efficiency": "c* efficiency, of shifting equilibrium",
    "c_star_efficiency_frozen": "c* efficiency, of frozen flow",
    "thrust_coefficient": "thrust coefficient C_F",
    "thrust_coefficient_efficiency": "C_F efficiency, of shifting equilibrium",
    "thrust_coefficient_efficiency_frozen": "C_F efficiency, of frozen flow",
    "mean_regression_rate": "space-time averaged regression rate",
    "mean_oxidizer_flux": "space-time averaged oxidizer flux",
    "published_regression_rate": "published rate at that flux",
    "characteristic_length": "L* at ignition",
    "characteristic_length_end": "L* at the burn's end",
    "apogee": "apogee above ground",
    "apogee_as_measured": "apogee on the thrust as measured",
    "impulse_flown": "impulse of the thrust that flies",
    "impulse_stand": "impulse on the stand",
    "time_to_apogee": "time to apogee",
    "rail_departure_velocity": "velocity leaving the rail",
    "peak_velocity": "peak velocity",
    "peak_mach": "peak Mach number",
    "peak_acceleration": "peak acceleration",
    "pad_thrust_to_weight": "thrust to weight on the pad",
    "liftoff_thrust_to_weight": "thrust to weight at lift-off",
    "wet_mass": "wet mass",
    "terminal_velocity_drogue": "terminal velocity, drogue",
    "terminal_velocity_main": "terminal velocity, main",
    "impact_velocity_ballistic": "impact velocity, ballistic",
    "margin_at_rail_departure": "static margin at rail departure (calibers)",
    "static_margin_on_pad": "static margin on the pad (calibers)",
}
"""The quantities of the products, in the order in which they are shown."""

EVENTS = ("t_open", "t_feed", "t_v", "t_purge", "t_fuel_out", "t_fuel_gone", "t_end")
EVENT_LABELS: dict[str, str] = {
    "t_open": "opens",
    "t_feed": "line full",
    "t_v": "liquid gone",
    "t_purge": "N₂ enters",
    "t_fuel_out": "fuel ends",
    "t_fuel_gone": "fuel gone",
    "t_end": "p_c low",
}
"""What a chart calls the events."""

MASTHEAD = ("C_i", "m", "Z", "K_loss", "p_loss_liquid", "p_loss_vapor", "a", "n", "regression_rate_reference")
"""What a calibration is asked for first."""

SOURCES: dict[str, str] = {
    "replica": "REPLICA: generated, not measured",
    "synthetic": "SYNTHETIC: generated, not measured",
    "measured": "measured",
}
"""What is said of a test's source wherever its results show."""

KINDS: dict[str, str] = {
    "hot_fire": "hot fire", "cold_flow": "cold flow", "water_flow": "water flow", "nothing": "nothing happened"
}  # fmt: skip

_FINEST: dict[str, int] = {"s": 4}
"""Unit: decimals beyond which nobody reads; a log's stamps are no finer than 0.1 ms."""
_KILOWATTS = 500.0
"""[W] from which on a power reads better in kW."""

_NOTHING = 1e-200
"""Size [any unit] below which a number is zero: it has no power of ten to take out."""
MINUS = "\N{MINUS SIGN}"


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
    """(factor [unit / SI], unit): multiply an SI value to have it in the unit people at a test stand use.

    >>> people_unit("Pa")
    (1e-05, 'bar')
    """
    found = scale(unit)
    return found.factor, found.unit


def shown(quantity: Quantity, system: str = "si", name: str = "", difference: bool = False) -> Shown:
    """A quantity [SI] as people read it in one of the systems of units.

    Args:
        quantity: of a product.
        system: of units: "si" or "team".
        name: the quantity's, which may ask for a unit of its own.
        difference: whether no zero point of a unit concerns it.
    """
    verdict = quantity.verdict or ""
    if quantity.value is None:
        return Shown("–", "", "", "", verdict or "absent", quantity.reason or "")
    found = scale(reading_unit(name, quantity.unit), system)
    factor, zero, unit = found.factor, 0.0 if difference else found.zero, found.unit
    value, std = factor * quantity.value + zero, factor * (quantity.std or 0.0)
    exponent = 0 if unit == "s" else exponent_of(max(abs(value), std))
    if exponent:
        unit = f"×10{superscript(exponent)} {unit}".strip()
        factor, zero, value, std = (x / 10.0**exponent for x in (factor, zero, value, std))
    decimals = min(decimals_for(value, std), _FINEST.get(unit, 8))
    interval = [fixed(factor * end + zero, decimals) for end in quantity.interval or ()]
    return Shown(
        fixed(value, decimals),
        fixed(std, decimals) if quantity.std else "",
        " … ".join(interval),
        unit,
        verdict,
        quantity.why or "",
    )


def exponent_of(size: float) -> int:
    """The power of ten to take out of numbers of a ``size`` [any unit] that are awkward to read: 0 for most.

    >>> exponent_of(6.4e8), exponent_of(12.0)
    (8, 0)
    """
    if size < _NOTHING or 1e-3 <= size < 1e5:
        return 0
    return math.floor(math.log10(size))


def decimals_for(value: float, std: float) -> int:
    """Decimals that show two digits of the standard deviation, or four digits of a value that has none [both in one
    unit].

    >>> decimals_for(12.345, 0.21), decimals_for(1.2345, 0.0)
    (2, 3)
    """
    scale = std if std > 0.0 else abs(value) * 1e-2
    if not (scale > 0.0 and math.isfinite(scale)):
        return 3
    return min(8, max(0, 1 - math.floor(math.log10(scale))))


def fixed(value: float, decimals: int) -> str:
    """The number [any unit] with a true minus sign.

    >>> fixed(-1.25, 1)
    '−1.2'
    """
    text = f"{value:.{decimals}f}"
    return text.replace("-", MINUS) if float(text) else text.replace("-", "")


def tidy(value: float, digits: int = 4) -> str:
    """A number [any unit] without uncertainty, to a few digits.

    >>> tidy(-0.001234567)
    '−0.001235'
    """
    return rounded(value, f".{digits}g").replace("-", MINUS)


def adopted_in_words(effects: Sequence[AdoptedEffect], called: Callable[[str], str]) -> str:
    """A sentence about the adopted effects that a product states, as they are ``called``; empty where there are
    none."""
    if not effects:
        return ""
    named = [effect_in_words(effect, called) for effect in effects]
    return f"Included in the model: {listed(named)} (engines/{effects[0].file})."


def effect_in_words(effect: AdoptedEffect, called: Callable[[str], str]) -> str:
    """An adopted effect with its size, in the units of people at a stand; of a table its ends."""
    if effect.table:
        in_order = sorted(effect.table, key=lambda quantity: quantity.value or 0.0)
        return f"{called(effect.name)}, {_plainly(in_order[0])} to {_plainly(in_order[-1])}"
    return f"{called(effect.name)}, {_values_in_words(effect.parameters)}"


def _values_in_words(parameters: Mapping[str, Quantity]) -> str:
    """The strength of an effect, then what else is stated of it."""
    texts = [(name, _plainly(quantity)) for name, quantity in parameters.items()]
    others = ", ".join(f"{name.replace('_', ' ')} {text}" for name, text in texts[1:])
    return texts[0][1] + (f" ({others})" if others else "")


def _plainly(quantity: Quantity) -> str:
    """A value with its deviation and unit, to few digits; differences of temperature stay differences."""
    unit, value, std = quantity.unit, quantity.value or 0.0, quantity.std or 0.0
    factor, unit = (1.0, unit) if unit == "K" else people_unit("" if unit == "-" else unit)
    if unit == "W" and abs(value) >= _KILOWATTS:
        factor, unit = 1e-3, "kW"
    if not std:
        return f"{tidy(factor * value)} {unit}".strip()
    decimals = decimals_for(factor * value, factor * std)
    return f"{fixed(factor * value, decimals)} ± {fixed(factor * std, decimals)} {unit}".strip()


def ordered(found: Mapping[str, Quantity]) -> dict[str, Quantity]:
    """Quantities by name, the known ones in their usual order, then the others as they come."""
    order = [*(name for name in NAMES if name in found), *(name for name in found if name not in NAMES)]
    return {name: found[name] for name in order}


def in_words(name: str) -> str:
    """The name of a quantity in words.

    >>> in_words("t_v"), in_words("tank_rest_pressure")
    ('liquid gone', 'tank rest pressure')
    """
    return NAMES.get(name, name.replace("_", " "))


def said_of(quantity: Quantity, unit: str, form: str = ".3g", std_form: str = ".2g", sign: float = 1.0) -> Text:
    """A quantity [SI] with its deviation in a sentence, shown in ``unit``; ``sign`` [-] of -1 turns it."""
    return said(sign * (quantity.value or 0.0), unit, form, quantity.std or 0.0, std_form)


def listed(names: Sequence[str]) -> str:
    """Names in a sentence.

    >>> listed(["a", "b", "c"])
    'a, b and c'
    """
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
