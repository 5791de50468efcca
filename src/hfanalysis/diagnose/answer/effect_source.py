"""What a named effect does, as a source over time in the governing equation that it enters.

It is the difference that the effect makes at the state the engine is in, not between two runs: a kilowatt into the tank
is a kilowatt, whatever the tank's pressure does in consequence.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import cumulative_trapezoid

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Active, Effect, compose
from hfanalysis.engine.equations import OUTPUTS, STATES, evaluate_rates
from hfanalysis.engine.sites import SITES
from hfanalysis.engine.unsteady import Engine, burn, constants
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.predict import aligned, last_regression, misread, with_spare_fuel
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknown import has_name
from hfanalysis.record.channels import unit_of

POINTS = 120
"""Instants at which a source is given."""

SHAPE_ERROR = 0.25
"""By how much, relative to itself, a source may be wrong where the effect has another shape than its closure. Evidence:
as of LEAST_ERROR."""

LEAST_ERROR = 0.05
"""The least deviation of a source, relative to its largest value. Evidence: chosen on the calibration split, as
SHAPE_ERROR is; `python -m benchmarks.blind table --split calibration` prints how many sources the bands cover."""

SLOPE_STEP = 0.02
"""Of x, in prior standard deviations, for the slopes of a source."""

FADE_ERROR, FLOW_ERROR = 0.5, 0.2
"""By how much the flow of fading fuel may be wrong, relative to itself and to the flow before."""

BRIEFEST_FADE = 0.01
"""Seconds of the shortest fade that is drawn."""

UNITS = {
    "tank_energy": "W",
    "tank_volume": "kg/s",
    "injector": "kg/s",
    "feed": "Pa",
    "grain": "kg/s",
    "chamber_mass": "kg/s",
    "chamber_energy": "W",
    "nozzle": "N",
}
"""Units in which the sources of the governing equations are given."""


@dataclass(frozen=True)
class Acting:
    """A source at ``time`` [s] in an equation: ``mean`` and ``std`` in ``unit``; the sensor's ``channel`` if in one.
    Arrays (n,)."""

    equation: str
    unit: str
    time: Array
    mean: Array
    std: Array
    channel: str | None = None


def acting_in(found: Fit) -> dict[str, Active]:
    """The effects of a fit by their names, without unknown sources."""
    acting = found.burnt.steps.engine.effects
    return {active.effect.name: active for active in acting if has_name(active.effect)}


def acting(found: Fit, name: str, observed: Observed) -> Acting:
    """The source over time [s after the opening] that an effect of a fit is, in the unit of its equation (UNITS).

    Its band holds what is uncertain of all constants of the fit, at the states of its run, and of the effect's shape.
    """
    active = acting_in(found)[name]
    time = np.linspace(0.0, observed.last, POINTS)
    if active.effect.of_sensor:
        return _sensor(found, active, observed)
    if active.effect.fading_web is not None and "t_fuel_out" in observed.events:
        return _fading(found, active, observed, time)
    course = Course.of(found, observed, time)
    mean = course.source(active.effect, found.x)
    slopes = np.column_stack([course.slope(active.effect, k, mean) for k in range(found.x.size)])
    std = np.sqrt(np.maximum(np.einsum("ti,ij,tj->t", slopes, found.covariance, slopes), 0.0))
    if active.effect.fading_web is not None:
        mean = course.beside_a_sudden_end(mean)
        std = np.hypot(std, FADE_ERROR * np.abs(mean))
    return Acting(active.effect.equation, unit_of_source(active.effect), time, mean, _with_shape(mean, std))


def unit_of_source(effect: Effect) -> str:
    """The unit of the source that an effect is; of a sensor's that of the channel that it is of, "" where it may be of
    several."""
    if effect.of_sensor:
        return unit_of(effect.sites[0]) if len(effect.sites) == 1 else ""
    return "Pa" if effect.sites == ("tank_pressure",) else UNITS[effect.equation]


def _with_shape(mean: Array, std: Array) -> Array:
    """A source's deviation with that of its shape."""
    size = np.abs(mean)
    return np.asarray(np.sqrt(std**2 + (SHAPE_ERROR * size) ** 2 + (LEAST_ERROR * float(size.max())) ** 2))


def _relative(found: Fit, effect: Effect) -> float:
    """Standard deviation of the strength, relative to it."""
    names = [f"{effect.name}.{p.name}" for p in effect.parameters[: effect.strengths]]
    values, stds = found.values, found.stds
    main = max(names, key=lambda n: abs(values[n]) / max(stds[n], 1e-300))
    return stds[main] / max(abs(values[main]), 1e-300)


def _sensor(found: Fit, active: Active, observed: Observed) -> Acting:
    """What a sensor reads too much, on the channel that it distorts most."""
    misled = misread(observed, found.burnt, active.effect.name)
    extra = {n: misled[n] for n in observed.names}
    noise = {c.name: float(np.median(c.noise_std)) for c in observed.channels}
    channel = max(extra, key=lambda n: float(np.abs(extra[n]).max()) / noise[n])
    burning = ~observed.resting
    mean = extra[channel][burning]
    std = _relative(found, active.effect) * np.abs(mean)
    return Acting("sensor", unit_of(channel), observed.grid[burning], mean, _with_shape(mean, std), channel)


def _fading(found: Fit, active: Active, observed: Observed, time: Array) -> Acting:
    """The fuel flow beside that of a fire which is out at once where the measured fuel ends, and burns as much.

    In a run the fuel lasts up to that instant whatever its surface does; how it fades goes by the time that it takes.
    """
    gone = observed.events["t_fuel_out"][0]
    share, speed = min(active.values[0], 1.0), last_regression(found.burnt, gone)
    assert active.effect.fading_web is not None
    seconds = min(max(active.effect.fading_web(active.named) / speed, BRIEFEST_FADE), gone)  # no longer than it burnt
    first, last = gone - (1.0 - 0.5 * share) * seconds, gone + 0.5 * share * seconds
    time = np.unique(np.r_[time, np.linspace(first, last, POINTS // 2), gone - 1e-6])
    before = aligned(observed, found.burnt, np.array([max(first, 0.0)]))
    flow = float(found.burnt.steps.at(before)[1][0, OUTPUTS.index("fuel_flow")])
    left = 1.0 - share * (time - first) / seconds
    mean = flow * np.where((time < first) | (time > last), 0.0, np.where(time < gone, left - 1.0, left))
    near = np.abs(time - gone) < seconds
    std = np.hypot(FADE_ERROR * np.abs(mean), FLOW_ERROR * flow * near)
    return Acting(active.effect.equation, UNITS[active.effect.equation], time, mean, _with_shape(mean, std))


@dataclass(frozen=True)
class Course:
    """The states of a fit's run at the instants at which its sources are asked for."""

    found: Fit
    fuel_out: float | None
    where: Array
    states: Array
    outputs: Array
    liquid_out: float | None

    @classmethod
    def of(cls, found: Fit, observed: Observed, time: Array) -> Course:
        engine = with_spare_fuel(found.hypothesis.at(found.x), observed.fuel_out)
        burnt = burn(engine, observed.longest + 1.0, run_on=True, keep_idle=True)
        where = aligned(observed, burnt, time)
        return cls(found, observed.fuel_out, where, *burnt.steps.at(where), burnt.liquid_out)

    def beside_a_sudden_end(self, mean: Array) -> Array:
        """The fuel flow beside that of a fire which is out at once when it has burnt all of the fuel, where ``mean`` is
        that beside one which does not end: from then on all of it is too much."""
        flow = self.outputs[:, OUTPUTS.index("fuel_flow")]
        burnt = cumulative_trapezoid(flow - mean, self.where, initial=0.0)
        return np.where(burnt < self.found.hypothesis.at(self.found.x).fuel_mass, mean, flow)

    def source(self, effect: Effect, x: Array) -> Array:
        """What the effect changes in its equation at each state, with the constants that ``x`` stands for."""
        engine = with_spare_fuel(self.found.hypothesis.at(x), self.fuel_out)
        other = replace(engine, effects=tuple(a for a in engine.effects if a.effect.name != effect.name))
        with_it, without = (Evaluation.of(e) for e in (engine, other))
        rows = _own_rows(with_it, effect)
        out = np.empty(self.where.size)
        for i, t in enumerate(self.where):
            liquid = self.liquid_out is None or t <= self.liquid_out
            burning = bool(t <= engine.fuel_end)
            there = with_it.at(t, self.states[i], liquid, burning)
            out[i] = _source(effect, there, without.at(t, np.delete(self.states[i], rows), liquid, burning))
        return out

    def environments(self, engine: Engine) -> Array:
        """What terms read (n, ENVIRONMENT) [SI] in an engine at each state."""
        one = Evaluation.of(with_spare_fuel(engine, self.fuel_out))
        rows = []
        for i, t in enumerate(self.where):
            liquid = self.liquid_out is None or t <= self.liquid_out
            rows.append(one.at(t, self.states[i], liquid, bool(t <= engine.fuel_end)).environment)
        return np.array(rows)

    def slope(self, effect: Effect, number: int, here: Array) -> Array:
        """Of the source with one of the fit's x, by a difference that stays within bounds."""
        step = np.zeros(self.found.x.size)
        inside = self.found.x[number] + SLOPE_STEP <= self.found.hypothesis.bounds[1][number]
        step[number] = SLOPE_STEP if inside else -SLOPE_STEP
        return np.asarray((self.source(effect, self.found.x + step) - here) / step[number])


def _own_rows(evaluation: Evaluation, effect: Effect) -> list[int]:
    """Where the effect's own states are among all."""
    at, rows = len(STATES), []
    for a in evaluation.active:
        for _ in a.effect.states:
            if a.effect.name == effect.name:
                rows.append(at)
            at += 1
    return rows


@dataclass(frozen=True)
class State:
    """OUTPUTS, SITES and ENVIRONMENT at one state."""

    outputs: Array
    sites: Array
    environment: Array

    def output(self, name: str) -> float:
        return float(self.outputs[OUTPUTS.index(name)])

    def site(self, name: str) -> float:
        return float(self.sites[SITES.index(name)])


class Evaluation:
    """The rates of an engine, state by state."""

    def __init__(self, equations, active) -> None:  # type: ignore[no-untyped-def]
        self.equations, self.active = equations, active

    @classmethod
    def of(cls, engine) -> Evaluation:  # type: ignore[no-untyped-def]
        composition = compose(engine.effects, constants(engine), len(STATES), idle=True)
        return cls(engine.equations(composition), composition.active)

    def at(self, t: float, y: Array, liquid: bool, burning: bool) -> State:
        out = np.zeros(len(OUTPUTS))
        evaluate_rates(t, np.ascontiguousarray(y), liquid, burning, self.equations, np.zeros(y.size), out)
        return State(out, self.equations.site.copy(), self.equations.env.copy())


def _source(effect: Effect, with_it: State, without: State) -> float:
    """The difference in the unit of the effect's equation."""
    equation, sites = effect.equation, effect.sites
    if sites == ("tank_pressure",):
        return with_it.site("tank_pressure") - without.site("tank_pressure")
    if equation == "tank_energy":
        return with_it.site("tank_heat") - without.site("tank_heat")
    if equation == "tank_volume":
        return with_it.site("nitrogen_inflow") - without.site("nitrogen_inflow")
    if equation == "feed":
        return without.output("run_pressure") - with_it.output("run_pressure")
    if equation == "grain":
        return with_it.output("fuel_flow") - without.output("fuel_flow")
    if equation == "chamber_mass":
        sources = ("fuel_source", "oxidizer_source")
        return sum(with_it.site(s) - without.site(s) for s in sources)
    if equation == "chamber_energy":
        gamma = without.output("gamma")
        heat = gamma / (gamma - 1.0) * without.output("nozzle_flow")
        return heat * (with_it.output("chamber_temperature_by_mass") - without.output("chamber_temperature_by_mass"))
    if equation == "nozzle":
        return with_it.output("thrust") - without.output("thrust")
    return with_it.output("oxidizer_flow") - without.output("oxidizer_flow")
