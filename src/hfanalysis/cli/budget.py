"""hfa budget: what the standard deviations of a test's quantities are made of, collected from its products."""

from __future__ import annotations

from collections.abc import Callable

from rich.text import Text

from hfanalysis.cli.exit_status import put, tell
from hfanalysis.cli.paper import new_table, paper
from hfanalysis.cli.perform import bring
from hfanalysis.cli.request import Request
from hfanalysis.errors import AbsentError
from hfanalysis.products.budgets import Made, made_of
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.disk import to_json
from hfanalysis.products.flight import Flight
from hfanalysis.products.validation import Validation
from hfanalysis.stages.base import Context
from hfanalysis.wording.numbers import in_words, shown

Reads = Callable[[Context], Calibration | Validation | Flight]

STAGES: dict[str, Reads] = {
    "calibrate": lambda context: context.read(Calibration),
    "validate": lambda context: context.read(Validation),
    "flight": lambda context: context.read(Flight),
}
"""The stages whose products have budgets, and how these are read."""

LEAST = 0.005
"""Share [-] below which an input is not shown at a terminal. Source: it would read 0 %."""


def budget(request: Request) -> None:
    """Bring the stages up to date and show the budgets of what they found. Raises AbsentError where there is none."""
    products: list[Calibration | Validation | Flight] = []
    absent = []
    for stage, read in STAGES.items():
        try:
            products.append(read(bring(stage, request)))
        except AbsentError as missing:
            absent.append(f"{stage}: {missing}")
    found = made_of(products)
    if not found:
        raise AbsentError(f"test {request.test}: no quantity has a budget" if products else absent[0])
    if request.as_json:
        put(to_json({"test": request.test, "budget": {made.name: _json(made) for made in found}}))
    elif not request.quiet:
        _show(found)
    for text in absent:
        tell(f"warning: {text}")


def _json(made: Made) -> dict[str, object]:
    return {"product": made.product, "quantity": made.quantity.to_json(), **made.budget.to_json()}


def _show(found: list[Made]) -> None:
    console = paper()
    for made in found:
        title = Text.assemble((in_words(made.name), "bold"), f"  {headline(made)}")
        table = new_table("share", "input", title="")
        table.columns[0].justify = "right"
        for name, share in rows(made):
            table.add_row(f"{100.0 * share:.0f} %", name)
        console.print(title)
        console.print(table)


def headline(made: Made) -> str:
    """The quantity with its deviation, and the two parts of that."""
    text = shown(made.quantity, name=made.name)
    parts = (made.budget.systematic, made.budget.random)
    scale = (made.quantity.std or 1.0) or 1.0
    shares = [f"{100.0 * (part / scale) ** 2:.0f} %" for part in parts]
    value = f"{text.value} ± {text.std} {text.unit}".rstrip()
    return f"{value}  ({shares[0]} of the variance systematic, {shares[1]} random)"


def rows(made: Made) -> list[tuple[str, float]]:
    """The inputs with their shares [-], largest first, and what is not linear."""
    some = [(name, share) for name, share in made.budget.shares.items() if share >= LEAST]
    left = made.budget.non_linear
    return some + ([("not linear", left)] if abs(left) >= LEAST else [])
