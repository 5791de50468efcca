"""What a test says, in the form that inference takes it: block means with the covariance of their noise.

A constant offset of a sensor and an error of its gain, as large as its stated accuracy allows, are part of the
covariance: they are nuisances with a Gaussian prior. Blocks that contain a change of phase are left out; the instants
of the changes are observations of their own. After the flow has ended the chamber's pressure is the ambient one and
the thrust is none: what the sensors read then is compared as well, for it tells a drift.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky

from hfanalysis.diagnose.alignment import share
from hfanalysis.diagnose.flow_end import find_flow_end
from hfanalysis.diagnose.oscillation import oscillation
from hfanalysis.diagnose.wander import roughness, wander_of
from hfanalysis.errors import AbsentError
from hfanalysis.segment.noise import Noise
from hfanalysis.segment.phases import Segments
from hfanalysis.segment.signals import Signal, sample_noise
from hfanalysis.testdata.definition import TestDefinition
from hfanalysis.testdata.log import Channel as LogChannel
from hfanalysis.testdata.log import TestLog

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

CHANNELS = ("p_tank", "p_run", "p_chamber", "thrust", "m_tank")
"""Canonical channels that are compared."""

BLOCK = 0.02
"""Seconds over which samples are averaged near the opening and the changes of phase."""

MERGED, NEAR = 5, 0.4
"""Blocks that are merged into one farther than NEAR [s] from any change: the noise there is coherent anyway."""

AROUND_CHANGE = 0.04
"""Seconds on either side of a phase change (beside its own deviation) without blocks: knees are rounded."""

FIRST = 0.03
"""Seconds after the opening before which nothing is compared: the chamber fills, the igniter is not modelled."""

AROUND_END = 0.3
"""Seconds before the end of the flow that was noted at the stand from which on nothing is compared."""

WORTH_IT = 0.5
"""Seconds of flow after the end of the fuel from which on they are compared."""

APART = 0.25
"""Seconds by which the ends of liquid and fuel have to lie apart for that: the model keeps to both."""

AT_ONCE = 0.05
"""Standard deviation [s] of the end of the fuel up to which it is one: a fire that fades goes on beyond its middle."""

COLD_FLOW_ERROR = 0.01
"""Part of the liquid's flow into a chamber without fire that is not known: part of it boils only behind the nozzle."""

TANK_SIDE = ("p_tank", "p_run", "m_tank")
"""Channels that go on telling when the nozzle has unchoked."""

CELL_ERROR = 0.02
"""Part of the thrust that a tank's cell may feel [kg of it weighs g]."""

LONGEST = 30.0

FORM_ERROR, FORM_TIME = 2e-4, 1.0
"""Model-form error: part of a channel's range, and the time [s] over which it is coherent."""

CHAMBER_FORM = 4.0
"""How much larger the model-form error of chamber and thrust is: chemistry and nozzle are idealised further."""

EVENT_STD = 0.005
"""Least standard deviation [s] of the instant of a phase change."""

FUEL_STD = 0.05
"""Least standard deviation [s] of the end of the fuel, which fades rather than stops."""

AT_REST = ("p_chamber", "thrust")
"""Channels whose true value is known once the flow has ended."""

SETTLING, SHORTEST_REST, LONGEST_REST = 0.5, 0.4, 10.0
"""Seconds after the end of the flow before the chamber is at rest, and how long a rest that is looked at may be."""

REST_BLOCKS = 4

FILLING_ERROR, FILLING_TIME = 0.1, 0.1
"""Model-form error while the line fills, as part of a channel's range, and the seconds over which it is coherent."""

BEFORE_OPENING, BEFORE = ("p_tank", "m_tank"), 1.0
"""Channels that show the tank at rest before the opening, and the seconds of it that are looked at."""


TOGETHER = ("p_chamber", "thrust")
"""Channels that share the oscillation of the burn."""


@dataclass(frozen=True)
class Channel:
    """Block means of one channel: ``time`` [s after the opening], ``value`` and stated ``accuracy`` [SI].

    ``first`` and ``count`` say which points of the common grid are averaged into each block. ``covariance`` is that of
    sensor noise, oscillation, bias and gain. ``resting`` blocks lie after the end of the flow.
    """

    name: str
    time: Array
    value: Array
    first: Integers
    count: Integers
    resting: NDArray[np.bool_]
    noise_std: Array
    accuracy: float
    covariance: Array

    def only(self, rows: Integers) -> Channel:
        """The same with some of its blocks."""
        picked = {n: getattr(self, n)[rows] for n in ("time", "value", "first", "count", "resting", "noise_std")}
        return replace(self, **picked, covariance=self.covariance[np.ix_(rows, rows)])

    def with_white_noise(self) -> Channel:
        """The same with independent noise of the same size, beside offset and gain."""
        burning = np.where(self.resting, 0.0, 1.0)
        gain = self.value * burning / float(np.abs(self.value).max())
        shared = (SHARE * self.accuracy) ** 2 * (np.outer(burning, burning) + np.outer(gain, gain))
        return replace(self, covariance=shared + np.diag(self.noise_std**2))

    def form_covariance(self, error: float) -> Array:
        """Covariance of a model-form error that is given as part of the channel's range; smooth (Matern, 3/2)."""
        lag = self.time[:, None] - self.time[None, :]
        size = error * CHAMBER_FORM if self.name in TOGETHER else error
        burning = np.where(self.resting, 0.0, size * float(np.ptp(self.value)))
        smooth = np.sqrt(3.0) * np.abs(lag) / FORM_TIME
        return np.asarray((1.0 + smooth) * np.exp(-smooth) * np.outer(burning, burning))

    def averaged(self, rows: Array) -> Array:
        """Block means of rows (grid, ...) on the common grid."""
        return averaged(rows, self.first, self.count)


def averaged(rows: Array, first: Integers, count: Integers) -> Array:
    """Means over ``count`` rows (grid, ...) from ``first`` on."""
    total = np.concatenate([np.zeros((1, *rows.shape[1:])), np.cumsum(rows, axis=0)])
    shape = (-1, *([1] * (rows.ndim - 1)))
    return np.asarray((total[first + count] - total[first]) / count.reshape(shape))


@dataclass(frozen=True)
class Observed:
    """The channels of a test, the instants of its phase changes with their deviations [s], and when it ends [s].

    ``grid`` [s]: points at which a model is asked: at the opening, through the flow, and ``resting`` ones after it (the
    first, too, stands for the time before). ``fuel_out``: where the comparison of the tank goes on beyond the fuel, its
    measured end, at which that of every model ends. ``stated``: what was measured outside the log (SI), with standard
    deviations, by name. ``common``: covariance of the first and second of TOGETHER, if both are there. ``form``:
    model-form error, as part of a channel's range.
    """

    channels: tuple[Channel, ...]
    grid: Array
    resting: NDArray[np.bool_]
    events: Mapping[str, tuple[float, float]]
    stated: Mapping[str, tuple[float, float]]
    phases: Mapping[str, float]
    end: float
    flow_end: float
    ambient: float
    common: Array | None = None
    form: float = FORM_ERROR
    fuel_out: float | None = None

    def at_form(self, error: float) -> Observed:
        """The same with another model-form error."""
        return replace(self, form=error)

    def with_white_noise(self) -> Observed:
        """The same as if the noise of blocks were independent: what it costs to think so can be studied."""
        return replace(self, channels=tuple(c.with_white_noise() for c in self.channels), common=None)

    def only(self, names: tuple[str, ...]) -> Observed:
        """The same with these channels alone."""
        kept = tuple(c for c in self.channels if c.name in names)
        both = set(TOGETHER) <= {c.name for c in kept}
        return replace(self, channels=kept, common=self.common if both else None)

    def without(self, left_out: Mapping[str, NDArray[np.bool_]]) -> Observed:
        """The same without some blocks of each channel."""
        keep = {c.name: np.flatnonzero(~left_out[c.name]) for c in self.channels}
        common = self.common
        if common is not None:
            common = common[np.ix_(*(keep[name] for name in TOGETHER))]
        return replace(self, channels=tuple(c.only(keep[c.name]) for c in self.channels), common=common)

    @cached_property
    def log_size(self) -> float:
        """Log of the determinant of the covariance's root."""
        return -float(sum(np.linalg.slogdet(factor)[1] for _, factor in self._factors))

    @cached_property
    def _factors(self) -> tuple[tuple[slice, Array], ...]:
        """Inverse Cholesky factors of groups of channels whose noise goes together, and their rows."""
        out, at, i = [], 0, 0
        while i < len(self.channels):
            c = self.channels[i]
            covariance = c.covariance + c.form_covariance(self.form)
            i += 1
            if c.name == TOGETHER[0] and self.common is not None:
                other = self.channels[i]
                second = other.covariance + other.form_covariance(self.form)
                covariance = np.block([[covariance, self.common], [self.common.T, second]])
                i += 1
            factor = _whitening(covariance)
            out.append((slice(at, at + factor.shape[0]), factor))
            at += factor.shape[0]
        return tuple(out)

    def whiten(self, rows: Array) -> Array:
        """Rows (blocks of all channels one after the other, ...) in units in which the noise is white and of size
        one."""
        return np.concatenate([factor @ rows[place] for place, factor in self._factors])

    @property
    def longest(self) -> float:
        """The last instant that anything is known of [s]."""
        weighed = self.flow_end if "fuel_mass_after" in self.stated else self.end
        burning = self.grid[~self.resting]
        return max([weighed, float(burning[-1]), *(at for at, _ in self.events.values())])

    @property
    def names(self) -> tuple[str, ...]:
        """Of the channels."""
        return tuple(c.name for c in self.channels)


def observe_test(log: TestLog, segments: Segments, definition: TestDefinition) -> Observed:
    """Reduce a test to what is compared. Raises AbsentError where neither tank, chamber nor thrust is left."""
    origin = segments.t_open.value
    if origin is None:
        raise AbsentError("no opening was found: there is nothing to compare")
    end = min(_end(segments), _last(log, origin))
    frame = _frame(log, segments, definition, origin)
    live = {name: Signal.of(as_read(log[name])).shifted(origin) for name in CHANNELS if name in log}
    if "m_tank" in live and not _cell_reads(live["m_tank"], definition):
        del live["m_tank"]
    reduced = {
        name: r for name, signal in live.items() if not signal.dead and (r := _reduce(signal, frame)) is not None
    }
    if not {"p_tank", "p_chamber", "thrust"} & set(reduced):
        raise AbsentError("neither tank, chamber nor thrust was recorded: the model cannot be compared")
    shaken = _oscillation(reduced, frame)
    channels = tuple(
        _channel(r, definition, frame, shaken.get((name, name)), log[name].zero_std) for name, r in reduced.items()
    )
    common = shaken.get(TOGETHER)
    if common is not None:
        one, two = (reduced[name] for name in TOGETHER)
        half = averaged(common, one.first, one.count)
        common = averaged(half.T, two.first, two.count).T
    return Observed(
        channels,
        frame.grid,
        frame.resting,
        _events(segments, frame.ends["tank"], frame.fuel_out),
        _stated(definition, segments),
        _phases(segments, end),
        end,
        max(frame.ends["tank"], _flow_end(definition, end)),
        definition.ambient_pressure.value,
        common,
        fuel_out=frame.fuel_out,
    )


def _whitening(covariance: Array) -> Array:
    """W with W C W^T = 1. An estimated covariance need not be positive: what is smaller than LEAST_VARIANCE is
    raised."""
    try:
        return np.tril(np.linalg.inv(cholesky(covariance, lower=True, check_finite=False)))
    except np.linalg.LinAlgError:
        size = np.sqrt(covariance.diagonal())
        values, vectors = np.linalg.eigh(covariance / np.outer(size, size))
        return np.asarray((vectors / np.sqrt(np.maximum(values, LEAST_VARIANCE))).T / size)


LEAST_VARIANCE = 1e-3
"""Of any combination of blocks, relative to a single block's."""


def _moved_by_knee(reduced: _Reduced, frame: _Frame) -> Array:
    """What a channel differs by if the end of the liquid was seen one standard deviation late.

    The model is laid over the measurement from knee to knee: an error of t_v stretches all that comes before and shifts
    all that comes after.
    """
    if "t_v" not in frame.changes:
        return np.zeros(reduced.time.size)
    instant, deviation = frame.changes["t_v"]
    out = np.zeros(reduced.time.size)
    burning = ~frame.resting[reduced.first]
    for side in (reduced.time < instant, reduced.time >= instant):
        part = side & burning
        if part.sum() > SPEED_ORDER + 2:
            t = reduced.time[part] - instant
            speed = np.polyval(np.polyder(np.polyfit(t, reduced.value[part], SPEED_ORDER)), t)
            out[part] = speed * share(reduced.time[part], instant, instant, frame.fuel_out)
    return np.asarray(out * max(deviation, EVENT_STD))


SPEED_ORDER = 3
"""Order of the polynomials whose slope is a channel's speed on either side of the knee."""


def as_read(channel: LogChannel) -> LogChannel:
    """A channel with its zero taken off but not the drift that ingest removes: a drift is an effect to be found."""
    if channel.drift == 0.0 or channel.raw is None:
        return channel
    return replace(channel, values=channel.raw - channel.zero)


@dataclass(frozen=True)
class _Frame:
    """The common grid, the changes of phase (instant, deviation), and from when to when is compared [s]."""

    grid: Array
    resting: NDArray[np.bool_]
    changes: Mapping[str, tuple[float, float]]
    start: float
    filled: float
    ends: Mapping[str, float]
    fuel_out: float | None = None

    def end(self, channel: str) -> float:
        """Where the comparison of a channel ends [s]."""
        return self.ends["tank" if channel in TANK_SIDE else "chamber"]


def _frame(log: TestLog, segments: Segments, definition: TestDefinition, origin: float) -> _Frame:
    last = _last(log, origin)
    end = min(_end(segments), last)
    ends = {"chamber": end, "tank": min(_tank_end(segments, definition, end), last)}
    fuel_out = segments.time("t_fuel_out")
    flow_end = _flow_end_without_fuel(log, segments, definition, origin)
    if flow_end is None:
        fuel_out = None
    else:
        ends["tank"] = min(flow_end - AROUND_END, LONGEST)
    changes = {
        name: (value, segments.std(name))
        for name in ("t_v", "t_fuel_out")
        if (value := segments.time(name)) is not None
    }
    over = _flow_end(definition, max(segments.time("t_end") or end, end))
    rest = _rest(log, origin, over if flow_end is None else max(over, flow_end))
    burning = np.arange(0.5 * BLOCK, ends["tank"], BLOCK)
    after: Array = np.zeros(0)
    if rest is not None:
        width = (rest[1] - rest[0]) / REST_BLOCKS
        after = np.asarray(rest[0] + width * (np.arange(REST_BLOCKS) + 0.5), dtype=np.float64)
    grid = np.concatenate([[0.0], burning, after])
    resting = np.ones(grid.size, dtype=bool)
    resting[1 : 1 + burning.size] = False
    filled = segments.time("t_feed") or 0.0
    return _Frame(grid, resting, changes, FIRST, filled, ends, fuel_out)


def _flow_end_without_fuel(log: TestLog, segments: Segments, definition: TestDefinition, origin: float) -> float | None:
    """Until when the tank goes on emptying after the end of the fuel [s]; None where that is not worth following.

    What was noted at the stand is the end of the fuel. Where it is clearly later, it may be that of the flow.
    """
    gone, t_v = segments.time("t_fuel_out"), segments.time("t_v")
    if gone is None or segments.std("t_fuel_out") > AT_ONCE or not {"p_tank", "p_run"} <= set(log.channels):
        return None
    if t_v is not None and abs(gone - t_v) < APART:
        return None
    tank, run = (Signal.of(as_read(log[name])).shifted(origin) for name in ("p_tank", "p_run"))
    if tank.dead or run.dead:
        return None
    accuracy = float(np.hypot(_accuracy(definition, "p_tank", tank.value), _accuracy(definition, "p_run", run.value)))
    end = find_flow_end(tank, run, gone, definition.ambient_pressure.value, accuracy, segments.time("t_purge"))
    noted = _flow_end(definition, 0.0)
    if end is not None and noted > gone + AROUND_END:
        end = min(end, noted)
    return end if end is not None and min(end - AROUND_END, LONGEST) > gone + WORTH_IT else None


def _rest(log: TestLog, origin: float, over: float) -> tuple[float, float] | None:
    """A stretch after the flow [s] in which the chamber is at rest; None where the log does not show one.

    The nozzle unchokes long before the last gas has left, so that the chamber's pressure has to stand still as well.
    """
    if "p_chamber" not in log:
        return None
    signal = Signal.of(log["p_chamber"]).shifted(origin)
    if signal.dead:
        return None
    last = float(signal.time[-1])
    first = max(over + SETTLING, last - LONGEST_REST)
    if last - first < SHORTEST_REST:
        return None
    half = 0.5 * (first + last)
    noise = Noise.of(signal, signal.between(-LONGEST, -0.1))
    fall = signal.mean(first, half) - signal.mean(half, last)
    if not abs(fall) <= 3.0 * noise.difference_std((first, half), (half, last)):
        return None
    return first, last


def _events(segments: Segments, end: float, fuel_out: float | None) -> dict[str, tuple[float, float]]:
    t_v = segments.time("t_v")
    events = {}
    if t_v is not None and t_v < end - AROUND_CHANGE:
        cold = COLD_FLOW_ERROR * max(t_v - fuel_out, 0.0) if fuel_out is not None else 0.0
        events["t_v"] = (t_v, float(np.hypot(max(segments.std("t_v"), EVENT_STD), cold)))
    gone = segments.time("t_fuel_out")
    if gone is not None and gone < LONGEST:
        events["t_fuel_out"] = (gone, max(segments.std("t_fuel_out"), FUEL_STD))
    return events


def _stated(definition: TestDefinition, segments: Segments) -> dict[str, tuple[float, float]]:
    """What was seen or weighed after the test."""
    seen = definition.observed
    if seen is None:
        return {}
    out = {}
    for name, least in (("throat_radius_after", 2e-5), ("fuel_mass_after", 5e-3)):
        value = getattr(seen, name)
        if name == "fuel_mass_after" and (segments.time("t_fuel_out") is not None or seen.burn_time is None):
            continue  # there is none left, or nobody knows until when it burnt
        if value is not None:
            out[name] = (float(value.value), max(float(value.std or 0.0), least))
    return out


def _tank_end(segments: Segments, definition: TestDefinition, end: float) -> float:
    """The tank goes on emptying after the nozzle has unchoked, until the end of the flow that was seen at the stand."""
    if segments.time("t_fuel_out") is not None:
        return end
    return min(max(_flow_end(definition, end) - AROUND_END, end), LONGEST)


def _flow_end(definition: TestDefinition, end: float) -> float:
    """Until when something flowed, as seen at the stand [s]."""
    seen = definition.observed.burn_time if definition.observed is not None else None
    return max(float(seen.value), end) if seen is not None else end


def _end(segments: Segments) -> float:
    """Where the comparison ends [s]: with the fuel, for what follows is another story, or where the flow ends."""
    known = [(segments.time(name), segments.std(name)) for name in ("t_fuel_out", "t_end")]
    # where the fuel fades, its fading is to be seen: no wide berth for a wide deviation
    given = [t - AROUND_CHANGE - min(2.0 * deviation, AROUND_CHANGE) for t, deviation in known if t is not None]
    return min([*given, LONGEST])


def _last(log: TestLog, origin: float) -> float:
    """Where the log ends [s]: beyond it nothing is compared, and no model need run."""
    return max(float(log[name].time.max()) for name in CHANNELS if name in log) - origin


def _phases(segments: Segments, end: float) -> dict[str, float]:
    """Where each phase begins [s]."""
    found = {"filling": 0.0, "liquid": segments.time("t_feed") or 0.0}
    t_v, t_purge = segments.time("t_v"), segments.time("t_purge")
    if t_v is not None:
        found["vapor"] = t_v
    if t_purge is not None:
        found["nitrogen"] = t_purge
    return {**found, "end": end}


def _cell_reads(cell: Signal, definition: TestDefinition) -> bool:
    """Whether the tank's cell at rest reads what is loaded."""
    loaded = definition.tank.oxidizer_mass if definition.tank is not None else None
    still = cell.between(-LONGEST, -0.1).value
    if loaded is None or still.size < 8:
        return False
    return abs(float(np.median(still)) - loaded.value) < TANK_CELL * loaded.value


SHARE = 0.7071
"""Part of a stated accuracy that is the zero's error; as much is the span's: squares add up to the whole."""

UNSTEADY_ZERO = 0.03
"""Part of its accuracy by which the zero of a sensor may move within a test, beside the wander that its quiet time
shows. A zero that moves further is an effect, and has to be found as one."""

TANK_CELL = 0.03
"""Part of the loaded mass by which the tank's cell may be off at rest and still be compared."""


@dataclass(frozen=True)
class _Reduced:
    """Block means of a signal: blocks of the grid (first, count) that are averaged, and all ``fine`` means."""

    signal: Signal
    time: Array
    value: Array
    first: Integers
    count: Integers
    fine: Array
    good: NDArray[np.bool_]


def _reduce(signal: Signal, frame: _Frame) -> _Reduced | None:
    """Blocks without enough samples are left out; None where too few are left."""
    blocks = int((~frame.resting).sum())
    edges = np.arange(blocks + 1) * BLOCK
    at = np.searchsorted(signal.time, edges)
    sums = np.concatenate([[0.0], np.cumsum(signal.value)])
    samples, centers = np.diff(at), frame.grid[1 : 1 + blocks]
    means = np.where(samples > 0, np.diff(sums[at]) / np.maximum(samples, 1), 0.0)
    filled = (samples > 0) & (samples >= 0.5 * BLOCK / max(signal.step, 1e-9))
    good = filled & (centers > frame.start) & (centers < frame.end(signal.name))
    for name, (instant, deviation) in frame.changes.items():
        berth = 2.0 * deviation if name == "t_v" else min(2.0 * deviation, AROUND_CHANGE)
        good &= np.abs(centers - instant) > AROUND_CHANGE + berth
    if good.sum() < 10:
        return None
    first, count = _merged(good, centers, frame)
    time, value, first = averaged(centers, first, count), averaged(means, first, count), first + 1
    one = np.ones(1, dtype=np.int64)
    before = signal.between(-BEFORE, -0.05).value
    if signal.name in BEFORE_OPENING and before.size > 4:
        time, value = np.r_[0.0, time], np.r_[before.mean(), value]
        first, count = np.r_[0 * one, first], np.r_[one, count]
    after = np.flatnonzero(frame.resting)[1:] if signal.name in AT_REST else np.zeros(0, dtype=np.int64)
    still = _still(signal, frame.grid[after])
    if np.isfinite(still).all():
        time, value = np.r_[time, frame.grid[after]], np.r_[value, still]
        first, count = np.r_[first, after], np.r_[count, np.ones(after.size, dtype=np.int64)]
    return _Reduced(signal, time, value, first, count, means, good)


def _still(signal: Signal, times: Array) -> Array:
    """Means about instants after the end of the flow."""
    half = 0.5 * float(times[1] - times[0]) if times.size > 1 else 0.0
    return np.array([signal.mean(t - half, t + half) for t in times])


def _oscillation(reduced: Mapping[str, _Reduced], frame: _Frame) -> dict[tuple[str, str], Array]:
    """Covariance of the burn's oscillation, and of the shaking of the tank's cell, in blocks of the grid."""
    found: dict[tuple[str, str], Array] = {}
    for group in (TOGETHER, ("m_tank",)):
        shaken = {name: r for name, r in reduced.items() if name in group}
        if shaken:
            found |= _shaken(shaken, frame)
    return found


def _shaken(shaken: Mapping[str, _Reduced], frame: _Frame) -> dict[tuple[str, str], Array]:
    usable = np.logical_and.reduce([r.good for r in shaken.values()])
    guide = next(iter(shaken.values()))
    if guide.signal.name in TOGETHER:
        level = np.interp(frame.grid[~frame.resting], guide.time, guide.value)
        quiet = guide.signal.between(-LONGEST, -0.05).value
        zero = float(quiet.mean()) if quiet.size else float(guide.value.min())
        level = np.maximum(level - zero, 0.0) / max(float(guide.value.max()) - zero, 1e-300)
    else:
        level = np.ones(usable.size)
    stds = {name: wander_of(r.signal, BLOCK).white for name, r in shaken.items()}
    found = oscillation({name: r.fine for name, r in shaken.items()}, level, usable, stds)
    still = int(frame.resting.sum())
    return {pair: np.pad(matrix, (1, still - 1)) for pair, matrix in found.items()}


def _channel(
    reduced: _Reduced, definition: TestDefinition, frame: _Frame, shaken: Array | None, zero_std: float | None
) -> Channel:
    signal, first, count = reduced.signal, reduced.first, reduced.count
    noise = wander_of(signal, BLOCK)
    resting = frame.resting[first]
    accuracy = _accuracy(definition, signal.name, reduced.value)
    own, white = noise.covariance(frame.grid), noise.white
    if shaken is not None:
        own = own + shaken
    else:
        fine = signal.between(frame.start, frame.end(signal.name)).reduced(BLOCK)
        rough = float(sample_noise(fine.value)) ** 2 - roughness(noise, BLOCK)
        white = max(white, max(rough, 0.0) ** 0.5)
    own[np.diag_indices_from(own)] += max(white, 1e-9 * float(np.abs(reduced.value).max())) ** 2
    own = averaged(averaged(own, first, count).T, first, count)
    burning = np.where(resting & (signal.name in AT_REST), 0.0, 1.0)
    gain = reduced.value * burning / float(np.abs(reduced.value).max())
    # a zero that was taken before the opening leaves of the accuracy mostly the gain's error
    offset = SHARE * accuracy if zero_std is None else float(np.hypot(zero_std, UNSTEADY_ZERO * accuracy))
    covariance = own + offset**2 * np.outer(burning, burning) + (SHARE * accuracy) ** 2 * np.outer(gain, gain)
    moved = _moved_by_knee(reduced, frame)
    covariance = covariance + np.outer(moved, moved)
    filling = np.where((reduced.time < frame.filled) & ~resting, FILLING_ERROR * float(np.ptp(reduced.value)), 0.0)
    lag = np.abs(reduced.time[:, None] - reduced.time[None, :])
    covariance = covariance + np.exp(-lag / FILLING_TIME) * np.outer(filling, filling)
    std = np.sqrt(own.diagonal())
    return Channel(signal.name, reduced.time, reduced.value, first, count, resting, std, accuracy, covariance)


def _merged(good: NDArray[np.bool_], centers: Array, frame: _Frame) -> tuple[Integers, Integers]:
    """Runs of good blocks: single near the opening and changes, MERGED of them elsewhere."""
    lively = centers < frame.start + NEAR
    for instant, _ in frame.changes.values():
        lively |= np.abs(centers - instant) < NEAR
    first, size = [], []
    i = 0
    while i < good.size:
        if not good[i]:
            i += 1
            continue
        span = 1
        while not lively[i] and span < MERGED and i + span < good.size and good[i + span] and not lively[i + span]:
            span += 1
        first.append(i)
        size.append(span)
        i += span
    return np.array(first, dtype=np.int64), np.array(size, dtype=np.int64)


def _accuracy(definition: TestDefinition, name: str, value: Array) -> float:
    stated = definition.channels[name].accuracy if name in definition.channels else None
    return stated.value if stated is not None else 2.5e-3 * float(np.abs(value).max())
