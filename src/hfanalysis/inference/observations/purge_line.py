"""The purge line where it follows the tank through its check valve: a second look at the tank's pressure.

Once the tank is below the line by what its check valve cracks at, the line sags with the tank and stays above it by as
much as when it began to, and by what a flow through the valve takes besides. A line that does not follow tells nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.observations.channel import form_covariance
from hfanalysis.inference.observations.frame import BLOCK
from hfanalysis.inference.observations.recorded import ALIKE, accuracy_of, signal_of
from hfanalysis.inference.observations.wander import wander_of
from hfanalysis.products.segments import Segments
from hfanalysis.record.accuracy import SPAN_SHARE
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal

SETTLED = 0.2
"""Seconds after nitrogen could first enter from which on the line is compared."""

SHORTEST = 1.0
"""Seconds that it has to follow the tank to be compared at all."""

FOLLOWS = 0.1, 1.3
"""Part of the tank's fall that a line which follows it falls by, from and to: what flows props it up."""

CLEAR = 5.0
"""Stated accuracies by which the tank has to fall meanwhile: a line that leaks sags on its own."""

LEVEL, AROUND = 1.0, 0.1
"""Seconds before it sags in which the line's level is taken, and on either side in which the tank's pressure is."""

VALVE = 0.1
"""Part of what its check valve cracks at by which the valve may take more or less once it is open (standard deviation).
Source: what has left its seat is held open by less than it took to open it, and a spring pushes back by more the
further it is pressed; data sheets have a valve close again at some tenths less than it cracks at."""

FEWEST = 4
"""Samples of either that this takes at least."""


@dataclass(frozen=True)
class PurgeLine:
    """The line's pressure less what its valve cracks at, with times [s] after the opening, and from when on it follows
    the tank.

    What it cracks at was read of both sensors as the line began to sag (``taken`` [s]), when the tank's read
    ``at_first`` [Pa], with a standard deviation of ``read_std`` [Pa]. So the zero is that of the tank's sensor, and the
    spans, whose relative errors are ``tank_span`` and ``own_span``, err by what the pressure has changed since;
    ``zero_std`` [Pa] is that of the tank's sensor. ``cracked`` [Pa]: what it cracks at.
    """

    signal: Signal
    start: float
    taken: float
    at_first: float
    read_std: float
    zero_std: float
    tank_span: float
    own_span: float
    cracked: float

    def zero_and_span(self, value: Array) -> Array:
        """Covariance (blocks, blocks) [Pa^2] of the line's blocks of these values (blocks,) [Pa] by errors of both
        sensors."""
        changed = self.own_span * (value - self.at_first)
        return np.asarray(self._zero**2 + self.read_std**2 + np.outer(changed, changed))

    def of_the_valve(self, time: Array) -> Array:
        """Covariance (blocks, blocks) [Pa^2] of the line at these times (blocks,) [s] by what its valve takes."""
        return form_covariance(time, np.full(time.size, VALVE * self.cracked))

    def with_tank(self, tank: Array, line: Array) -> Array:
        """Covariance (blocks of the tank, blocks of the line) [Pa^2] by errors of the tank's sensor, of blocks of these
        values [Pa]."""
        spanned = self.tank_span**2 * self.at_first * tank
        return np.asarray((self.zero_std**2 + spanned)[:, np.newaxis] * np.ones(line.size))

    @property
    def _zero(self) -> float:
        """Standard deviation of what the tank's sensor errs by at first."""
        return float(np.hypot(self.zero_std, self.tank_span * self.at_first))


def purge_line(
    log: TestLog, segments: Segments, definition: TestDefinition, origin: float, end: float
) -> PurgeLine | None:
    """The purge line up to ``end`` [s after the opening]; None where it does not follow the tank. ``origin`` [s of the
    log]."""
    t_purge = segments.time("t_purge")
    if t_purge is None or not set(ALIKE) <= set(log.channels):
        return None
    start = t_purge + SETTLED
    tank, line = (signal_of(log, name, origin) for name in ALIKE)
    if line.dead or tank.dead or end < start + SHORTEST:
        return None
    accuracy = accuracy_of(definition, ALIKE[0], tank.value)
    fell, tank_fell = (_fall(signal, start, end) for signal in (line, tank))
    if not (tank_fell > CLEAR * accuracy and FOLLOWS[0] * tank_fell < fell < FOLLOWS[1] * tank_fell):
        return None
    at_first, before = tank.between(t_purge - AROUND, t_purge + AROUND), line.between(t_purge - LEVEL, t_purge - AROUND)
    if min(at_first.time.size, before.time.size) < FEWEST:
        return None
    slope, level = np.polyfit(at_first.time - t_purge, at_first.value, 1)
    stood = float(before.value.mean())
    late = slope * segments.std("t_purge")
    noise = np.hypot(_mean_std(line, LEVEL), _mean_std(tank, 2.0 * AROUND))
    return PurgeLine(
        replace(line, value=line.value - (stood - float(level))),
        start,
        t_purge,
        float(level),
        float(np.hypot(late, noise)),
        SPAN_SHARE * accuracy,
        SPAN_SHARE * accuracy / float(np.abs(tank.value).max()),
        SPAN_SHARE * accuracy_of(definition, ALIKE[1], line.value) / stood,
        stood - float(level),
    )


def _mean_std(signal: Signal, seconds: float) -> float:
    """Standard deviation of a mean over so many seconds, by the noise of the quiet time before the opening."""
    noise = wander_of(signal, BLOCK)
    slow = float(noise.covariance(np.zeros(1), seconds)[0, 0])
    return float(np.sqrt(slow + noise.white**2 * BLOCK / seconds))


def _fall(signal: Signal, start: float, end: float) -> float:
    """By how much a signal falls between the first and the last tenth of a stretch."""
    tenth = 0.1 * (end - start)
    return float(signal.mean(start, start + tenth) - signal.mean(end - tenth, end))
