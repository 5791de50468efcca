"""The performance of the firing: measured, and by the model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from markupsafe import Markup

from hfanalysis.errors import AbsentError
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.wording import in_words, quantities, tidy

_CAPTION = "Measured: peaks of the despiked signal, impulse within the burn and free of the cell's drift."


def render(material: Material) -> Iterator[Block]:
    """Measured and model side by side."""
    performance = material.product("validation").get("performance") or {}
    measured, model = (quantities(performance.get(side) or {}) for side in ("measured", "model"))
    if not (measured or model):
        raise AbsentError("the validation holds no performance table")
    columns = ("quantity", ">measured", ">95 % interval", ">model", ">model − measured", "remark")
    names = dict.fromkeys([*measured, *model])
    rows = (_row(name, measured.get(name, {}), model.get(name, {})) for name in names)
    yield html.table("Performance", _CAPTION, columns, rows)


def _row(name: str, measured: Mapping[str, Any], model: Mapping[str, Any]) -> tuple[Any, ...]:
    return (
        in_words(name),
        _cell(measured, name),
        html.interval(measured, name) if measured.get("value") is not None else "",
        _cell(model, name),
        _share(measured.get("value"), model.get("value")),
        html.switchable("; ".join(dict.fromkeys(_remarks(measured, model)))),
    )


def _cell(quantity: Mapping[str, Any], name: str) -> Markup:
    return html.value(quantity, name) if quantity else Markup("–")


def _share(measured: float | None, model: float | None) -> str:
    if not measured or model is None:
        return ""
    percent = 100.0 * (model - measured) / abs(measured)
    return f"{'+' if percent > 0 else ''}{tidy(percent, 2)} %"


def _remarks(*found: Mapping[str, Any]) -> Iterator[str]:
    for quantity in found:
        for key in ("reason", "why"):
            if quantity.get(key):
                yield str(quantity[key])


SECTION = Section("Performance", 15, ("validation",), render)
