"""The injector: the pressure drop across it, and its coefficient over time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from hfanalysis.arrays import Array
from hfanalysis.charts import svg
from hfanalysis.charts.chart import Chart, Series, around
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.material import Material, window
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.time_charts import over_time

_FIRST = 0.1
"""The share of the history, from its start, that does not set the chart's range: the line is still filling."""


def render(material: Material) -> Iterator[Block]:
    """Both charts, where there is what they need, and what reaches the injector."""
    yield _drop(material)
    yield _coefficient(material)
    yield _inlet(material)


def _drop(material: Material) -> Chart | None:
    run, chamber = (material.log.get(name) for name in ("p_run", "p_chamber"))
    if run is None or chamber is None:
        return None
    start, end = window(material)
    time = run.time - material.opening
    part = run.good & (time >= start) & (time <= end)
    good = chamber.good
    if not part.any() or not good.any():
        return None
    behind = np.interp(run.time[part], chamber.time[good], chamber.values[good])
    drop = Series("run line less chamber", "p_run", time[part], run.values[part] - behind)
    caption = "Run line less chamber pressure: what drives the flow, and what keeps the chamber from pushing back."
    title, axis = "Pressure drop across the injector", ("pressure drop", "Pa")
    return over_time(material, "injector-drop", title, axis, [drop], caption)


def _coefficient(material: Material) -> Chart | None:
    calibration = material.get(Calibration)
    history = calibration.C_i_history if calibration is not None else None
    if calibration is None or history is None or len(history.time) < 2:
        return None
    time, value, std = (np.asarray(column, dtype=float) for column in (history.time, history.value, history.std))
    quantity = calibration.C_i
    return over_time(
        material,
        "injector-coefficient",
        "Injector coefficient over time",
        ("injector coefficient C_i", ""),
        list(_series(time, value, std, quantity)),
        _caption(quantity),
        span=around([time]),
        height=260.0,
        value_span=_range(time, value),
    )


def _inlet(material: Material) -> Markup | None:
    """The state before the injector, and its discharge coefficient by laws that know of it."""
    calibration = material.get(Calibration)
    if calibration is None or calibration.inlet is None:
        return None
    rows = [
        (html.symbol_and_words(name), html.value(q, name), html.interval(q, name), html.judged(q, material.reasons))
        for name, q in (calibration.inlet.quantities | dict(calibration.C_d)).items()
    ]
    table = html.table("What reaches the injector", _INLET, ("quantity", ">value", ">95 % interval", "how"), rows)
    fold = '<details class="more"><summary><h3>What reaches the injector</h3></summary>{}</details>'
    return Markup(fold).format(table)


_INLET = (
    "The liquid boils on its way through the line. C_i is on the density of the tank's liquid, an effective "
    "coefficient: a small one does not say that the injector is poor."
)


def _series(time: Array, value: Array, std: Array, quantity: Quantity) -> Iterator[Series]:
    yield Series("95 % interval", "C_i", time, value - 1.96 * std, "band", value + 1.96 * std)
    yield Series("C_i(t)", "C_i", time, value)
    if quantity.value is not None:
        level = np.full(2, quantity.value)
        yield Series("calibrated", "C_i", time[[0, -1]], level, "level")


def _caption(quantity: Quantity) -> Markup:
    words = Markup("Each instant taken for itself, with its 95 % interval.")
    if quantity.value is not None:
        words += Markup(" Dashed: the calibrated C_i = {}.").format(html.value(quantity))
    return words + Markup(" A coefficient that drifts says that the model lacks something.")


def _range(time: Array, value: Array) -> tuple[float, float]:
    settled = np.isfinite(value) & (time > time[0] + _FIRST * (time[-1] - time[0]))
    limits = np.nanpercentile(value[settled] if settled.any() else value, [1, 99])
    low, high = svg.value_range([np.asarray(limits)], with_zero=False)
    air = 0.5 * (high - low)
    return max(0.0, low - air), high + air


SECTION = Section("Injector", 35, (), render)
