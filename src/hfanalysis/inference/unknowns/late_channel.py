"""A channel that is read late, as by another logger or a filter: an unknown of a sensor's clock.

While the engine starts, thrust rises with the chamber's pressure. No model is needed to see by how much later it does,
to a millisecond, and no effect on the engine makes it late. A chamber pressure that lags behind is something else: it
rises slower, not later, and an effect of the library.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Channels, Parameter
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis
from hfanalysis.inference.fitting.predict import misread
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.places import SourcePlace
from hfanalysis.inference.unknown import SHAPE, Described, History, Samples, nameless_effect
from hfanalysis.products import diagnosis
from hfanalysis.quantity import Quantity
from hfanalysis.record.channels import unit_of
from hfanalysis.sentences import capitalised, text
from hfanalysis.wording.numbers import said_of

CHANNEL = "thrust"
"""The channel that may be late."""

BEFORE, AFTER = 0.05, 0.45
"""Seconds before and after the opening between which thrust is laid over the chamber's pressure."""

LONGEST_DELAY, SHORTEST_DELAY = 0.2, 5e-3
"""The largest delay that is looked for, and the least that is one [s]."""

FINEST_DELAY = 1e-3
"""Seconds between delays that are tried."""

FEWEST = 40
"""Samples of that stretch from which on a delay shows."""

CLEAR = 6.0
"""Times that thrust lies closer to the delayed pressure than to the other. Evidence: a slow rise, or a lag, stays below
6 (tests/inference/unknowns/test_late_channel.py)."""

BLOCK = 0.02
"""Seconds of samples that count as one observation: their noise goes together."""

TYPICAL = 0.03
"""Seconds by which clocks of two loggers typically differ."""

START_UP = 0.1
"""Seconds from the opening in which a late reading is not drawn."""


def _late(times: Array, channels: Channels, values: Mapping[str, float]) -> dict[str, Array]:
    return {**channels, CHANNEL: np.interp(times - values["delay"], times, channels[CHANNEL])}


EFFECT = nameless_effect(
    f"clock_of_{CHANNEL}",
    "sensor",
    f"an unknown delay of {CHANNEL}",
    (Parameter("delay", "s", "by which the channel is read late", TYPICAL),),
    distort=_late,
)
"""A channel that is read ``delay`` seconds late, or early where that is negative."""

DELAY = f"{EFFECT.name}.delay"
"""Its name in a hypothesis."""


@dataclass(frozen=True)
class LateChannel(Described):
    """``seconds`` [s] by which a channel is read later than another."""

    seconds: float
    log_evidence: float
    place = SourcePlace(f"clock of {CHANNEL}", "sensor", "s", TYPICAL, sensor=CHANNEL)
    known_by = "delay"

    @classmethod
    def in_samples(cls, samples: Samples) -> LateChannel | None:
        """By how much [s] thrust is read later than the chamber's pressure; None where it is not, or does not show."""
        signals = samples.signals
        if not {CHANNEL, "p_chamber"} <= set(signals):
            return None
        thrust, chamber = signals[CHANNEL], signals["p_chamber"]
        step = max(thrust.step, chamber.step, FINEST_DELAY)
        time = np.arange(-BEFORE, AFTER, step)
        delays = step * np.arange(round(LONGEST_DELAY / step) + 1)
        if time.size < FEWEST or thrust.between(-BEFORE, AFTER).time.size < FEWEST:
            return None
        read = thrust.at(time)
        apart = np.array([_misfit(read, chamber.at(time - delay)) for delay in delays])
        best = int(np.argmin(apart))
        if not SHORTEST_DELAY <= delays[best] < LONGEST_DELAY - step or apart[0] < CLEAR * apart[best]:
            return None
        closer = apart[0] / max(apart[best], 1e-12 * apart[0])
        return LateChannel(float(delays[best]), 0.5 * (BEFORE + AFTER) / BLOCK * float(np.log(closer)))

    def added_to(self, fitted: Fit) -> tuple[Hypothesis, Array]:
        free, active = Free(DELAY, 0.0, TYPICAL), EFFECT.at(delay=self.seconds)
        return fitted.hypothesis.with_active(active, (free,)), np.array([free.place(self.seconds)])

    def history(self, fitted: Fit, observed: Observed) -> History:
        """What the channel reads too much [SI] over time [s after the opening], but for the start, where the model
        leaps.

        It is late all the time, though that shows where its reading changes; what it lacks at the start is in the mean.
        """
        flowing = ~observed.resting
        time, mean = observed.grid[flowing], misread(observed, fitted.burnt, EFFECT.name)[CHANNEL][flowing]
        unit, drawn = unit_of(CHANNEL), time > START_UP
        sizes = {
            "source": Quantity(float(mean.mean()), unit, SHAPE * abs(float(mean.mean()))),
            "delay": Quantity(fitted.values[DELAY], "s", fitted.stds[DELAY]),
        }
        std = SHAPE * np.abs(mean[drawn])
        place, whole = replace(self.place, unit=unit), (0.0, float(time[-1]))
        return History(place, time[drawn], mean[drawn], std, START_UP, sizes, whole)

    @staticmethod
    def words(row: diagnosis.Place, known: Quantity, where: str, unit: str) -> str:
        return text("{where} is read {delay} late.", where=capitalised(where), delay=said_of(known, "ms"))


def _misfit(thrust: Array, pressure: Array) -> float:
    """Sum of squares of what a straight line from pressure to thrust leaves."""
    design = np.column_stack([np.ones_like(pressure), pressure])
    left = thrust - design @ np.linalg.lstsq(design, thrust, rcond=None)[0]
    return float(left @ left)


UNKNOWN = LateChannel
