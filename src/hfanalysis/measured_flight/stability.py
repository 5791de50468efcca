"""The rocket's static margin along its flight in winds, from geometry and what the burn leaves of the propellant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.shape import Masses, Places, masses, places, shape
from hfanalysis.flight import summary
from hfanalysis.flight.ascent import arguments
from hfanalysis.flight.margin import Margin, margin
from hfanalysis.flight.pitch import GUST_INTENSITY, HIGH, LOW, aero, fly_in_wind
from hfanalysis.measured_flight.firing import Firing
from hfanalysis.products import flight
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.rocket.aerodynamics import Shape, center_of_pressure, components, drag_parts
from hfanalysis.rocket.balance import Balance, MassPart, balance, oxidizer
from hfanalysis.thermo.nitrous import saturation

Progress = Callable[[str, float | None], None]

SLOW = 0.3
"""Mach number [-] at which slopes and the drag's parts are listed."""


@dataclass(frozen=True)
class StabilityRuns:
    """Center of gravity and inertia on the thrust curve's clock, the shape, the margins by wind, and remarks.

    ``engine_center``: of the engine with its propellant [m from its front], of the propellant alone where it is not
    weighed apart.
    """

    outside: Shape
    balance: Balance
    place: Masses
    margins: tuple[Margin, ...]
    engine_center: Array
    notes: tuple[str, ...]


def stability(
    firing: Firing, definition: TestDefinition, winds: Sequence[float], seeds: int, longest: float, progress: Progress
) -> StabilityRuns | str:
    """Fly ``seeds`` times in every wind [m/s], ``longest`` [s] at most; or why there is no stability to tell."""
    rocket = definition.rocket
    outside = shape(rocket)
    if isinstance(outside, str) or rocket is None:
        return str(outside)
    place = masses(rocket, outside, definition.tank, definition.grain, definition.chamber)
    if isinstance(place, str):
        return place
    weighed = balance(_parts(firing, place, definition))
    aerodynamics, reads = aero(outside), arguments(firing.curve, firing.vehicle, firing.rail_length)
    found = []
    for i, wind in enumerate(winds):
        progress("flying in winds", i / len(winds))
        flights = fly_in_wind(reads, (weighed.center, weighed.inertia), aerodynamics, wind, seeds, longest)
        found.append(margin(flights))
    known = tuple(m for m in found if m is not None)
    if not known:
        return summary.NO_RAIL if firing.rail_length is None else summary.RAIL_TOO_LONG
    notes = tuple(filter(None, (place.remark, _tank_note(firing))))
    return StabilityRuns(outside, weighed, place, known, _engine_center(firing, place, definition), notes)


def _tank_note(firing: Firing) -> str:
    known = np.isfinite(firing.propellant.temperature).all()
    return "" if known else "how the oxidizer divides into liquid and vapor is not known: taken as all liquid"


def _parts(firing: Firing, place: Masses, definition: TestDefinition) -> list[MassPart]:
    return [*place.fixed, *_load(firing, place.where, definition)]


def _load(firing: Firing, place: Places, definition: TestDefinition) -> list[MassPart]:
    """Oxidizer, fuel and chamber gas on the thrust curve's clock."""
    time, load = firing.curve.time, firing.propellant
    histories = (load.oxidizer, load.liquid, load.fuel, load.temperature)
    mass, liquid, fuel, t = (np.interp(time, load.time, history) for history in histories)
    tank = oxidizer(place.tank, liquid, mass - liquid, _liquid_volume(t, definition))
    gas = [] if firing.gas_mass is None else [MassPart(firing.gas_mass, place.gas_center)]
    return [*tank, MassPart(fuel, place.grain_center, place.grain_length), *gas]


def _liquid_volume(temperature: Array, definition: TestDefinition) -> Array:
    """Of the saturated liquid [m^3/kg]; where the tank's temperature is not known, at 20 degC."""
    source = saturation(definition.model.properties)
    return np.asarray(source.liquid_volume(np.where(np.isfinite(temperature), temperature, 293.15))[0])


def _engine_center(firing: Firing, place: Masses, definition: TestDefinition) -> Array:
    return _center([*([] if place.dry is None else [place.dry]), *_load(firing, place.where, definition)], place.where)


def propellant_center(firing: Firing, definition: TestDefinition) -> Array | str:
    """Center of gravity [m from the engine's front] of what tank, grain and chamber hold, on the thrust curve's clock;
    or what is not given of where they are."""
    where = places(definition.rocket, definition.tank, definition.grain, definition.chamber)
    return where if isinstance(where, str) else _center(_load(firing, where, definition), where)


def _center(parts: list[MassPart], where: Places) -> Array:
    """From the engine's front [m]; of an empty engine the last that it had."""
    held = np.asarray(sum((np.asarray(part.mass) for part in parts), np.zeros(1)))
    with np.errstate(invalid="ignore", divide="ignore"):
        center = np.asarray(balance(parts).center - where.front)
    there = held > 0.0
    return center if there.all() else np.interp(np.arange(held.size), np.flatnonzero(there), center[there])


def product(stable: StabilityRuns | str) -> flight.Stability:
    """What flight.json says of stability."""
    if isinstance(stable, str):
        return flight.Stability(margin_at_rail_departure=Quantity.absent(stable))
    parts = components(stable.outside, SLOW)
    slope, place = center_of_pressure(parts)
    calmest = stable.margins[0]
    return flight.Stability(
        margin_at_rail_departure=Quantity(float(calmest.mean[0]), "", float(calmest.std[0]) or None),
        static_margin_on_pad=Quantity((place - float(stable.balance.center[0])) / stable.outside.diameter),
        normal_force_slope=Quantity(slope, "1/rad"),
        center_of_pressure=Quantity(place, "m"),
        center_of_gravity_loaded=Quantity(float(stable.balance.center[0]), "m"),
        center_of_gravity_empty=Quantity(float(stable.balance.center[-1]), "m"),
        mach=SLOW,
        slopes={part.name: flight.Slope(slope=part.slope, position=part.position) for part in parts},
        drag_parts=drag_parts(stable.outside, SLOW, 0.0),
        limits=(LOW, HIGH),
        gust_intensity=GUST_INTENSITY,
        winds=tuple(m.product() for m in stable.margins),
        notes=stable.notes,
    )


def checks(stable: StabilityRuns | str) -> dict[str, flight.Check]:
    """Whether the margin keeps within its limits, two standard deviations included, in every wind."""
    return {
        "least_static_margin": _check(stable, LOW, "at least", lambda m: m.least, lambda margin: margin >= LOW),
        "largest_static_margin": _check(stable, HIGH, "at most", lambda m: m.largest, lambda margin: margin <= HIGH),
    }


def _check(
    stable: StabilityRuns | str,
    limit: float,
    side: str,
    extreme: Callable[[flight.WindMargin], float],
    holds: Callable[[float], bool],
) -> flight.Check:
    result, why = "unknown", str(stable)
    if not isinstance(stable, str):
        said = [(extreme(m), m.wind) for m in (margin.product() for margin in stable.margins)]
        words = ", ".join(f"{margin:.2f} in a wind of {wind:.1f} m/s" for margin, wind in said)
        result = "passed" if all(holds(margin) for margin, _ in said) else "failed"
        why = f"{words}; mean and two standard deviations"
    return flight.Check(limit=limit, unit="calibers", side=side, result=result, why=why)
