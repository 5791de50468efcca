"""What a hypothesis says the sensors read, and its slopes: one run of the engine, or one with tangents."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf, pi, sqrt

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.equations import RADIUS, STATES
from hfanalysis.engine.observe import distorted, distorted_tangents, true_channels, true_tangents
from hfanalysis.engine.phases import LIQUID_OUT
from hfanalysis.engine.sensitivity import Tangents, run_with_tangents, tangents_of
from hfanalysis.engine.tangents import at_times
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.inference.fitting.fade import abrupt, bounded, fade_misfit, fade_slope
from hfanalysis.inference.fitting.hypothesis import Departures, Hypothesis
from hfanalysis.inference.fitting.laws import LAWS
from hfanalysis.inference.observations.alignment import model_times, share
from hfanalysis.inference.observations.channel import ObservedChannel
from hfanalysis.inference.observations.observed import FADE, Observed
from hfanalysis.inference.observations.recorded import ALIKE
from hfanalysis.inference.splines import Splines

AFTER = 1.0
"""Seconds that a run goes on after the last observation, for its liquid may end later than the measured."""

TICK = 1e-5
"""Seconds over which a channel's speed is a difference: a chamber that empties halves in some milliseconds."""

ACCURACY, FINE = 3e-5, 1e-7
"""Relative tolerances of the runs of a search, and of those that a fit ends by: what the former err by moves the most
probable parameters by up to a tenth of their deviation."""

THROAT_GROWTH = "throat_growth"
"""The own state that a throat's radius after the test tells of."""


@dataclass(frozen=True)
class Prediction:
    """A run of a hypothesis: whitened ``residual`` (observations,), measured less model, and, if asked for, its
    ``slopes`` (observations, parameters) with ``x``.

    ``true``: the channels (grid,) [SI] without any distortion on the common grid, where they are at hand.
    """

    residual: Array
    slopes: Array | None
    burnt: Burn
    true: Mapping[str, Array] | None = None


def predict(
    hypothesis: Hypothesis,
    observed: Observed,
    x: Array,
    tangents: bool,
    only: slice | None = None,
    accuracy: float = ACCURACY,
) -> Prediction:
    """Run a hypothesis at ``x`` (parameters,), in prior standard deviations; residual and slopes are whitened.

    ``only``: slopes with these of its free parameters, which costs the less the fewer they are. Raises ValueError or
    ArithmeticError for an engine that cannot be run.
    """
    engine = with_spare_fuel(hypothesis.as_run(x), observed.fuel_out)
    burnt = burn(engine, observed.longest + AFTER, accuracy, run_on=True, keep_idle=True)
    true = true_readings(observed, burnt)
    there = Prediction(residuals(hypothesis, observed, x, burnt, true), None, burnt, true)
    return with_slopes(hypothesis, observed, x, there, only) if tangents else there


def with_slopes(
    hypothesis: Hypothesis, observed: Observed, x: Array, there: Prediction, only: slice | None = None
) -> Prediction:
    """A prediction that was made at ``x`` (parameters,) with its slopes (observations, parameters), whitened, all of
    them or ``only`` some: the run need not be anew."""
    if only is not None:
        free = hypothesis.free[only]
        found = tangents_of(there.burnt, [f.name for f in free])
        scales = np.array([f.slope(float(v)) for f, v in zip(free, x[only], strict=True)])
        return replace(there, slopes=slopes_of(hypothesis, observed, found, there.true) * scales)
    found = tangents_of(there.burnt, hypothesis.of_run)
    of_engine = slopes_of(hypothesis, observed, found, there.true)
    return replace(there, slopes=all_slopes(hypothesis, observed, of_engine) @ hypothesis.jacobian(x))


def with_spare_fuel(engine: Engine, fuel_out: float | None = None) -> Engine:
    """The same grain with as much web again behind its wall, whose fire is out at ``fuel_out`` [s].

    A model whose fuel is gone earlier than measured would leap to cold gas, and no slope leads out of that. So the end
    of the fuel is that of the measurement, where anything after it is compared; what web is left then is an observation
    of its own.
    """
    return replace(engine, spare_web=engine.outer_radius, fuel_end=inf if fuel_out is None else fuel_out)


def all_slopes(hypothesis: Hypothesis, observed: Observed, of_engine: Array) -> Array:
    """Whitened slopes (observations, parameters) with all parameters [1/SI]: the engine's, those of the sensors'
    sources, and those of its table.

    ``of_engine`` (observations, parameters of a run) [1/SI].
    """
    names, out = hypothesis.of_engine, np.zeros((of_engine.shape[0], hypothesis.size))
    column = {name: i for i, name in enumerate(hypothesis.names)}
    out[:, [column[name] for name in names]] = of_engine[:, : len(names)]
    for block, place in hypothesis.places():
        if block.sensor is not None:
            out[:, place] = sensor_slopes(observed, block.sensor, block.splines)
    if hypothesis.departures is not None:
        out[:, hypothesis.of_departures] = _departure_slopes(observed, hypothesis.engine, hypothesis.departures)
    if hypothesis.runs_laws:
        out[:, hypothesis.of_laws] = of_engine[:, len(names) :] * [law.typical for law in LAWS.parameters]
    if places := hypothesis.of_courses:
        blocks = -observed.whiten(np.concatenate([c.courses for c in observed.channels if c.courses is not None]))
        out[: blocks.shape[0], places] = blocks
    return out


def _departure_slopes(observed: Observed, engine: Engine, departures: Departures) -> Array:
    """Whitened slopes (observations, departures) of the residuals with the departures of the table of nitrous oxide and
    of laws, in their standard deviations; ``engine``: whose grain it is."""
    blocks = np.concatenate([c.averaged(departures.reads[c.name]) for c in observed.channels])
    scalars = np.zeros((len(observed.events) + len(observed.stated), departures.later.size))
    for row, (name, (at, _)) in enumerate(observed.events.items()):
        if name == "t_v":
            scalars[row] = -departures.later / observed.spread(name)
        else:
            scalars[row] = -departures.wider / (observed.spread(name) * _typical_regression(engine, at))
    return np.concatenate([-observed.whiten(blocks), scalars])


def sensor_slopes(observed: Observed, sensor: str, splines: Splines) -> Array:
    """Whitened slopes (observations, coefficients) of the residuals with the coefficients [1/SI] of what is added to a
    sensor's reading."""
    rows = [np.zeros((c.time.size, splines.count)) for c in observed.channels]
    for i, channel in enumerate(observed.channels):
        if channel.name == sensor:
            rows[i] = splines.at(channel.time)
        elif (sensor, channel.name) == ALIKE and observed.line_zero is not None:
            rows[i] = rows[i] + splines.at(np.array([observed.line_zero]))
    return np.concatenate(
        [-observed.whiten(np.concatenate(rows)), np.zeros((len(observed.events) + len(observed.stated), splines.count))]
    )


def residuals(
    hypothesis: Hypothesis, observed: Observed, x: Array, burnt: Burn, true: Mapping[str, Array] | None = None
) -> Array:
    """Whitened measured less model (observations,): the channels one after the other, then the events, then what was
    stated.

    ``x`` (parameters,) in prior standard deviations; ``true``: :func:`true_readings`, if they are at hand.
    """
    read = readings(observed, burnt, true)
    parts = []
    for channel in observed.channels:
        model = channel.averaged(read[channel.name]) + added(hypothesis, observed, x, channel)
        parts.append(channel.value - model)
    raw = np.concatenate(parts)
    scalars = []
    for name, (at, _) in observed.events.items():
        deviation = observed.spread(name)
        if name == "t_v":
            gone = burnt.liquid_out if burnt.liquid_out is not None else 2.0 * observed.end
            if hypothesis.departures is not None:
                gone += float(hypothesis.departures.later @ hypothesis.linear(x))
            scalars.append((at - gone) / deviation)
        else:
            web = hypothesis.engine.outer_radius - port_radius(burnt, at)
            if hypothesis.departures is not None:
                web -= float(hypothesis.departures.wider @ hypothesis.linear(x))
            scalars.append(web / (deviation * _typical_regression(hypothesis.engine, at)))
    for name, (value, deviation) in observed.stated.items():
        if name == FADE:
            scalars.append(bounded(faded(observed, burnt, burnt.steps.engine) / deviation)[0])
        else:
            scalars.append((value - _after(name, burnt, observed)) / deviation)
    return np.concatenate([observed.whiten(raw), np.array(scalars)])


def true_readings(observed: Observed, burnt: Burn) -> dict[str, Array]:
    """The channels (grid,) [SI] of a run on the common grid, without any distortion."""
    return _with_purge_line(true_channels(burnt, aligned(observed, burnt, observed.grid)))


def readings(observed: Observed, burnt: Burn, true: Mapping[str, Array] | None = None) -> dict[str, Array]:
    """What the sensors read (grid,) [SI] on the common grid; ``true``: :func:`true_readings`, if they are at hand."""
    channels = _resting(observed, true_readings(observed, burnt) if true is None else true)
    return _with_its_zero(observed, channels, distorted(channels, observed.grid, burnt.steps.engine.effects))


def misread(observed: Observed, burnt: Burn, name: str) -> dict[str, Array]:
    """What the sensors read too much (grid,) [SI] on the common grid for an effect of theirs, called ``name``, in a
    run."""
    engine = burnt.steps.engine
    others = tuple(a for a in engine.effects if a.effect.name != name)
    without = readings(observed, replace(burnt, steps=replace(burnt.steps, engine=replace(engine, effects=others))))
    return {channel: read - without[channel] for channel, read in readings(observed, burnt).items()}


def _with_purge_line(channels: dict[str, Array]) -> dict[str, Array]:
    """The channels, or their slopes, with a purge line that follows the tank through its check valve."""
    return {**channels, ALIKE[1]: channels[ALIKE[0]]}


def _with_its_zero(observed: Observed, true: Mapping[str, Array], read: dict[str, Array]) -> dict[str, Array]:
    """What is read, or its slopes, with a purge line whose zero was taken of the tank's sensor: what that errs by at
    the time is in it ever after."""
    if observed.line_zero is None:
        return read
    taken = int(np.abs(observed.grid - observed.line_zero).argmin())
    return {**read, ALIKE[1]: read[ALIKE[1]] + (read[ALIKE[0]] - true[ALIKE[0]])[taken]}


def added(hypothesis: Hypothesis, observed: Observed, x: Array, channel: ObservedChannel) -> Array:
    """What unknown sources, and departures of tables and laws, add to a channel's blocks (blocks,) [SI], at ``x``
    (parameters,)."""
    own = hypothesis.offset(channel.name, x, channel.time)
    if hypothesis.departures is not None:
        own = own + channel.averaged(hypothesis.departures.reads[channel.name] @ hypothesis.linear(x))
    if channel.courses is not None and (places := hypothesis.of_courses):
        own = own + channel.courses @ x[places]
    if channel.name != ALIKE[1] or observed.line_zero is None:
        return own
    return own + hypothesis.offset(ALIKE[0], x, np.array([observed.line_zero]))


def _resting(observed: Observed, channels: Mapping[str, Array]) -> dict[str, Array]:
    """The channels, with what is known of them before the opening and after the end of the flow."""
    known = {"p_chamber": observed.ambient, "p_run": observed.ambient, "thrust": 0.0}
    return {n: np.where(observed.resting, known[n], v) if n in known else v for n, v in channels.items()}


def aligned(observed: Observed, burnt: Burn, times: Array) -> Array:
    """Instants of the model that correspond to measured ones, both (n,) [s after the opening].

    They are stretched so that the model's liquid ends when the measured does.
    """
    seen, gone = observed.events.get("t_v"), burnt.liquid_out
    moved = times
    if seen is not None and gone is not None:
        moved = model_times(times, seen[0], gone, observed.fuel_out)
    return np.asarray(np.clip(moved, 0.0, burnt.steps.times[-1, 1]))


def slopes_of(
    hypothesis: Hypothesis, observed: Observed, found: Tangents, true: Mapping[str, Array] | None = None
) -> Array:
    """Whitened derivatives (residuals, parameters) of :func:`residuals` with the parameters of ``found`` [1/SI]."""
    read = _slopes_of_readings(observed, found, true_readings(observed, found.burn) if true is None else true)
    white = -observed.whiten(np.concatenate([c.averaged(read[c.name]) for c in observed.channels]))
    rows = []
    for name, (at, _) in observed.events.items():
        deviation = observed.spread(name)
        if name == "t_v":
            rows.append(-np.nan_to_num(found.event(LIQUID_OUT)) / deviation)
        else:
            unit = deviation * _typical_regression(hypothesis.engine, at)
            rows.append(-found.output("port_radius", np.array([at]))[0] / unit)
    for name, (_, deviation) in observed.stated.items():
        if name == FADE:
            slope = bounded(faded(observed, found.burn, found.burn.steps.engine) / deviation)[1]
            rows.append(slope * _faded_slopes(observed, found) / deviation)
        else:
            rows.append(-_after_slopes(name, found, observed) / deviation)
    return np.concatenate([white, *(row[np.newaxis] for row in rows)])


def signatures(hypothesis: Hypothesis, observed: Observed, x: Array) -> Array:
    """What each effect's strengths add to the blocks of all channels [SI], linear: (blocks, strengths); ``x``
    (parameters,)."""
    engine = with_spare_fuel(hypothesis.as_run(x), observed.fuel_out)
    names = [
        f"{a.effect.name}.{p.name}" for a in engine.effects for p in a.effect.parameters[: a.effect.strengths]
        if f"{a.effect.name}.{p.name}" in hypothesis.of_engine
    ]  # fmt: skip
    found = run_with_tangents(engine, names, observed.longest + AFTER, ACCURACY, run_on=True)
    read = _slopes_of_readings(observed, found, true_readings(observed, found.burn))
    values = hypothesis.values(x)
    size = np.array([values[n] for n in names])
    return np.asarray(np.concatenate([c.averaged(read[c.name]) for c in observed.channels]) * size)


def _slopes_of_readings(observed: Observed, found: Tangents, true: Mapping[str, Array]) -> dict[str, Array]:
    """Slopes (grid, parameters) of what is read at aligned instants, which move with the end of the liquid."""
    times = aligned(observed, found.burn, observed.grid)
    slopes = _with_purge_line(true_tangents(found, times))
    seen = observed.events.get("t_v")
    if seen is not None and found.burn.liquid_out is not None:
        ahead = _with_purge_line(true_channels(found.burn, np.minimum(times + TICK, found.burn.steps.times[-1, 1])))
        moved = share(observed.grid, seen[0], found.burn.liquid_out, observed.fuel_out)
        moment = np.nan_to_num(found.event(LIQUID_OUT))
        for name in slopes:
            speed = (ahead[name] - true[name]) / TICK * moved
            slopes[name] = slopes[name] + speed[:, np.newaxis] * moment[np.newaxis]
    for name in ("p_chamber", "p_run", "thrust"):
        slopes[name] = np.where(observed.resting[:, np.newaxis], 0.0, slopes[name])
    channels = _resting(observed, true)
    effects = found.burn.steps.engine.effects
    read = distorted_tangents(channels, slopes, observed.grid, effects, found.parameters)
    return _with_its_zero(observed, slopes, read)


def port_radius(burnt: Burn, at: float) -> float:
    """Of a run at an instant [s after the opening], in [m]."""
    return float(burnt.steps.at(np.array([at]))[0][0, RADIUS])


def _typical_regression(engine: Engine, burn_time: float) -> float:
    """The web over the burn time [m/s]: what turns an instant's deviation into one of the port's radius."""
    return (engine.outer_radius - engine.port_radius) / burn_time


LAST = 0.5, 0.2
"""Seconds before the end of the fuel between which its regression counts for how fast the fire goes out."""

LEAST_REGRESSION = 1e-5
"""Of it [m/s]: a model's grain may have stopped to burn by then."""


def last_regression(burnt: Burn, gone: float) -> float:
    """The regression shortly before the fuel is ``gone`` [s after the opening], in [m/s]: late in a firing well below
    the mean; where a run ends before that, shortly before its end."""
    earlier, later = LAST
    last = max(min(gone - later, float(burnt.steps.times[-1, 1])), 0.0)
    first = max(last - (earlier - later), 0.0)
    radius = burnt.steps.at(np.array([first, last]))[0][:, RADIUS]
    return max(float(radius[1] - radius[0]) / max(last - first, TICK), LEAST_REGRESSION)


def faded(observed: Observed, burnt: Burn, engine: Engine) -> float:
    """Log of the measured over the time [-] in which the fire of an engine goes out that burns as ``burnt`` until
    then."""
    speed = last_regression(burnt, observed.events["t_fuel_out"][0])
    return fade_misfit(observed.stated[FADE][0], abrupt(observed, engine), engine, speed)


def _faded_slopes(observed: Observed, found: Tangents) -> Array:
    """Slopes of :func:`faded`."""
    engine, speed = found.burn.steps.engine, last_regression(found.burn, observed.events["t_fuel_out"][0])
    at_once = abrupt(observed, engine)
    return np.array([fade_slope(parameter, at_once, engine, speed) for parameter in found.parameters])


def _after(name: str, burnt: Burn, observed: Observed) -> float:
    """What the model says of something that was measured after the test [SI]; the fuel's end closes the comparison."""
    states, _ = burnt.steps.at(np.array([min(observed.flow_end, burnt.steps.times[-1, 1])]))
    engine = burnt.steps.engine
    if name == "fuel_mass_after":
        return float(engine.grain.fuel(states[0, RADIUS]))
    growth = _growth_row(burnt)
    return sqrt(engine.throat_area / pi) + (float(states[0, growth]) if growth is not None else 0.0)


def _growth_row(burnt: Burn) -> int | None:
    """Where the states hold the throat's growth, if an effect brings one."""
    names = [s.name for a in burnt.steps.composition.active for s in a.effect.states]
    return len(STATES) + names.index(THROAT_GROWTH) if THROAT_GROWTH in names else None


def _after_slopes(name: str, found: Tangents, observed: Observed) -> Array:
    """Slopes of :func:`_after`."""
    burnt = found.burn
    at = np.array([min(observed.flow_end, burnt.steps.times[-1, 1])])
    if name == "fuel_mass_after":
        states, _ = burnt.steps.at(at)
        ring = burnt.steps.engine.grain.ring(states[0, RADIUS])
        return np.asarray(-ring * found.output("port_radius", at)[0])
    row = _growth_row(burnt)
    if row is None:
        return np.zeros(len(found.parameters))
    return np.asarray(at_times(at, burnt.steps.times, found.states[:, :, row : row + 1])[0, 0])
