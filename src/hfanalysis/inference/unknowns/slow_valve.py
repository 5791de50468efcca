"""A valve that takes its time to open, where the model's opens at once. The run line's pressure tells, without a model.

Behind a valve that opens at once it leaps to what the flow leaves of the tank's, or nearly so, and creeps up with the
chamber's pressure, or as the line fills. Behind one that takes its time it comes up gradually from the beginning.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Parameter
from hfanalysis.engine.equations import O_TANK_PRESSURE, OUTPUTS
from hfanalysis.engine.sites import AT_FLOW, FEED_FACTOR, switch, term
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.places import SourcePlace
from hfanalysis.inference.unknown import POINTS, SHAPE, Described, History, Samples, nameless_effect
from hfanalysis.products import diagnosis
from hfanalysis.quantity import Quantity
from hfanalysis.sentences import text
from hfanalysis.wording.numbers import said_of

BEFORE, AFTER = 0.15, 0.6
"""Seconds before and after the opening between which the run line's pressure is looked at."""

FINEST_SAMPLE = 1e-3
"""Seconds between samples that are looked at."""

GRADUAL = 3
"""Samples that the first part of the rise (EARLY) takes at least where it is gradual: a leap takes one or two."""

EARLY = 0.05, 0.2
"""Parts of the rise between which it tells a gradual opening. Evidence: a line that fills begins with its steepest rise
(tests/inference/unknowns/test_slow_valve.py)."""

NEARLY = 0.95
"""Part of the rise at which the valve counts as open."""

NOISE = 0.01
"""Of the rise: noise of a sample above which nothing can be told."""

SLOW_LOG = 5e-3
"""Seconds between samples above which nothing can be told."""

AROUND = 0.02
"""Seconds before and after the rise that are compared with a leap and with a gradual one."""

BLOCK = 2e-3
"""Seconds of samples that count as one observation."""

SECONDS = 0

JAR = 0.03
"""Part of its way that a valve is open at least: flow and pressure need a beginning."""

SURE = 0.3
"""Standard deviation of the log of the seconds: where the rise begins and ends is a matter of definition."""


@term
def _opening(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    """The loss of a valve whose free area grows in proportion to time, and is all of the line's when it is open."""
    if hook == AT_FLOW and t < p[SECONDS]:
        share = max(t / p[SECONDS], JAR)
        site[FEED_FACTOR] += 1.0 / (share * share) - 1.0


@switch
def _open(t, env, c, p, x):  # type: ignore[no-untyped-def]
    return t - p[SECONDS]


EFFECT = nameless_effect(
    "valve",
    "feed",
    "a valve that opens slowly",
    (Parameter("seconds", "s", "until it is open", 0.1, center=0.1),),
    term=_opening,
    switch=_open,
)
"""A valve that is open after ``seconds``."""

PARAMETER = f"{EFFECT.name}.seconds"
"""Their name in a hypothesis."""


@dataclass(frozen=True)
class SlowValve(Described):
    """``seconds`` [s] from the first rise of the run line's pressure until the valve is open."""

    seconds: float
    log_evidence: float
    place = SourcePlace("valve", "feed", "Pa", 1e5)
    known_by = "opens_in"
    also_by = "feed_line_fill"

    @classmethod
    def in_samples(cls, samples: Samples) -> SlowValve | None:
        """How long [s] the valve takes; None where it opens at once, or where that does not show."""
        signals = samples.signals
        if "p_run" not in signals or not signals["p_run"].step <= SLOW_LOG:
            return None
        line = signals["p_run"]
        step = max(line.step, FINEST_SAMPLE)
        time = np.arange(-BEFORE, AFTER, step)
        still, open_ = line.between(-5.0 * BEFORE, -BEFORE).value, line.between(0.7 * AFTER, AFTER).value
        if min(still.size, open_.size) < GRADUAL:
            return None
        closed, level = float(np.median(still)), float(np.median(open_))
        if not line.noise < NOISE * (level - closed):
            return None
        risen = np.maximum.accumulate(median_filter((line.at(time) - closed) / (level - closed), 3, mode="nearest"))
        first, second, last = (float(time[int(np.argmax(risen >= part))]) for part in (*EARLY, NEARLY))
        if second - first < (GRADUAL - 0.5) * step or line.between(first, second).time.size < GRADUAL - 1:
            return None  # a leap, or one in a hole of the log
        begins = first - EARLY[0] / (EARLY[1] - EARLY[0]) * (second - first)
        near = (time > begins - AROUND) & (time < last + AROUND)
        at_once = min(_misfit(risen[near], time[near] >= instant) for instant in time[near])
        gradually = _misfit(risen[near], np.clip((time[near] - begins) / max(last - begins, step), 0.0, 1.0))
        closer = np.log(at_once / max(gradually, 1e-12 * at_once))
        return SlowValve(last - begins, 0.5 * float(closer) * (last - begins + 2.0 * AROUND) / BLOCK)

    def added_to(self, fitted: Fit) -> tuple[Hypothesis, Array]:
        free = Free(PARAMETER, self.seconds, SURE, "positive")
        return fitted.hypothesis.with_active(EFFECT.at(seconds=self.seconds), (free,)), np.zeros(1)

    def history(self, fitted: Fit, observed: Observed) -> History:
        """What the valve takes of the pressure [Pa] over time [s after the opening] while it opens."""
        seconds, std = fitted.values[PARAMETER], fitted.stds[PARAMETER]
        ends = (1.5 * seconds, observed.last)
        time = np.unique(np.concatenate([np.linspace(0.0, end, POINTS // 2) for end in ends]))
        outputs = fitted.burnt.steps.at(time)[1]
        loss = outputs[:, O_TANK_PRESSURE] - outputs[:, OUTPUTS.index("run_pressure")]
        mean = loss * loss_share(time, seconds)
        moved = 0.5 * loss * (loss_share(time, seconds + std) - loss_share(time, max(seconds - std, 0.1 * seconds)))
        sizes = {"opens_in": Quantity(seconds, "s", std)}
        return History(self.place, time, mean, np.abs(moved) + SHAPE * np.abs(mean), std, sizes)

    @staticmethod
    def words(row: diagnosis.Place, known: Quantity, where: str, unit: str) -> str:
        opens = "The valve takes {opens} to open, by the run line's pressure; the model's opens at once."
        return text(opens, opens=said_of(known, "ms"))


def loss_share(times: Array, seconds: float) -> Array:
    """Part (n,) [-] of the feed's loss that is the valve's at ``times`` (n,) [s after the opening], if it is open after
    ``seconds`` [s].

    Its area grows evenly, and the loss of a flow goes with the square of the area's inverse.

    >>> loss_share(np.array([0.1, 0.2]), seconds=0.2).tolist()
    [0.75, 0.0]
    """
    return np.asarray(1.0 - np.clip(times / seconds, JAR, 1.0) ** 2)


def _misfit(one: Array, other: Array) -> float:
    return float(np.sum((one - other) ** 2))


UNKNOWN = SlowValve
