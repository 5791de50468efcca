"""The performance of the firing: measured, and by the model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from markupsafe import Markup

from hfanalysis.errors import AbsentError
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import MINUS, fixed, in_words, quantities

_CAPTION = "Measured: peaks of the despiked signal, impulse within the burn and free of the cell's drift."


def render(material: Material) -> Iterator[Block]:
    """Measured and model side by side, and whether the masses close."""
    validation = material.product("validation")
    performance = validation.get("performance") or {}
    measured, model = (quantities(performance.get(side) or {}) for side in ("measured", "model"))
    if not (measured or model):
        raise AbsentError("the validation holds no performance table")
    columns = ("quantity", ">measured", ">95 % interval", ">model", ">model − measured", "remark")
    rows = (_row(name, measured.get(name, {}), model.get(name, {})) for name in dict.fromkeys([*measured, *model]))
    yield html.table("Performance", _CAPTION, columns, rows)
    for reason in dict.fromkeys(str(quantity["reason"]) for quantity in model.values() if quantity.get("reason")):
        yield html.paragraph(Markup("No model: {}.").format(html.switchable(reason.rstrip("."))))
    yield _closure(quantities(validation.get("closure") or {}))


def _closure(found: Mapping[str, Mapping[str, Any]]) -> Markup | None:
    rows = [(in_words(name), html.value(q, name), html.switchable(_remark(q))) for name, q in found.items()]
    caption = "Whether masses and energy close."
    return html.table("Closure", caption, ("quantity", ">value", "remark"), rows) if rows else None


def _row(name: str, measured: Mapping[str, Any], model: Mapping[str, Any]) -> tuple[Any, ...]:
    known = measured.get("value") is not None
    return (
        in_words(name),
        _cell(measured, name),
        html.interval(measured, name) if known else "",
        _cell(model, name),
        _share(measured.get("value"), model.get("value")),
        html.switchable(_remark(measured)),
    )


def _cell(quantity: Mapping[str, Any], name: str) -> Markup:
    return html.value(quantity, name) if quantity else Markup("–")


def _share(measured: float | None, model: float | None) -> str:
    if not measured or model is None:
        return ""
    text = fixed(100.0 * (model - measured) / abs(measured), 1)
    return f"{text} %" if text.startswith(MINUS) or text == "0.0" else f"+{text} %"


def _remark(quantity: Mapping[str, Any]) -> str:
    return str(quantity.get("reason") or quantity.get("why") or "")


SECTION = Section("Performance", 15, ("validation",), render)
