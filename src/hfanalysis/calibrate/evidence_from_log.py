"""A test's evidence on its fuel's regression, from its log: what is compared, and how sure it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import Regression, engine_of_test, exponent, starting_for
from hfanalysis.calibrate.evidence import NO_PORTS, NUISANCES, Evidence, Ports, Scalar
from hfanalysis.calibrate.head_pressure import before_nozzle_of
from hfanalysis.calibrate.measured_pressures import quiet_noises
from hfanalysis.calibrate.uncertainty import Draws
from hfanalysis.engine.effect import Active
from hfanalysis.engine.unsteady import Engine, burn
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import fuel_of
from hfanalysis.record.signals import Signal, line_at

BLOCKS = 120
"""Block means of the chamber pressure that are compared; they are no shorter than FINEST_CHAMBER_BLOCK."""

FINEST_CHAMBER_BLOCK = 0.02
"""Shortest block mean of the chamber pressure [s]."""

PORTS, LEAST_PORTS = 20, 3
"""Means of a measured port radius that are compared, and fewest of them. Source: by choice: a law has two constants."""

FAR, QUICK = 3.0, 2.0
"""Standard deviations of its sensor by which a port may be off the grain's, and times the mean rate by which it may
have grown when it is first seen [-]. Source: by choice: a diameter or a web in the place of a radius is farther off."""

BESIDE_END = 0.15
"""Seconds left out on either side of the end of the liquid, which model and log do not have at the same instant."""

SLIVER = 0.02
"""Part of the grain below which what is left of it counts as nothing: the fire went out for want of fuel."""


def evidence_of(
    log: TestLog, segments: Segments, definition: TestDefinition, calibration: TankConstants, draws: Draws,
    effects: Sequence[Active] = (),
) -> Evidence:  # fmt: skip
    """What a test says about a and n, ``effects`` acting.

    Raises AbsentError where the test does not state its engine, where C_i cannot be had, or where the chamber pressure
    is missing or too short.
    """
    t_v = segments.time("t_v")
    if t_v is None:
        raise AbsentError(f"no end of the liquid to fit with: {segments.events['t_v'].reason}")
    log, origin = before_nozzle_of(log, definition), segments.t_open.value or 0.0
    tank, chamber = (Signal.of(log[name]).shifted(origin) for name in ("p_tank", "p_chamber"))
    start = segments.time("t_feed") or min(0.1, 0.1 * t_v)
    pressure = line_at(tank, start)
    engine = engine_of_test(definition, calibration, _saturated(definition, pressure), Regression(1e-3, 0.0), effects)
    burn_time, fuel_left, end = _seen(segments, definition, t_v)
    web = engine.outer_radius - engine.port_radius
    first = starting_for(replace(engine, a=web / end), start, pressure)
    stop, why = _window_end(segments, calibration, t_v, end, _has_nitrogen(engine.effects))
    burnt = burn(first, longest=end)
    width = max((stop - start) / BLOCKS, FINEST_CHAMBER_BLOCK)
    part = _compared(chamber, start, stop, (t_v, burnt.liquid_out or t_v), width)
    if part.time.size < 8:
        raise AbsentError("too few good samples of p_chamber after t_feed")
    late = abs(t_v - burnt.liquid_out) if burnt.liquid_out is not None else 0.0
    if burn_time is not None:
        burn_time = replace(burn_time, std=float(np.hypot(burn_time.std, late)))
    ports, sensor, odd = _ports(log, origin, engine, start, end)
    remarks = (
        f"p_chamber from {start:.2f} to {part.time[-1]:.2f} s ({why})",
        *burning_of(segments, definition)[1],
        *([f"port_radius, {ports.time.size} means to {ports.time[-1]:.2f} s"] if ports.time.size else odd),
        *_remarks(definition, calibration, engine.effects),
    )
    covariance = covariance_of(draws, calibration, (*_stated_variances(definition), sensor**2))
    return Evidence(
        definition.test.id, first, part.time, part.value, burn_time, fuel_left, end, (start, pressure), covariance,
        chamber.noise / np.sqrt(max(width / chamber.step, 1.0)), _wander(log, segments, part.time), remarks,
        ports,
    )  # fmt: skip


def _ports(
    log: TestLog, origin: float, engine: Engine, start: float, end: float
) -> tuple[Ports, float, tuple[str, ...]]:
    """Block means of the port's radius while the fuel burns, one standard deviation of its sensor's bias [m], and why
    they are none of this grain, where they are not."""
    channel = log.get("port_radius")
    if channel is None:
        return NO_PORTS, 0.0, ()
    seen = Signal.of(channel).shifted(origin).between(start, end - BESIDE_END)
    width = max((end - start) / PORTS, seen.step)
    means = seen.reduced(width)
    if means.time.size < LEAST_PORTS:
        return NO_PORTS, 0.0, ("port_radius has too few good samples in the burn",)
    first, last = (float(means.value[i]) for i in (0, -1))
    off, web = FAR * channel.accuracy, engine.outer_radius - engine.port_radius
    most = engine.port_radius + off + QUICK * web * float(means.time[0]) / end
    if not (engine.port_radius - off <= first <= most and last <= engine.outer_radius + off):
        told = f"port_radius goes from {1e3 * first:.1f} to {1e3 * last:.1f} mm, and is not used: the grain's port has "
        return NO_PORTS, 0.0, (f"{told}{1e3 * engine.port_radius:.1f} to {1e3 * engine.outer_radius:.1f} mm",)
    std = max(seen.noise / np.sqrt(max(width / seen.step, 1.0)), 0.1 * channel.accuracy)
    return Ports(means.time, means.value, float(std)), channel.accuracy, ()


def _wander(log: TestLog, segments: Segments, time: Array) -> Array:
    """Covariance by the wander of the chamber's sensor, as all pressure sensors show it before the opening."""
    noise = quiet_noises(log, segments)["p_chamber"]
    return replace(noise, white=0.0).covariance(time)


def _saturated(definition: TestDefinition, pressure: float) -> float:
    from hfanalysis.thermo.nitrous import saturation

    source = saturation(definition.model.properties)
    return float(source.temperature(min(pressure, 0.999 * source.pressure_range[1])))


def _compared(chamber: Signal, start: float, stop: float, gone: tuple[float, float], width: float) -> Signal:
    """Block means of the chamber pressure, without the stretch in which only model or log has liquid left."""
    low, high = min(gone) - BESIDE_END, max(gone) + BESIDE_END
    parts = [chamber.between(start, min(low, stop)).reduced(width), chamber.between(high, stop).reduced(width)]
    time, value = (np.concatenate([getattr(p, name) for p in parts]) for name in ("time", "value"))
    return replace(chamber, time=time, value=value)


def _seen(segments: Segments, definition: TestDefinition, t_v: float) -> tuple[Scalar | None, Scalar | None, float]:
    """Burn time and fuel left, as far as they are known, and the end of the fire [s]."""
    stated, observed = burning_of(segments, definition)[0], definition.observed
    end = stated.value if stated is not None else segments.time("t_end") or 2.0 * t_v
    left = observed.fuel_mass_after if observed is not None else None
    assert definition.grain is not None
    assert definition.grain.mass is not None
    grain = definition.grain.mass.value
    if left is None or left.value < SLIVER * grain:
        return stated, None, end
    std = definition.known_std("observed.fuel_mass_after")
    return None, Scalar(left.value, std, "[observed] fuel_mass_after"), end


def burning_of(segments: Segments, definition: TestDefinition) -> tuple[Scalar | None, tuple[str, ...]]:
    """When the fuel is gone [s]; None with a remark where nobody saw it: t_end is no end of the fire."""
    seen = definition.known("observed.burn_time")
    if seen is not None:
        return Scalar(seen.value, seen.std or 0.0, "[observed] burn_time"), ()
    gone = segments.time("t_fuel_gone")
    if gone is not None:
        return Scalar(gone, max(segments.std("t_fuel_gone"), 0.01), "t_fuel_gone of the log"), ()
    low = segments.time("t_end")
    if low is None:
        return None, ()
    return None, (f"compared until t_end, {low:.2f} s, which is no end of the fire: it may burn on, and fuel be left",)


def _window_end(
    segments: Segments, calibration: TankConstants, t_v: float, end: float, nitrogen: bool
) -> tuple[float, str]:
    """Until when the chamber pressure is one that the model can have, and why."""
    t_purge, t_fuel_out = segments.time("t_purge"), segments.time("t_fuel_out")
    ends = [(end - BESIDE_END, "the end of the burn")]
    if t_purge is not None:
        # with an adopted purge too: what is known of the gas in the chamber rests on its nitrogen from there on
        ends.append((t_purge, "then nitrogen enters" + ("" if nitrogen else ", which the model does not have")))
    if t_fuel_out is not None:
        ends.append((t_fuel_out - BESIDE_END, "then the fuel runs out"))
    if calibration.m.value is None:
        ends.append((t_v, "the vapor's expansion is not calibrated"))
    return min(ends)


def _has_nitrogen(effects: Sequence[Active]) -> bool:
    return any("nitrogen_inflow" in active.effect.sites for active in effects)


def _remarks(definition: TestDefinition, calibration: TankConstants, effects: Sequence[Active]) -> list[str]:
    m, std = exponent(calibration)
    known = "as calibrated" if calibration.m.value is not None else f"assumed, +/- {std:.2f}"
    beyond = (
        f"no effect beyond the model's: adiabatic equilibrium combustion ({definition.model.conventions} conventions), "
    )
    if effects:
        names = ", ".join(active.effect.name for active in effects)
        beyond = f"adopted effects: {names}; else equilibrium combustion ({definition.model.conventions} conventions), "
    nitrogen = "" if _has_nitrogen(effects) else ", without nitrogen"
    return [
        f"oxidizer flow of the calibrated tank alone{nitrogen}, from the pressure that its liquid phase "
        f"extrapolates to; feed loss K_loss mdot^2 / rho; vapor exponent {m:.3f} ({known})",
        beyond + f"constant throat, even regression of {fuel_of(definition.fuel).name}",
    ]


def covariance_of(draws: Draws, calibration: TankConstants, apart: tuple[float, float, float]) -> Array:
    """Of NUISANCES [SI], from the repeated calibrations; ``apart``: variances of grain mass [kg^2], throat [m^4] and
    the port's sensor [m^2].

    Raises AbsentError where too few of the repetitions have an answer.
    """
    v, i = draws.values, draws.inputs
    m, m_std = exponent(calibration)
    drawn_m = v["m"] if calibration.m.value is not None else m + m_std * _standard(v["m"].size)
    columns = (i["mass"], v["C_i"] * i["area"], v["K_loss"], drawn_m, i["volume"], i["p_tank"], i["p_chamber"])
    table = np.column_stack(columns)
    good = np.isfinite(table).all(axis=1)
    if good.sum() < 20:
        raise AbsentError("the repetitions of the calibration do not give the errors of what a and n rest on")
    out = np.zeros((len(NUISANCES), len(NUISANCES)))
    out[: len(columns), : len(columns)] = np.cov(table[good], rowvar=False)
    return out + np.diag([*[0.0] * len(columns), *apart])


def whole_covariance(draws: Draws, definition: TestDefinition, calibration: TankConstants) -> Array:
    """The same with all errors in, ``draws`` and what is stated without a deviation."""
    radius = definition.known("nozzle.throat_radius")
    assert radius is not None
    throat = 2.0 * pi * radius.value * (radius.std or 0.0)
    return covariance_of(draws, calibration, (definition.known_std("grain.mass") ** 2, throat**2, 0.0))


def _stated_variances(definition: TestDefinition) -> tuple[float, float]:
    """Of grain mass [kg^2] and throat area [m^4], as far as test.toml states deviations: these weigh the fit."""
    grain, nozzle = definition.grain, definition.nozzle
    assert grain is not None
    assert grain.mass is not None
    assert nozzle is not None
    assert nozzle.throat_radius is not None
    radius = nozzle.throat_radius
    return (grain.mass.std or 0.0) ** 2, (2.0 * pi * radius.value * (radius.std or 0.0)) ** 2


def _standard(size: int) -> Array:
    """Standard normal numbers, the same each time."""
    return np.random.default_rng(1).standard_normal(size)
