"""The throat's radius over time: as it was, evenly between two measured radii, or as thrust over pressure has it.

With a choked nozzle F / (p_c A_t) hardly knows the flow: thrust and pressure tell the throat's area but for the
nozzle's efficiency, which is taken as one number for the burn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import AbsentError
from hfanalysis.performance.efficiency import smooth, throat_spread
from hfanalysis.performance.load_cell import UNSEEN_DRIFT
from hfanalysis.performance.reconstruction.inputs import Error, Firing
from hfanalysis.performance.reconstruction.theory import Theory

EROSION = 1e-4
"""Scale of a throat's growth [m/s] that neither radii nor thrust tell, one standard deviation of a half normal one.
Source: graphite with nitrous oxide at 10 to 30 bar erodes by hundredths to two tenths of a millimeter a second."""

HALF_NORMAL = (0.798, 0.603)
"""Mean and standard deviation of the half normal distribution, over its scale. Source: sqrt(2 / pi), sqrt(1 - 2/pi)."""

NOZZLE_DRIFT = 0.01
"""Standard deviation [-] of what the nozzle's efficiency changes by through a burn. Source: an exit that erodes, and a
mixture that moves C_F by about as much."""

SLOW = 3
"""Order of the polynomial that is the throat's course by thrust. Source: erosion begins late and goes on."""

LEAST_COURSE = 0.003
"""Standard deviation [-] of that course of the area at the least. Source: C_F over the mixture."""

RICH = 8.0
"""OF [-] at which the thrust coefficient is taken. Source: it moves by 1 % from 5 to 9."""


@dataclass(frozen=True)
class Throat:
    """``radius`` (n,) [m], what it rests on, and its errors; ``by_thrust``: whether thrust tells its course; ``grows``:
    what tells the change, None where nothing does."""

    radius: Array
    said: str
    errors: Mapping[str, Error] = field(default_factory=dict)
    by_thrust: bool = False
    nozzle_efficiency: float | None = None
    grows: str | None = None


def throat_course(firing: Firing, theory: Theory, time: Array, pressure: Array) -> Throat:
    """At ``time`` [s], with the ``pressure`` before the nozzle [Pa], (n,) each.

    Raises AbsentError where the throat is said to have shrunk.
    """
    before = float(np.sqrt(firing.shape.throat_area / pi))
    after = firing.definition.known("observed.throat_radius_after")
    if after is not None:
        slack = 3.0 * float(np.hypot(after.std or 0.0, 0.5 * throat_spread(firing.definition) * before))
        if after.value < before - slack:
            raise AbsentError(
                f"the throat is {2e3 * after.value:.2f} mm wide after and {2e3 * before:.2f} mm before: it cannot "
                "shrink"
            )
    found = _by_thrust(firing, theory, time, pressure)
    share = (time - time[0]) / (time[-1] - time[0])
    if after is None:
        return _without_after(time, before, share, found)
    ends = np.interp(time[[0, -1]], [0.0, firing.fire.end], [before, after.value])
    even = np.interp(time, time[[0, -1]], ends)
    error = {"after": Error("throat", 2.0 * (after.std or 0.0) / after.value * share)}
    if found is None:
        return Throat(even, "the throat evenly between its measured radii", error, grows="both measured radii")
    area, std = found
    scale = np.interp(share, [0.0, 1.0], pi * ends**2 / area[[0, -1]])
    error["course"] = Error("throat", std * np.sin(np.pi * share))
    said = "the throat between its measured radii as thrust over pressure has it"
    efficiency = float(np.mean(area / (pi * even**2)))
    return Throat(np.sqrt(area * scale / pi), said, error, True, efficiency, "both measured radii, and thrust between")


def _without_after(time: Array, before: float, share: Array, found: tuple[Array, float] | None) -> Throat:
    """Nobody measured it afterwards."""
    if found is None:
        shape = 2.0 * EROSION * HALF_NORMAL[1] * (time - time[0]) / before
        said = f"the throat may have grown by {1e3 * EROSION:.1f} mm/s: nobody measured it afterwards"
        error = {"erosion": Error("throat", shape, HALF_NORMAL[0] / HALF_NORMAL[1])}
        return Throat(np.full(time.size, before), said, error)
    area, std = found
    radius = before * np.sqrt(area / area[0])
    drift = float(np.linalg.norm([NOZZLE_DRIFT, UNSEEN_DRIFT, std]))
    said = "the throat from its radius before on as thrust over pressure has it, with one efficiency of the nozzle"
    efficiency = float(area[0] / (pi * before**2))
    error = {"course": Error("throat", drift * share)}
    return Throat(radius, said, error, True, efficiency, "the radius before, and thrust over pressure since")


def _by_thrust(firing: Firing, theory: Theory, time: Array, pressure: Array) -> tuple[Array, float] | None:
    """Area [m^2] (n,) over the nozzle's efficiency, and its standard deviation [-]; None without a thrust to trust."""
    if "thrust_corrected" not in firing.measured or firing.log["thrust"].doubt > 0.0:
        return None
    thrust = np.interp(time, firing.time, smooth(firing.measured["thrust_corrected"]))
    force = thrust + firing.ambient * firing.shape.exit_area
    area = force / (theory.at(theory.vacuum, pressure, np.full(time.size, RICH)) * pressure)
    if not (np.isfinite(area) & (area > 0.0)).all():
        return None
    x = np.linspace(-1.0, 1.0, time.size)
    course = np.exp(np.polynomial.polynomial.polyval(x, np.polynomial.polynomial.polyfit(x, np.log(area), SLOW)))
    scatter = float(np.std(np.log(area / course)))
    return course, max(LEAST_COURSE, scatter * float(np.sqrt((SLOW + 1) / time.size)))
