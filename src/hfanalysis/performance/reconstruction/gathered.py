"""What of a test a reconstruction starts from: its window, the fuel burnt in it, the throat, and all their errors."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import AbsentError
from hfanalysis.performance.efficiency import Ideal, smooth, throat_spread
from hfanalysis.performance.flows import HISTORY_STEP
from hfanalysis.performance.measured import bias
from hfanalysis.performance.reconstruction.inputs import Inputs
from hfanalysis.performance.reconstruction.theory import Theory
from hfanalysis.performance.reduction import Test
from hfanalysis.record.signals import Signal
from hfanalysis.units import Value

STEP = 0.1
"""[s] of the histories. Source: a port takes seconds to open."""

MOST = 80
"""Steps of a window at most: what a burn does in a hundredth of it, it does slowly."""

PLATEAU = 0.8
"""Part of the usual pressure from which on the chamber has risen."""

LEAST = 1.0
"""[s] of a window that is worth it."""

ASSUMED = (0.93, 0.05)
"""c* efficiency and its deviation [-] where nothing says it. Source: hybrids with mixing chambers reach 0.9 to 0.98,
plain ones 0.8 to 0.95 (Sutton and Biblarz, Rocket Propulsion Elements; Zilliac and Karabeyoglu, AIAA 2006-4504)."""

DRIFT = 0.04
"""Standard deviation [-] of what the efficiency changes by through a window. Source: it goes with the mixing, which the
port's length over its radius sets, and that halves in a burn; measured ones move by some per cent."""

EROSION = 2e-5
"""Standard deviation of a throat's growth [m/s] that nobody measured. Source: graphite with nitrous oxide at 10 to 30
bar, some hundredths of a millimeter a second; none where the throat is cold at first."""

UNWEIGHED = 0.02
"""Standard deviation of the fuel that is left when the fire has gone out, as share of the grain [-], where nobody
weighed it. Source: slivers."""

LATER = 0.5
"""Part of the fuel that may burn after the window at most; beyond it nothing closes. Source: by choice: the band would
hold half and double of everything."""

COLDEST, RICHEST = 1100.0, 1.0
"""c* [m/s] and OF [-] that bound the fuel that passes later. Source: equilibrium of nitrous oxide and paraffin."""

UNIFORM = 1.0 / np.sqrt(12.0)
"""Standard deviation of what lies anywhere in a range, over its width. Source: the uniform distribution."""


Moved = dict[str, dict[str, Array | float]]
"""As of :class:`~hfanalysis.performance.reconstruction.inputs.Inputs`."""


@dataclass(frozen=True)
class Gathered:
    """``inputs`` of the window, its ``variant`` with what it assumes, and the nozzle's efficiency [-]."""

    inputs: Inputs
    variant: str
    assumption: str
    nozzle_efficiency: float | None


def gather(test: Test, found: Ideal, theory: Theory) -> Gathered:
    """From a test; raises AbsentError with the reason where it cannot be had."""
    channel = test.log["p_chamber"]
    if channel.doubt > 0.0:
        raise AbsentError("p_chamber is in doubt: what rests on it alone would be, too")
    start, end = _window(test, found)
    time = np.linspace(start, end, int(np.clip((end - start) / STEP, 10, MOST)) + 1)
    pressure, oxidizer = (np.interp(time, test.flows.time, x) for x in (found.pressure, smooth(test.flows.oxidizer)))
    throat, nozzle = _throat(test, theory, time, pressure)
    read = np.interp(time, test.flows.time, test.measured["p_chamber"])
    shrink = throat_spread(test.definition)
    moved = {
        **_both("zero", "pressure", pressure, pressure * bias(channel) / read),
        **_both("flow", "oxidizer", oxidizer, oxidizer * _relative(test)),
        **_both("throat", "throat", pi * throat**2, pi * throat**2 * shrink),
        **_both("drift", "drift", np.zeros(time.size), DRIFT * np.linspace(-0.5, 0.5, time.size)),
        **_tap(found, test, time, pressure),
        **_unmeasured_throat(test, time, throat),
    }
    fuel, assumption, of_fuel = _fuel(test, start, end)
    if fuel is None:
        moved |= _both("efficiency", "drift", np.zeros(time.size), np.full(time.size, ASSUMED[1] / ASSUMED[0]))
        assumption = f"c* efficiency of {ASSUMED[0]:.2f} +/- {ASSUMED[1]:.2f} assumed: {assumption}"
    else:
        for name, by in of_fuel.items():
            moved |= _both(name, "fuel", fuel, by)
    noise = channel_noise(test) / np.maximum(pressure, 1.0)
    inputs = Inputs(time, pressure, oxidizer, pi * throat**2, fuel, noise, np.zeros(time.size), moved)
    variant = "a" if fuel is None else ("d" if nozzle is not None else "b")
    return Gathered(inputs, variant, assumption, nozzle)


def _both(name: str, of: str, value: Array | float, std: Array | float) -> Moved:
    """An error moved by two deviations either way."""
    return {f"{name}+": {of: value + 2.0 * std}, f"{name}-": {of: value - 2.0 * std}}


def channel_noise(test: Test) -> float:
    """Standard deviation [Pa] of a smoothed sample of the chamber's pressure."""
    signal = Signal.of(test.log["p_chamber"])
    return float(signal.noise / np.sqrt(max(0.2 / signal.step, 1.0)))


def _window(test: Test, found: Ideal) -> tuple[float, float]:
    """From the plateau on until nitrogen enters, the fuel is gone or the fire out [s]."""
    ends = [t for name in ("t_purge", "t_fuel_gone", "t_end") if (t := test.segments.time(name)) is not None]
    end = min([*ends, test.fire.end])
    first = max(test.segments.time("t_feed") or 0.0, 0.2)
    inside = (test.flows.time > first) & (test.flows.time < end) & found.burning
    if not inside.any():
        raise AbsentError("the chamber has no pressure to speak of before nitrogen enters")
    read = found.pressure
    risen = inside & (read > PLATEAU * np.median(read[inside]))
    start = float(test.flows.time[risen][0])
    last = float(test.flows.time[inside][-1])
    if last - start < LEAST:
        raise AbsentError(f"only {last - start:.1f} s lie between the plateau's begin and nitrogen or the fire's end")
    return start, last - HISTORY_STEP


def _relative(test: Test) -> float:
    flow = test.calibration.C_i
    return (flow.std or 0.0) / flow.value if flow.value else 0.0


def _tap(found: Ideal, test: Test, time: Array, pressure: Array) -> Moved:
    """Where the gauge's place is not stated: the pressure before the nozzle may be lower, to the end of its range."""
    low = np.interp(time, test.flows.time, found.before.low / found.before.factor)
    if (low >= 1.0).all():
        return {}
    return {"tap+": {"pressure": pressure}, "tap-": {"pressure": pressure * low}}


def _unmeasured_throat(test: Test, time: Array, throat: Array) -> Moved:
    after = _after(test)
    if after is not None:
        by = (after.std or 0.0) * (time - time[0]) / np.ptp(time)
        return _both("after", "throat", pi * throat**2, 2.0 * pi * throat * by)
    wider = pi * (throat + 2.0 * EROSION * (time - time[0])) ** 2
    return {"erosion+": {"throat": wider}, "erosion-": {"throat": pi * throat**2}}


def _after(test: Test) -> Value | None:
    return test.definition.known("observed.throat_radius_after")


def _throat(test: Test, theory: Theory, time: Array, pressure: Array) -> tuple[Array, float | None]:
    """Radius [m] over time (n,), and the nozzle's efficiency where thrust and both radii tell its course."""
    before = np.sqrt(test.engine.throat_area / pi)
    after = _after(test)
    if after is None:
        return np.full(time.size, before), None
    slack = 3.0 * float(np.hypot(after.std or 0.0, 0.5 * throat_spread(test.definition) * before))
    if after.value < before - slack:
        raise AbsentError(
            f"the throat is {2e3 * after.value:.2f} mm wide after and {2e3 * before:.2f} mm before: it cannot shrink"
        )
    even = np.interp(time, [0.0, test.fire.end], [before, after.value])
    if "thrust_corrected" not in test.measured or test.log["thrust"].doubt > 0.0:
        return even, None
    thrust = np.interp(time, test.flows.time, smooth(test.measured["thrust_corrected"]))
    force = thrust + test.ambient * test.engine.exit_area
    ideal = theory.at(theory.vacuum, pressure, np.full(time.size, 8.0)) * pressure
    area = force / ideal
    ends = pi * even[[0, -1]] ** 2
    count = max(int(0.3 / (time[1] - time[0])), 1)
    found = np.array([area[:count].mean(), area[-count:].mean()])
    scales = np.interp(time, time[[0, -1]], ends / found)
    return np.sqrt(area * scales / pi), float(np.mean(found / ends))


def _fuel(test: Test, start: float, end: float) -> tuple[float | None, str, dict[str, float]]:
    """Fuel burnt in the window [kg], what that rests on, and by how much its errors move it."""
    grain = test.definition.known("grain.mass")
    if grain is None:
        return None, "the grain's mass is not stated", {}
    left = test.definition.known("observed.fuel_mass_after")
    gone = test.segments.time("t_fuel_gone")
    watched = test.definition.known("observed.burn_time") is not None
    if left is None and gone is None and not watched:
        return None, "nobody weighed the fuel afterwards, and it is not seen to run out", {}
    total = grain.value - (left.value if left is not None else 0.0)
    if total <= 0.0:
        raise AbsentError(f"{left.value if left else 0:.3g} kg of fuel are left of {grain.value:.3g} kg: none burnt")
    weighed = (left.std or 0.0) if left is not None else UNWEIGHED * grain.value
    late, bound = _later(test, end, total)
    if bound > LATER * total:
        return (
            None,
            (
                f"up to {bound:.2g} kg of the {total:.3g} kg of fuel may have burnt after {end:.1f} s, when "
                "nitrogen entered"
            ),
            {},
        )
    first = 0.5 * total * start / max(test.fire.end, start)
    errors = {"fuel": float(np.hypot(grain.std or 0.0, weighed)), "ignition": 2.0 * UNIFORM * first}
    said = "one c* efficiency through the window, closed by the fuel burnt"
    if bound > 0.0:
        errors["later"] = UNIFORM * bound
        said += f"; up to {bound:.2g} kg of fuel may have burnt after {end:.1f} s"
    return total - first - late, said, errors


def _later(test: Test, end: float, total: float) -> tuple[float, float]:
    """Fuel that burnt after the window [kg], as taken and at most: no more than the nozzle passed."""
    after = (test.flows.time > end + 2.0 * STEP) & (test.flows.time < test.fire.end)
    if not after.any():
        return 0.0, 0.0
    over = np.maximum(test.measured["p_chamber"][after] - test.ambient, 0.0)
    passed = float(np.trapezoid(over, test.flows.time[after])) * test.engine.throat_area / COLDEST
    most = min(passed / (1.0 + RICHEST), total)
    return 0.5 * most, most
