"""The page of a campaign: its tests, and stand by stand what they say together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

from markupsafe import Markup

from hfanalysis.campaign.skill import skill_sentence
from hfanalysis.campaign.stand_page import NOTHING, judged, parts_of
from hfanalysis.campaign.words import diagnosed
from hfanalysis.products.campaign import Campaign, Predicted, TestRow
from hfanalysis.report import html
from hfanalysis.report.page import render
from hfanalysis.wording.numbers import KINDS

_NUMBERS = ("burn_time", "total_impulse", "specific_impulse", "peak_chamber_pressure")


def page(product: Campaign) -> str:
    """The HTML of a campaign's product."""
    tests = product.tests
    return render(
        "campaign.html.j2",
        tests=tests,
        overview=_overview(tests),
        missing=[(test, row.status, row.reason) for test, row in tests.items() if row.reason],
        predictions=_predictions(product.predictions),
        stands=[(name, list(parts_of(stand, tests))) for name, stand in product.stands.items()],
        has_pages=any(row.page for row in tests.values()),
        generated=sorted({row.source for row in tests.values() if row.source} - {"measured"}),
    )


def _overview(tests: Mapping[str, TestRow]) -> Markup:
    """A row for each test; a column of which no test has anything is left out."""
    heads = ("burn time", "total impulse", "specific impulse", "peak p_c", "apogee")
    columns = ("test", "date", "stand", "kind", *(f">{head}" for head in heads), "what the model lacks")
    rows = [_test(test, row) for test, row in tests.items()]
    kept = [i for i, _ in enumerate(columns) if any(row[i] != NOTHING for row in rows)]
    caption = (
        "Measured performance, the apogee predicted with it, and what the diagnosis found. A number with a question "
        "mark is doubted: its test's page says why."
    )
    shown = [[row[i] for i in kept] for row in rows]
    return html.table("Tests", caption, [columns[i] for i in kept], shown, sorts=True)


def _predictions(found: Mapping[str, Predicted]) -> Markup:
    """A row for each prediction; nothing where there is none."""
    if not found:
        return Markup()
    columns = ("prediction", "test", ">bands that held", ">mean error", ">as last time", ">without effects")
    caption = (
        "As they were frozen; that it was before the firing, only a hash that was posted proves. The error of a test's "
        "own log is in no band, and the model without effects is not moved by what it missed."
    )
    rows = [(name, one.test, *_skill(one)) for name, one in found.items()]
    said = skill_sentence(found)
    table = html.table("Predictions", caption, columns, rows)
    return (html.paragraph(said) if said else Markup()) + table


def _skill(one: Predicted) -> tuple[str, ...]:
    if not one.of:
        return (one.reason or "–", "–", "–", "–")
    errors = (one.mean_error.get(name) for name in ("predicted", "as_last_time", "without_effects"))
    return (f"{one.held} of {one.of}", *("–" if e is None else f"{100.0 * e:.1f} %" for e in errors))


def _test(test: str, row: TestRow) -> tuple[Any, ...]:
    name: Any = test
    if row.page:
        name = Markup('<a href="{}">{}</a>').format(f"{quote(test)}/report.html", test)
    numbers = [judged(name, row.performance.get(name)) for name in _NUMBERS]
    kind = KINDS.get(row.kind or "", row.kind or "–")
    lacks = diagnosed(row.diagnosis)
    return (name, row.date or NOTHING, row.stand or NOTHING, kind, *numbers, judged("apogee", row.apogee), lacks)
