"""An unknown source over time, as a fit has it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.naming.places import CLOCK, FAILING, OFFSET, SWING, VALVE, Site, sensor_site, site_of
from hfanalysis.engine.model import O_TANK_PRESSURE, OUTPUTS
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.predict import aligned, misread
from hfanalysis.inference.observations.failing import FailingFlow
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.observations.swinging import Swing
from hfanalysis.inference.unknowns.failing_flow import LIQUID_LEFT, SHARE_OF_FLOW, flow_before, lost_at
from hfanalysis.inference.unknowns.late_channel import delay_name, late
from hfanalysis.inference.unknowns.pulse import START, has_pulse, parameters_of, pulse_in
from hfanalysis.inference.unknowns.slow_valve import SECONDS_OF_VALVE, loss_share
from hfanalysis.inference.unknowns.swing import EDGE, PHASE_OF_SWING, SHARE_OF_SWING, SURE, swing_at
from hfanalysis.quantity import Quantity

Array = NDArray[np.float64]

POINTS, POINTS_A_TURN = 200, 12
"""Instants at which a source is given, and those in a turn of one that swings."""

START_UP = 0.1
"""Seconds from the opening in which a late reading is not drawn."""

FORM = 0.3
"""By how much, relative to itself, the loss of an opening valve may be wrong: each has a characteristic of its own."""

STEP = 1e-3
"""Of x, for the slopes of a pulse."""

FACTOR_OF = {
    "injector_factor": "oxidizer_flow",
    "regression_factor": "fuel_flow",
    "throat_factor": "thrust",
    "thrust_factor": "thrust",
    "temperature_factor": "nozzle_flow",
}
"""What sources that are factors multiply; for the chamber's temperature, the flow in whose enthalpy it is."""

GONE, ONE_SIDED = 0.2, 0.4
"""Part of its largest size below which a source is gone, and goes to one side."""


@dataclass(frozen=True)
class Course:
    """A source over time as a fit has it: ``mean`` and ``std`` at ``time`` [s] in the site's unit.

    ``blur``: the standard deviation of the instants at which it begins and ends [s]. ``sizes``: what else it is known
    by. ``stretch``: from when to when it acts [s], where its size over time does not tell. ``whole``: what it is a
    factor of, or what that goes with, by the unit of its equation.
    """

    site: Site
    time: Array
    mean: Array
    std: Array
    blur: float
    sizes: Mapping[str, Quantity] = field(default_factory=dict)
    stretch: tuple[float, float] | None = None
    whole: Array | None = None

    @property
    def of_equation(self) -> Array:
        """Its mean by the unit of its equation: a tenth of a large flow is more than a tenth of a small one."""
        return self.mean if self.whole is None else self.mean / (1.0 + self.mean) * self.whole

    @property
    def equation(self) -> str:
        """The equation that the source is in.

        What the thrust departs by to one side and is gone, or not seen any more, as the flow ends is the nozzle's: a
        cell that has drifted does not come back at that instant, and gusts blow to and fro.
        """
        if self.site.name != f"{OFFSET}thrust":
            return self.site.equation
        low, high, last = float(self.mean.min()), float(self.mean.max()), abs(float(self.mean[-1]))
        largest, other = max(high, -low), min(max(high, 0.0), max(-low, 0.0))
        gone = last < max(GONE * largest, float(self.std[-1]))
        return "nozzle" if gone and other < ONE_SIDED * largest else self.site.equation


def course_of(found: Fit, name: str, observed: Observed) -> Course:
    """An unknown source as a fit has it; ``name`` is that of its site."""
    site, time = site_of(name, observed), np.linspace(0.0, float(observed.grid[~observed.resting][-1]), POINTS)
    if name.startswith(CLOCK):
        return _course_of_delay(found, site, observed)
    if site == VALVE:
        return _course_of_valve(found, float(time[-1]))
    if site == FAILING:
        return _course_of_failing(found, float(time[-1]), observed)
    if site == SWING:
        return _course_of_swing(found, float(time[-1]), observed)
    if has_pulse(found.hypothesis, name):
        return _course_of_pulse(found, site, time, observed)
    for block, place in found.hypothesis.places():
        if block.names[0].startswith(_prefix(site)):
            basis = block.splines.at(time) @ block.matrix
            covariance = found.covariance[place, place]
            std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", basis, covariance, basis), 0.0))
            whole = _whole(found, site, time, observed)
            return Course(site, time, basis @ found.x[place], std, 0.5 * block.splines.spacing, whole=whole)
    raise ValueError(f"the fit has no source at {name}")


def _course_of_delay(found: Fit, site: Site, observed: Observed) -> Course:
    """What a sensor that is read late reads too much, but for the start, where the model leaps. It is late all the
    time, though that shows where its reading changes; what it lacks at the start is in the mean."""
    assert site.sensor is not None
    name, effect = delay_name(site.sensor), late(site.sensor).name
    flowing = ~observed.resting
    time, mean = observed.grid[flowing], misread(observed, found.burnt, effect)[site.sensor][flowing]
    unit, whole = sensor_site(observed, site.sensor).unit, (0.0, float(time[-1]))
    sizes = {
        "source": Quantity(float(mean.mean()), unit, FORM * abs(float(mean.mean()))),
        "delay": Quantity(found.values[name], "s", found.stds[name]),
    }
    drawn = time > START_UP
    std = FORM * np.abs(mean[drawn])
    return Course(replace(site, unit=unit), time[drawn], mean[drawn], std, START_UP, sizes, whole)


def _course_of_valve(found: Fit, end: float) -> Course:
    """What the valve takes of the pressure while it opens."""
    seconds, std = found.values[SECONDS_OF_VALVE], found.stds[SECONDS_OF_VALVE]
    time = np.unique(np.r_[np.linspace(0.0, 1.5 * seconds, POINTS // 2), np.linspace(0.0, end, POINTS // 2)])
    outputs = found.burnt.steps.at(time)[1]
    loss = outputs[:, O_TANK_PRESSURE] - outputs[:, OUTPUTS.index("run_pressure")]
    mean = loss * loss_share(time, seconds)
    moved = 0.5 * loss * (loss_share(time, seconds + std) - loss_share(time, max(seconds - std, 0.1 * seconds)))
    return Course(
        VALVE, time, mean, np.abs(moved) + FORM * np.abs(mean), std, {"opens_in": Quantity(seconds, "s", std)}
    )


def _course_of_swing(found: Fit, end: float, observed: Observed) -> Course:
    """What the flow swings by, with points enough for its frequency."""
    given = next(plain for plain in observed.plain if isinstance(plain, Swing))
    time = np.linspace(0.0, end, max(POINTS, round(POINTS_A_TURN * given.frequency * end)))
    mean = swing_at(time, found.values, given)
    std = SURE * np.abs(
        swing_at(time, {**found.values, PHASE_OF_SWING: found.values[PHASE_OF_SWING] + 0.5 * np.pi}, given)
    )
    share = Quantity(found.values[SHARE_OF_SWING], SWING.unit, found.stds[SHARE_OF_SWING])
    return Course(SWING, time, mean, std, EDGE, {"source": share, "frequency": Quantity(given.frequency, "Hz")})


def _whole(found: Fit, site: Site, time: Array, observed: Observed) -> Array | None:
    """What a site's source is a factor of, in the fit's run with it."""
    if site.name not in FACTOR_OF:
        return None
    outputs = found.burnt.steps.at(aligned(observed, found.burnt, time))[1]
    return np.asarray(outputs[:, OUTPUTS.index(FACTOR_OF[site.name])])


def _course_of_pulse(found: Fit, site: Site, time: Array, observed: Observed) -> Course:
    names = [f.name for f in found.hypothesis.free]
    own = [names.index(name) for name in parameters_of(site.name)]
    mean = pulse_in(found.hypothesis, found.x, site.name, time)
    slopes = np.empty((time.size, len(own)))
    for column, k in enumerate(own):
        moved = found.x.copy()
        moved[k] += STEP
        slopes[:, column] = (pulse_in(found.hypothesis, moved, site.name, time) - mean) / STEP
    covariance = found.covariance[np.ix_(own, own)]
    std = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", slopes, covariance, slopes), 0.0))
    blur, whole = found.stds[parameters_of(site.name)[START]], _whole(found, site, time, observed)
    return Course(site, time, mean, std, blur, whole=whole)


def _course_of_failing(found: Fit, end: float, observed: Observed) -> Course:
    """What the flow lacks as the last liquid leaves, with points enough for it."""
    given = next(plain for plain in observed.plain if isinstance(plain, FailingFlow))
    share, liquid = (found.values[name] for name in (SHARE_OF_FLOW, LIQUID_LEFT))
    flow = flow_before(found, given.t_v, given.seconds)
    seconds = liquid / (flow * (1.0 - 0.5 * share))
    near = np.linspace(given.t_v - 1.2 * seconds, given.t_v, POINTS // 2)
    time = np.unique(np.r_[near, np.linspace(0.0, end, POINTS // 2)])
    mean = -flow * lost_at(time, given.t_v, seconds, share)
    relative = np.hypot(found.stds[SHARE_OF_FLOW] / share, FORM)
    std = seconds * found.stds[LIQUID_LEFT] / liquid
    return Course(FAILING, time, mean, relative * np.abs(mean), std, {"fails_within": Quantity(seconds, "s", std)})


def _prefix(site: Site) -> str:
    return f"offset_{site.sensor}." if site.sensor is not None else f"probe_{site.name}."
