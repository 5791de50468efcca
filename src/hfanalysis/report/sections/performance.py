"""The performance of the firing: measured, and by the model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from markupsafe import Markup

from hfanalysis.health.reasons import Doubt
from hfanalysis.products.validation import Closure, Validation
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import MINUS, fixed, in_words, ordered

_CAPTION = "Measured: peaks of the despiked signal, impulse within the burn and free of the cell's drift."


def render(material: Material) -> Iterator[Block]:
    """Measured and model side by side, and whether the masses close."""
    validation = material.need(Validation)
    measured, model = (side.quantities for side in (validation.performance.measured, validation.performance.model))
    columns = ("quantity", ">measured", ">95 % interval", ">model", ">model − measured", "remark")
    rows = (_row(name, quantity, model.get(name), material) for name, quantity in ordered(measured).items())
    yield html.table("Performance", _CAPTION, columns, rows)
    if validation.performance.motor_class:
        yield html.paragraph(Markup("Motor class {}.").format(validation.performance.motor_class))
    for reason in dict.fromkeys(quantity.reason for quantity in ordered(model).values() if quantity.reason):
        yield html.paragraph(Markup("No model: {}.").format(html.switchable(reason)))
    reasons = material.reasons
    if validation.efficiencies is not None:
        yield _table("Efficiencies", _BASIS, validation.efficiencies.quantities, reasons)
    if validation.standard is not None:
        yield _table("Standard quantities", "By which engines are compared.", validation.standard.quantities, reasons)
    yield from _closure(validation.closure, reasons)


_BASIS = (
    "Of shifting equilibrium, the most that the gas can give; beside it of frozen flow, which is the model's nozzle "
    "and the report's. Means over the liquid phase."
)


def _closure(closure: Closure, reasons: list[Doubt]) -> Iterator[Markup | None]:
    judged = closure.to_purge
    if judged is not None:
        told = {"closes": "They close: ", "does not close": "They do not close: "}.get(judged.verdict or "", "")
        words = "what passes the nozzle, by p_c and c*, against what came by injector and grain."
        yield _table("Masses until nitrogen enters", told + words, judged.quantities, reasons)
    yield _table("Closure", "Masses over the burn, and energy; not judged.", ordered(closure.quantities), reasons)


def _table(title: str, caption: str, found: Mapping[str, Quantity], reasons: list[Doubt]) -> Markup | None:
    rows = [(in_words(n), html.value(q, n), html.interval(q, n), html.judged(q, reasons)) for n, q in found.items()]
    return html.table(title, caption, ("quantity", ">value", "95 % interval", "remark"), rows) if rows else None


def _row(name: str, measured: Quantity, model: Quantity | None, material: Material) -> tuple[Any, ...]:
    return (
        in_words(name),
        html.value(measured, name),
        html.interval(measured, name),
        html.value(model, name) if model else Markup("–"),
        _share(measured.value, model.value if model else None),
        html.judged(measured, material.reasons),
    )


def _share(measured: float | None, model: float | None) -> str:
    if not measured or model is None:
        return ""
    text = fixed(100.0 * (model - measured) / abs(measured), 1)
    return f"{text} %" if text.startswith(MINUS) or text == "0.0" else f"+{text} %"


SECTION = Section("Performance", 15, ("validation",), render, folded=True)
