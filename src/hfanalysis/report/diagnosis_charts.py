"""Charts of a diagnosis: what the model lacks over time, and what is left without and with it."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from hfanalysis.charts.chart import Chart, Series
from hfanalysis.charts.colors import style_of
from hfanalysis.charts.svg import value_range
from hfanalysis.diagnose.answer.words import EQUATIONS, place_sentence
from hfanalysis.products.diagnosis import Diagnosis, Lacking, Place
from hfanalysis.products.validation import Validation
from hfanalysis.record.channels import LONG_NAMES, unit_of
from hfanalysis.report import html
from hfanalysis.report.material import Material, required
from hfanalysis.report.time_charts import broken, lines_of, over_time
from hfanalysis.sentences import capitalised
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
        return f"with {listed([product.plain(row.name) for row in product.effects])}"
    return "" if product.verdict == "none" else "with the source that has no name"


def called(product: Diagnosis, row: Place) -> str:
    """A source in words: the effect that it is, or where it is."""
    name = product.called.get(row.site) or place(row.equation)
    return f"{name} ({LONG_NAMES.get(row.channel, row.channel)})" if row.channel else name


def sources(material: Material, product: Diagnosis) -> Iterator[Chart | None]:
    """What the model lacks over time, for every row of the localisation, in the units of people at a stand."""
    for number, row in enumerate(product.localisation, 1):
        history = row.history
        if history is None:
            continue
        unit, factor = READ.get(history.unit, (history.unit, 1.0))
        columns = (history.time, history.mean, history.low90, history.high90)
        time, mean, low, high = (np.asarray(column, float) for column in columns)
        style = style_of(row.channel) if row.channel else _STYLES.get(row.equation, "other")
        name = called(product, row)
        lines = [
            Series("90 % band", style, time, factor * low, "band", factor * high),
            Series(name, style, time, factor * mean),
        ]
        lines = [broken(material, line) for line in lines]
        said = place_sentence(row, product.compared.end)
        yield over_time(
            material,
            f"diagnosis-source-{number}",
            capitalised(name),
            (name, unit),
            lines,
            f"{said} Fitted together with all constants.",
            height=220.0,
            value_span=value_range([factor * low, factor * high]),
            difference=True,
        )


def channels(material: Material, product: Diagnosis) -> Iterator[Chart | None]:
    """Every channel as measured, by the calibrated model, and by the model with what is missing."""
    if not with_what(product):
        return
    calibrated = "model with what is included" if material.adopted else "model as calibrated"
    for channel in product.compared.channels:
        better = material.table("diagnosis", f"residuals/{channel}")
        if channel not in material.log or "measured" not in better:
            continue
        words, base = LONG_NAMES.get(channel, channel), material.table("residuals", f"full/{channel}")
        lines = list(lines_of(material, material.log[channel], "measured", style_of(channel)))
        if base:
            lines.append(Series(calibrated, "raw", base["time"].values, base["model"].values, dashed=True))
        time, measured, after = (better[name].values for name in ("time", "measured", "after"))
        read = np.interp(time, lines[0].time, lines[0].values) if lines[0].time.size else measured
        # a purge line is compared less what its valve takes: the line is drawn on what the sensor reads
        model = measured - after + np.nanmedian(read - measured)
        lines.append(Series("model with the effects", "model", time, model, dashed=True))
        key = f"diagnosis-channel-{_slug(channel)}"
        axis = (words, better["measured"].unit)
        yield over_time(
            material, key, capitalised(words), axis, lines, misfit(material, product, channel), height=250.0, weight=0.3
        )


def misfit(material: Material, product: Diagnosis, channel: str) -> Markup:
    """How far each model is from a channel, beside its noise."""
    gap, unit = product.gap, unit_of(channel)
    calibrated = _calibrated(material, channel)
    parts = [
        *([("calibrated", calibrated)] if calibrated is not None else []),
        ("refitted", gap.before[channel]),
        ("with the effects", gap.after[channel]),
    ]
    told = Markup(", ").join(Markup("{} ({})").format(html.amount(size, unit, 2, True), name) for name, size in parts)
    return Markup("Misfit {}; noise {}.").format(told, html.amount(gap.noise[channel], unit, 2, True))


def _calibrated(material: Material, channel: str) -> float | None:
    """Root mean square of what the calibrated model leaves over the burn [SI]; None where it did not run."""
    validation = material.get(Validation)
    phases = validation.gap.get("full", {}).get(channel, {}) if validation is not None else {}
    count = sum(found.samples for found in phases.values())
    return float(np.sqrt(sum(f.samples * f.rms**2 for f in phases.values()) / count)) if count else None


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
            Series("refitted without" if better else "model", "other", time, before, dashed=bool(better)),
            Series("zero", "zero", time[[0, -1]], np.zeros(2), "level"),
        ]
        if better:
            lines.insert(2, Series("with the effects", style_of(channel), time, after))
        words = LONG_NAMES.get(channel, channel)
        title, key = f"{words.capitalize()}: what is left", f"diagnosis-left-{_slug(channel)}"
        axis = ("measured − model", table["before"].unit)
        caption = "Dashed: the model refitted alone; solid: with what is missing." if better else ""
        yield over_time(material, key, title, axis, lines, caption, height=220.0, difference=True)


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
