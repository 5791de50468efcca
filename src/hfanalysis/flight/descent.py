"""From apogee to the ground: drogue, main parachute, ballistic case (report, section 3.1.5), compiled: a descent takes
half a millisecond, so that thousands can be drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import (
    EARTH_RADIUS,
    STANDARD_GRAVITY,
    Vehicle,
    air_about,
    drag_in,
    gravity,
)
from hfanalysis.thermo.air import air_of_day

LONGEST_FALL = 3600.0
"""Longest part of a descent [s]."""

LONGEST_STEP = 1.0
"""Longest step of the solver [s]. Source: by choice, for the histories: the air changes by a third of a per cent."""

TOLERANCE = 1e-9
"""Of a step, of altitude and speed [-]. Evidence: test_ascent.py: the whole way down as scipy's LSODA has it."""

FIRST_STEP = 1e-3
"""Of the solver [s]. Source: by choice: a canopy that opens stops a rocket within a tenth of a second."""

LEAST_STEP = 1e-12
"""Step [s] at which a fall is given up."""


@dataclass(frozen=True)
class Leg:
    """One part of a descent: time [s], altitude above sea level [m], speed [m/s] (upwards positive)."""

    time: Array
    altitude: Array
    speed: Array

    @property
    def end(self) -> tuple[float, float, float]:
        """Last time [s], altitude above sea level [m] and speed [m/s]."""
        return float(self.time[-1]), float(self.altitude[-1]), float(self.speed[-1])


def fall(vehicle: Vehicle, drag_area: float, start: tuple[float, float, float], floor: float) -> Leg:
    """Fall from (time [s], altitude [m], speed [m/s]) to an altitude ``floor`` [m] (report, eq. 3.48 to 3.50).

    ``drag_area``: C_d A [m^2] beside the rocket's own.
    """
    fixed = np.array([
        drag_area, vehicle.frontal_area, vehicle.dry_mass, vehicle.launch_altitude, vehicle.warmer,
        vehicle.pressure_share,
    ])  # fmt: skip
    rows = np.empty((MOST_ROWS, 3))
    count = _fall(np.array(start), floor, vehicle.drag_table, fixed, rows)
    return Leg(*rows[:count].T.copy())


MOST_ROWS = 100_000
"""Steps of a fall: more than the longest takes."""


@compiled(nogil=True, inline="always")
def _rate(z: float, v: float, table: Array, fixed: Array) -> float:
    """dv/dt [m/s^2] at an altitude [m] and a speed upwards [m/s]."""
    _, rho, sound = air_of_day(z, fixed[3], fixed[4], fixed[5])
    canopy = 0.5 * fixed[0] * rho * v * abs(v)
    pull = STANDARD_GRAVITY * (EARTH_RADIUS / (EARTH_RADIUS + z)) ** 2
    return float(-pull - (canopy + drag_in(rho, sound, v, fixed[1], table)) / fixed[2])


@compiled(nogil=True)
def _step(z: float, v: float, h: float, table: Array, fixed: Array) -> tuple[float, float, float]:
    """One step ``h`` [s] of Dormand and Prince's method of order 5 (J. Comp. Appl. Math. 6 (1980) 19): altitude [m],
    speed [m/s], and the error [-] of both over TOLERANCE, by its embedded one of order 4."""
    a1 = _rate(z, v, table, fixed)
    v2 = v + h * a1 / 5.0
    a2 = _rate(z + h * v / 5.0, v2, table, fixed)
    v3 = v + h * (3.0 * a1 + 9.0 * a2) / 40.0
    a3 = _rate(z + h * (3.0 * v + 9.0 * v2) / 40.0, v3, table, fixed)
    v4 = v + h * (44.0 / 45.0 * a1 - 56.0 / 15.0 * a2 + 32.0 / 9.0 * a3)
    a4 = _rate(z + h * (44.0 / 45.0 * v - 56.0 / 15.0 * v2 + 32.0 / 9.0 * v3), v4, table, fixed)
    v5 = v + h * (19372.0 * a1 / 6561.0 - 25360.0 * a2 / 2187.0 + 64448.0 * a3 / 6561.0 - 212.0 * a4 / 729.0)
    z5 = z + h * (19372.0 * v / 6561.0 - 25360.0 * v2 / 2187.0 + 64448.0 * v3 / 6561.0 - 212.0 * v4 / 729.0)
    a5 = _rate(z5, v5, table, fixed)
    v6 = v + h * (9017.0 * a1 / 3168.0 - 355.0 * a2 / 33.0 + 46732.0 * a3 / 5247.0 + 49.0 * a4 / 176.0
                  - 5103.0 * a5 / 18656.0)  # fmt: skip
    z6 = z + h * (9017.0 * v / 3168.0 - 355.0 * v2 / 33.0 + 46732.0 * v3 / 5247.0 + 49.0 * v4 / 176.0
                  - 5103.0 * v5 / 18656.0)  # fmt: skip
    a6 = _rate(z6, v6, table, fixed)
    new_v = v + h * (35.0 * a1 / 384.0 + 500.0 * a3 / 1113.0 + 125.0 * a4 / 192.0 - 2187.0 * a5 / 6784.0
                     + 11.0 * a6 / 84.0)  # fmt: skip
    new_z = z + h * (35.0 * v / 384.0 + 500.0 * v3 / 1113.0 + 125.0 * v4 / 192.0 - 2187.0 * v5 / 6784.0
                     + 11.0 * v6 / 84.0)  # fmt: skip
    a7 = _rate(new_z, new_v, table, fixed)
    off_v = h * (71.0 * a1 / 57600.0 - 71.0 * a3 / 16695.0 + 71.0 * a4 / 1920.0 - 17253.0 * a5 / 339200.0
                 + 22.0 * a6 / 525.0 - a7 / 40.0)  # fmt: skip
    off_z = h * (71.0 * v / 57600.0 - 71.0 * v3 / 16695.0 + 71.0 * v4 / 1920.0 - 17253.0 * v5 / 339200.0
                 + 22.0 * v6 / 525.0 - new_v / 40.0)  # fmt: skip
    error = max(abs(off_v) / (1.0 + abs(v)), abs(off_z) / (1.0 + abs(z)))
    return new_z, new_v, error / TOLERANCE


@compiled(nogil=True)
def _fall(start: Array, floor: float, table: Array, fixed: Array, rows: Array) -> int:
    """Fills ``rows`` (n, 3) with time [s], altitude [m] and speed [m/s] and returns how many; the last is on the
    ``floor`` [m], or where the time was up."""
    t, z, v = start[0], start[1], start[2]
    end, h, count = t + LONGEST_FALL, FIRST_STEP, 1
    rows[0, 0], rows[0, 1], rows[0, 2] = t, z, v
    while z > floor and t < end and count < rows.shape[0]:
        new_z, new_v, error = _step(z, v, h, table, fixed)
        if error > 1.0 and h > LEAST_STEP:
            h *= max(0.2, 0.9 * error**-0.2)
            continue
        if new_z < floor:  # the share of the step that ends on the floor, by false position
            low, high, over, under = 0.0, h, z - floor, new_z - floor
            for _ in range(60):
                part = low + (high - low) * over / (over - under)
                new_z, new_v, _ = _step(z, v, part, table, fixed)
                if abs(new_z - floor) < 1e-9 * (1.0 + abs(floor)):
                    break
                if new_z > floor:
                    low, over, under = part, new_z - floor, 0.5 * under
                else:
                    high, under, over = part, new_z - floor, 0.5 * over
            h, new_z = part, floor
        t, z, v = t + h, new_z, new_v
        rows[count, 0], rows[count, 1], rows[count, 2] = t, z, v
        count += 1
        h = min(h * min(5.0, 0.9 * max(error, 1e-10) ** -0.2), LONGEST_STEP, max(end - t, LEAST_STEP))
    return count


@dataclass(frozen=True)
class Descent:
    """Under parachutes and without: speeds [m/s] downwards positive, times [s], the main's opening load in g."""

    time_of_main: float
    drogue_speed: float
    landing_speed: float
    landing_time: float
    main_load: float
    ballistic_speed: float
    legs: tuple[Leg, ...]


def descend(vehicle: Vehicle, apogee: tuple[float, float, float], drogue: Parachute, main: Parachute) -> Descent:
    """From apogee (time [s], altitude above sea level [m], speed [m/s]) to the ground (report, section 3.1.5).

    A main opens at its deploy altitude or below. One without a deploy altitude, or one that is above the apogee, opens
    at apogee; the drogue then does nothing.
    """
    ground = vehicle.launch_altitude
    top = (apogee[0], apogee[1], 0.0)
    deploy = apogee[1] if main.deploy_altitude is None else min(ground + main.deploy_altitude, apogee[1])
    first = fall(vehicle, drogue.drag_coefficient * drogue.area, top, deploy)
    second = fall(vehicle, main.drag_coefficient * main.area, first.end, ground)
    ballistic = fall(vehicle, 0.0, top, ground)
    _, rho, sound = air_about(vehicle, deploy)
    canopy = 0.5 * main.drag_coefficient * main.area * rho * first.end[2] ** 2
    own = drag_in(rho, sound, -first.end[2], vehicle.frontal_area, vehicle.drag_table)
    load = (canopy + own) / vehicle.dry_mass - gravity(deploy)
    return Descent(
        time_of_main=first.end[0],
        drogue_speed=-first.end[2],
        landing_speed=-second.end[2],
        landing_time=second.end[0],
        main_load=load / STANDARD_GRAVITY,
        ballistic_speed=-ballistic.end[2],
        legs=(first, second, ballistic),
    )
