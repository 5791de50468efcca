"""The rocket's static margin along its flight in winds, from its shape, its masses and what the engine holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hfanalysis.arrays import Array
from hfanalysis.flight import summary
from hfanalysis.flight.ascent import arguments
from hfanalysis.flight.curve import Curve
from hfanalysis.flight.margin import Margin, margin
from hfanalysis.flight.pitch import GUST_INTENSITY, HIGH, LOW, aero, fly_in_wind
from hfanalysis.flight.winds import GUST_SEEDS, WINDS
from hfanalysis.products import flight
from hfanalysis.quantity import Quantity
from hfanalysis.rocket.aerodynamics import Shape, center_of_pressure, components, drag_parts
from hfanalysis.rocket.balance import Balance, Held, Masses, balance, engine_center
from hfanalysis.rocket.vehicle import Vehicle

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


@dataclass(frozen=True)
class Launch:
    """What is launched: thrust and mass over the burn, the vehicle, and its rail [m] (None: not known)."""

    curve: Curve
    vehicle: Vehicle
    rail_length: float | None


def stability(
    launch: Launch,
    built: tuple[Shape, Masses] | str,
    held: Held,
    longest: float,
    winds: Sequence[float] = WINDS,
    seeds: int = GUST_SEEDS,
    progress: Progress | None = None,
) -> StabilityRuns | str:
    """Fly ``seeds`` times in every wind [m/s], ``longest`` [s] at most; or why there is no stability to tell.

    ``built``: its outside and its masses, or what is not known of them; ``held``: on the curve's clock.
    """
    if isinstance(built, str):
        return built
    outside, place = built
    weighed = balance([*place.fixed, *held.parts(place.where)])
    aerodynamics, reads = aero(outside), arguments(launch.curve, launch.vehicle, launch.rail_length)
    found = []
    for i, wind in enumerate(winds):
        if progress is not None:
            progress("flying in winds", i / len(winds))
        flights = fly_in_wind(reads, (weighed.center, weighed.inertia), aerodynamics, wind, seeds, longest)
        found.append(margin(flights))
    known = tuple(m for m in found if m is not None)
    if not known:
        return summary.NO_RAIL if launch.rail_length is None else summary.RAIL_TOO_LONG
    notes = tuple(filter(None, (place.remark, held.remark)))
    center = engine_center(held, place.where, place.dry)
    return StabilityRuns(outside, weighed, place, known, center, notes)


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
