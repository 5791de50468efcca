"""Specific impulse by what was expended: the mass that left the engine, and of a purge the gas that pushed with it.

Until nitrogen enters, the calibrated tank and grain say what left. After that the tank's gas is of unknown mixture: its
flow lies between that of nitrogen that chokes in the injector and that of nitrous oxide that does not expand in it. The
report's number, by the loaded masses, stands beside.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import effective_area
from hfanalysis.calibrate.loaded_mass import UNSTATED
from hfanalysis.effects.injector_choked_vapor import expanding_flow
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT, SPECIFIC_NITROGEN
from hfanalysis.performance.efficiency import oxidizer_spread
from hfanalysis.performance.flows import HISTORY_STEP, Flows
from hfanalysis.performance.measured import Fire, specific_impulse
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.units import Value

LIGHT = (SPECIFIC_NITROGEN, 300.0)
"""Gas constant [J/(kg K)] and temperature [K] of the lightest gas that a purged tank can give. Source: nitrogen of a
bottle on a warm day."""

HEAVY = (SPECIFIC_GAS_CONSTANT * 0.9, 230.0)
"""Of the heaviest: nitrous oxide, Z = 0.9, as cold as liquid leaves it. Source: vapor pressure of 10 bar at 230 K."""

DIATOMIC = 1.4
"""Isentropic exponent of nitrogen [-]. Source: ideal gas of two atoms."""


@dataclass(frozen=True)
class Expended:
    """Mass that left the engine [kg], to ``until`` [s], over the burn, and while there was liquid (None where nobody
    knows how long); each with its standard deviation."""

    until: float
    to_purge: Value
    whole: Value
    whole_why: str
    liquid: Value | None = None


def expended(
    log: TestLog, segments: Segments, definition: TestDefinition, calibration: Calibration, flows: Flows, fire: Fire,
    nitrogen: Array,
) -> Expended:  # fmt: skip
    """By the ``flows``; ``nitrogen`` [kg/s], (n,), comes beside the oxidizer where an adopted purge says so."""
    found = _expended(log, segments, definition, calibration, flows, fire, nitrogen)
    gone = segments.time("t_v")
    if gone is None or not 0.0 < gone < fire.end:
        return found
    part = (flows.time >= 0.0) & (flows.time <= gone)
    passed = float(np.trapezoid((flows.total + nitrogen)[part], flows.time[part]))
    relative = (found.to_purge.std or 0.0) / found.to_purge.value
    return replace(found, liquid=Value(passed, passed * relative))


def _expended(
    log: TestLog, segments: Segments, definition: TestDefinition, calibration: Calibration, flows: Flows, fire: Fire,
    nitrogen: Array,
) -> Expended:  # fmt: skip
    """All but that of the liquid phase."""
    purge = segments.time("t_purge")
    until = fire.end if purge is None else min(purge, fire.end)
    rate = calibration.regression_rate_reference
    spread = (oxidizer_spread(calibration), (rate.std or 0.0) / rate.value if rate.value else 0.0)

    def passed(start: float, end: float) -> tuple[float, float]:
        part = (flows.time >= start) & (flows.time <= end)
        oxidizer, fuel = (
            float(np.trapezoid(x[part], flows.time[part])) for x in (flows.oxidizer + nitrogen, flows.fuel)
        )
        return oxidizer, fuel

    oxidizer, fuel = passed(0.0, until)
    first = Value(oxidizer + fuel, float(np.hypot(oxidizer * spread[0], fuel * spread[1])))
    left = _left(definition)
    if until < fire.end and not nitrogen.any():
        light, heavy = _after(log, segments, definition, calibration, (until, fire.end))
        last = passed(until, fire.end)[1]
        std = float(np.linalg.norm([first.std or 0.0, (heavy - light) / sqrt(12.0), last * spread[1]]))
        why = f"after t_purge {light:.2f} to {heavy:.2f} kg of gas of unknown mixture passed the injector"
        return Expended(until, first, Value(first.value + 0.5 * (light + heavy) + last, std), why)
    if left is not None and purge is None:
        return Expended(until, left, left, "loaded less left")
    whole = sum(passed(0.0, fire.end))
    return Expended(until, first, Value(whole, (first.std or 0.0) * whole / first.value), "through injector and grain")


def _left(definition: TestDefinition) -> Value | None:
    """Loaded less left, where both leftovers are stated."""
    tank, grain, seen = definition.tank, definition.grain, definition.observed
    if seen is None or seen.oxidizer_mass_after is None or seen.fuel_mass_after is None:
        return None
    if tank is None or tank.oxidizer_mass is None or grain is None or grain.mass is None:
        return None
    parts = (tank.oxidizer_mass, grain.mass, seen.oxidizer_mass_after, seen.fuel_mass_after)
    std = float(np.linalg.norm([p.std if p.std is not None else UNSTATED * p.value for p in parts]))
    return Value(parts[0].value + parts[1].value - parts[2].value - parts[3].value, std)


def _after(
    log: TestLog, segments: Segments, definition: TestDefinition, calibration: Calibration, span: tuple[float, float]
) -> tuple[float, float]:
    """Least and most gas [kg] that the injector passed over a span [s] in which nitrogen is in the tank."""
    time = np.arange(*span, HISTORY_STEP)
    origin = segments.t_open.value or 0.0

    def at(name: str) -> Array:
        return Signal.of(log[name]).shifted(origin).reduced(HISTORY_STEP).at(time)

    before = np.maximum(at("p_run" if "p_run" in log else "p_tank"), 1.0)
    behind = at("p_chamber") if "p_chamber" in log else np.full(time.size, definition.ambient_pressure.value)
    drop = np.maximum(before - behind, 0.0)
    area = effective_area(definition, calibration)
    choked = np.array([expanding_flow(ratio, DIATOMIC) for ratio in behind / before])
    light, heavy = (area * np.sqrt(2.0 * before / (r * t) * drop) for r, t in (LIGHT, HEAVY))
    return float(np.trapezoid(light * choked, time)), float(np.trapezoid(heavy, time))


def impulses(
    found: Expended, impulse: Quantity, impulse_to_purge: Quantity, loaded: tuple[Quantity, Quantity]
) -> dict[str, Quantity]:
    """The three specific impulses [s] of impulses [N s], over the burn and to purge, and of ``loaded`` masses [kg]."""
    none = Quantity(0.0, "kg", 0.0)
    whole, first = (Quantity(value.value, "kg", value.std) for value in (found.whole, found.to_purge))
    to_purge = specific_impulse(impulse_to_purge, first, none)
    said = f"to {found.until:.2f} s, by the calibrated tank's flow and a and n"
    return {
        "specific_impulse": _with(specific_impulse(impulse, whole, none), f"expended: {found.whole_why}"),
        "specific_impulse_to_purge": _with(to_purge, said),
        "specific_impulse_loaded": specific_impulse(impulse, *loaded),
    }


def liquid_impulse(found: Expended, impulse: Quantity) -> Quantity:
    """Specific impulse [s] of the liquid phase by its ``impulse`` [N s], beside that of the whole burn."""
    if found.liquid is None:
        return Quantity.absent("when the liquid is gone is not known, or it is there to the end")
    mass = Quantity(found.liquid.value, "kg", found.liquid.std)
    return _with(specific_impulse(impulse, mass, Quantity(0.0, "kg", 0.0)), "by what passed injector and grain to t_v")


def _with(quantity: Quantity, why: str) -> Quantity:
    return (
        quantity if quantity.value is None else replace(quantity, why=f"{quantity.why}; {why}" if quantity.why else why)
    )
