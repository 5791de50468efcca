"""The measured pressures on one clock, counted from the valve opening: what every reduction starts from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import AbsentError
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.noise import LONG_STRETCH, Noise, pool
from hfanalysis.record.signals import Signal, live_signals
from hfanalysis.segment.breaks import kink
from hfanalysis.thermo.saturation import Saturation

PRESSURES = ("p_tank", "p_run", "p_chamber", "p_purge")
READING_POINTS = 150
"""Block means over the window of a reading: few enough for a full covariance."""

FINEST_BLOCK = 0.002
"""Block means over this time [s]: fine against every phase, coarse enough for hundreds of repetitions."""

BEFORE = 500
"""Blocks before the opening of a channel that is sampled more slowly than they last [blocks]."""


@dataclass(frozen=True)
class MeasuredPressures:
    """Pressures [Pa] at ``time`` [s after opening], all of one length, good samples only (linear between them).

    ``signals`` are the channels they come from, with all their samples; ``assumed`` says what was taken for missing.
    """

    time: Array
    tank: Array
    run: Array
    chamber: Array
    signals: dict[str, Signal]
    noises: dict[str, Noise]
    assumed: tuple[str, ...] = ()

    @classmethod
    def of(
        cls, log: TestLog, segments: Segments, definition: TestDefinition, end: float, lost: float | None = None
    ) -> MeasuredPressures:
        """From the opening to ``end`` [s]. Raises AbsentError where the log has no p_tank, or no p_run and nothing is
        said of what the line loses: ``lost`` [-] of p_tank - p_chamber.
        """
        origin = segments.t_open.value or 0.0
        signals = {name: signal.shifted(origin) for name, signal in live_signals(log).items() if name in PRESSURES}
        noises = _noises(signals, segments)
        burning = segments.kind == "hot_fire"
        for name in ("p_tank", "p_run", *(("p_chamber",) if burning else ())):
            if name not in signals and (name != "p_run" or lost is None):
                raise AbsentError(f"test {definition.test.id}: {log.lacks(name)}; a calibration takes it")
            if name in signals and signals[name].between(0.0, end).time.size < 2:
                last = f"{signals[name].time[-1]:.2f} s" if signals[name].time.size else "no time"
                until = f"says nothing after the opening: its last good sample is at {last}"
                raise AbsentError(f"test {definition.test.id}: {name} {until}")
        blocks = signals["p_tank"].between(0.0, end).reduced(FINEST_BLOCK)
        if blocks.time.size < 8:
            raise AbsentError("too few good samples of p_tank after the opening")
        time = blocks.time
        assumed: tuple[str, ...] = ()
        if "p_chamber" in signals:
            chamber = _on(signals["p_chamber"], time)
        else:
            chamber = np.full(time.size, definition.ambient_pressure.value)
            assumed = ("p_chamber is not in the log of this cold flow: ambient pressure taken",)
        tank = blocks.value
        run = _on(signals["p_run"], time) if "p_run" in signals else tank - (lost or 0.0) * (tank - chamber)
        return cls(time, tank, run, chamber, signals, noises, assumed)

    def mean(self, values: Array, start: float, end: float) -> float:
        """Mean of ``values`` (n,) on this clock, in their unit, over [start, end) [s]."""
        part = (self.time >= start) & (self.time < end)
        return float(values[part].mean()) if part.any() else float("nan")

    def gap(self, start: float, end: float) -> tuple[str, float]:
        """The channel with the longest stretch without a good sample from ``start`` to ``end`` [s], and that stretch
        [s].
        """
        longest = ("", 0.0)
        for name in ("p_tank", "p_run", "p_chamber"):
            if name not in self.signals:
                continue
            time = np.concatenate(([start], self.signals[name].between(start, end).time, [end]))
            longest = max(longest, (name, float(np.diff(time).max())), key=lambda item: item[1])
        return longest

    def tank_temperature(self, saturation: Saturation) -> Array:
        """T_sat(p_tank) [K], (n,); pressures beyond the critical point count as just below it."""
        low, high = saturation.pressure_range
        return saturation.temperature(np.clip(self.tank, low, high))


@dataclass(frozen=True)
class PressureReading:
    """Value of a signal at an instant, its mean slope there [unit/s], and how it is made from block means."""

    value: float
    slope: float
    weights: Array
    time: Array


def read_at(signal: Signal, instant: float, before: float, after: float, breaks: bool) -> PressureReading:
    """A signal at an ``instant`` [s] from smooth curves over ``before`` and ``after`` [s].

    ``breaks``: its slope may change there at once, as it does where the liquid ends or nitrogen enters. What is known
    to happen decides, not whether the noise lets it be seen: where that decided, m jumped by two deviations between
    logs that differed in their noise alone.
    """
    window = signal.between(instant - before, instant + after).reduced((before + after) / READING_POINTS)
    if window.time.size < 8:
        nearest = np.array([float(np.interp(instant, signal.time, signal.value))])
        return PressureReading(float(nearest[0]), 0.0, np.ones(1), np.array([instant]))
    x = window.time - instant
    columns = kink(order=2)(window.time, instant) if breaks else np.vander(x, 4, increasing=True)
    weights = np.linalg.pinv(columns, rcond=1e-9)
    slopes = weights[[1, 3] if breaks else [1]] @ window.value
    return PressureReading(float(weights[0] @ window.value), float(slopes.mean()), weights[0], window.time)


def quiet_noises(log: TestLog, segments: Segments) -> dict[str, Noise]:
    """Noise of each live pressure sensor of the log."""
    origin = segments.t_open.value or 0.0
    signals = {n: s.shifted(origin) for n, s in live_signals(log).items() if n in PRESSURES}
    return _noises(signals, segments)


def _noises(signals: Mapping[str, Signal], segments: Segments) -> dict[str, Noise]:
    """Noise of each pressure sensor from before the opening; the purge line's from before it sags.

    The tank's falls so smoothly while the liquid lasts that its wander shows there, too, and for longer.
    """
    t_v, t_purge = segments.time("t_v"), segments.time("t_purge")
    noises = {}
    for name, signal in signals.items():
        end = t_purge - 0.1 if name == "p_purge" and t_purge is not None else -0.02
        stretches = [signal.between(-20.0, end)]
        if name == "p_tank" and t_v is not None:
            start = 2.0 * (segments.time("t_feed") or 0.1)
            liquid = signal.between(start, t_v - 0.05)
            # in a shorter one its fall passes for wander
            stretches += [liquid] if liquid.time.size > LONG_STRETCH else []
        noises[name] = Noise.of(signal, *stretches)
    return pool(noises)


def _on(signal: Signal, time: Array) -> Array:
    """A signal on another clock: block means where it is finer than the clock, else linear between its samples.

    Whole blocks before the opening: none is half of before it and half of after.
    """
    reduced = signal.between(-BEFORE * FINEST_BLOCK, time[-1] + 1.0).reduced(FINEST_BLOCK)
    return reduced.at(time)
