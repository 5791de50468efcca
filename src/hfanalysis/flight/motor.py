"""A motor as engine files state it, and the rules that flight simulators expect such files to keep."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.sentences import rounded

RAMP = 1e-3
"""Time [s] in which a thrust that is there from the start rises, and one that is there to the end falls."""

RESOLUTION = 6e-4
"""Least time between two points of an engine file [s]. Source: thrustcurve.org refuses a RASP file whose first point
or step is below half a millisecond."""

PLUGGED = "P"
"""The delay of a motor that fires no charge. Source: RASP; OpenRocket reads it so in either format, where a number
would be the seconds from burn-out to the charge."""

MOST_POINTS = 200
"""Points to which a curve is thinned first; more where the impulse asks for them."""

IMPULSE_TOLERANCE = 5e-4
"""Relative impulse that thinning may lose before it is put back [-]. Evidence: a tenth of it takes more points and
changes nothing else."""


OUT = 0.05
"""Part of the largest thrust below which a motor is burnt out. Source: NFPA 1125, burn time of its thrust curve."""

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
LEAST_OF_B = 2.5
"""Largest total impulse of class A [N s]; each class has twice that of the one before. Source: NFPA 1125."""


@dataclass(frozen=True)
class Motor:
    """Header of an engine file: name, diameter and length [m], propellant and total mass [kg], maker."""

    name: str
    diameter: float
    length: float
    propellant_mass: float
    total_mass: float
    maker: str = "hfanalysis"

    @property
    def word(self) -> str:
        """The name without blanks, which separate the fields of a RASP header."""
        return word(self.name)


@dataclass(frozen=True)
class Points:
    """A thrust curve: times [s] and thrust [N]; mass of propellant left [kg] and the motor's center of gravity [m from
    its front] where they are known."""

    time: Array
    thrust: Array
    mass: Array | None = None
    center: Array | None = None

    @property
    def impulse(self) -> float:
        """[N s], thrust linear between the points and, before the first, from zero at t = 0."""
        time, thrust = np.concatenate(([0.0], self.time)), np.concatenate(([0.0], self.thrust))
        return float(np.trapezoid(thrust, time))

    def by_share(self, share: float) -> tuple[float, float]:
        """Time [s] from the first to the last thrust of a ``share`` of the peak, and the mean thrust [N] over it."""
        level = share * float(self.thrust.max())
        above = np.flatnonzero(self.thrust >= level)
        edges = [float(self.time[above[0]]), float(self.time[above[-1]])]
        for i, (inside, outside) in enumerate(((above[0], above[0] - 1), (above[-1], above[-1] + 1))):
            if 0 <= outside < self.time.size:  # where the line to the next point crosses the level
                part = (self.thrust[inside] - level) / (self.thrust[inside] - self.thrust[outside])
                edges[i] += float(part * (self.time[outside] - self.time[inside]))
        clock = np.unique(np.concatenate((edges, self.time[(self.time > edges[0]) & (self.time < edges[1])])))
        burn = edges[1] - edges[0]
        return burn, float(np.trapezoid(np.interp(clock, self.time, self.thrust), clock)) / burn


def word(name: str) -> str:
    """A name that is one word of printable characters."""
    return "-".join("".join(c if c.isprintable() else " " for c in name).replace(";", " ").split()) or "engine"


def as_written(points: Points) -> Points:
    """The curve to the digits that engine files carry: microseconds, 0.1 mN, milligrams, micrometers."""
    loads = (None if series is None else np.round(series, 6) for series in (points.mass, points.center))
    return Points(np.round(points.time, 6), np.round(points.thrust, 4), *loads)


def left_by_thrust(points: Points) -> Array:
    """Share of the propellant left at each point [-], (n,), used up as the impulse builds up."""
    gone = np.cumsum(0.5 * np.diff(points.time) * (points.thrust[1:] + points.thrust[:-1]))
    return np.clip(1.0 - np.concatenate(([0.0], gone)) / points.impulse, 0.0, 1.0)


def problems(points: Points) -> list[str]:
    """What would make a flight simulator stumble; empty for a curve that keeps the rules."""
    time, thrust = points.time, points.thrust
    if time.size < 2:
        return ["fewer than two points"]
    found = []
    if not (np.isfinite(time).all() and np.isfinite(thrust).all()):
        found.append("numbers that are not finite")
    if np.any(np.diff(time) <= 0.0) or time[0] < 0.0:
        found.append("times that do not increase from zero on")
    if time[0] == 0.0 and thrust[0] > 0.0:
        found.append(f"a thrust of {thrust[0]:g} N at t = 0")
    if thrust[-1] != 0.0:
        found.append(f"a last thrust of {thrust[-1]:g} N instead of zero")
    if np.any(thrust < 0.0):
        found.append("a negative thrust")
    if not np.any(thrust > 0.0):
        found.append("no thrust at all")
    if points.mass is not None and (not np.isfinite(points.mass).all() or np.any(points.mass < 0.0)):
        found.append("a negative mass")
    if points.mass is not None and np.any(np.diff(points.mass) > 0.0):
        found.append("a mass that grows")
    return found


def points_of(
    time: Array, thrust: Array, mass: Array | None = None, center: Array | None = None, most: int = MOST_POINTS
) -> Points:
    """A curve that keeps the rules from one sampled at increasing times [s], the first of which is ignition.

    ``thrust`` [N], ``mass`` of propellant [kg] and ``center`` of gravity [m], (n,) each. Negative thrust counts as
    none. Thinned to about ``most`` points, with the impulse [N s] kept. Raises ValueError for a curve without thrust.
    """
    t = np.asarray(time, dtype=np.float64) - time[0]
    force = np.maximum(np.asarray(thrust, dtype=np.float64), 0.0)
    impulse = float(np.trapezoid(force, t))
    if not impulse > 0.0:
        raise ValueError("a curve without thrust makes no engine file")
    kept = _thinned(t, force, impulse, most)
    clock, values = _with_ends(t[kept], force[kept])
    loads = [None if series is None else np.interp(clock, t, series) for series in (mass, center)]
    if loads[0] is not None:
        loads[0] = np.minimum.accumulate(np.maximum(loads[0], 0.0))
    scale = impulse / float(np.trapezoid(values, clock))
    return Points(clock, values * scale, loads[0], loads[1])


def _thinned(t: Array, force: Array, impulse: float, most: int) -> NDArray[np.intp]:
    """Points to keep, as few as hold the impulse on straight lines between them."""
    order = _by_weight(t, force)
    count = min(most, t.size)
    while True:
        kept = np.sort(order[:count])
        lost = abs(float(np.trapezoid(force[kept], t[kept])) / impulse - 1.0)
        if lost < IMPULSE_TOLERANCE or count == t.size:
            return kept
        count = min(2 * count, t.size)


def _by_weight(t: Array, force: Array) -> NDArray[np.intp]:
    """Points in the order of how far they lie off the line through those chosen before (Ramer, Douglas and Peucker)."""
    chosen, waiting = [0, t.size - 1], [_farthest(t, force, 0, t.size - 1)]
    while waiting:
        _, index, first, last = heapq.heappop(waiting)
        if index < 0:
            continue
        chosen.append(index)
        heapq.heappush(waiting, _farthest(t, force, first, index))
        heapq.heappush(waiting, _farthest(t, force, index, last))
    return np.array(chosen, dtype=np.intp)


def _farthest(t: Array, force: Array, first: int, last: int) -> tuple[float, int, int, int]:
    """How far, taken negative, the farthest point between two lies off their line, and which it is (-1: none is)."""
    if last - first < 2:
        return 1.0, -1, first, last
    inside = slice(first + 1, last)
    slope = (force[last] - force[first]) / (t[last] - t[first])
    off = np.abs(force[inside] - force[first] - slope * (t[inside] - t[first]))
    index = int(off.argmax())
    return -float(off[index]), first + 1 + index, first, last


def _with_ends(t: Array, force: Array) -> tuple[Array, Array]:
    """From zero at t = 0 to zero at the end, times apart by what the files resolve."""
    if force[-1] > 0.0:
        t, force = np.append(t, t[-1] + RAMP), np.append(force, 0.0)
    if force[0] > 0.0:
        late = t > 0.0
        rise = min(RAMP, 0.5 * float(t[late][0]))
        t, force = np.concatenate(([0.0, rise], t[late])), np.concatenate(([0.0, force[0]], force[late]))
    t = np.round(t, 6)
    kept = _apart(t)
    return t[kept], force[kept]


def _apart(t: Array) -> list[int]:
    """Points that are far enough apart for a file, the first and the last among them."""
    kept = [0]
    for i in range(1, t.size - 1):
        if min(t[i] - t[kept[-1]], t[-1] - t[i]) >= RESOLUTION:
            kept.append(i)
    return [*kept, t.size - 1]


def motor_class(impulse: float) -> str:
    """Letter of a total impulse [N s], with its upper limit.

    >>> motor_class(979.0)
    'J (640 to 1280 N s)'
    >>> motor_class(16135.0)
    'N (10240 to 20480 N s)'
    """
    number = max(int(np.ceil(np.log2(max(impulse, 1e-9) / LEAST_OF_B))), 0)
    if number >= len(LETTERS):
        return f"beyond Z ({LEAST_OF_B * 2.0 ** (len(LETTERS) - 1):.3g} N s)"
    high = LEAST_OF_B * 2.0**number
    return f"{LETTERS[number]} ({rounded(0.5 * high if number else 0.0, '.4g')} to {rounded(high, '.4g')} N s)"
