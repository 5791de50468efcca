"""The fuel that burnt in a window: what was loaded less what is left, what burnt before, and what may burn later."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.errors import AbsentError
from hfanalysis.performance.efficiency import smooth
from hfanalysis.performance.reconstruction.inputs import Firing
from hfanalysis.segment.end_of_burn import CRITICAL_RATIO

UNWEIGHED = 0.02
"""Standard deviation of the fuel that is left when the fire has gone out, as share of the grain [-], where nobody
weighed it. Source: slivers."""

LATER = 0.5
"""Part of the fuel that may burn after the window, beyond which it is a bound only and an efficiency is assumed.
Source: by choice: it would tell no efficiency."""

COLDEST, RICHEST = 1100.0, 1.0
"""c* [m/s] and OF [-] that bound the fuel that passes later. Source: equilibrium of nitrous oxide and paraffin."""

SHORTLY = 0.2
"""[s] after a window's end that are no later burning."""


@dataclass(frozen=True)
class Burnt:
    """``mass`` in the window with its standard deviation [kg], None where nobody says; ``total`` of the burn, as far as
    is known [kg]; what that rests on; ``closes``: whether it tells an efficiency."""

    mass: tuple[float, float] | None
    total: float
    said: str
    closes: bool = False


def fuel_burnt(firing: Firing, start: float, end: float) -> Burnt:
    """From ``start`` to ``end`` [s]. Raises AbsentError where none burnt."""
    grain = firing.definition.known("grain.mass")
    if grain is None:
        return Burnt(None, 0.5 * firing.shape.fuel_mass, "the grain's mass is not stated")
    left = firing.definition.known("observed.fuel_mass_after")
    watched = firing.definition.known("observed.burn_time") is not None
    if left is None and firing.segments.time("t_fuel_gone") is None and not watched:
        said = "nobody weighed the fuel afterwards, and it is not seen to run out"
        return Burnt(None, 0.5 * grain.value, said)
    total = grain.value - (left.value if left is not None else 0.0)
    if total <= 0.0:
        raise AbsentError(f"{left.value if left else 0:.3g} kg of fuel are left of {grain.value:.3g} kg: none burnt")
    weighed = (left.std or 0.0) if left is not None else UNWEIGHED * grain.value
    most = _later(firing, end, total)
    first = 0.5 * total * start / max(firing.fire.end, start)
    width = 1.0 / np.sqrt(12.0)
    std = float(np.linalg.norm([grain.std or 0.0, weighed, 2.0 * width * first, width * most]))
    mass = total - first - 0.5 * most, std
    if most > LATER * total:
        said = f"up to {most:.2g} of the {total:.3g} kg of fuel may have burnt after {end:.1f} s, when the window ends"
        return Burnt(mass, total, said)
    said = "one c* efficiency through the window, closed by the fuel burnt"
    if most > 0.0:
        said += f"; up to {most:.2g} kg of fuel may have burnt after {end:.1f} s"
    return Burnt(mass, total, said, True)


def _later(firing: Firing, end: float, total: float) -> float:
    """Fuel that burnt after the window at most [kg]: no more than the nozzle passed.

    Below the critical ratio the flow falls by an ellipse (Stodola's law).
    """
    after = (firing.time > end + SHORTLY) & (firing.time < firing.fire.end)
    if not after.any():
        return 0.0
    pressure = np.maximum(smooth(firing.measured["p_chamber"])[after], firing.ambient)
    slower = (CRITICAL_RATIO * firing.ambient / pressure - 1.0) / (CRITICAL_RATIO - 1.0)
    flowing = pressure * np.sqrt(1.0 - np.clip(slower, 0.0, 1.0) ** 2)
    passed = float(np.trapezoid(flowing, firing.time[after])) * firing.shape.throat_area / COLDEST
    return min(passed / (1.0 + RICHEST), total)
