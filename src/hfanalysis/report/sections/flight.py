"""The rocket's flight on the measured thrust."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from markupsafe import Markup

from hfanalysis.report import html
from hfanalysis.report.chart import Chart, Series, around
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.wording import in_words, quantities

_CURVES = {"height": ("Height above ground", "m"), "speed": ("Speed", "m/s"), "acceleration": ("Acceleration", "m/s^2")}
_SIGNS = {"passed": "good", "failed": "bad"}


def render(material: Material) -> Iterator[Block]:
    """The numbers with their bands, the checks, and the way up."""
    product = material.product("flight")
    caption = "One standard deviation and 95 % interval from flights that differ in what is uncertain."
    columns = ("quantity", ">value", ">95 % interval", "remark")
    found = quantities(product) | quantities(product.get("stability") or {})
    yield html.table("Flight", caption, columns, (_row(*item) for item in found.items()))
    yield html.bullets((_check(*item) for item in (product.get("checks") or {}).items()), "plain")
    for name, (title, unit) in _CURVES.items():
        yield _curve(material, name, title, unit)
    for note in product.get("notes", []):
        yield html.paragraph(html.switchable(str(note)))


def _row(name: str, quantity: Mapping[str, Any]) -> tuple[Any, ...]:
    why = html.switchable(str(quantity.get("why") or quantity.get("reason") or ""))
    return in_words(name), html.value(quantity, name), html.interval(quantity, name), why


def _check(name: str, check: Mapping[str, Any]) -> Markup:
    result = str(check.get("result", ""))
    kind = _SIGNS.get(result, "open")
    badge = Markup('<span class="verdict {}"><span aria-hidden="true">{}</span> {}</span>')
    limit = html.amount(check.get("limit"), str(check.get("unit", "")))
    why = Markup(' <span class="because">{}</span>').format(check["why"]) if check.get("why") else Markup()
    words = Markup("{} {}: {} {}{}")
    return words.format(badge.format(kind, html.MARKS[kind], result), in_words(name), check.get("is", ""), limit, why)


def _curve(material: Material, name: str, title: str, unit: str) -> Chart | None:
    ascent, bands = material.table("flight", "ascent"), material.table("flight", "bands")
    if name not in ascent:
        return None
    time, values = ascent["time"].values, ascent[name].values
    series = [Series(name, "p_tank", time, values)]
    if f"{name}_low" in bands:
        low, high = (bands[f"{name}_{side}"].values for side in ("low", "high"))
        series.insert(0, Series("95 % of the flights", "p_tank", bands["time"].values, low, "band", high))
    return Chart(
        f"flight-{name}",
        title,
        name,
        unit,
        tuple(series),
        around([time]),
        x_label="time of flight [s]",
        height=240.0,
        clock="flight",
    )


SECTION = Section("Flight", 78, ("flight",), render)
