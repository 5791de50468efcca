"""Plots of a simulation and of the parametric study, each one SVG file that stands by itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.charts import svg
from hfanalysis.charts.chart import Chart, Series, around
from hfanalysis.charts.colors import STYLES
from hfanalysis.charts.envelope import Envelope
from hfanalysis.charts.style import alone, ground
from hfanalysis.flight.histories import Flown
from hfanalysis.products.prediction import Prediction
from hfanalysis.simulation.over_temperature import NAMES, OverTemperature
from hfanalysis.simulation.study import FlowPoint, MixturePoint
from hfanalysis.steady_design.steady import SteadyEngine

_FLOW = "oxidizer flow [kg/s]"

BESIDE = "raw"
"""Style of what stands beside a line."""

_DOWN = {"drogue": "under the drogue", "main": "under the main", "ballistic": "without parachutes"}


@dataclass(frozen=True)
class PlottedCurve:
    """A named line, within a band where it has one; ``style`` picks its color, else it takes the next one."""

    x: Array
    y: Array
    name: str
    style: str = ""
    band: tuple[Array, Array] | None = None


def simulation(table: Mapping[str, Array]) -> Iterator[tuple[str, str]]:
    """File names and plots of a burn; ``table`` holds its histories (n,) by column, named with their units ("time
    [s]")."""
    time = table["time [s]"]

    def curve(column: str, factor: float, name: str) -> PlottedCurve:
        return PlottedCurve(time, table[column] * factor, name)

    pressures = [curve("tank_pressure [Pa]", 1e-5, "tank"), curve("chamber_pressure [Pa]", 1e-5, "chamber")]
    yield "pressures.svg", chart("Pressures", "time [s]", "pressure [bar]", pressures)
    yield "thrust.svg", chart("Thrust", "time [s]", "thrust [kN]", [curve("thrust [N]", 1e-3, "thrust")])


def flight(found: Flown) -> Iterator[tuple[str, str]]:
    """File names and plots of a flight to the ground: height, speed, acceleration, and the margin in winds."""
    up, ground = found.ascent, found.launch.vehicle.launch_altitude
    time, legs = up.column("time"), found.legs()
    down = [(leg.time, leg.altitude - ground, leg.speed, _DOWN[name]) for name, leg in legs.items()]
    heights = [PlottedCurve(time, found.height, "ascent"), *(PlottedCurve(t, z, name) for t, z, _, name in down)]
    yield "height.svg", chart("Height above ground", "time [s]", "height [m]", heights)
    speeds = [PlottedCurve(time, up.column("speed"), "ascent"), *(PlottedCurve(t, v, name) for t, _, v, name in down)]
    yield "speed.svg", chart("Speed, falling downwards", "time [s]", "speed [m/s]", speeds)
    felt = [PlottedCurve(time, up.column("acceleration"), "ascent")]
    yield "acceleration.svg", chart("Acceleration on the way up", "time [s]", "acceleration [m/s^2]", felt)
    if not isinstance(found.stable, str):
        margins = [PlottedCurve(one.time, one.mean, f"wind {one.wind:.1f} m/s") for one in found.stable.margins]
        title = "Static margin, mean over gusts"
        yield "margin.svg", chart(title, "time [s]", "margin [calibers]", margins)


def study(flows: Sequence[FlowPoint], mixtures: Sequence[MixturePoint]) -> Iterator[tuple[str, str]]:
    """File names and plots of the parametric study."""
    for one in study_charts(flows, mixtures):
        scale = one.scale()
        label = f"{one.quantity} [{scale.unit}]"
        styles = [line.style if line.style == BESIDE else "" for line in one.series]
        curves = [
            PlottedCurve(line.time, scale.factor * line.values + scale.zero, line.label, style)
            for line, style in zip(one.series, styles, strict=True)
        ]
        yield f"{one.key}.svg", chart(one.title, one.x_label, label, curves, with_zero=False)


def study_charts(flows: Sequence[FlowPoint], mixtures: Sequence[MixturePoint]) -> Iterator[Chart]:
    """The same as charts: the report's figures of section 2.2."""
    fixed = any(point.fixed for point in flows)
    for key, quantity, unit in (
        ("specific_impulse", "specific impulse", "s"),
        ("thrust", "thrust", "N"),
        ("exit_radius", "exit radius, expanded to ambient", "m"),
    ):
        lines = _by_length(flows, key, fixed and key != "exit_radius")
        title = f"{key.replace('_', ' ').capitalize()} against oxidizer flow and grain length"
        yield _across(f"{key}_flow_length", title, (quantity, unit), _FLOW, lines)
    if fixed:
        ideal = _by_length(flows, "specific_impulse", False)
        title = "Specific impulse expanded to ambient, against oxidizer flow and grain length"
        yield _across("specific_impulse_ideal_flow_length", title, ("specific impulse", "s"), _FLOW, ideal)
    title = "Specific impulse expanded to ambient, against O/F and chamber pressure"
    yield _across("specific_impulse_mixture", title, ("specific impulse", "s"), "O/F", list(_by_pressure(mixtures)))


def over_temperature(found: OverTemperature) -> Chart | None:
    """How numbers change with the day, in percent of those at the stated temperature; None where that has none."""
    days, known = found.temperature, [name for name, own in found.stated.items() if np.isfinite(own)]

    def change(name: str, of: Array) -> Array:
        return 100.0 * (of / found.stated[name] - 1.0)

    styles = {name: STYLES[i % len(STYLES)] for i, name in enumerate(found.numbers)}
    lines = [Series(NAMES[name], styles[name], days, change(name, found.numbers[name])) for name in known]
    within = [
        Series(f"{NAMES[name]}, 95 %", styles[name], days, change(name, low), "band", change(name, high))
        for name, (low, high) in found.bands.items()
        if name in known
    ]
    title = "Against the temperature of the tank"
    about, axis = ("change", "%"), "temperature of the tank [degC]"
    return _across("temperature", title, about, axis, [*within, *lines]) if lines else None


def prediction(found: Prediction) -> str | None:
    """What is predicted over the temperature of the tank, in percent of what is at the planned one, with its bands;
    None where there is nothing to draw."""
    days = np.array([float(day) for day in found.over_temperature])
    curves = []
    for name, words in NAMES.items():
        if name == "burn_time":
            continue  # its band is as wide at every temperature, and hides the others
        here, told = found.predicted[name].value, [of[name] for of in found.over_temperature.values()]
        if here is None or all(one.value is None for one in told):
            continue
        low, middle, high = (
            100.0 * (np.array([np.nan if value is None else value for value in values]) / here - 1.0)
            for values in zip(*((one.low, one.value, one.high) for one in told), strict=True)
        )
        curves.append(PlottedCurve(days, middle, words, band=(low, high)))
    title = f"{found.name} against the temperature of the tank, with bands of {100.0 * found.band:.0f} %"
    return chart(title, "temperature of the tank [degC]", "change [%]", curves) if curves else None


def _across(key: str, title: str, about: tuple[str, str], x_label: str, lines: Sequence[Series]) -> Chart:
    drawn = tuple(line for line in lines if line.finite)
    span = around([line.time for line in lines])
    return Chart(key, title, *about, drawn, span, x_label=x_label, with_zero=False, clock=x_label)


def _by_length(flows: Sequence[FlowPoint], key: str, fixed: bool) -> list[Series]:
    lengths = sorted({point.grain_length for point in flows})
    lines = []
    for number, length in enumerate(lengths):
        points = [point for point in flows if point.grain_length == length]
        found = np.array([_value(point.fixed if fixed else point.ideal, key) for point in points])
        x = np.array([point.oxidizer_flow for point in points])
        lines.append(Series(f"{1e3 * length:.0f} mm", STYLES[number % len(STYLES)], x, found))
    return lines


def _value(engine: SteadyEngine | None, key: str) -> float:
    return float("nan") if engine is None else float(getattr(engine, key))


def _by_pressure(mixtures: Sequence[MixturePoint]) -> Iterator[Series]:
    """A curve for each pressure; beside it PROPEP's enthalpy where that is another."""
    for number, pressure in enumerate(sorted({point.chamber_pressure for point in mixtures})):
        points = [point for point in mixtures if point.chamber_pressure == pressure]
        x = np.array([point.of_ratio for point in points])
        own = np.array([point.specific_impulse for point in points])
        propep = np.array([point.specific_impulse_propep for point in points])
        yield Series(f"{1e-5 * pressure:.1f} bar", STYLES[number % len(STYLES)], x, own)
        if not np.array_equal(own, propep):
            yield Series("PROPEP's", BESIDE, x, propep)


def chart(title: str, x_label: str, y_label: str, curves: Sequence[PlottedCurve], with_zero: bool = True) -> str:
    """One chart as an SVG document with its own style sheet."""
    xs = np.concatenate([curve.x for curve in curves])
    ys = [values for curve in curves for values in (curve.y, *(curve.band or ()))]
    span, values = (float(xs.min()), float(xs.max())), svg.value_range(ys, with_zero)
    plot = svg.new_plot(span, values, names=[curve.name for curve in curves])
    svg.axes(plot, x_label, y_label)
    colors = cycle(STYLES)
    for curve in curves:
        data = Envelope(curve.x, curve.y, *(curve.band or (curve.y, curve.y)))
        svg.line(plot, data, curve.style or next(colors), curve.name)
    drawn = str(svg.render(plot, "chart", title, f"{y_label} over {x_label}"))
    head, body = drawn.split(">", 1)
    below = ground(svg.WIDTH, plot.height)
    return f'{head} xmlns="http://www.w3.org/2000/svg"><style><![CDATA[{alone()}]]></style>{below}{body}\n'
