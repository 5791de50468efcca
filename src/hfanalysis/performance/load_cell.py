"""What a load cell may be off by over a burn: one model, for peaks, impulses and what is flown.

The true thrust is (reading - zero - drift) times one over the gain. The zero is as good as the tare; the drift is known
where the cell comes to rest, and not how it got there; the gain is as good as its calibration.
"""

from __future__ import annotations

import datetime
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.budget import Input
from hfanalysis.performance.thrust import FIRST, Thrust
from hfanalysis.record.accuracy import SPAN_SHARE, in_place
from hfanalysis.record.log import Channel

ANY_COURSE = 12.0**-0.5
"""Standard deviation of the part of its drift [-] that a cell has gone, at a moment as over the whole burn. Source:
uniform distribution from none to all of it: that of a step at any moment, and between them lies every steady course."""

UNSEEN_DRIFT = 0.01
"""Standard deviation of a drift that no settled level after the burn shows, of the peak thrust [-]."""

GAIN = 0.01
"""Standard deviation of the gain [-] of a cell that was not calibrated in place: beside the cell's own error, lines,
rails and flexures carry a part of the thrust, and no log tells how much. Source: as forces of no stated accuracy
(record.channels.ACCURACY)."""

GAIN_IN_PLACE = 0.0025
"""The same [-] of a cell that was, with known loads through the stand. Source: force standards of class A, against
which cells are calibrated, are good to 0.25 % (ASTM E74)."""

ROWS = {"gain": "load cell: gain", "zero": "load cell: zero", "drift": "load cell: drift"}
"""How its rows of a budget are called."""


@dataclass(frozen=True)
class CellError:
    """Standard deviations: of the ``gain``, relative; of the ``zero`` [N]; at any moment of the ``course`` [N] of a
    drift that is taken off as a straight line; of a drift that is ``left`` in [N], from the opening to the burn's end.
    """

    gain: float
    zero: float
    course: float
    left: float

    def of_impulse(self, impulse: float, duration: float) -> list[Input]:
        """What each does to an ``impulse`` [N s] over a ``duration`` [s]."""
        drift = np.hypot(self.course, 0.5 * self.left) * duration
        return self._inputs(self.gain * impulse, self.zero * duration, drift)

    def at(self, thrust: float, part: float) -> list[Input]:
        """What each does to a ``thrust`` [N] after a ``part`` of the burn [-]."""
        return self._inputs(self.gain * thrust, self.zero, np.hypot(self.course, part * self.left))

    @staticmethod
    def _inputs(gain: float, zero: float, drift: float) -> list[Input]:
        sizes = {"gain": gain, "zero": zero, "drift": float(drift)}
        return [Input(ROWS[name], abs(size)) for name, size in sizes.items()]


def cell_error(
    channel: Channel,
    thrust: Thrust,
    burn: Array,
    calibrated: datetime.date | None = None,
    test: datetime.date | None = None,
) -> CellError:
    """What the cell may be off by.

    Args:
        channel: the cell's.
        thrust: as it was corrected.
        burn: its samples over the burn [N].
        calibrated: when it was calibrated in place.
        test: when the test was.
    """
    peak = float(np.max(np.abs(burn), initial=0.0))
    floor = GAIN_IN_PLACE if in_place(calibrated, test) else GAIN
    own = SPAN_SHARE * _undoubted(channel.accuracy, channel) / peak if peak > 0.0 else 0.0
    zero = _undoubted(channel.accuracy if channel.zero_std is None else channel.zero_std, channel)
    course = max(ANY_COURSE * abs(thrust.error), channel.doubt)
    left = UNSEEN_DRIFT * peak if drift_unseen(thrust) else abs(left_in(thrust))
    return CellError(max(floor, own), zero, course, left)


def drift_unseen(thrust: Thrust) -> bool:
    """Whether no settled level after the burn shows where the cell's zero had gone."""
    return thrust.error == 0.0 and left_in(thrust) == 0.0


def _undoubted(std: float, channel: Channel) -> float:
    """Without what the channel's health doubts: that its zero has moved is what the drift's course is about."""
    return float(np.sqrt(max(std**2 - channel.doubt**2, 0.0)))


def left_in(thrust: Thrust) -> float:
    """What the corrected cell reads [N] with the chamber at ambient pressure; 0 where the log does not show it."""
    if np.isnan(thrust.since):
        return 0.0
    seen = thrust.signal.mean(thrust.since, thrust.since + FIRST)
    return seen if np.isfinite(seen) else 0.0
