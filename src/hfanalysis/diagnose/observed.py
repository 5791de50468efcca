"""What a test says, in the form that inference takes it: block means with the covariance of their noise.

A constant offset of a sensor, as large as its stated accuracy allows, is part of the covariance: it is a nuisance with
a Gaussian prior. Blocks that contain a change of phase are left out; the instants of the changes are observations of
their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, solve_triangular

from hfanalysis.errors import AbsentError
from hfanalysis.segment.noise import Noise
from hfanalysis.segment.phases import Segments
from hfanalysis.segment.signals import Signal, sample_noise
from hfanalysis.testdata.definition import TestDefinition
from hfanalysis.testdata.log import TestLog

Array = NDArray[np.float64]

CHANNELS = {
    "p_tank": "tank_pressure",
    "p_run": "run_pressure",
    "p_chamber": "chamber_pressure",
    "thrust": "thrust",
}
"""Canonical channels that are compared, and the model's outputs that they measure."""

BLOCK = 0.02
"""Seconds over which samples are averaged."""

AROUND_CHANGE = 0.06
"""Seconds on either side of a phase change (beside its own deviation) without blocks: knees are rounded."""

FIRST = 0.05
"""Seconds after the opening before which nothing is compared: the chamber fills, the igniter is not modelled."""

LONGEST = 30.0

FORM_ERROR, FORM_TIME = 1e-3, 1.0
"""Model-form error: part of a channel's range, and the time [s] over which it is coherent."""

EVENT_STD = 0.005
"""Least standard deviation [s] of the instant of a phase change."""


FUEL_STD = 0.05
"""Least standard deviation [s] of the end of the fuel, which fades rather than stops."""


@dataclass(frozen=True)
class Channel:
    """Block means of one channel: ``time`` [s after the opening], ``value`` and stated ``accuracy`` [SI].

    ``covariance`` is that of sensor noise and bias; ``factor`` whitens them, model-form error included.
    """

    name: str
    time: Array
    value: Array
    noise_std: Array
    accuracy: float
    covariance: Array
    factor: Array

    def at_form(self, error: float) -> Channel:
        """The same with another model-form error, given as part of the channel's range."""
        lag = self.time[:, None] - self.time[None, :]
        form = error * float(np.ptp(self.value))
        covariance = self.covariance + form**2 * np.exp(-np.abs(lag) / FORM_TIME)
        factor = np.tril(cho_factor(covariance, lower=True, check_finite=False)[0])
        return replace(self, factor=factor)

    def whiten(self, rows: Array) -> Array:
        """Rows (samples, ...) in units in which the noise is white and of size one."""
        return np.asarray(solve_triangular(self.factor, rows, lower=True, check_finite=False))


@dataclass(frozen=True)
class Observed:
    """The channels of a test, the instants of its phase changes with their deviations [s], and when it ends [s]."""

    channels: tuple[Channel, ...]
    events: Mapping[str, tuple[float, float]]
    phases: Mapping[str, float]
    end: float

    def at_form(self, error: float) -> Observed:
        """The same with another model-form error, given as part of each channel's range."""
        return replace(self, channels=tuple(c.at_form(error) for c in self.channels))

    @property
    def longest(self) -> float:
        """The last instant that is compared [s]."""
        return max(self.end, *(at for at, _ in self.events.values())) if self.events else self.end

    @property
    def names(self) -> tuple[str, ...]:
        """Of the channels."""
        return tuple(c.name for c in self.channels)


def observe_test(log: TestLog, segments: Segments, definition: TestDefinition) -> Observed:
    """Reduce a test to what is compared. Raises AbsentError where no pressure of tank or chamber is left."""
    origin = segments.t_open.value
    if origin is None:
        raise AbsentError("no opening was found: there is nothing to compare")
    end = _end(segments)
    changes = [
        (value, segments.std(name)) for name in ("t_v", "t_fuel_out") if (value := segments.time(name)) is not None
    ]
    filled = segments.time("t_feed") or 0.0
    channels = []
    for name in CHANNELS:
        if name not in log:
            continue
        signal = Signal.of(log[name]).shifted(origin)
        if not signal.dead:
            channels.append(_channel(signal, definition, changes, max(FIRST, filled), end))
    found = [c for c in channels if c is not None]
    if not {"p_tank", "p_chamber"} & {c.name for c in found}:
        raise AbsentError("neither the tank's nor the chamber's pressure was recorded: the model cannot be compared")
    t_v = segments.time("t_v")
    seen = t_v is not None and t_v < end - AROUND_CHANGE
    events = {"t_v": (t_v, max(segments.std("t_v"), EVENT_STD))} if seen and t_v is not None else {}
    gone = segments.time("t_fuel_out")
    if gone is not None and gone < LONGEST:
        events["t_fuel_out"] = (gone, max(segments.std("t_fuel_out"), FUEL_STD))
    return Observed(tuple(found), events, _phases(segments, end), end)


def _end(segments: Segments) -> float:
    """Where the comparison ends [s]: with the fuel, for what follows is another story, or where the flow ends."""
    known = [(segments.time(name), segments.std(name)) for name in ("t_fuel_out", "t_end")]
    given = [t - AROUND_CHANGE - 2.0 * deviation for t, deviation in known if t is not None]
    return min([*given, LONGEST])


def _phases(segments: Segments, end: float) -> dict[str, float]:
    """Where each phase begins [s]."""
    found = {"filling": 0.0, "liquid": segments.time("t_feed") or 0.0}
    t_v, t_purge = segments.time("t_v"), segments.time("t_purge")
    if t_v is not None:
        found["vapor"] = t_v
    if t_purge is not None:
        found["nitrogen"] = t_purge
    return {**found, "end": end}


def _channel(
    signal: Signal, definition: TestDefinition, changes: list[tuple[float, float]], start: float, end: float
) -> Channel | None:
    quiet = signal.between(-LONGEST, -0.1)
    noise = Noise.of(signal, quiet)
    run = signal.between(start, end)
    if run.time.size < 20:
        return None
    blocks = run.reduced(BLOCK)
    keep = np.ones(blocks.time.size, dtype=bool)
    for at, deviation in changes:
        keep &= np.abs(blocks.time - at) > AROUND_CHANGE + 2.0 * deviation
    time, value = blocks.time[keep], blocks.value[keep]
    if time.size < 10:
        return None
    # in the burn the chamber's oscillation comes on top of the sensor's own noise
    jitter = max(sample_noise(blocks.value), 1e-12 * float(np.abs(value).max()))
    accuracy = _accuracy(definition, signal.name, value)
    covariance = noise.covariance(time) + accuracy**2
    covariance[np.diag_indices_from(covariance)] += jitter**2
    std = np.sqrt(noise.covariance(time).diagonal() + jitter**2)
    return Channel(signal.name, time, value, std, accuracy, covariance, covariance).at_form(FORM_ERROR)


def _accuracy(definition: TestDefinition, name: str, value: Array) -> float:
    stated = definition.channels[name].accuracy if name in definition.channels else None
    return stated.value if stated is not None else 2.5e-3 * float(np.abs(value).max())
