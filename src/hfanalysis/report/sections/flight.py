"""The rocket's flight on the measured thrust, and its static margin in winds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from markupsafe import Markup

from hfanalysis.products.flight import Check, Flight
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.flight_charts import CURVES, WAYS_DOWN, FlightCurves, without_margin
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import in_words, ordered

_SIGNS = {"passed": "good", "failed": "bad"}


def render(material: Material) -> Iterator[Block]:
    """The numbers with their bands, the checks, the way up, and the margin."""
    product = material.need(Flight)
    caption = html.switchable(
        f"Thrust {product.thrust_basis}, {product.thrust}. One standard deviation and 95 % interval from flights that "
        f"differ in what is uncertain. That is {product.band_covers}."
    )
    columns = ("quantity", ">value", ">95 % interval", "remark")
    found = ordered(product.flown) | ordered(product.stability.quantities)
    yield html.table("Flight", caption, columns, (_row(*item, material) for item in found.items()))
    yield html.bullets((_check(*item) for item in product.checks.items()), "plain")
    curves = _curves(material)
    for name in CURVES:
        yield curves.curve(name)
    yield curves.margin(product.stability) or without_margin(product.stability, "test.toml")
    for note in product.notes:
        yield html.paragraph(html.switchable(note))


def _row(name: str, quantity: Quantity, material: Material) -> tuple[Any, ...]:
    remark = html.judged(quantity, material.reasons)
    return in_words(name), html.value(quantity, name), html.interval(quantity, name), remark


def _check(name: str, check: Check) -> Markup:
    kind = _SIGNS.get(check.result, "open")
    badge = Markup('<span class="verdict {}"><span aria-hidden="true">{}</span> {}</span>')
    limit = html.amount(check.limit, check.unit)
    why = Markup(' <span class="because">{}</span>').format(check.why) if check.why else Markup()
    words = Markup("{} {}: {} {}{}")
    return words.format(badge.format(kind, html.MARKS[kind], check.result), in_words(name), check.side, limit, why)


def _curves(material: Material) -> FlightCurves:
    product = material.need(Flight)
    check = product.checks.get("rail_departure_velocity")
    names = ("ascent", "bands", *WAYS_DOWN, *(f"stability/{i}" for i in range(len(product.stability.winds))))
    groups = {name: {key: of.values for key, of in material.table("flight", name).items()} for name in names}
    departure, burn = product.rail_departure_velocity.value, product.burn_time.value
    return FlightCurves(groups, departure, burn, check.limit if check else None)


SECTION = Section("Flight", 78, ("flight",), render, folded=True)
