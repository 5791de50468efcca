"""C_i over time: whether it takes a course, how fast it drifts, and what that is worth in the one number told of it.

The balance gives the mean of C_i weighted by flow. Where C_i drifts, that is not its mean over time; the difference is
an error of the one number. Where it only scatters by more than its errors, these are too small, all by one factor
(Birge 1932).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.products.calibration import CoefficientHistory
from hfanalysis.quantity import NORMAL_95, Quantity

INDEPENDENT = 0.5
"""Of the values of a history, the part that tells something new: windows overlap by half. Source: definition."""

LEAST_VALUES = 6
"""Values below which neither a course nor a scatter is told."""


@dataclass(frozen=True)
class Course:
    """A straight line through C_i(t): ``drift`` [1/s] and its standard deviation, chi-square about mean and line."""

    drift: float
    std: float
    middle: float
    about_mean: float
    about_line: float
    freedom: int

    @classmethod
    def of(cls, history: CoefficientHistory | None) -> Course | None:
        """None where the history has too few values."""
        if history is None or len(history.time) < LEAST_VALUES:
            return None
        time, value, std = (np.array(x) for x in (history.time, history.value, history.std))
        if not (std > 0.0).all():  # rounded to nothing: a C_i of a hole as large as the tank
            return None
        weight = 1.0 / std**2
        middle = float(weight @ time / weight.sum())
        x, level = time - middle, float(weight @ value / weight.sum())
        information = float(weight @ x**2)
        drift = float(weight @ (x * (value - level))) / information
        about_mean, about_line = (float(weight @ (value - level - s * x) ** 2) for s in (0.0, drift))
        freedom = time.size - 2
        scatter = max(about_line / freedom, 1.0) / INDEPENDENT
        return cls(drift, float(np.sqrt(scatter / information)), middle, about_mean, about_line, freedom)

    @property
    def seen(self) -> bool:
        """Whether it drifts by more than its scatter lets it."""
        return abs(self.drift) > NORMAL_95 * self.std

    @property
    def scatter(self) -> float:
        """Birge's factor [-] on errors of values that scatter by more."""
        return float(np.sqrt(max(self.about_mean / (self.freedom + 1), 1.0)))

    def in_mean(self, time: Array, flow: Array) -> float:
        """Mean by ``flow`` (n,) less that over ``time`` (n,) [s] of a C_i that drifts so [-]."""
        by_flow = float(np.trapezoid(flow * time, time) / np.trapezoid(flow, time))
        return self.drift * (by_flow - 0.5 * float(time[0] + time[-1]))

    def quantity(self) -> Quantity:
        """The drift [1/s], with the chi-squares that tell of it."""
        why = (
            f"chi-square {self.about_mean:.0f} about a constant and {self.about_line:.0f} about a straight line, "
            f"for {self.freedom + 1} and {self.freedom}"
        )
        return Quantity(self.drift, "1/s", self.std, why=why)


def with_drift(history: CoefficientHistory) -> CoefficientHistory:
    """The history with its drift, where it has values enough."""
    course = Course.of(history)
    return history if course is None else history.but(drift=course.quantity())


def with_course(
    discharge: Quantity, record: float, history: CoefficientHistory | None, time: Array, flow: Array
) -> Quantity:
    """C_i with what its course is worth; ``record``: its standard deviation [-] by pressures and times.

    ``flow`` (n,) through the injector at ``time`` (n,) [s] of the liquid phase.
    """
    course = Course.of(history)
    if course is None or discharge.value is None or discharge.interval is None or not discharge.std:
        return discharge
    if course.seen:
        more = abs(course.in_mean(time, flow))
        drift = f"C_i(t) drifts by {course.drift:+.3f} /s"
        said = f"mean by flow; {drift}, which is worth {more:.4f} in its mean (C_i_history)"
    else:
        more = record * float(np.sqrt(course.scatter**2 - 1.0))
        said = f"its errors by the pressures are taken {course.scatter:.1f} times: C_i(t) scatters, without a course"
    if not more > 0.0:
        return discharge
    wider = float(np.hypot(discharge.std, more)) / discharge.std
    value = discharge.value
    low, high = (value + wider * (end - value) for end in discharge.interval)
    why = f"{discharge.why}; {said}" if discharge.why else said
    return Quantity(value, discharge.unit, discharge.std * wider, (low, high), verdict=discharge.verdict, why=why)
