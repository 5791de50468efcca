"""The performance table of a hot fire (report, table 4.6), as measured."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.loaded_mass import UNSTATED, load_cell_mass
from hfanalysis.flight.constant_thrust import STANDARD_GRAVITY
from hfanalysis.flight.motor import OUT
from hfanalysis.inference.budget import Input, total
from hfanalysis.performance.load_cell import UNSEEN_DRIFT, CellError, cell_error, drift_unseen
from hfanalysis.performance.stand import unknown_weight
from hfanalysis.performance.thrust import AT_AMBIENT, Thrust, burnt_out, thrust_of
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import UNPHYSICAL, Quantity
from hfanalysis.record.accuracy import left_by_zero
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.signals import Signal, sample_noise
from hfanalysis.sentences import said, text
from hfanalysis.units import Value

NAMES = ("burn_time", "total_impulse", "specific_impulse", "peak_chamber_pressure", "peak_thrust", "average_thrust",
         "oxidizer_mass", "fuel_mass", "specific_impulse_to_purge", "specific_impulse_loaded")  # fmt: skip

SMOOTHING = 0.1
"""[s] of the running mean of which a peak is the largest value: longer than a period of the chamber's oscillation.
Evidence: test_performance_errors.py: one cycle of a rough chamber is no peak, an overshoot of 0.25 s is."""

BURN_TIME, HOLES = "burn time", "between samples"
"""Rows of a budget."""

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
    seen = definition.known("observed.burn_time")
    if seen is not None:
        return Fire(seen.value, seen.std or 0.0, "[observed] burn_time")
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
    impulse, later = impulse_to(log, thrust, fire, definition), None
    if fire.latest is not None and fire.latest > fire.end:
        later = impulse_to(log, thrust, replace(fire, end=fire.latest), definition).value
    impulse = impulse if later is None else impulse.reaching(later)
    if impulse.value is not None and (weight := unknown_weight(definition)):
        # the fuel's weight goes over the burn, whichever way the nozzle points: half of it on average
        impulse = impulse.reaching(impulse.value - 0.5 * weight * fire.end, impulse.value + 0.5 * weight * fire.end)
    out["total_impulse"] = impulse
    oxidizer, fuel = _oxidizer(log, segments, definition, calibration), _fuel(definition)
    out["specific_impulse"] = _expended(segments, fire, impulse, oxidizer, fuel)
    out["specific_impulse_to_purge"] = Quantity.absent("what was expended is not known without a calibrated tank")
    out["specific_impulse_loaded"] = specific_impulse(impulse, *loaded(log, segments, definition, calibration))
    out["largest_chamber_pressure"] = _largest(log, "p_chamber", _signal(log, segments, "p_chamber"), fire)
    out["peak_chamber_pressure"] = _peak(log, "p_chamber", _signal(log, segments, "p_chamber"), fire)
    out["peak_thrust"] = _peak(
        log, "thrust", thrust.signal if thrust else log.lacks("thrust"), fire,
        cell_error_of(log, thrust, definition, fire.end) if thrust else None,
    )  # fmt: skip
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
    return left_by_zero(channel.accuracy, channel.zero_std)


def cell_error_of(log: TestLog, thrust: Thrust, definition: TestDefinition, end: float) -> CellError:
    """What the cell may be off by over a burn that ends at ``end`` [s]."""
    spec = definition.channels.get("thrust")
    calibrated = spec.calibrated if spec is not None else None
    return cell_error(log["thrust"], thrust, thrust.signal.between(0.0, end).value, calibrated, definition.test.date)


def impulse_to(log: TestLog, thrust: Thrust | None, fire: Fire, definition: TestDefinition) -> Quantity:
    """Integral of the thrust over the burn, the cell's drift taken off."""
    if thrust is None:
        return Quantity.absent(log.lacks("thrust"))
    signal = thrust.signal
    if signal.time.size < 9:
        return Quantity.absent("thrust has too few good samples")
    if signal.time[-1] < fire.end - EARLY:
        return Quantity.absent(_ends_early("thrust", signal, fire))
    edges = np.array([0.0, fire.end])
    whole, unseen = signal.bridged(), signal.holes(*edges)
    inner = whole.between(*edges)
    time = np.concatenate((edges[:1], inner.time, edges[1:]))
    value = float(np.trapezoid(whole.at(time), time))
    inputs = impulse_inputs(log, thrust, fire, definition, value)
    drift = _of_drift(thrust)
    lacking = sum(min(end, fire.end) - max(start, 0.0) for start, end in unseen)
    holes = f"; {lacking:.2f} s without samples bridged by straight lines" if lacking else ""
    why = text("over the burn{drift}{holes}", drift=drift, holes=holes)
    return Quantity(value, "N s", total(inputs), why=why)


def _of_drift(thrust: Thrust) -> str:
    if thrust.error:
        return text("; {error} of the cell's drift taken off", error=said(thrust.error, "N", ".0f"))
    if not drift_unseen(thrust):
        return ""
    allowed = f"a drift of {UNSEEN_DRIFT:.0%} of its peak is allowed for"
    return f"; no rest after the burn shows whether the cell's zero held: {allowed}"


def impulse_inputs(log: TestLog, thrust: Thrust, fire: Fire, definition: TestDefinition, impulse: float) -> list[Input]:
    """What an ``impulse`` [N s] over the burn may be off by: the cell, the burn's end, what lies between samples."""
    whole = thrust.signal.bridged()
    last = abs(thrust.signal.around(fire.end, 0.2))
    inner = whole.between(0.0, fire.end)
    scatter = sample_noise(inner.value) * np.sqrt(thrust.signal.step * fire.end)
    cell = cell_error_of(log, thrust, definition, fire.end).of_impulse(impulse, fire.end)
    ends = Input(BURN_TIME, last * fire.std, random=True)
    return [*cell, ends, Input(HOLES, float(np.hypot(scatter, _between_samples(inner.time, inner.value))), random=True)]


def _ends_early(name: str, signal: Signal, fire: Fire) -> str:
    """How it is said that a channel says nothing of the burn's last part."""
    return f"the good samples of {name} end at {signal.time[-1]:.1f} s, before the burn does ({fire.end:.1f} s)"


def _between_samples(time: Array, value: Array) -> float:
    """What an integral may be off by: between two samples the change may come at any instant."""
    return float(np.linalg.norm(np.diff(value) * np.diff(time)) / np.sqrt(12.0))


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


def _peak(log: TestLog, name: str, signal: Signal | str, fire: Fire, cell: CellError | None = None) -> Quantity:
    """Largest value of the mean curve: flagged samples left out, the chamber's oscillation averaged; of a ``cell``'s
    reading, where it is one."""
    if isinstance(signal, str):
        return Quantity.absent(signal)
    part = signal.between(0.0, fire.end)
    if part.time.size < 8:
        return Quantity.absent(f"{name} has too few good samples in the burn")
    smooth = part.smooth(max(SMOOTHING, 3.0 * part.step))
    inside = (part.time > 0.5 * SMOOTHING) & (part.time < fire.end - 0.5 * SMOOTHING)
    place = int(np.argmax(np.where(inside, smooth, -np.inf)))
    count = max(SMOOTHING / part.step, 1.0)
    value, when = float(smooth[place]), float(part.time[place])
    off = bias(log[name]) if cell is None else total(cell.at(value, when / fire.end))
    error = float(np.hypot(off, part.noise / np.sqrt(count)))
    return Quantity(value, log[name].unit, error, why=f"of the mean curve, at {when:.2f} s")


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
