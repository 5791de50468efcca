"""RASP engine files (``.eng``), which flight simulators read: a header and thrust over time."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from hfanalysis.flight.motor import PLUGGED, RAMP, Motor, Points

__all__ = ["RAMP", "Motor", "constant_thrust", "of_points", "read", "text"]

_HEADER = 7
"""Fields of a header: name, diameter [mm], length [mm], delays, propellant [kg], total mass [kg], maker. Source: the
RASP format."""


def constant_thrust(thrust: float, burn_time: float) -> list[tuple[float, float]]:
    """Times [s] and thrust [N] of a constant ``thrust`` [N] over ``burn_time`` [s], its impulse kept exactly.

    The format starts at (0, 0) by itself; the thrust stands after the rise and falls after the burn time. Raises
    ValueError for a burn that is shorter than the rise.

    >>> constant_thrust(100.0, 2.0)
    [(0.001, 100.0), (2.0, 100.0), (2.001, 0.0)]
    """
    if not burn_time > RAMP:
        raise ValueError(f"a burn of {burn_time} s is too short for an engine file")
    return [(RAMP, thrust), (burn_time, thrust), (burn_time + RAMP, 0.0)]


def text(motor: Motor, points: Sequence[tuple[float, float]], comments: Sequence[str] = ()) -> str:
    """The engine file of ``points`` (time [s], thrust [N]).

    Raises ValueError for times that do not increase from above zero, or an end that is not zero.
    """
    times = [0.0, *(time for time, _ in points)]
    if len(points) < 2 or any(later <= earlier for earlier, later in pairwise(times)):
        raise ValueError("an engine file needs times that start above zero and increase")
    if points[-1][1] != 0.0 or min(thrust for _, thrust in points) < 0.0:
        raise ValueError("an engine file needs thrust that is never negative and ends at zero")
    header = (
        f"{motor.word} {1e3 * motor.diameter:.1f} {1e3 * motor.length:.1f} {PLUGGED} "
        f"{motor.propellant_mass:.4f} {motor.total_mass:.4f} {Motor(motor.maker, 0, 0, 0, 0).word}"
    )
    lines = [*(f"; {comment}".rstrip() for comment in comments), header]
    return "\n".join([*lines, *(f"   {time:.6f} {thrust:.4f}" for time, thrust in points), ";", ""])


def of_points(motor: Motor, points: Points, comments: Sequence[str] = ()) -> str:
    """The engine file of a curve; its start at (0, 0) goes without saying."""
    pairs = zip(points.time.tolist(), points.thrust.tolist(), strict=True)
    return text(motor, [(t, f) for t, f in pairs if t > 0.0], comments)


def read(content: str) -> tuple[Motor, Points, tuple[str, ...]]:
    """The first motor of a file: header, curve as it stands there, and the comments before it.

    Raises ValueError naming the line that cannot be read.
    """
    comments: list[str] = []
    motor: Motor | None = None
    pairs: list[tuple[float, float]] = []
    for number, line in enumerate(content.splitlines(), 1):
        stripped = line.strip()
        if stripped.startswith(";"):
            if motor is not None:
                break
            comments.append(stripped[1:].strip())
        elif stripped and motor is None:
            motor = _header(number, stripped)
        elif stripped and motor is not None:
            pairs.append(_point(number, stripped))
    if motor is None or not pairs:
        raise ValueError("the file holds no motor: expected a header line and points of time and thrust")
    time, thrust = np.array(pairs).T
    return motor, Points(time, thrust), tuple(comments)


def _header(number: int, line: str) -> Motor:
    cells = line.split()
    try:
        diameter, length, propellant, total = (float(cells[i]) for i in (1, 2, 4, 5))
    except (ValueError, IndexError):
        raise ValueError(f"line {number}: found {line!r}; expected a RASP header of {_HEADER} fields") from None
    return Motor(cells[0], 1e-3 * diameter, 1e-3 * length, propellant, total, " ".join(cells[6:]) or "unknown")


def _point(number: int, line: str) -> tuple[float, float]:
    cells = re.split(r"[\s,]+", line)
    try:
        return float(cells[0]), float(cells[1])
    except (ValueError, IndexError):
        raise ValueError(f"line {number}: found {line!r}; expected a time and a thrust") from None
