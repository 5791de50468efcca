"""Which channels a quantity rests on, by product and name: a doubt about one of them is a doubt about it."""

from __future__ import annotations

from collections.abc import Mapping

from hfanalysis.quantity import STATED, Quantity
from hfanalysis.record.channels import CANONICAL

PRESSURES = ("p_tank", "p_run", "p_chamber")
FIRE = ("p_chamber", "thrust")

SEGMENTS = {
    "t_open": ("p_run", "p_chamber", "thrust"),
    "t_feed": ("p_run",),
    "t_v": ("p_tank", "p_run"),
    "t_purge": ("p_purge", "p_tank"),
    "t_fuel_out": FIRE,
    "t_fuel_gone": FIRE,
    "t_end": ("p_chamber",),
}

CALIBRATION = {
    "C_i": PRESSURES,
    "C_d": ("p_run", "m_tank"),
    "spi": PRESSURES,
    "hem": PRESSURES,
    "dyer": PRESSURES,
    "subcooling": ("p_tank", "p_run"),
    "quality": ("p_tank", "p_run"),
    "density": ("p_tank", "p_run"),
    "back_pressure": ("p_chamber", "p_run"),
    "drift": PRESSURES,
    "m": PRESSURES,
    "m_choked": PRESSURES,
    "vapor_C_d": PRESSURES,
    "Z": ("p_tank",),
    "K_loss": PRESSURES,
    "p_loss_liquid": ("p_tank", "p_run"),
    "p_loss_vapor": ("p_tank", "p_run"),
    "vapor_mass_at_t_v": ("p_tank",),
    "oxidizer_flow_peak": PRESSURES,
    "mass_at_t_feed": PRESSURES,
    "oxidizer_mass_liquid_phase": ("p_tank",),
    "oxidizer_mass": (),
    "oxidizer_mass_fitted": (*PRESSURES, "thrust"),
    "tank_temperature": (*PRESSURES, "thrust"),
    "a": PRESSURES,
    "n": PRESSURES,
    "regression_rate_reference": PRESSURES,
    "reference_flux": PRESSURES,
    "pressure": ("p_tank",),
    "temperature": ("p_tank",),
    "bulk_temperature": ("p_tank",),
    "liquid_fraction": ("p_tank",),
    "blowdown_mass": ("p_tank",),
    "liquid_phase_heat": PRESSURES,
    "load_cell_mass": ("m_tank",),
}

VALIDATION = {
    "burn_time": FIRE,
    "total_impulse": ("thrust",),
    "specific_impulse": ("thrust",),
    "specific_impulse_to_purge": ("thrust",),
    "specific_impulse_loaded": ("thrust",),
    "largest_chamber_pressure": ("p_chamber",),
    "peak_chamber_pressure": ("p_chamber",),
    "mean_chamber_pressure": ("p_chamber",),
    "peak_thrust": ("thrust",),
    "average_thrust": ("thrust",),
    "total_impulse_of_file": ("thrust",),
    "oxidizer_mass": (),
    "fuel_mass": (),
    "oxidizer_through_injector": PRESSURES,
    "fuel_burned": PRESSURES,
    "propellant_through_nozzle": ("p_chamber",),
    "oxidizer_loaded": (),
    "fuel_loaded": (),
    "difference": PRESSURES,
    "c_star": PRESSURES,
    "c_star_efficiency": PRESSURES,
    "c_star_efficiency_frozen": PRESSURES,
    "thrust_coefficient": FIRE,
    "thrust_coefficient_efficiency": FIRE,
    "thrust_coefficient_efficiency_frozen": FIRE,
    "mean_regression_rate": FIRE,
    "mean_oxidizer_flux": PRESSURES,
    "vacuum_thrust": ("thrust",),
    "vacuum_specific_impulse": ("thrust",),
    "vacuum_thrust_coefficient": FIRE,
    "sea_level_specific_impulse": ("thrust",),
    "sea_level_thrust_coefficient": FIRE,
    "liquid_phase_heat": PRESSURES,
    **dict.fromkeys(("ignition_delay", "rise_time", "ignition_overshoot"), ("p_chamber",)),
    **dict.fromkeys(("action_time", "burn_time_5_percent", "tail_impulse"), ("thrust",)),
    **dict.fromkeys(("impulse_liquid", "impulse_vapor", "impulse_nitrogen"), ("thrust",)),
    "specific_impulse_liquid": ("thrust",),
    "pressure_lag": ("thrust", "p_chamber"),
    **dict.fromkeys(("injector_drop_liquid", "injector_drop_vapor"), ("p_run", "p_chamber")),
    **dict.fromkeys(("of_ratio_mean", "a", "n", "throat_radius_change", "nozzle_efficiency"), PRESSURES),
    **dict.fromkeys(("roughness_rms", "roughness_peak_to_peak", "rms", "peak_to_peak"), ("p_chamber",)),
    **dict.fromkeys(("frequency", "amplitude", "bandwidth", "detection_limit"), ("p_chamber",)),
}

FLOWN = (
    "apogee", "time_to_apogee", "rail_departure_velocity", "peak_velocity", "peak_mach", "peak_acceleration",
    "time_to_main", "main_deployment_acceleration", "landing_time", "impact_velocity_ballistic",
    "pad_thrust_to_weight", "liftoff_thrust_to_weight", "apogee_as_measured", "impulse_flown", "impulse_stand",
    "total_impulse", "burn_time", "average_thrust", "margin_at_rail_departure",
)  # fmt: skip
FLIGHT = dict.fromkeys(FLOWN, ("thrust",))

Rests = Mapping[str, tuple[str, ...]]
TABLES: Mapping[str, Rests] = {
    "segments.json": SEGMENTS,
    "calibration.json": CALIBRATION,
    "validation.json": VALIDATION,
    "flight.json": FLIGHT,
}
"""By product and quantity, the channels. A quantity that is not named rests on none."""

TOGETHER = " together"
"""How the name of a product ends here whose constants were fitted together, with the thrust."""

PACED = {
    "burn_time": 1.0,
    **dict.fromkeys(("C_i", "spi", "hem", "dyer", "vapor_C_d"), -1.0),
    **dict.fromkeys(("oxidizer_flow_peak", "a", "regression_rate_reference"), -1.0),
    **dict.fromkeys(("total_impulse", "specific_impulse", "total_impulse_of_file", *FLOWN), 1.0),
    "specific_impulse_loaded": 1.0,
    "specific_impulse_liquid": 1.0,
    **dict.fromkeys(("ignition_delay", "rise_time", "action_time", "burn_time_5_percent", "pressure_lag"), 1.0),
    **dict.fromkeys(("impulse_liquid", "impulse_vapor", "impulse_nitrogen", "tail_impulse"), 1.0),
    "K_loss": 2.0,
    "drift": -2.0,
}  # fmt: skip
"""With which power of the clock's pace a quantity goes, about: a clock at half its pace makes flows of twice the size.
Source: the definitions; of a flight's numbers no more than their size. Events are not in it: they are dated on the
log's own clock, which is where every later stage looks for them."""

OUTSIDE = ("[observed]", "set by the engineer", "as stated", "held as")
"""How the reason of a quantity begins that comes from test.toml, not from the log."""
FROM_CELL = ("from the load cell",)
"""How it is said that a mass comes from the tank's cell."""
FROM = "from "
"""How the reason of a quantity begins that names the channels it comes from, of those that it may."""

OF_LEVEL = ("zero", "drift", "scale", "unit", "gauge_or_absolute", "gross_mass")
"""Kinds of finding that shift or stretch a channel and leave it the shape, and with it the instants of its bends."""
BY_LEVEL = ("t_end",)
"""Instants at which a channel passes a level."""


def channels_of(product: str, name: str, quantity: Quantity) -> tuple[str, ...]:
    """The channels that a quantity of a product (its file's name) rests on."""
    told = quantity.why or ""
    if quantity.verdict == STATED or told.startswith(OUTSIDE):
        return ()
    if any(words in told for words in FROM_CELL):
        return ("m_tank",)
    named = tuple(told.removeprefix(FROM).split(", ")) if told.startswith(FROM) else ()
    if named and CANONICAL.keys() >= set(named):
        return named
    found = rests(product, name)
    return (*found, "thrust") if product.endswith(TOGETHER) and found == PRESSURES else found


def rests(product: str, name: str) -> tuple[str, ...]:
    """The channels that a quantity of this name rests on in a product, wherever it comes from in one test."""
    return TABLES.get(product.removesuffix(TOGETHER), {}).get(name, ())


def concerns(product: str, name: str, kind: str) -> bool:
    """Whether a kind of finding concerns a quantity of a channel: shifts do not move the bends of a curve."""
    return product != "segments.json" or name in BY_LEVEL or kind not in OF_LEVEL


def power_of_time(name: str) -> float:
    """The power of the clock's pace that a quantity goes with, about; 0 where it has nothing to do with time."""
    return PACED.get(name, 0.0)
