"""Every calibrated quantity with its interval and verdict."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import quantities

_CAPTION = "One standard deviation and the 95 % interval: noise, stated accuracies, masses and phase times together."


def render(material: Material) -> Iterator[Block]:
    """The table, and the notes of the calibration."""
    product = material.product("calibration")
    columns = ("quantity", ">value", ">95 % interval", "verdict", "why")
    yield html.table("Calibration", _CAPTION, columns, (_row(*item) for item in quantities(product).items()))
    for note in product.get("notes", []):
        yield html.paragraph(html.switchable(str(note)))


def _row(name: str, quantity: Mapping[str, Any]) -> tuple[Any, ...]:
    why = html.switchable(str(quantity.get("why") or quantity.get("reason") or ""))
    judged = html.verdict(str(quantity.get("verdict") or ""))
    return html.symbol_and_words(name), html.value(quantity, name), html.interval(quantity, name), judged, why


SECTION = Section("Calibration", 70, ("calibration",), render)
