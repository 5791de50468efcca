"""Charts of a diagnosis: what the model lacks over time, and what is left without and with it."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from hfanalysis.charts.chart import Chart, Series, around
from hfanalysis.charts.colors import style_of
from hfanalysis.charts.svg import value_range
from hfanalysis.diagnose.answer.words import EQUATIONS
from hfanalysis.products.diagnosis import Diagnosis, Lacking
from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.report.material import Material, required
from hfanalysis.report.time_charts import over_time
from hfanalysis.wording.numbers import fixed, listed, tidy

READ: dict[str, tuple[str, float]] = {
    "W": ("kW", 1e-3),
    "kg/s": ("g/s", 1e3),
    "m/s": ("mm/s", 1e3),
    "1": ("%", 100.0),
    "bar": ("Pa", 1e5),
    "L": ("m^3", 1e-3),
}
"""Unit of a product: the unit in which a chart takes it, and the factor to it."""

_STYLES = {
    "tank_energy": "p_tank",
    "tank_volume": "m_tank",
    "injector": "p_run",
    "feed": "p_run",
    "grain": "p_purge",
    "chamber_mass": "p_chamber",
    "chamber_energy": "p_chamber",
    "nozzle": "thrust",
}


def place(equation: str) -> str:
    """An equation in words."""
    return EQUATIONS.get(equation, equation.replace("_", " "))


def with_what(product: Diagnosis) -> str:
    """What the better of the two models has that the base model has not; empty where nothing is claimed."""
    if product.effects:
        return f"with {listed([row.name for row in product.effects])}"
    return "" if product.verdict == "none" else "with the unknown source"


def sources(material: Material, product: Diagnosis) -> Iterator[Chart | None]:
    """What the model lacks over time, for every row of the localisation."""
    for number, row in enumerate(product.localisation, 1):
        history = row.history
        if history is None:
            continue
        unit, factor = READ.get(history.unit, (history.unit, 1.0))
        columns = (history.time, history.mean, history.low90, history.high90)
        time, mean, low, high = (np.asarray(column, float) for column in columns)
        style = style_of(row.channel) if row.channel else _STYLES.get(row.equation, "other")
        lines = [
            Series("90 % band", style, time, factor * low, "band", factor * high),
            Series(row.site, style, time, factor * mean),
        ]
        where = place(row.equation) + (f" ({row.channel})" if row.channel else "")
        title = f"What {where} lacks: {row.site}"
        caption = (
            "All calibrated constants were fitted together with it. Gain in log evidence credited to it: "
            f"{tidy(row.significance, 3)}."
        )
        caption += " It stands beside what is named." if row.beside else ""
        axis, key = (row.site.replace("_", " "), unit), f"diagnosis-source-{number}"
        yield over_time(
            material,
            key,
            title,
            axis,
            lines,
            caption,
            span=around([time]),
            height=250.0,
            value_span=value_range([factor * low, factor * high]),
            difference=True,
        )


def residuals(material: Material, product: Diagnosis) -> Iterator[Chart | None]:
    """Measured less model of every channel, without and with what is missing."""
    better = with_what(product)
    for channel in product.compared.channels:
        table = material.table("diagnosis", f"residuals/{channel}")
        if not table:
            continue
        time, before, after, noise = required(table, "time", "before", "after", "noise_std")
        lines = [
            Series("noise, 95 %", "noise", time, -1.96 * noise, "band", 1.96 * noise),
            Series("without" if better else "model", "other", time, before, dashed=bool(better)),
            Series("zero", "zero", time[[0, -1]], np.zeros(2), "level"),
        ]
        if better:
            lines.insert(2, Series("with it", style_of(channel), time, after))
        words = LONG_NAMES.get(channel, channel)
        title, key = f"{words.capitalize()}: what is left", f"diagnosis-left-{_slug(channel)}"
        axis = ("measured − model", table["before"].unit)
        caption = f"Dashed: the model alone; solid: {better}." if better else ""
        yield over_time(material, key, title, axis, lines, caption, span=around([time]), height=220.0, difference=True)


def weak_form(material: Material, product: Diagnosis) -> Iterator[Chart | None]:
    """What each governing equation lacks by itself, from the measured channels alone."""
    for equation, found in product.weak_form.items():
        if found.reason is not None:
            continue
        unit, factor = READ.get(found.unit, (found.unit, 1.0))
        columns = (found.time, found.value, found.low90, found.high90, found.explained)
        time, value, low, high, explained = (np.asarray(column, float) for column in columns)
        style = _STYLES.get(equation, "other")
        lines = [
            Series("90 % band", style, time, factor * low, "band", factor * high),
            Series("lacking", style, time, factor * value),
            Series("zero", "zero", time[[0, -1]], np.zeros(2), "level"),
        ]
        if np.any(explained):
            lines.append(Series("explained", "model", time, factor * explained, dashed=True))
        usual = float(np.median(high - low)) / 2.0
        yield over_time(
            material,
            f"diagnosis-weak-{_slug(equation)}",
            f"Equation by equation: {place(equation)}",
            (place(equation), unit),
            lines,
            _weak_words(found),
            span=around([time]),
            height=200.0,
            value_span=value_range([factor * (value - usual), factor * (value + usual)]),
            difference=True,
        )


def _weak_words(found: Lacking) -> str:
    """Where it is beyond two standard deviations, and how much on average."""
    chi, mean, start, end = found.significance, found.mean, found.t_start, found.t_end
    said = f"Chi-square {tidy(chi.chi_square, 3)} on {chi.degrees_of_freedom} degrees of freedom." if chi else ""
    if mean is None or mean.value is None or start is None or end is None:
        reason = (mean.reason if mean else None) or "nowhere beyond the noise"
        return f"{reason.capitalize()}. {said}"
    unit, factor = {"W": READ["W"], "kg/s": READ["kg/s"]}.get(found.unit, (found.unit, 1.0))
    return (
        f"From {fixed(start.value or 0.0, 1)} to {fixed(end.value or 0.0, 1)} s it lacks "
        f"{tidy(factor * mean.value, 3)} ± {tidy(factor * (mean.std or 0.0), 2)} {unit} on average. {said}"
    )


def _slug(name: str) -> str:
    """A name as part of an address."""
    return re.sub(r"[^a-z0-9]+", "-", str(name).lower()).strip("-")
