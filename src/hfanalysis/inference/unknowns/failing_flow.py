"""A flow that fails before the liquid is gone, as gas comes in with the last of it.

A vortex, or a bulk that sloshes off the outlet, brings gas into the feed while there is liquid left: chamber pressure
and thrust fall some hundredths of a second before the tank's pressure shows the end of the liquid. While they do, no
blocks are compared: no name could be judged by them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Parameter
from hfanalysis.engine.equations import O_OXIDIZER_FLOW
from hfanalysis.engine.sites import AT_FLOW, INJECTOR_FACTOR, IS_LIQUID, M_LIQUID, switch, term
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.observations.recorded import TOGETHER
from hfanalysis.inference.places import SourcePlace
from hfanalysis.inference.unknown import POINTS, SHAPE, Described, History, Samples, nameless_effect
from hfanalysis.products import diagnosis
from hfanalysis.quantity import Quantity
from hfanalysis.record.signals import Signal
from hfanalysis.sentences import text
from hfanalysis.wording.numbers import said_of

COURSE, LOOKED_AT = 1.5, 0.3
"""Seconds before the end of the liquid over which the course is a straight line, up to where it may begin to fail."""

BIN, CLEAR = 0.01, 0.004
"""Seconds that are averaged, and kept clear of the end of the liquid, beside its own deviation."""

DATED = 2e-3
"""Standard deviation [s] of the end of the liquid up to which something can be said to come before it."""

DURATIONS = np.geomspace(0.02, 0.25, 12)
"""Seconds before the end of the liquid at which the flow may begin to fail."""

LEAST_FALL = 0.04
"""Part of pressure and thrust that is lost at least: a line misses a curved course by less."""

UNEVEN = 0.02
"""Part of itself by which a channel departs from a straight course and a straight fall at any instant."""

LEAST_GAIN = 8.0
"""Log evidence [natural log] from which on a fall is plain."""

HIDDEN = 0.05
"""Seconds before the end of the liquid in which every sample has to be good."""

SHARE, LIQUID = range(2)

SURE = 0.25
"""Standard deviation of what fails, and of the liquid that is then left, relative to what the samples show."""

LARGEST_SHARE = 0.95
"""Part of the flow that fails at most."""

STEADY = 0.05
"""Seconds before the flow fails at which it is still whole."""


@term
def _failing(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    """The flow falls in proportion to the liquid that is left."""
    if hook == AT_FLOW and env[IS_LIQUID] > 0.0 and env[M_LIQUID] < p[LIQUID]:
        site[INJECTOR_FACTOR] *= 1.0 - min(p[SHARE], LARGEST_SHARE) * (1.0 - env[M_LIQUID] / p[LIQUID])


@switch
def _begins(t, env, c, p, x):  # type: ignore[no-untyped-def]
    return env[M_LIQUID] - p[LIQUID]


EFFECT = nameless_effect(
    "failing",
    "injector",
    "a flow that fails before the liquid is gone",
    (
        Parameter("share", "-", "of the flow that has failed when the liquid is gone", 0.1),
        Parameter("liquid", "kg", "left when it begins to fail", 0.1, center=0.1),
    ),
    term=_failing,
    switch=_begins,
)
"""An injector that passes less and less as the last ``liquid`` leaves, by ``share`` at its end."""

SHARE_OF_FLOW, LIQUID_LEFT = (f"{EFFECT.name}.{p.name}" for p in EFFECT.parameters)
"""Names of its parameters in a hypothesis."""


@dataclass(frozen=True)
class FailingFlow(Described):
    """The flow begins to fail ``seconds`` [s] before the end of the liquid at ``t_v`` [s after the opening], when
    chamber pressure and thrust have lost a ``share`` [-] of themselves."""

    t_v: float
    seconds: float
    share: float
    log_evidence: float
    place = SourcePlace("failing flow", "injector", "kg/s", 0.1)
    known_by = "fails_within"

    @classmethod
    def in_samples(cls, samples: Samples) -> FailingFlow | None:
        """How long [s] before the end of the liquid chamber pressure and thrust fall; None where they do not, or it
        does not show."""
        signals, segments = samples.signals, samples.segments
        t_v, gone = segments.time("t_v"), segments.time("t_fuel_gone")
        gone = gone if samples.shown is None else samples.shown
        if t_v is None or segments.std("t_v") > DATED or "p_tank" not in signals or not set(TOGETHER) <= set(signals):
            return None
        if t_v < COURSE + LOOKED_AT or (gone is not None and gone < t_v + LOOKED_AT):
            return None
        time = np.arange(-COURSE, -CLEAR - segments.std("t_v") - BIN, BIN) + 0.5 * BIN
        time -= time[-1] + 0.5 * BIN + CLEAR + segments.std("t_v")
        lost = [_lost(signals[name], t_v, time) for name in TOGETHER]
        if any(part is None for part in lost):
            return None
        together = np.mean([part for part in lost if part is not None], axis=0)
        steady = time < -LOOKED_AT
        noise = float(np.hypot(np.std(together[steady]), UNEVEN))
        gains, shares = np.array([_gain(together, time, seconds, noise) for seconds in DURATIONS]).T
        best = int(np.argmax(gains))
        if gains[best] < LEAST_GAIN or shares[best] < LEAST_FALL or best == DURATIONS.size - 1:
            return None  # a fall that takes longer than all that are tried is a course that blocks show
        return FailingFlow(t_v, float(DURATIONS[best]), float(shares[best]), float(gains[best]))

    @property
    def hides(self) -> float:
        """The time [s] that the flow takes to fail."""
        return self.seconds

    def added_to(self, fitted: Fit) -> tuple[Hypothesis, Array]:
        # what is left behind a ramp of the flow is less than what a whole flow would take along
        liquid = flow_before(fitted, self.t_v, self.seconds) * self.seconds * (1.0 - 0.5 * self.share)
        lost = Free(SHARE_OF_FLOW, self.share, SURE, "positive")
        free = (replace(lost, most=lost.place(LARGEST_SHARE)), Free(LIQUID_LEFT, liquid, SURE, "positive"))
        return fitted.hypothesis.with_active(EFFECT.at(share=self.share, liquid=liquid), free), np.zeros(2)

    def history(self, fitted: Fit, observed: Observed) -> History:
        """What the flow lacks [kg/s] over time [s after the opening] as the last liquid leaves, with points enough for
        it."""
        share, liquid = (fitted.values[name] for name in (SHARE_OF_FLOW, LIQUID_LEFT))
        flow = flow_before(fitted, self.t_v, self.seconds)
        seconds = liquid / (flow * (1.0 - 0.5 * share))
        near = np.linspace(self.t_v - 1.2 * seconds, self.t_v, POINTS // 2)
        time = np.unique(np.r_[near, np.linspace(0.0, observed.last, POINTS // 2)])
        mean = -flow * np.where(time < self.t_v, share * fallen(time - self.t_v, seconds), 0.0)
        relative = np.hypot(fitted.stds[SHARE_OF_FLOW] / share, SHAPE)
        std = seconds * fitted.stds[LIQUID_LEFT] / liquid
        sizes = {"fails_within": Quantity(seconds, "s", std)}
        return History(self.place, time, mean, relative * np.abs(mean), std, sizes)

    @staticmethod
    def words(row: diagnosis.Place, known: Quantity, where: str, unit: str) -> str:
        return text(
            "In the last {within} of the liquid the injector's flow fails, by {lost} on average: chamber pressure and "
            "thrust fall before the tank's shows the end of the liquid, as where gas comes in with it.",
            within=said_of(known, "ms", ".0f", ".0f"),
            lost=said_of(row.source, unit, ".3g", ".2g", -1.0),
        )


def flow_before(fitted: Fit, t_v: float, seconds: float) -> float:
    """The flow [kg/s] of a fit shortly before it begins to fail, ``seconds`` [s] before the end of the liquid at
    ``t_v`` [s after the opening]."""
    gone = fitted.burnt.liquid_out if fitted.burnt.liquid_out is not None else t_v
    outputs = fitted.burnt.steps.at(np.array([max(gone - seconds - STEADY, 0.0)]))[1]
    return max(float(outputs[0, O_OXIDIZER_FLOW]), 1e-6)


def _lost(signal: Signal, t_v: float, time: Array) -> Array | None:
    """Part of itself that a channel has lost at ``time`` (n,) [s after the end of the liquid], by a straight course."""
    still = signal.between(-np.inf, -0.1).value
    if not signal.step < 0.6 * BIN or still.size < 2:
        return None
    read = np.array([signal.mean(t_v + t - 0.5 * BIN, t_v + t + 0.5 * BIN) for t in time])
    good = np.isfinite(read)
    steady = good & (time < -LOOKED_AT)
    if steady.sum() < 0.5 * time.size or not good[time > -HIDDEN].all():
        return None
    course = np.polyval(np.polyfit(time[steady], read[steady], 1), time)
    level = course - float(np.median(still))
    if not level.min() > 0.1 * level.max() > 0.0:
        return None
    return np.where(good, (course - read) / level, 0.0)


def fallen(time: Array, seconds: float) -> Array:
    """What part of a fall of so many ``seconds`` [s] has come about at ``time`` (n,) [s after the end of the liquid];
    (n,) [-].

    >>> fallen(np.array([-0.2, -0.05, 0.0]), seconds=0.1).tolist()
    [0.0, 0.5, 1.0]
    """
    return np.asarray(np.clip(1.0 + time / seconds, 0.0, 1.0))


def _gain(lost: Array, time: Array, seconds: float, noise: float) -> tuple[float, float]:
    """Log evidence of a fall within so many seconds before the end, one among all that are tried; and its size."""
    fall = fallen(time, seconds)
    share = max(float(fall @ lost / (fall @ fall)), 0.0)
    return 0.5 * share**2 * float(fall @ fall) / noise**2 - float(np.log(DURATIONS.size)), share


UNKNOWN = FailingFlow
