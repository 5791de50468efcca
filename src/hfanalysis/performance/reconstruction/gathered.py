"""What of a test a reconstruction starts from: its window, the fuel burnt in it, and all errors; no regression law."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.chamber import chamber_volume
from hfanalysis.engine.grain import USUAL_N
from hfanalysis.errors import AbsentError
from hfanalysis.performance.closing import CHEMISTRY
from hfanalysis.performance.efficiency import EFFICIENCY_WIDTH, oxidizer_spread, smooth, throat_spread
from hfanalysis.performance.flows import HISTORY_STEP
from hfanalysis.performance.measured import bias
from hfanalysis.performance.reconstruction.fuel import fuel_burnt
from hfanalysis.performance.reconstruction.inputs import Error, Firing, Inputs
from hfanalysis.performance.reconstruction.theory import Theory
from hfanalysis.performance.reconstruction.throat import throat_course
from hfanalysis.performance.tap import before_nozzle, tap_of
from hfanalysis.record.signals import Signal
from hfanalysis.segment.end_of_burn import CRITICAL_RATIO

STEP = 0.1
"""[s] of the histories. Source: a port takes seconds to open."""

MOST = 60
"""Steps of a window at most: what a burn does in a hundredth of it, it does slowly."""

PLATEAU = 0.8
"""Part of the usual pressure from which on the chamber has risen."""

LEAST = 1.0
"""[s] of a window that is worth it."""

ASSUMED = (0.93, 0.05)
"""c* efficiency and its deviation [-] where nothing says it. Source: hybrids with mixing chambers reach 0.9 to 0.98,
plain ones 0.8 to 0.95 (Sutton and Biblarz, Rocket Propulsion Elements; Zilliac and Karabeyoglu, AIAA 2006-4504)."""

OPEN = 2.0
"""Times that deviation from which one starts where the fuel burnt says it. Source: by choice: wide, so that the fuel
does."""

DRIFT = 0.04
"""Standard deviation [-] of what the efficiency changes by through a window. Source: it goes with the mixing, which the
port's length over its radius sets, and that halves in a burn; measured ones move by some per cent."""

BREAKS = "t_v", "t_purge"
"""Events at which the flow breaks, and before which a window ends."""

NOMINAL = 7.0
"""OF [-] for what hardly hangs on it: the gas's R T and gamma. Source: stoichiometry is at 9, best c* at 7."""

UNIFORM = 1.0 / np.sqrt(12.0)
"""Standard deviation of what lies anywhere in a range, over its width. Source: the uniform distribution."""


@dataclass(frozen=True)
class Gathered:
    """``inputs`` of the window, its ``variant`` with what it assumes, the nozzle's efficiency [-]; ``grows``: whether
    the throat's course was told."""

    inputs: Inputs
    variant: str
    assumption: str
    nozzle_efficiency: float | None
    grows: str | None


def gather(firing: Firing, theory: Theory) -> Gathered:
    """From a test; raises AbsentError with the reason where it cannot be had."""
    channel = firing.log["p_chamber"]
    if channel.doubt > 0.0:
        raise AbsentError("p_chamber is in doubt: what rests on it alone would be, too")
    read = smooth(firing.measured["p_chamber"])
    start, end = _window(firing, read)
    time = np.linspace(start, end, int(np.clip((end - start) / STEP, 10, MOST)) + 1)
    gauge, oxidizer = (np.interp(time, firing.time, x) for x in (read, smooth(firing.oxidizer)))
    bad = np.flatnonzero(~(gauge > 0.0))
    if bad.size:
        raise AbsentError(f"p_chamber reads no pressure at {time[bad[0]]:.2f} s, within the burn")
    fuel = fuel_burnt(firing, start, end)
    port = _port(firing, time, fuel.total)
    factor, low = _tap(firing, theory, port, gauge)
    pressure = gauge * factor
    throat = throat_course(firing, theory, time, pressure)
    share, by_gauge = (time - start) / (end - start), bias(channel) / gauge / np.sqrt(2.0)
    errors = {
        "zero": Error("pressure", by_gauge),
        "gain": Error("pressure", np.full(time.size, float(by_gauge.mean()))),
        "flow": Error("oxidizer", np.full(time.size, oxidizer_spread(firing.calibration))),
        "throat": Error("throat", np.full(time.size, throat_spread(firing.definition))),
        "theory": Error("theory", np.full(time.size, CHEMISTRY)),
        "drift": Error("efficiency", DRIFT * (share - 0.5)),
        **({"tap": Error("pressure", np.log(low) * UNIFORM, 0.5 / UNIFORM)} if (low < 1.0).any() else {}),
        **throat.errors,
    }
    volume = chamber_volume(firing.shape.dead_volume, port, firing.shape.grain_length)
    stored = np.gradient(pressure * volume, time) / theory.at(theory.heat, pressure, np.full(time.size, NOMINAL))
    said = fuel.said
    if not fuel.closes:
        said = f"c* efficiency of {ASSUMED[0]:.2f} +/- {ASSUMED[1]:.2f} assumed: {said}"
    spread = ASSUMED[1] / ASSUMED[0] * (OPEN if fuel.closes else 1.0)
    inputs = Inputs(
        time, pressure, oxidizer, pi * throat.radius**2, stored, _noise(firing) / pressure, fuel.mass,
        (ASSUMED[0], spread), _usual(oxidizer, port), errors,
    )  # fmt: skip
    variant = "a" if not fuel.closes else ("d" if throat.by_thrust else "b")
    return Gathered(inputs, variant, f"{said}; {throat.said}", throat.nozzle_efficiency, throat.grows)


def _noise(firing: Firing) -> float:
    """Standard deviation [Pa] of a smoothed sample of the chamber's pressure; neighbors share half of their samples."""
    signal = Signal.of(firing.log["p_chamber"])
    return float(signal.noise / np.sqrt(max(0.5 * STEP / signal.step, 1.0)))


def _window(firing: Firing, read: Array) -> tuple[float, float]:
    """From the plateau on until the liquid is gone (the vapor's flow is a model's), nitrogen enters, or the fire or its
    fuel is out [s]."""
    ends = [t - EFFICIENCY_WIDTH for name in BREAKS if (t := firing.segments.time(name)) is not None]
    ends += [t for name in ("t_fuel_gone", "t_end") if (t := firing.segments.time(name)) is not None]
    end = min([*ends, firing.fire.end])
    first = max(firing.segments.time("t_feed") or 0.0, 0.2)
    burning = (read > CRITICAL_RATIO * firing.ambient) & (firing.oxidizer > 0.0)
    inside = (firing.time > first) & (firing.time < end) & burning
    if not inside.any():
        raise AbsentError("the chamber has no pressure to speak of in the liquid phase")
    risen = inside & (read > PLATEAU * np.median(read[inside]))
    start = float(firing.time[risen][0])
    last = float(firing.time[inside][-1])
    if last - start < LEAST:
        raise AbsentError(f"only {last - start:.1f} s lie between the plateau's begin and the end of liquid or fire")
    return start, last - HISTORY_STEP


def _port(firing: Firing, time: Array, burnt: float) -> Array:
    """Radius [m] about as it opens (n,): evenly with the fuel that burns."""
    shape = firing.shape
    passed = burnt * np.clip(time / firing.fire.end, 0.0, 1.0)
    return np.asarray(np.sqrt(shape.port_radius**2 + passed / (shape.fuel_density * pi * shape.grain_length)))


def _usual(oxidizer: Array, port: Array) -> Array:
    """Course of the logarithm of OF (n,), where r goes as G^n with the usual n."""
    flow, radius = (np.log(x / x[0]) for x in (oxidizer, port))
    return np.asarray((1.0 - USUAL_N[0]) * flow + (2.0 * USUAL_N[0] - 1.0) * radius)


def _tap(firing: Firing, theory: Theory, port: Array, gauge: Array) -> tuple[Array, Array]:
    """Pressure before the nozzle over the gauge's (n,), and that at the least over it: the gauge's place may not be
    stated."""
    gamma = theory.at(theory.gamma, gauge, np.full(gauge.size, NOMINAL))
    before = before_nozzle(tap_of(firing.definition), port, gamma, firing.shape)
    return before.factor, before.low / before.factor
