"""Every calibrated quantity with its interval and verdict."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import ordered

_CAPTION = (
    "One standard deviation and the 95 % interval. They hold noise, stated accuracies, masses and phase times. They "
    "also hold what is off in every repetition alike: volume, holes, the table of nitrous oxide, the line's content."
)


def render(material: Material) -> Iterator[Block]:
    """The table, and the notes of the calibration."""
    product = material.need(Calibration)
    columns = ("quantity", ">value", ">95 % interval", "verdict", "why")
    rows = (_row(*item, material) for item in ordered(product.quantities).items())
    yield html.table("Calibration", _CAPTION, columns, rows)
    for note in product.notes:
        yield html.paragraph(html.switchable(note))


def _row(name: str, quantity: Quantity, material: Material) -> tuple[Any, ...]:
    number = html.value(quantity, name), html.interval(quantity, name)
    remark = html.remark(quantity, material.reasons)
    return html.symbol_and_words(name), *number, html.verdict(quantity.verdict or ""), remark


SECTION = Section("Calibration", 70, ("calibration",), render, folded=True)
