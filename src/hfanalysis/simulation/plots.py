"""Plots of a simulation and of the parametric study, each one SVG file that stands by itself."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.charts import svg
from hfanalysis.charts.colors import STYLES
from hfanalysis.charts.envelope import Envelope
from hfanalysis.charts.style import sheet
from hfanalysis.simulation.study import FlowPoint, MixturePoint
from hfanalysis.steady_design.steady import SteadyEngine

_ALONE = "svg { font-family: system-ui, sans-serif; background: var(--paper); }"


@dataclass(frozen=True)
class PlottedCurve:
    """A named line; ``style`` picks its color, else it takes the next one."""

    x: Array
    y: Array
    name: str
    style: str = ""


def simulation(table: Mapping[str, Array]) -> Iterator[tuple[str, str]]:
    """File names and plots of a burn; ``table`` holds its histories (n,) by column, named with their units ("time
    [s]")."""
    time = table["time [s]"]

    def curve(column: str, factor: float, name: str) -> PlottedCurve:
        return PlottedCurve(time, table[column] * factor, name)

    pressures = [curve("tank_pressure [Pa]", 1e-5, "tank"), curve("chamber_pressure [Pa]", 1e-5, "chamber")]
    yield "pressures.svg", chart("Pressures", "time [s]", "pressure [bar]", pressures)
    yield "thrust.svg", chart("Thrust", "time [s]", "thrust [kN]", [curve("thrust [N]", 1e-3, "thrust")])


def study(flows: Sequence[FlowPoint], mixtures: Sequence[MixturePoint]) -> Iterator[tuple[str, str]]:
    """File names and plots of the parametric study."""
    fixed = any(point.fixed for point in flows)
    for key, label, factor in (
        ("specific_impulse", "specific impulse [s]", 1.0),
        ("thrust", "thrust [kN]", 1e-3),
        ("exit_radius", "exit radius, expanded to ambient [mm]", 1e3),
    ):
        curves = _by_length(flows, key, factor, fixed and key != "exit_radius")
        title = f"{key.replace('_', ' ').capitalize()} against oxidizer flow and grain length"
        yield f"{key}_flow_length.svg", chart(title, "oxidizer flow [kg/s]", label, curves, with_zero=False)
    if fixed:
        ideal = _by_length(flows, "specific_impulse", 1.0, False)
        title = "Specific impulse expanded to ambient, against oxidizer flow and grain length"
        labels = "oxidizer flow [kg/s]", "specific impulse [s]"
        yield "specific_impulse_ideal_flow_length.svg", chart(title, *labels, ideal, with_zero=False)
    title = "Specific impulse expanded to ambient, against O/F and chamber pressure"
    curves = list(_by_pressure(mixtures))
    yield "specific_impulse_mixture.svg", chart(title, "O/F", "specific impulse [s]", curves, with_zero=False)


def _by_length(flows: Sequence[FlowPoint], key: str, factor: float, fixed: bool) -> list[PlottedCurve]:
    lengths = sorted({point.grain_length for point in flows})
    curves = []
    for length in lengths:
        points = [point for point in flows if point.grain_length == length]
        found = [_value(point.fixed if fixed else point.ideal, key) * factor for point in points]
        x = np.array([point.oxidizer_flow for point in points])
        curves.append(PlottedCurve(x, np.array(found), f"{1e3 * length:.0f} mm"))
    return curves


def _value(engine: SteadyEngine | None, key: str) -> float:
    return float("nan") if engine is None else float(getattr(engine, key))


def _by_pressure(mixtures: Sequence[MixturePoint]) -> Iterator[PlottedCurve]:
    """A curve for each pressure; beside it PROPEP's enthalpy where that is another."""
    for pressure in sorted({point.chamber_pressure for point in mixtures}):
        points = [point for point in mixtures if point.chamber_pressure == pressure]
        x = np.array([point.of_ratio for point in points])
        own = np.array([point.specific_impulse for point in points])
        propep = np.array([point.specific_impulse_propep for point in points])
        yield PlottedCurve(x, own, f"{1e-5 * pressure:.1f} bar")
        if not np.array_equal(own, propep):
            yield PlottedCurve(x, propep, "PROPEP's", "raw")


def chart(title: str, x_label: str, y_label: str, curves: Sequence[PlottedCurve], with_zero: bool = True) -> str:
    """One chart as an SVG document with its own style sheet."""
    xs = np.concatenate([curve.x for curve in curves])
    plot = svg.new_plot((float(xs.min()), float(xs.max())), svg.value_range([c.y for c in curves], with_zero))
    svg.axes(plot, x_label, y_label)
    colors = cycle(STYLES)
    for curve in curves:
        data = Envelope(curve.x, curve.y, curve.y, curve.y)
        svg.line(plot, data, curve.style or next(colors), curve.name)
    drawn = str(svg.render(plot, "chart", title, f"{y_label} over {x_label}"))
    head, body = drawn.split(">", 1)
    return f'{head} xmlns="http://www.w3.org/2000/svg"><style><![CDATA[{sheet()}{_ALONE}]]></style>{body}\n'
