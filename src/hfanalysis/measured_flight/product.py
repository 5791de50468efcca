"""flight.json and flight.h5: what a test's firing does to its rocket, with bands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.rocket import drag_from
from hfanalysis.engine.cautions import LEAST_RAIL_SPEED
from hfanalysis.errors import AbsentError
from hfanalysis.flight import histories, stability, summary
from hfanalysis.flight.ascent import LIFT_OFF, THRUST_BIAS, THRUST_DRIFT, THRUST_SCALE, Ascent, ascend
from hfanalysis.flight.curve import Curve
from hfanalysis.flight.histories import BAND, Flown
from hfanalysis.flight.stability import Launch
from hfanalysis.measured_flight.budget import apogee_budget
from hfanalysis.measured_flight.firing import Firing
from hfanalysis.measured_flight.uncertainty import (
    DrawnFlights,
    Input,
    band_covers,
    disperse,
    inputs,
    laws_of,
    rows,
    spread_of,
)
from hfanalysis.products import flight as products
from hfanalysis.products.budget import Budget
from hfanalysis.quantity import Quantity
from hfanalysis.record.rocket import Rocket
from hfanalysis.rocket.vehicle import gravity

Progress = Callable[[str, float | None], None]


@dataclass(frozen=True)
class MeasuredFlight:
    """A firing, its flight, and the flights that differ in what is uncertain."""

    firing: Firing
    ascent: Ascent
    dispersion: DrawnFlights
    inputs: dict[str, Input]
    samples: int
    seed: int
    impulse: Quantity
    as_measured: Quantity
    covers: str
    budget: Budget | None = None


def fly_measured(
    firing: Firing,
    rocket: Rocket,
    samples: int,
    seed: int,
    progress: Progress | None = None,
    shots: bool = False,
) -> MeasuredFlight:
    """Fly it. Raises AbsentError for a rocket that stays on its pad or leaves the atmosphere model.

    ``shots``: the bands hold how thrust differs from one firing to the next, too.
    """
    try:
        flown = ascend(firing.curve, firing.vehicle, firing.rail_length)
    except ValueError as error:
        raise AbsentError(str(error)) from None
    drawn = rows(firing, rocket, samples, seed, shots)
    spread = disperse(firing, drawn, 1.25 * flown.end[0], progress)
    given, covers = inputs(firing, rocket, shots), band_covers(firing, rocket, shots)
    impulse, measured = _impulse(firing, flown, drawn), _as_measured(firing, drawn)
    scattered = bool(shots or rocket.shot_to_shot)
    made = apogee_budget(drawn, spread.results, len(firing.curves), scattered)
    return MeasuredFlight(firing, flown, spread, given, samples, seed, impulse, measured, covers, made)


AS_MEASURED_FLIGHTS = 1000
"""Flights drawn of the thrust as measured, where it is not what flies. Source: by choice, a quarter of the others."""


def _as_measured(firing: Firing, drawn: Array) -> Quantity:
    """The apogee [m] on the thrust with the purge gas in it."""
    try:
        flown = ascend(firing.as_measured[0], firing.vehicle, firing.rail_length)
    except ValueError as error:
        return Quantity.absent(str(error))
    few = drawn[:AS_MEASURED_FLIGHTS]
    some = disperse(firing, few, 1.25 * flown.end[0], curves=firing.as_measured).spreads()
    return some["apogee"].about(flown.height, "m") if "apogee" in some else Quantity(flown.height, "m")


def _impulse(firing: Firing, flown: Ascent, drawn: Array) -> Quantity:
    """Of the thrust along the flight [N s], with what scatters it."""
    burn = firing.curve.burn_time
    each = np.array([_along(curve, firing) for curve in firing.curves])
    off = (drawn[:, THRUST_BIAS] + 0.5 * drawn[:, THRUST_DRIFT]) * burn
    may = drawn[:, THRUST_SCALE] * each[np.arange(len(drawn)) % each.size] + off
    return spread_of(may, laws_of(firing.curves, len(drawn))).about(_of_trace(flown, burn), "N s")


def _along(curve: Curve, firing: Firing) -> float:
    """Impulse [N s] of a curve along its own flight; without a flight, on the stand."""
    try:
        return _of_trace(ascend(curve, firing.vehicle, firing.rail_length), curve.burn_time)
    except ValueError:
        return curve.impulse


def _of_trace(flown: Ascent, burn: float) -> float:
    time, thrust = flown.column("time"), flown.column("thrust")
    some = time <= burn * (1.0 + 1e-9)
    return float(np.trapezoid(thrust[some], time[some]))


def product(launched: MeasuredFlight, rocket: Rocket, stable: stability.StabilityRuns | str) -> products.Flight:
    """The content of flight.json."""
    firing = launched.firing
    flown = summary.quantities(
        firing.vehicle, launched.ascent, firing.rail_length, firing.canopies, launched.dispersion.spreads()
    )
    rail = rail_check(flown["rail_departure_velocity"])
    drawn = {name: _drawn(given) for name, given in launched.inputs.items()}
    about = {
        "checks": {"rail_departure_velocity": rail, **stability.checks(stable)},
        "thrust": firing.thrust_is,
        "thrust_basis": firing.thrust_basis,
        "band_covers": launched.covers,
        "drag": drag_from(rocket),
        "masses": dict(firing.propellant.how),
        "dispersion": products.Dispersion(flights=launched.samples, seed=launched.seed, inputs=drawn),
        "stability": stability.product(stable),
        "budget": {"apogee": launched.budget} if launched.budget is not None else {},
        "notes": firing.notes,
    }
    return products.Flight.from_json({**flown, **_on_pad(launched), **about})


def _drawn(given: Input) -> products.DispersionInput:
    origin = "test.toml" if given.stated else "default"
    return products.DispersionInput(std=given.std, unit=given.unit, origin=origin, of=given.of)


def _on_pad(launched: MeasuredFlight) -> dict[str, Quantity]:
    firing = launched.firing
    propellant, dry = launched.inputs["propellant"].std, launched.inputs["dry_mass"].std
    std = float(np.hypot(propellant, dry))
    peak = float(launched.ascent.column("thrust").max())
    weight = firing.wet_mass * gravity(firing.vehicle.launch_altitude)
    stand, thrust = firing.as_measured[0], firing.thrust
    spread = np.hypot(thrust.gain_std * firing.impulse_stand, thrust.burn_time * thrust.bias_std)
    spread = float(np.hypot(spread, 0.5 * thrust.burn_time * thrust.drift_std))
    return {
        "wet_mass": Quantity(firing.wet_mass, "kg", std),
        "pad_thrust_to_weight": Quantity(peak / weight),
        "liftoff_thrust_to_weight": Quantity(_at_liftoff(launched) / weight),
        "apogee_as_measured": launched.as_measured,
        "impulse_flown": launched.impulse,
        "impulse_stand": Quantity(stand.impulse, "N s", spread),
        "total_impulse": Quantity(stand.impulse, "N s"),
        "burn_time": Quantity(firing.burn_time, "s"),
        "average_thrust": Quantity(stand.impulse / stand.burn_time, "N"),
    }


LIFT_OFF_MEAN = 0.5
"""[s] after lift-off over which the thrust is averaged where no rail is left. Source: by choice, about what a rail
takes."""


def _at_liftoff(launched: MeasuredFlight) -> float:
    """Mean thrust [N] from lift-off to the end of the rail."""
    flown, rail = launched.ascent, launched.firing.rail_length
    time, thrust = flown.column("time"), flown.column("thrust")
    height = flown.column("altitude") - launched.firing.vehicle.launch_altitude
    start = float(flown.results[LIFT_OFF])
    up = np.cos(launched.firing.vehicle.launch_angle)
    left = np.flatnonzero(height >= (np.inf if rail is None else rail * up))
    end = float(time[left[0]]) if left.size and rail is not None else start + LIFT_OFF_MEAN
    some = (time >= start) & (time <= max(end, start))
    return float(thrust[some].mean())


def rail_check(speed: Quantity) -> products.Check:
    """Whether the rail is left fast enough: passed, failed, or unknown where the 95 % interval holds the limit."""
    result, why = "unknown", str(speed.reason)
    if speed.value is not None:
        low, high = speed.interval or (speed.value, speed.value)
        result = "passed" if low >= LEAST_RAIL_SPEED else "failed" if high < LEAST_RAIL_SPEED else "unknown"
        why = f"{speed.value:.1f} m/s, 95 % from {low:.1f} to {high:.1f}"
    return products.Check(limit=LEAST_RAIL_SPEED, unit="m/s", side="at least", result=result, why=why)


def write_histories(
    path: Path, launched: MeasuredFlight, stable: stability.StabilityRuns | str, provenance: Mapping[str, Any]
) -> None:
    """flight.h5: groups ``ascent``, ``bands``, the ways down, ``balance`` and ``stability``, in SI."""
    firing, load, dispersion = launched.firing, launched.firing.propellant, launched.dispersion
    time = launched.ascent.column("time")
    masses = {name: np.interp(time, load.time, of) for name, of in (("oxidizer", load.oxidizer), ("fuel", load.fuel))}
    bands = {f"{name}_{side}": band[i] for name, band in dispersion.bands.items() for i, side in enumerate(BAND)}
    launch = Launch(firing.curve, firing.vehicle, firing.rail_length)
    flown = Flown(launch, launched.ascent, firing.canopies, stable)
    beside = {f"{name}_mass": of for name, of in masses.items()}
    title = "flight on the measured thrust"
    histories.write(path, title, provenance, flown, beside, {"time": dispersion.time} | bands)
