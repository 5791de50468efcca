"""Ascent from ignition to apogee along one line (report, sections 2.1.4 and 3.1.5), compiled: one flight takes half a
millisecond, so that thousands can be drawn.

The path keeps its angle. A wind turns it once, at the end of the rail: a stable rocket points into the air it flies
through, and thrust and drag then act along that direction, which therefore stays what it was there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.flight.curve import Curve
from hfanalysis.rocket.vehicle import EARTH_RADIUS, STANDARD_GRAVITY, Vehicle, drag_coefficient
from hfanalysis.thermo.air import air_of_day
from hfanalysis.thermo.atmosphere import HIGHEST

COAST_STEP = 0.05
"""Step of the coast [s]. Evidence: Runge-Kutta of fourth order follows what is left, drag and gravity, to 1e-8."""

LONGEST_ASCENT = 3600.0
"""Longest flight to its apogee [s]."""

PAD = 1e-3
"""Height [m] above which a rocket has left its pad. Evidence: a tenth of it changes no flight that is tested."""

NOT_FROM_PAD = "the rocket does not leave its pad"

APOGEE, TIME, RAIL, SPEED, MACH, ACCELERATION, LIFT_OFF, PRESSURE = range(8)
"""What :func:`fly` finds: height [m] and time [s] of the apogee, speed [m/s] at the rail's end (NaN: not reached), peak
speed, peak Mach number, peak acceleration [m/s^2] while burning, time [s] of lift-off, peak dynamic pressure [Pa]."""
RESULTS = 8
"""How many results a flight has."""

NOMINAL = np.array([1.0, 0.0, 0.0, 0.0, 1.0, 1.0, np.nan, 0.0, 0.0])
"""A flight that differs in nothing [1, N, N, kg, 1, 1, rad, m/s, m/s]. Source: by definition: factors of 1, offsets of
0, the vehicle's launch angle."""

THRUST_SCALE, THRUST_BIAS, THRUST_DRIFT, MASS, PROPELLANT, DRAG, ANGLE, WIND, CROSSWIND = range(9)
"""What a flight may differ in: factor on the thrust, its offset [N] and drift over the burn [N], mass added [kg],
factors on the propellant and on the drag, launch angle [rad] (NaN: the vehicle's), wind along and across [m/s]."""

TRACE = ("time", "altitude", "speed", "acceleration", "thrust", "drag", "mass", "mach")
"""Columns of a traced flight [s, m above sea level, m/s, m/s^2, N, N, kg, 1]."""

Arguments = tuple[Array, Array, Array, Array, Array]
"""Thrust, mass, gain, drag table, and the numbers that do not change over a flight."""


@dataclass(frozen=True)
class Ascent:
    """A flight to its apogee: ``results`` as APOGEE and following, ``trace`` (n, 8) as TRACE, on the solver's steps."""

    results: Array
    trace: Array

    def column(self, name: str) -> Array:
        """One of TRACE over time, (n,), [s, m, m/s, m/s^2, N, N, kg, 1]; raises ValueError for a name that is none."""
        return self.trace[:, TRACE.index(name)]

    @property
    def height(self) -> float:
        """Of the apogee above the launch site [m]."""
        return float(self.results[APOGEE])

    @property
    def end(self) -> tuple[float, float, float]:
        """Time [s], altitude above sea level [m] and speed [m/s] at apogee."""
        return float(self.trace[-1, 0]), float(self.trace[-1, 1]), float(self.trace[-1, 2])


def ascend(curve: Curve, vehicle: Vehicle, rail_length: float | None = None, row: Array = NOMINAL) -> Ascent:
    """Fly to apogee (report, eq. 2.17 to 2.21); ``rail_length`` [m] (None: there is no rail to leave).

    ``row`` (9,): what differs from the nominal flight, as NOMINAL. Raises ValueError for a rocket that stays on its pad
    or leaves the atmosphere model.
    """
    trace = np.empty((curve.thrust.size + int(LONGEST_ASCENT / COAST_STEP), len(TRACE)))
    results = np.empty(RESULTS)
    steps = fly(*arguments(curve, vehicle, rail_length), row, results, trace, 0.0, trace[:0, :3])
    if not results[APOGEE] > 0.0:
        raise ValueError(NOT_FROM_PAD)
    if vehicle.launch_altitude + results[APOGEE] >= HIGHEST:
        raise ValueError(f"the rocket leaves the atmosphere model: above {HIGHEST:.0f} m")
    return Ascent(results, trace[:steps].copy())


def arguments(curve: Curve, vehicle: Vehicle, rail_length: float | None) -> Arguments:
    """What :func:`fly` reads of a thrust curve and a vehicle: (n + 1,), (n + 1,), (n + 1, k), (2, m), (11,) [SI].

    ``rail_length`` [m] (None: there is no rail to leave).
    """
    fixed = np.array([
        curve.step, vehicle.dry_mass, curve.mass_after, vehicle.frontal_area, vehicle.launch_angle,
        vehicle.launch_altitude, np.inf if rail_length is None else rail_length, *curve.ambients,
        vehicle.warmer, vehicle.pressure_share,
    ])  # fmt: skip
    return curve.thrust, curve.mass, curve.gain, vehicle.drag_table, fixed


@compiled(nogil=True)
def fly_all(
    thrust: Array, mass: Array, gain: Array, table: Array, fixed: Array, rows: Array, results: Array, every: float,
    paths: Array,
) -> None:  # fmt: skip
    """Many flights, one by row; ``rows`` (flights, 9) as NOMINAL, ``results`` (flights, 8) as APOGEE and following.

    ``paths`` (flights, n, 3): altitude [m], speed [m/s], acceleration [m/s^2] ``every`` so many seconds [s]. The other
    arguments are those of :func:`arguments`.
    """
    none = np.empty((0, 8))
    for i in range(rows.shape[0]):
        fly(thrust, mass, gain, table, fixed, rows[i], results[i], none, every, paths[i])


@compiled(nogil=True)
def fly(
    thrust: Array, mass: Array, gain: Array, table: Array, fixed: Array, row: Array, results: Array, trace: Array,
    every: float, path: Array,
) -> int:  # fmt: skip
    """One flight; fills ``results`` (8,), ``trace`` (n, 8) and ``path`` (m, 3) (of length 0: not wanted) [SI].

    ``row`` (9,) as NOMINAL; ``every`` [s] between the rows of ``path`` (altitude, speed, acceleration). The other
    arguments are those of :func:`arguments`. Returns the traced steps.
    """
    burn_step, last, base, rail = fixed[0], thrust.size - 1, fixed[5], fixed[6]
    angle = fixed[4] if np.isnan(row[ANGLE]) else row[ANGLE]
    climb, on_rail = np.cos(angle), True
    now, t, z, v = 0, 0.0, base, 0.0
    results[:] = 0.0
    results[RAIL] = results[LIFT_OFF] = np.nan
    path[:] = np.nan
    steps = next_path = 0
    while t < LONGEST_ASCENT:
        burning = now < last
        h = burn_step if burning else COAST_STEP
        a, mach, pressure, resistance, force, m = _felt(thrust, mass, gain, table, fixed, row, now, 0.0, z, v, climb)
        steps = _note(trace, steps, t, z, v, a, force, resistance, m, mach)
        while next_path < path.shape[0] and next_path * every < t + h:
            late = next_path * every - t
            path[next_path, 0], path[next_path, 1], path[next_path, 2] = z + v * climb * late, v + a * late, a
            next_path += 1
        _peaks(results, z - base, v, mach, a if burning else 0.0, pressure)
        # four slopes of the classical Runge-Kutta method
        k1, s1 = a, v
        s2 = v + 0.5 * h * k1
        k2 = _felt(thrust, mass, gain, table, fixed, row, now, 0.5, z + 0.5 * h * s1 * climb, s2, climb)[0]
        s3 = v + 0.5 * h * k2
        k3 = _felt(thrust, mass, gain, table, fixed, row, now, 0.5, z + 0.5 * h * s2 * climb, s3, climb)[0]
        s4 = v + h * k3
        k4 = _felt(thrust, mass, gain, table, fixed, row, now, 1.0, z + h * s3 * climb, s4, climb)[0]
        new_v = v + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
        new_z = z + h / 6.0 * (s1 + 2.0 * (s2 + s3) + s4) * climb
        if np.isnan(results[LIFT_OFF]) and new_z > base:
            results[LIFT_OFF] = t
        if on_rail and new_z - base >= rail * climb:
            share = (base + rail * climb - z) / (new_z - z)
            results[RAIL] = np.sqrt(v * v + share * (new_v * new_v - v * v))
            climb, on_rail = _turned(angle, results[RAIL], row[WIND], row[CROSSWIND]), False
        if new_v <= 0.0 and (v > 0.0 or not burning):
            if z > base + PAD:
                share = v / (v - new_v)
                results[TIME], results[APOGEE] = t + share * h, z + 0.5 * v * share * h * climb - base
                return _note(trace, steps, t + share * h, base + results[APOGEE], 0.0, a, force, 0.0, m, 0.0)
            if not burning:
                return steps
            new_z, new_v = base, 0.0
        z, v = new_z, new_v
        now += 1
        t = now * burn_step if burning else t + h
    return steps


@compiled(nogil=True, inline="always")
def _felt(
    thrust: Array, mass: Array, gain: Array, table: Array, fixed: Array, row: Array, now: int, share: float, z: float,
    v: float, climb: float,
) -> tuple[float, float, float, float, float, float]:  # fmt: skip
    """dv/dt = (F - D)/m - g cos(theta) [m/s^2] (0 on the pad), ``share`` of a step on, at an altitude and a speed.

    Then Mach number, dynamic pressure [Pa], drag [N], thrust [N] and mass [kg].
    """
    ambient, rho, sound = air_of_day(z, fixed[5], fixed[9], fixed[10])
    force, m = _push(thrust, mass, gain, fixed, row, now, share, ambient)
    mach, pressure = abs(v) / sound, 0.5 * rho * v * v
    resistance = drag_coefficient(mach, table) * fixed[3] * row[DRAG] * pressure
    pull = STANDARD_GRAVITY * (EARTH_RADIUS / (EARTH_RADIUS + z)) ** 2 * climb
    net = (force - (resistance if v >= 0.0 else -resistance)) / m - pull
    if z <= fixed[5] + PAD and net <= 0.0 and v <= 0.0:
        net = 0.0
    return net, mach, pressure, resistance, force, m


@compiled(nogil=True, inline="always")
def _push(
    thrust: Array, mass: Array, gain: Array, fixed: Array, row: Array, now: int, share: float, ambient: float
) -> tuple[float, float]:
    """Thrust [N] at the ambient pressure and mass [kg], ``share`` of a step on; none and the rest after the burn."""
    last = thrust.size - 1
    if now >= last:
        return 0.0, fixed[1] + row[MASS] + row[PROPELLANT] * (fixed[2] - fixed[1])
    force = thrust[now] + share * (thrust[now + 1] - thrust[now])
    m = mass[now] + share * (mass[now + 1] - mass[now])
    columns = gain.shape[1]
    if columns > 1:
        x = min(max((ambient - fixed[7]) / fixed[8], 0.0), columns - 1.0)
        i = min(int(x), columns - 2)
        x -= i
        here = gain[now, i] + x * (gain[now, i + 1] - gain[now, i])
        there = gain[now + 1, i] + x * (gain[now + 1, i + 1] - gain[now + 1, i])
        force += here + share * (there - here)
    force = row[THRUST_SCALE] * force + row[THRUST_BIAS] + row[THRUST_DRIFT] * (now + share) / last
    return force, fixed[1] + row[MASS] + row[PROPELLANT] * (m - fixed[1])


@compiled(nogil=True, inline="always")
def _turned(angle: float, speed: float, wind: float, crosswind: float) -> float:
    """Cosine from the vertical of the direction in which the rocket meets the air when it leaves its rail."""
    along, up = speed * np.sin(angle) - wind, speed * np.cos(angle)
    return float(up / np.sqrt(along * along + crosswind * crosswind + up * up))


@compiled(nogil=True, inline="always")
def _peaks(results: Array, height: float, v: float, mach: float, a: float, pressure: float) -> None:
    results[SPEED] = max(results[SPEED], v)
    results[MACH] = max(results[MACH], mach)
    results[ACCELERATION] = max(results[ACCELERATION], a)
    results[PRESSURE] = max(results[PRESSURE], pressure)


@compiled(nogil=True, inline="always")
def _note(
    trace: Array, steps: int, t: float, z: float, v: float, a: float, force: float, resistance: float, m: float,
    mach: float,
) -> int:  # fmt: skip
    if steps >= trace.shape[0]:
        return steps
    trace[steps, 0], trace[steps, 1], trace[steps, 2], trace[steps, 3] = t, z, v, a
    trace[steps, 4], trace[steps, 5], trace[steps, 6], trace[steps, 7] = force, resistance, m, mach
    return steps + 1
