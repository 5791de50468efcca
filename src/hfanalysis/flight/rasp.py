"""RASP engine files (``.eng``), which flight simulators read: a header and thrust over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

RAMP = 1e-3
"""[s] in which a constant thrust rises and falls: the format knows no steps."""


@dataclass(frozen=True)
class Motor:
    """Header of an engine file: name, diameter and length [m], propellant and total mass [kg], maker."""

    name: str
    diameter: float
    length: float
    propellant_mass: float
    total_mass: float
    maker: str = "hfanalysis"


def constant_thrust(thrust: float, burn_time: float) -> list[tuple[float, float]]:
    """Times [s] and thrust [N] of a constant thrust over ``burn_time``, its impulse kept exactly.

    The format starts at (0, 0) by itself; the thrust stands after the rise and falls after the burn time.

    >>> constant_thrust(100.0, 2.0)
    [(0.001, 100.0), (2.0, 100.0), (2.001, 0.0)]
    """
    if not burn_time > RAMP:
        raise ValueError(f"a burn of {burn_time} s is too short for an engine file")
    return [(RAMP, thrust), (burn_time, thrust), (burn_time + RAMP, 0.0)]


def text(motor: Motor, points: Sequence[tuple[float, float]], comments: Sequence[str] = ()) -> str:
    """The engine file. Raises ValueError for times that do not increase from above zero, or an end that is not zero."""
    times = [0.0, *(time for time, _ in points)]
    if len(points) < 2 or any(later <= earlier for earlier, later in pairwise(times)):
        raise ValueError("an engine file needs times that start above zero and increase")
    if points[-1][1] != 0.0 or min(thrust for _, thrust in points) < 0.0:
        raise ValueError("an engine file needs thrust that is never negative and ends at zero")
    header = (
        f"{_word(motor.name)} {1e3 * motor.diameter:.1f} {1e3 * motor.length:.1f} P "
        f"{motor.propellant_mass:.4f} {motor.total_mass:.4f} {_word(motor.maker)}"
    )
    lines = [*(f"; {comment}" for comment in comments), header]
    return "\n".join([*lines, *(f"   {time:.6f} {thrust:.3f}" for time, thrust in points), ";", ""])


def _word(name: str) -> str:
    """The name without blanks, which separate the header's fields."""
    return "-".join(name.split()) or "engine"
