"""The page of a campaign: its tests, and stand by stand what they say together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any
from urllib.parse import quote

from markupsafe import Markup, escape

from hfanalysis.campaign.conclusions import conclusions
from hfanalysis.campaign.skill import skill_sentence
from hfanalysis.campaign.strips import strip
from hfanalysis.campaign.words import HIDDEN, agreement, alone, diagnosed, regression_sentence
from hfanalysis.products.campaign import Campaign, Predicted, StandRow, TestRow, Together
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.names import called
from hfanalysis.report.page import render
from hfanalysis.wording.numbers import KINDS, fixed

_NUMBERS = ("burn_time", "total_impulse", "specific_impulse", "peak_chamber_pressure")


def page(product: Campaign) -> str:
    """The HTML of a campaign's product."""
    tests = product.tests
    return render(
        "campaign.html.j2",
        tests=tests,
        overview=_overview(tests),
        lacking=[(test, diagnosed(row.diagnosis)) for test, row in tests.items()],
        missing=[(test, row.status, row.reason) for test, row in tests.items() if row.reason],
        predictions=_predictions(product.predictions),
        stands=[(name, list(_stand(stand, tests))) for name, stand in product.stands.items()],
        has_pages=any(row.page for row in tests.values()),
        generated=sorted({row.source for row in tests.values() if row.source} - {"measured"}),
    )


def _overview(tests: Mapping[str, TestRow]) -> Markup:
    heads = ("burn time", "total impulse", "specific impulse", "peak p_c", "apogee")
    columns = ("test", "kind", *(f">{head}" for head in heads))
    caption = "Measured performance, and the apogee predicted with it."
    return html.table("Tests", caption, columns, [_test(test, row) for test, row in tests.items()])


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
    numbers = [_cell(name, row.performance.get(name)) for name in _NUMBERS]
    kind = KINDS.get(row.kind or "", row.kind or "–")
    return (name, kind, *numbers, _cell("apogee", row.apogee))


def _cell(name: str, quantity: Quantity | None) -> Markup:
    return html.value(quantity, name) if quantity and quantity.value is not None else Markup("–")


def _stand(stand: StandRow, tests: Mapping[str, TestRow]) -> Iterator[Markup]:
    """Table and pictures of what belongs to the stand, its effects, its regression law."""
    if len(stand.tests) == 1:
        yield html.paragraph(alone(stand.tests[0]))
        return
    for sentence in conclusions(stand, tests):
        yield html.paragraph(sentence)
    rows = {test: tests[test].calibration for test in stand.tests}
    columns = ("constant", *(f">{test}" for test in rows), ">together", "the tests")
    caption = "The mean counts how far the tests differ beyond their own deviations; only what is identified is in it."
    constants = stand.constants
    yield html.table(
        "Constants of the stand", caption, columns, [_constant(name, rows, constants[name]) for name in constants]
    )
    for name, together in constants.items():
        picture = strip(name, {test: row[name] for test, row in rows.items() if name in row}, together.mean)
        if picture:
            yield Markup('<figure><div class="plot">{}</div></figure>').format(picture)
    if stand.effects:
        yield _effects(stand)
    else:
        yield html.paragraph("No effect is named in any of the tests.")
    yield html.paragraph(regression_sentence(stand.regression))
    if stand.sensors:
        yield _sensors(stand)


def _sensors(stand: StandRow) -> Markup:
    """A row for each sensor: its zero by test, in the order of dates."""
    tests = list(dict.fromkeys(test for row in stand.sensors.values() for test in row.zeros))
    rows = [(name, *(_cell(row.channel, row.zeros.get(test)) for test in tests)) for name, row in stand.sensors.items()]
    caption = "What was taken off as a sensor's zero, in the order of dates; another serial number is another sensor."
    return html.table("Zeros of the sensors", caption, ("sensor", *(f">{test}" for test in tests)), rows)


def _constant(name: str, rows: Mapping[str, Mapping[str, Quantity]], together: Together) -> tuple[Any, ...]:
    cells = [_judged(name, row.get(name)) for row in rows.values()]
    return (html.symbol_and_words(name), *cells, _cell(name, together.mean), agreement(together))


def _judged(name: str, quantity: Quantity | None) -> Markup:
    verdict = (quantity.verdict if quantity else None) or ""
    return _cell(name, quantity) + (Markup(" ") + html.verdict(verdict) if html.mark(verdict) != "good" else Markup())


def _effects(stand: StandRow) -> Markup:
    """A row for each effect and each of its numbers: by test, and together."""
    tests = stand.tests
    rows: list[tuple[Any, ...]] = []
    for name, found in stand.effects.items():
        chances = [_chance(found.probability.get(test), test in found.named_in) for test in tests]
        rows.append((Markup("<strong>{}</strong>").format(called(name)), *chances, "", ""))
        for parameter, numbers in found.parameters.items():
            words = Markup('<span class="words">{}</span>').format(parameter.replace("_", " "))
            cells = [_cell(parameter, numbers.by_test.get(test)) for test in tests]
            together = numbers.together
            rows.append((words, *cells, _cell(parameter, together.mean), agreement(together)))
    columns = ("effect", *(f">{test}" for test in tests), ">together", "the tests")
    caption = "How probable each effect is that some test names, and its size where it is named."
    return html.table("Effects", caption, columns, rows)


def _chance(probability: float | None, named: bool) -> Markup:
    if probability is None:
        return Markup("–")
    text = f"< {HIDDEN}" if probability < HIDDEN else fixed(probability, 2)
    return Markup("<strong>{}</strong> named").format(text) if named else escape(text)
