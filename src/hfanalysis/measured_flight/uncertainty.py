"""What is uncertain of a flight, and thousands of flights that differ in it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.flight.ascent import (
    ANGLE,
    APOGEE,
    CROSSWIND,
    DRAG,
    MASS,
    NOMINAL,
    PROPELLANT,
    RESULTS,
    THRUST_BIAS,
    THRUST_DRIFT,
    THRUST_SCALE,
    TIME,
    WIND,
    Arguments,
    arguments,
    fly_all,
)
from hfanalysis.flight.curve import Curve
from hfanalysis.flight.summary import ASCENT, FlightSpread
from hfanalysis.measured_flight.firing import Firing
from hfanalysis.processors import processors
from hfanalysis.record.rocket import Rocket
from hfanalysis.units import Value

Progress = Callable[[str, float | None], None]

DRAG_UNSTATED = 0.10
"""Relative standard deviation of a drag that is stated without one [-]. Evidence: it is what separates drag build-ups
from flights of rockets like these: Halcyon flew 1.6 % lower than its team's drag says and 3.7 % lower than the built-up
one (docs/flight.md)."""
DRY_MASS_UNSTATED = 0.005
"""Relative standard deviation of a dry mass that is stated without one [-]: a rocket that was weighed, and then worked
on."""
ANGLE_UNSTATED = np.radians(1.0)
"""Standard deviation of the angle to which a rail is set and holds [rad]."""
WIND_UNSTATED = 2.0
"""Standard deviation of each horizontal component of the wind [m/s]: calm to a moderate breeze."""
STATED_WIND_SHARE = 0.3
"""Standard deviation of a wind that is stated without one, of its speed [-]: gusts."""

SHOT_TO_SHOT = 0.067
"""Relative standard deviation of the thrust from one firing to the next [-], where test.toml states none. Source: NFPA
1125 certifies no motor whose total impulse differs by more among its firings."""

CHUNK = 250
"""Flights that one core takes at a time."""

PATHS = 2000
"""Flights whose course is kept for the bands over time; more add nothing to them."""

POINTS = 241
"""Times of the bands."""


@dataclass(frozen=True)
class Input:
    """One uncertain input: standard deviation with its unit, and whether test.toml states it."""

    std: float
    unit: str
    stated: bool
    of: str


def inputs(firing: Firing, rocket: Rocket, shots: bool = False) -> dict[str, Input]:
    """Every uncertain input of a flight by name; ``shots``: with how thrust differs from one firing to the next, as it
    is where that is stated."""
    return {**_inputs(firing, rocket), **({"shot_to_shot": _scatter(rocket)} if shots or rocket.shot_to_shot else {})}


def _scatter(rocket: Rocket) -> Input:
    stated = rocket.shot_to_shot
    return Input(stated or SHOT_TO_SHOT, "", stated is not None, "relative, of the thrust from one firing to the next")


def band_covers(firing: Firing, rocket: Rocket, shots: bool) -> str:
    """What a band holds, in words."""
    laws = "" if len(firing.curves) < 2 else ", and what cannot be told of the purge gas's part and the nozzle's law"
    if not (shots or rocket.shot_to_shot):
        return f"errors of this record only: if this thrust repeats exactly{laws}"
    scatter = _scatter(rocket)
    return (
        f"errors of this record{laws}, and {100.0 * scatter.std:.2g} % (one standard deviation) of thrust from one "
        f"firing to the next, {'as stated' if scatter.stated else 'a default'}"
    )


def _inputs(firing: Firing, rocket: Rocket) -> dict[str, Input]:
    thrust, angle, wind = firing.thrust, rocket.launch_angle, rocket.wind_speed
    drag, load = _drag(rocket), firing.propellant
    speed = _wind(wind)
    return {
        "thrust_gain": Input(thrust.gain_std, "", False, "relative, of the load cell"),
        "thrust_bias": Input(thrust.bias_std, "N", False, "of the load cell's zero and its drift's course"),
        "thrust_drift": Input(thrust.drift_std, "N", False, "of drift left in, at the end of the burn"),
        "dry_mass": Input(*_stated(rocket.dry_mass, DRY_MASS_UNSTATED * rocket.dry_mass.value, "kg"), "of the rocket"),
        "propellant": Input(load.loaded_std, "kg", load.stated_std, "oxidizer and fuel loaded"),
        "drag": Input(drag or DRAG_UNSTATED, "", drag is not None, "relative, coefficient and air density together"),
        "launch_angle": Input(*_stated(angle, float(ANGLE_UNSTATED), "rad"), "of the rail"),
        "wind": Input(speed[1], "m/s", wind is not None, f"about {speed[0]:.3g} m/s, from any direction"),
    }


def _stated(value: Value | None, default: float, unit: str) -> tuple[float, str, bool]:
    known = value is not None and value.std is not None
    return (value.std if value is not None and value.std is not None else default), unit, known


def _drag(rocket: Rocket) -> float | None:
    """What is stated of the drag's error, relative: on its own, or with the coefficient."""
    stated = rocket.drag_coefficient
    if rocket.drag_uncertainty is not None or stated is None or stated.std is None:
        return rocket.drag_uncertainty
    return stated.std / stated.value


def _wind(stated: Value | None) -> tuple[float, float]:
    """Mean speed and standard deviation of each component [m/s]."""
    if stated is None:
        return 0.0, WIND_UNSTATED
    return stated.value, STATED_WIND_SHARE * stated.value if stated.std is None else stated.std


def rows(firing: Firing, rocket: Rocket, samples: int, seed: int, shots: bool = False) -> Array:
    """Flights to be flown, (samples, 9), one by row, as NOMINAL [1, N, N, kg, 1, 1, rad, m/s, m/s]; the same from run
    to run. ``shots``: with how thrust differs from one firing to the next."""
    rng = np.random.default_rng(seed)
    std = {name: found.std for name, found in inputs(firing, rocket, shots).items()}
    drawn = np.tile(NOMINAL, (samples, 1))
    normal = rng.standard_normal((samples, 9))
    propellant = float(firing.propellant.total[0])
    drawn[:, THRUST_SCALE] += std["thrust_gain"] * normal[:, 0]
    drawn[:, THRUST_BIAS] = std["thrust_bias"] * normal[:, 1]
    drawn[:, THRUST_DRIFT] = std["thrust_drift"] * normal[:, 2]
    drawn[:, MASS] = std["dry_mass"] * normal[:, 3]
    drawn[:, PROPELLANT] += std["propellant"] / propellant * normal[:, 4]
    drawn[:, DRAG] = np.maximum(1.0 + std["drag"] * normal[:, 5], 0.05)
    drawn[:, ANGLE] = np.abs(firing.vehicle.launch_angle + std["launch_angle"] * normal[:, 6])
    direction = rng.uniform(0.0, 2.0 * np.pi, samples)
    mean = _wind(rocket.wind_speed)[0]
    drawn[:, WIND] = mean * np.cos(direction) + std["wind"] * normal[:, 7]
    drawn[:, CROSSWIND] = mean * np.sin(direction) + std["wind"] * normal[:, 8]
    if "shot_to_shot" in std:
        drawn[:, THRUST_SCALE] *= np.maximum(1.0 + std["shot_to_shot"] * rng.standard_normal(samples), 0.05)
    return drawn


@dataclass(frozen=True)
class DrawnFlights:
    """Drawn flights: ``results`` (n, 8) of each, and bands (2.5, 50, 97.5 %) over ``time``: (3, n) by column.

    ``laws`` (n,): by which of several laws each flies; none: by one.
    """

    results: Array
    time: Array
    bands: dict[str, Array]
    laws: NDArray[np.intp] | None = None

    def spreads(self) -> dict[str, FlightSpread]:
        """Standard deviation and 95 % interval of every quantity of the ascent that most flights have."""
        found = {}
        for name, (index, _) in ASCENT.items():
            there = np.isfinite(self.results[:, index]) & (self.results[:, APOGEE] > 0.0)
            if there.sum() > 0.9 * len(self.results):
                laws = None if self.laws is None else self.laws[there]
                found[name] = spread_of(self.results[there, index], laws)
        return found


def spread_of(values: Array, laws: NDArray[np.intp] | None = None) -> FlightSpread:
    """Standard deviation and 95 % interval of drawn ``values`` (n,) [any unit]; of several ``laws`` (n,) of which one
    holds, and no one knows which, the interval holds that of each."""
    groups = [values] if laws is None else [values[laws == law] for law in np.unique(laws)]
    ends = np.array([np.percentile(group, (2.5, 97.5)) for group in groups])
    return FlightSpread(float(values.std(ddof=1)), (float(ends[:, 0].min()), float(ends[:, 1].max())))


def disperse(
    firing: Firing,
    drawn: Array,
    last: float,
    progress: Progress | None = None,
    curves: Sequence[Curve] | None = None,
) -> DrawnFlights:
    """Fly every row of ``drawn`` (flights, 9) [SI] on all cores, dealt in turn to the ``curves`` that may hold
    (default: the firing's); the bands end at ``last`` [s] or when the first flights have turned."""
    results = np.empty((len(drawn), RESULTS))
    paths = np.empty((min(len(drawn), PATHS), POINTS, 3))
    every = last / (POINTS - 1)

    def fly_some(dealt: tuple[Arguments, NDArray[np.intp]]) -> None:
        fixed, mine = dealt
        kept = int(np.searchsorted(mine, len(paths)))
        found, path = np.empty((mine.size, RESULTS)), np.empty((mine.size, POINTS if kept else 0, 3))
        fly_all(*fixed, drawn[mine], found, every, path)
        results[mine] = found
        if kept:
            paths[mine[:kept]] = path[:kept]

    parts = list(_dealt(firing, curves or firing.curves, len(drawn)))
    with ThreadPoolExecutor(processors()) as cores:
        for done, _ in enumerate(cores.map(fly_some, parts), 1):
            if progress is not None:
                progress("flying with drawn inputs", done / len(parts))
    flying = results[:, APOGEE] > 0.0
    laws = laws_of(curves or firing.curves, len(drawn))
    turned = spread_of(results[flying, TIME], laws[flying]).ci95[0] if flying.mean() > 0.5 else -1.0
    time: Array = every * np.arange(POINTS, dtype=np.float64)
    kept = time <= turned
    bands = dict(_bands(paths[:, kept], laws[: len(paths)], firing.vehicle.launch_altitude))
    return DrawnFlights(results, time[kept], bands, laws)


def laws_of(curves: Sequence[Curve], count: int) -> NDArray[np.intp]:
    """By which law each of so many flights flies that are dealt to the curves in turn, (count,)."""
    return np.array([curve.law for curve in curves], dtype=np.intp)[np.arange(count) % len(curves)]


def _dealt(firing: Firing, curves: Sequence[Curve], count: int) -> Iterator[tuple[Arguments, NDArray[np.intp]]]:
    """What is flown, and by which rows: every curve has as many, in parts of CHUNK at most."""
    for j, curve in enumerate(curves):
        fixed, mine = arguments(curve, firing.vehicle, firing.rail_length), np.arange(j, count, len(curves))
        for start in range(0, mine.size, CHUNK):
            yield fixed, mine[start : start + CHUNK]


def _bands(paths: Array, laws: NDArray[np.intp], ground: float) -> Iterator[tuple[str, Array]]:
    """As :func:`spread_of`, over time: the median of all, and what holds the band of every law."""
    offsets = {"height": ground, "speed": 0.0, "acceleration": 0.0}
    for column, (name, offset) in enumerate(offsets.items()):
        values = paths[:, :, column]
        flying = np.isfinite(values).any(axis=0)  # of a law by which no rocket leaves its pad there is no band
        groups = [values[laws == law] for law in np.unique(laws)]
        seen = [group for group in groups if np.isfinite(group[:, flying]).any(axis=0).all()] or [values]
        each = [np.nanpercentile(group, (2.5, 97.5), axis=0) for group in seen]
        low, high = np.min([ends[0] for ends in each], axis=0), np.max([ends[1] for ends in each], axis=0)
        yield name, np.stack((low, np.nanmedian(values, axis=0), high)) - offset
