"""The rocket in its pitch plane, in wind and gusts: how it meets the air, and its static margin along the flight.

Three degrees of freedom: place, height and attitude. On the rail the attitude is the rail's. Gusts are a first-order
process of Dryden's form: an intensity in parts of the wind, and a length over which the air forgets them. The margin's
center of pressure moves with Mach number and, by the body's lift, with the angle of attack.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.flight.ascent import Arguments
from hfanalysis.rocket.aerodynamics import BODY_LIFT, Shape, center_of_pressure, components, planform
from hfanalysis.rocket.vehicle import EARTH_RADIUS, STANDARD_GRAVITY, drag_coefficient
from hfanalysis.thermo.air import air_of_day

PITCH_STEP = 0.01
"""Step of a flight in wind [s]. Evidence: a rocket of a few calibers' margin swings in a second or so."""

GUST_INTENSITY = 0.10
"""Standard deviation of the gusts in parts of the wind [-]. Source: OpenRocket's default, moderate."""

GUST_LENGTH = 70.0
"""Length of the gusts along the wind near the ground [m]. Source: MIL-F-8785C's Dryden form at 10 m."""

LOW, HIGH = 1.5, 6.0
"""Static margin [calibers] that a flight should keep within. Source: report, section 3.2.4."""

MACHS = 33
"""Mach numbers, from 0 to 1.6, at which slope, place and damping of the normal force are tabulated."""
MACH_STEP = 0.05
"""Between the Mach numbers of the table [-]. Evidence: with twice as much no number moves by more than it is known
to."""

TIME, HEIGHT, SPEED, MARGIN, ATTACK, ATTITUDE = range(6)
COLUMNS = ("time", "height", "speed", "margin", "angle_of_attack", "attitude")
"""Columns of a path [s, m, m/s through the air, calibers, rad, rad from the vertical]."""


@dataclass(frozen=True)
class Aero:
    """What the equations read of a shape: ``table`` (4, MACHS): slope [1/rad], its place [m], sums of slope x and x^2.

    ``fixed``: reference area [m^2], diameter [m], body lift coefficient and its centroid [m].
    """

    table: Array
    fixed: Array


def aero(shape: Shape) -> Aero:
    """Tabulate a shape's normal force [1/rad], its place [m] and its damping over Mach number."""
    table = np.empty((4, MACHS))
    for i in range(MACHS):
        parts = components(shape, MACH_STEP * i)
        slope, place = center_of_pressure(parts)
        first, second = (sum(p.slope * p.position**k for p in parts) for k in (1, 2))
        table[:, i] = slope, place, first, second
    side, centroid = planform(shape)
    return Aero(table, np.array([shape.area, shape.diameter, BODY_LIFT * side / shape.area, centroid]))


@dataclass(frozen=True)
class Flights:
    """Flights in one wind that differ in their gusts: ``paths`` (seeds, n, 6) as COLUMNS, NaN after the apogee.

    ``departure``: index of the rail's end in each.
    """

    wind: float
    paths: Array
    departure: NDArray[np.intp]


def fly_in_wind(
    arguments: Arguments, balance: tuple[Array, Array], aerodynamics: Aero, wind: float, seeds: int, longest: float
) -> Flights:
    """Fly ``seeds`` times in a ``wind`` [m/s] from ahead, ``longest`` [s] at most.

    ``arguments``: those of :func:`hfanalysis.flight.ascent.arguments`; ``balance``: CG [m from the nose tip] and pitch
    inertia [kg m^2] on the thrust curve's clock, (n + 1,) each. The gusts are the same from run to run.
    """
    count = int(longest / PITCH_STEP) + 1
    paths = np.full((seeds, count, len(COLUMNS)), np.nan)
    departure = np.zeros(seeds, dtype=np.intp)
    for seed in range(seeds):
        noise = np.random.default_rng([seed, round(1e3 * wind)]).standard_normal(count)
        departure[seed] = _fly(
            *arguments,
            *balance,
            aerodynamics.table,
            aerodynamics.fixed,
            wind,
            GUST_INTENSITY * wind,
            noise,
            paths[seed],
        )
    return Flights(wind, paths, departure)


@compiled(nogil=True)
def _fly(
    thrust: Array, mass: Array, gain: Array, drag: Array, fixed: Array, center: Array, inertia: Array, table: Array,
    body: Array, wind: float, gusts: float, noise: Array, path: Array,
) -> int:  # fmt: skip
    """One flight to its apogee; fills ``path`` and returns the index of the rail's end (-1: not reached)."""
    y = np.array([0.0, fixed[5], 0.0, 0.0, fixed[4], 0.0])
    k1, k2, k3, k4 = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    seen = np.empty(4)
    rail, gust, departure = True, gusts * noise[0], -1
    for i in range(path.shape[0]):
        t = i * PITCH_STEP
        flow = wind + gust
        _rates(y, t, rail, flow, thrust, mass, gain, drag, fixed, center, inertia, table, body, k1, seen)
        path[i, 0], path[i, 1], path[i, 2] = t, y[1] - fixed[5], seen[0]
        path[i, 3], path[i, 4], path[i, 5] = seen[1], seen[2], y[4]
        _rates(y + 0.5 * PITCH_STEP * k1, t + 0.5 * PITCH_STEP, rail, flow, thrust, mass, gain, drag, fixed, center,
               inertia, table, body, k2, seen)  # fmt: skip
        _rates(y + 0.5 * PITCH_STEP * k2, t + 0.5 * PITCH_STEP, rail, flow, thrust, mass, gain, drag, fixed, center,
               inertia, table, body, k3, seen)  # fmt: skip
        _rates(y + PITCH_STEP * k3, t + PITCH_STEP, rail, flow, thrust, mass, gain, drag, fixed, center, inertia, table,
               body, k4, seen)  # fmt: skip
        y = y + PITCH_STEP / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
        if rail and np.hypot(y[0], y[1] - fixed[5]) >= fixed[6]:
            rail, departure = False, i + 1
        if y[3] < 0.0 and t > 1.0:
            break
        forgotten = np.exp(-max(np.hypot(y[2], y[3]), wind) * PITCH_STEP / GUST_LENGTH)
        gust = forgotten * gust + gusts * np.sqrt(1.0 - forgotten * forgotten) * noise[i]
    return departure


@compiled(nogil=True)
def _rates(
    y: Array, t: float, rail: bool, wind: float, thrust: Array, mass: Array, gain: Array, drag: Array, fixed: Array,
    center: Array, inertia: Array, table: Array, body: Array, dy: Array, seen: Array,
) -> None:  # fmt: skip
    """d/dt of place, altitude, their speeds, attitude and pitch rate; ``seen``: airspeed, margin, angle of attack."""
    pressure, rho, sound = air_of_day(y[1], fixed[5], fixed[9], fixed[10])
    force, m, cg, turn = _at(t, pressure, thrust, mass, gain, fixed, center, inertia)
    s, c = np.sin(y[4]), np.cos(y[4])
    through, up = y[2] + wind, y[3]
    along, across = through * s + up * c, through * c - up * s
    speed = np.hypot(along, across)
    attack = np.arctan2(abs(across), along) if speed > 1e-6 else 0.0
    mach = speed / sound
    slope, place, first, second = _tabulated(table, mach)
    sine = np.sin(attack)
    lift = body[2] * sine * sine
    normal = slope * sine + lift
    ratio = lift / sine if sine > 1e-9 else 0.0
    cp = (slope * place + ratio * body[3]) / (slope + ratio)
    q = 0.5 * rho * speed * speed * body[0]
    side = -np.sign(across) * q * normal
    push = force - drag_coefficient(mach, drag) * fixed[3] * 0.5 * rho * speed * along
    pull = STANDARD_GRAVITY * (EARTH_RADIUS / (EARTH_RADIUS + y[1])) ** 2
    ahead, sideways = push / m - pull * c, side / m + pull * s
    if rail:
        standing = ahead <= 0.0 and np.hypot(y[2], y[3]) <= 0.0
        ahead, sideways = 0.0 if standing else ahead, 0.0
    dy[0], dy[1] = y[2], y[3]
    dy[2], dy[3] = ahead * s + sideways * c, ahead * c - sideways * s
    damping = 0.5 * rho * speed * body[0] * (second - 2.0 * cg * first + cg * cg * slope)
    dy[4] = 0.0 if rail else y[5]
    # a force to the right behind the center of gravity turns the nose to the left
    dy[5] = 0.0 if rail else (-side * (cp - cg) - damping * y[5]) / turn
    seen[0], seen[1], seen[2], seen[3] = speed, (cp - cg) / body[1], attack, cp


@compiled(nogil=True, inline="always")
def _at(
    t: float, pressure: float, thrust: Array, mass: Array, gain: Array, fixed: Array, center: Array, inertia: Array
) -> tuple[float, float, float, float]:
    """Thrust [N] at the ambient pressure, mass [kg], center of gravity [m] and pitch inertia [kg m^2]."""
    last = thrust.size - 1
    x = t / fixed[0]
    if x >= last:
        return 0.0, fixed[2], center[last], inertia[last]
    i = int(x)
    x -= i
    force = thrust[i] + x * (thrust[i + 1] - thrust[i])
    columns = gain.shape[1]
    if columns > 1:
        k = min(max((pressure - fixed[7]) / fixed[8], 0.0), columns - 1.0)
        j = min(int(k), columns - 2)
        force += gain[i, j] + (k - j) * (gain[i, j + 1] - gain[i, j])
    return (
        force,
        mass[i] + x * (mass[i + 1] - mass[i]),
        center[i] + x * (center[i + 1] - center[i]),
        inertia[i] + x * (inertia[i + 1] - inertia[i]),
    )


@compiled(nogil=True, inline="always")
def _tabulated(table: Array, mach: float) -> tuple[float, float, float, float]:
    x = min(mach / MACH_STEP, MACHS - 1.001)
    i = int(x)
    x -= i
    return (
        table[0, i] + x * (table[0, i + 1] - table[0, i]),
        table[1, i] + x * (table[1, i + 1] - table[1, i]),
        table[2, i] + x * (table[2, i + 1] - table[2, i]),
        table[3, i] + x * (table[3, i + 1] - table[3, i]),
    )
