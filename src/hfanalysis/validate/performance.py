"""The performance table of a hot fire (report, table 4.6), measured and modeled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.evidence_from_log import VIDEO
from hfanalysis.calibrate.loaded_mass import UNSTATED, load_cell_mass
from hfanalysis.engine.unsteady import Burn
from hfanalysis.flight.constant_thrust import STANDARD_GRAVITY
from hfanalysis.inference.full_run import FullRun, moved
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import STATED, UNPHYSICAL, Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.sentences import said, text
from hfanalysis.units import Value
from hfanalysis.validate.thrust import AT_AMBIENT, OUT, Thrust, burnt_out, thrust_of

NAMES = ("burn_time", "total_impulse", "specific_impulse", "peak_chamber_pressure", "peak_thrust", "average_thrust",
         "oxidizer_mass", "fuel_mass", "specific_impulse_to_purge", "specific_impulse_loaded")  # fmt: skip

SMOOTHING = 0.1
"""[s] of the running mean of which a peak is the largest value: longer than a period of the chamber's oscillation.
Evidence: test_performance_errors.py: one cycle of a rough chamber is no peak, an overshoot of 0.25 s is."""

SPAN = 0.25
"""Part of a cell's accuracy that a tare does not take away, and of its drift that a straight line may miss. Evidence:
test_performance_errors.py: a tare takes away three quarters of what a cell may be off by."""


LARGEST_SPECIFIC_IMPULSE = 320.0
"""[s] that nothing with nitrous oxide reaches. Source: characteristic velocity of 1700 m/s at most times a thrust
coefficient of 1.85, full expansion from 40 bar to a tenth of an atmosphere."""

BURNS_ON = "t_end: p_chamber below 1.8 times ambient for good; nobody saw the fire end, it may burn on"
"""What a burn time is that only the chamber's pressure sets."""

EARLY = 0.5
"""[s] before the burn's end at which a channel may end and still say what it was over the burn."""


@dataclass(frozen=True)
class Fire:
    """When the engine burns: from the opening to ``end`` [s], known to ``std``, as ``source`` says.

    ``latest`` [s]: until when it may burn on, where ``end`` is none of the fire's.
    """

    end: float
    std: float
    source: str
    latest: float | None = None


def fire_of(segments: Segments, definition: TestDefinition, log: TestLog | None = None) -> Fire | str:
    """The burn as seen on video, else until the fuel is gone, else until the chamber is down to 1.8 times ambient
    (after which it may burn on), else until the ``log``'s thrust is gone; or why there is none."""
    if segments.kind != "hot_fire" or segments.misfire:
        return "nothing burns in this test"
    seen = definition.observed.burn_time if definition.observed else None
    if seen is not None:
        return Fire(seen.value, seen.std if seen.std is not None else VIDEO, "[observed] burn_time")
    gone = segments.time("t_fuel_gone")
    if gone is not None:
        return Fire(gone, max(segments.std("t_fuel_gone"), 1e-3), "t_fuel_gone: the solid fuel is gone")
    low = segments.time("t_end")
    if low is not None:
        return Fire(low, max(segments.std("t_end"), 1e-3), BURNS_ON, _may_last(log, segments, definition, low))
    faded = burnt_out(thrust_of(log, segments, definition).signal) if log is not None and "thrust" in log else None
    if faded is not None:
        return Fire(*faded, f"until the thrust is below {100.0 * OUT:.0f} % of its largest for good")
    return text("the end of the burn is not known: {reason}", reason=segments.t_end.reason)


def _may_last(log: TestLog | None, segments: Segments, definition: TestDefinition, end: float) -> float:
    """Until when [s] there is pressure in the chamber that may be a fire's, from ``end`` on: at most the log's end."""
    signal = _signal(log, segments, "p_chamber") if log is not None else ""
    if log is None or isinstance(signal, str):
        return end
    later = signal.between(end, np.inf)
    limit = (1.0 + AT_AMBIENT) * definition.ambient_pressure.value + bias(log["p_chamber"])
    above: Any = np.flatnonzero(later.smooth(max(SMOOTHING, 3.0 * signal.step)) > limit) if later.time.size > 8 else []
    return float(later.time[above[-1]]) if len(above) else end


def measured(
    log: TestLog, segments: Segments, definition: TestDefinition, calibration: Calibration | None
) -> dict[str, Quantity]:
    """The measured column [s, N s, Pa, N, kg], and ``total_impulse_of_file`` [N s]: the raw integral over the whole
    file.
    """
    fire = fire_of(segments, definition, log)
    if isinstance(fire, str):
        none = {name: Quantity.absent(fire) for name in NAMES}
        return none | {"oxidizer_mass": _oxidizer(log, segments, definition, calibration)}
    out = {"burn_time": Quantity(fire.end, "s", fire.std, why=fire.source).reaching(fire.latest or fire.end)}
    thrust = thrust_of(log, segments, definition) if "thrust" in log else None
    impulse, later = impulse_to(log, thrust, fire), None
    if fire.latest is not None and fire.latest > fire.end:
        later = impulse_to(log, thrust, replace(fire, end=fire.latest)).value
    out["total_impulse"] = impulse = impulse if later is None else impulse.reaching(later)
    oxidizer, fuel = _oxidizer(log, segments, definition, calibration), _fuel(definition)
    out["specific_impulse"] = _expended(segments, fire, impulse, oxidizer, fuel)
    out["specific_impulse_to_purge"] = Quantity.absent("what was expended is not known without a calibrated tank")
    out["specific_impulse_loaded"] = specific_impulse(impulse, *loaded(log, segments, definition, calibration))
    out["largest_chamber_pressure"] = _largest(log, "p_chamber", _signal(log, segments, "p_chamber"), fire)
    out["peak_chamber_pressure"] = _peak(log, "p_chamber", _signal(log, segments, "p_chamber"), fire)
    out["peak_thrust"] = _peak(log, "thrust", thrust.signal if thrust else log.lacks("thrust"), fire)
    average = _average(impulse, out["burn_time"])
    out["average_thrust"] = average if later is None else average.reaching(later / (fire.latest or fire.end))
    out |= {"oxidizer_mass": oxidizer, "fuel_mass": fuel}
    out["mean_chamber_pressure"] = _mean(log, segments, "p_chamber", fire)
    out["total_impulse_of_file"] = _raw_integral(log)
    return out


def _expended(segments: Segments, fire: Fire, impulse: Quantity, oxidizer: Quantity, fuel: Quantity) -> Quantity:
    """By what was loaded less what is left, as far as nothing else is known and no purge gas pushes."""
    purge = segments.time("t_purge")
    if purge is not None and purge < fire.end:
        return Quantity.absent(
            f"nitrogen enters at {purge:.2f} s, before the burn ends, and how much of it is not known without a "
            "calibrated tank"
        )
    return specific_impulse(impulse, oxidizer, fuel)


def _signal(log: TestLog, segments: Segments, name: str) -> Signal | str:
    channel = log.get(name)
    if channel is None:
        return log.lacks(name)
    signal = Signal.of(channel).shifted(segments.t_open.value or 0.0)
    return signal if signal.time.size > 8 else f"{name} has too few good samples"


def bias(channel: Channel) -> float:
    """Standard deviation of what a zero leaves [SI]."""
    if channel.zero_std is None:
        return channel.accuracy
    return float(np.hypot(channel.zero_std, SPAN * channel.accuracy))


def impulse_to(log: TestLog, thrust: Thrust | None, fire: Fire) -> Quantity:
    """Integral of the thrust over the burn, the cell's drift taken off."""
    if thrust is None:
        return Quantity.absent(log.lacks("thrust"))
    signal, channel = thrust.signal, log["thrust"]
    if signal.time.size < 9:
        return Quantity.absent("thrust has too few good samples")
    if signal.time[-1] < fire.end - EARLY:
        return Quantity.absent(_ends_early("thrust", signal, fire))
    edges = np.array([0.0, fire.end])
    whole, unseen = signal.bridged(), signal.holes(*edges)
    inner = whole.between(*edges)
    time = np.concatenate((edges[:1], inner.time, edges[1:]))
    value = float(np.trapezoid(whole.at(time), time))
    near = signal.mean(fire.end - 0.2, fire.end + 0.2)
    last = abs(near if np.isfinite(near) else float(whole.at(edges[1:])[0]))
    bridged = [_across(whole, max(start, 0.0), min(end, fire.end)) for start, end in unseen]
    errors = (bias(channel) * fire.end, SPAN * thrust.error * 0.5 * fire.end, last * fire.std, *bridged)
    drift = (
        text("; {error} of the cell's drift taken off", error=said(thrust.error, "N", ".0f")) if thrust.error else ""
    )
    lacking = sum(min(end, fire.end) - max(start, 0.0) for start, end in unseen)
    holes = f"; {lacking:.2f} s without samples bridged by straight lines" if lacking else ""
    why = text("over the burn{drift}{holes}", drift=drift, holes=holes)
    return Quantity(value, "N s", float(np.linalg.norm(errors)), why=why)


def _ends_early(name: str, signal: Signal, fire: Fire) -> str:
    """How it is said that a channel says nothing of the burn's last part."""
    return f"the good samples of {name} end at {signal.time[-1]:.1f} s, before the burn does ({fire.end:.1f} s)"


def _across(signal: Signal, start: float, end: float) -> float:
    """What an integral across a hole may be off by: the change may come at any instant of it."""
    first, last = signal.at(np.array([np.nextafter(start, end), np.nextafter(end, start)]))
    return float(abs(last - first) * (end - start) / np.sqrt(12.0))


def _raw_integral(log: TestLog) -> Quantity:
    """What a plain integral of the raw channel over the file gives."""
    channel = log.get("thrust")
    if channel is None:
        return Quantity.absent(log.lacks("thrust"))
    raw = channel.values if channel.raw is None else channel.raw
    good = channel.good & np.isfinite(raw)
    value = float(np.trapezoid(raw[good], channel.time[good]))
    return Quantity(value, "N s", why="the raw channel over the whole file: offset, drift and all")


def specific_impulse(impulse: Quantity, oxidizer: Quantity, fuel: Quantity) -> Quantity:
    """I_tot / (g (m_o + m_f)) [s] of the masses of the table."""
    for needed in (impulse, oxidizer, fuel):
        if needed.value is None:
            return Quantity.absent(str(needed.reason))
    assert impulse.value is not None
    assert oxidizer.value is not None
    assert fuel.value is not None
    mass = oxidizer.value + fuel.value
    value = impulse.value / (STANDARD_GRAVITY * mass)
    by_mass = value * np.hypot(oxidizer.std or 0.0, fuel.std or 0.0) / mass
    found = Quantity(value, "s", float(np.hypot((impulse.std or 0.0) / (STANDARD_GRAVITY * mass), by_mass)))
    if found.interval is None or found.interval[0] <= LARGEST_SPECIFIC_IMPULSE:
        return found
    why = f"more than any nitrous oxide hybrid has, {LARGEST_SPECIFIC_IMPULSE:.0f} s: thrust, its unit or a mass is off"
    return replace(found, verdict=UNPHYSICAL, why=why)


def _peak(log: TestLog, name: str, signal: Signal | str, fire: Fire) -> Quantity:
    """Largest value of the mean curve: flagged samples left out, the chamber's oscillation averaged."""
    if isinstance(signal, str):
        return Quantity.absent(signal)
    part = signal.between(0.0, fire.end)
    if part.time.size < 8:
        return Quantity.absent(f"{name} has too few good samples in the burn")
    smooth = part.smooth(max(SMOOTHING, 3.0 * part.step))
    inside = (part.time > 0.5 * SMOOTHING) & (part.time < fire.end - 0.5 * SMOOTHING)
    place = int(np.argmax(np.where(inside, smooth, -np.inf)))
    count = max(SMOOTHING / part.step, 1.0)
    error = np.hypot(bias(log[name]), part.noise / np.sqrt(count))
    return Quantity(
        float(smooth[place]), log[name].unit, float(error), why=f"of the mean curve, at {part.time[place]:.2f} s"
    )


def _largest(log: TestLog, name: str, signal: Signal | str, fire: Fire) -> Quantity:
    """Largest good sample: what the structure has seen, the chamber's oscillation and the sensor's noise in it."""
    if isinstance(signal, str):
        return Quantity.absent(signal)
    part = signal.between(0.0, fire.end)
    if part.time.size < 8:
        return Quantity.absent(f"{name} has too few good samples in the burn")
    place = int(np.argmax(part.value))
    error = float(np.hypot(bias(log[name]), part.noise))
    return Quantity(
        float(part.value[place]), log[name].unit, error, why=f"a single sample, at {part.time[place]:.2f} s"
    )


def _mean(log: TestLog, segments: Segments, name: str, fire: Fire) -> Quantity:
    signal = _signal(log, segments, name)
    if isinstance(signal, str):
        return Quantity.absent(signal)
    inner = signal.between(0.0, fire.end)
    if inner.time.size < 8:
        return Quantity.absent(f"{name} has too few good samples in the burn")
    if signal.time[-1] < fire.end - EARLY:
        return Quantity.absent(_ends_early(name, signal, fire))
    mean = float(np.trapezoid(inner.value, inner.time) / np.ptp(inner.time))
    return Quantity(mean, log[name].unit, bias(log[name]))


def _average(impulse: Quantity, burn_time: Quantity) -> Quantity:
    """Total impulse over burn time."""
    if impulse.value is None or burn_time.value is None:
        return Quantity.absent(str(impulse.reason or burn_time.reason))
    value = impulse.value / burn_time.value
    by_time = value * (burn_time.std or 0.0) / burn_time.value
    return Quantity(value, "N", float(np.hypot((impulse.std or 0.0) / burn_time.value, by_time)))


def _oxidizer(
    log: TestLog, segments: Segments, definition: TestDefinition, calibration: Calibration | None
) -> Quantity:
    """Loaded, less what is stated to be left."""
    after = definition.observed.oxidizer_mass_after if definition.observed else None
    stated = definition.tank.oxidizer_mass if definition.tank else None
    found = calibration.oxidizer_mass if calibration is not None else None
    if found is not None and found.value is not None:
        return _less(Value(found.value, found.std), after)
    if stated is not None:
        return _less(stated, after)
    cell = load_cell_mass(log, segments)
    if cell is None:
        return Quantity.absent("[tank] oxidizer_mass is not stated, and no cell says it")
    return _less(Value(*cell), after)


def _fuel(definition: TestDefinition) -> Quantity:
    grain = definition.grain.mass if definition.grain else None
    if grain is None:
        return Quantity.absent("test.toml does not state [grain] mass")
    return _less(grain, definition.observed.fuel_mass_after if definition.observed else None)


def loaded(
    log: TestLog, segments: Segments, definition: TestDefinition, calibration: Calibration | None
) -> tuple[Quantity, Quantity]:
    """Oxidizer and fuel as loaded [kg], whatever is left of them."""
    full = replace(definition, observed=None)
    return _oxidizer(log, segments, full, calibration), _fuel(full)


def _less(loaded: Value, after: Value | None) -> Quantity:
    std = loaded.std if loaded.std is not None else UNSTATED * loaded.value
    if after is None:
        return Quantity(loaded.value, "kg", std, why="loaded")
    left = after.std if after.std is not None else UNSTATED * loaded.value
    return Quantity(loaded.value - after.value, "kg", float(np.hypot(std, left)), why="loaded less left")


@dataclass(frozen=True)
class _Column:
    """The modeled numbers of one run, in the order of NAMES."""

    values: Array

    @classmethod
    def of(cls, full: FullRun, burnt: Burn, oxidizer: float, fuel: float, purge: float | None) -> _Column:
        impulse = float(burnt.state("impulse")[-1])
        peaks = [float(burnt.output(name).max()) for name in ("chamber_pressure", "thrust")]
        isp = impulse / (STANDARD_GRAVITY * (oxidizer + fuel))
        whole, to_purge = (_by_expended(full, burnt, end) for end in (np.inf, np.inf if purge is None else purge))
        table = [burnt.burn_time, impulse, whole, *peaks, impulse / burnt.burn_time, oxidizer, fuel, to_purge, isp]
        return cls(np.array(table))


def _by_expended(full: FullRun, burnt: Burn, end: float) -> float:
    """Impulse over the weight of all that left by injector and grain until ``end`` [s], or the burn's."""
    part = burnt.time <= max(end, float(burnt.time[1]))
    passed = float(np.trapezoid(burnt.output("oxidizer_flow")[part], burnt.time[part]))
    ports = burnt.state("port_radius")[part][[0, -1]]
    burned = full.engine.grain.fuel(ports[0]) - full.engine.grain.fuel(ports[1])
    return float(burnt.state("impulse")[part][-1] / (STANDARD_GRAVITY * (passed + burned)))


_UNITS = ("s", "N s", "s", "Pa", "N", "N", "kg", "kg", "s", "s")


def modeled(full: FullRun, calibration: Calibration, purge: float | None = None) -> dict[str, Quantity]:
    """The model's column [s, N s, Pa, N, kg], with what the calibrated constants' uncertainties make of it; ``purge``
    [s]: when nitrogen enters in the log."""
    engine = full.engine
    nominal = _Column.of(full, full.burnt, engine.oxidizer_mass, engine.fuel_mass, purge).values
    errors = np.zeros(len(NAMES))
    for change in _changes(full, calibration):
        oxidizer = change.get("oxidizer_mass", engine.oxidizer_mass)
        try:
            other = _Column.of(full, moved(full, change), oxidizer, engine.fuel_mass, purge).values
        except (ValueError, ArithmeticError):
            continue
        errors += (other - nominal) ** 2
    out = {
        n: Quantity(float(v), u, float(e)) for n, v, u, e in zip(NAMES, nominal, _UNITS, np.sqrt(errors), strict=True)
    }
    if not full.burnt.fuel_out:
        reason = f"the model's fuel is not gone after {full.burnt.burn_time:.0f} s"
        out |= {name: Quantity.absent(reason) for name in ("burn_time", "average_thrust")}
    return out


def _changes(full: FullRun, calibration: Calibration) -> list[dict[str, float]]:
    """One standard deviation of each calibrated constant; a and n along and across their combination."""
    engine, discharge, m = full.engine, calibration.C_i, calibration.m.std or 0.0
    rate, flux = calibration.regression_rate_reference, calibration.regression.reference_flux
    assert discharge.value is not None
    area = engine.feed.area * (1.0 + (discharge.std or 0.0) / discharge.value)
    changes = [{"area": area}, {"loss_factor": engine.feed.loss_factor + (calibration.K_loss.std or 0.0)}]
    changes.append({"oxidizer_mass": engine.oxidizer_mass + (calibration.load.std or 0.0)})
    if engine.polytropic_exponent is not None and m > 0.0:
        changes.append({"polytropic_exponent": engine.polytropic_exponent + m})
    n = engine.n + (calibration.n.std or 0.0)
    if STATED in (calibration.a.verdict, calibration.n.verdict) or not rate.value or flux is None or not flux.value:
        return [*changes, {"a": engine.a + (calibration.a.std or 0.0)}, {"n": n}]
    changes.append({"a": engine.a * (1.0 + (rate.std or 0.0) / rate.value)})
    return [*changes, {"n": n, "a": rate.value / flux.value**n}]
