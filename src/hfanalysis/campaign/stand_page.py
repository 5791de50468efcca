"""What the tests of one stand say together, as parts of a page: sentences, tables and pictures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from markupsafe import Markup, escape

from hfanalysis.campaign.conclusions import conclusions
from hfanalysis.campaign.family import FAMILY
from hfanalysis.campaign.individuals import individuals
from hfanalysis.campaign.sensors import courses, drifts
from hfanalysis.campaign.strips import strip
from hfanalysis.campaign.words import HIDDEN, agreement, alone, by_chance, regression_sentence, tests_named
from hfanalysis.products.campaign import StandRow, TestRow, Together
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.names import called
from hfanalysis.wording.numbers import fixed, in_words

LAW = ("a", "n")

NOTHING = Markup("–")
"""What stands in a cell where nothing is known."""


def parts_of(stand: StandRow, tests: Mapping[str, TestRow]) -> Iterator[Markup]:
    """What belongs to the stand: its constants, effects, regression law and sensors; in a table a row is a test."""
    if len(stand.tests) == 1:
        yield html.paragraph(alone(stand.tests[0]))
        return
    for sentence in conclusions(stand, tests):
        yield html.paragraph(sentence)
    rows = {test: tests[test] for test in sorted(stand.tests, key=lambda test: (tests[test].date or "", test))}
    yield from _constants(stand, rows)
    yield from _effects(stand)
    yield html.paragraph(regression_sentence(stand.regression))
    if stand.trends:
        yield _trends(stand)
    if stand.sensors:
        yield from _sensors(stand, rows)


def cell(name: str, quantity: Quantity | None) -> Markup:
    """A quantity in a table, with the number by which its column is sorted."""
    if quantity is None or quantity.value is None:
        return NOTHING
    return html.sorted_by(quantity.value, html.value(quantity, name))


def _constants(stand: StandRow, rows: Mapping[str, TestRow]) -> Iterator[Markup]:
    constants = stand.constants
    caption = "The mean counts how far the tests differ beyond their own deviations; only what is identified is in it."
    yield html.table(
        "Constants of the stand", caption, ("constant", ">together", "the tests"),
        [(html.symbol_and_words(name), cell(name, one.mean), agreement(one)) for name, one in constants.items()],
    )  # fmt: skip
    names = [*constants, *(name for name in LAW if any(name in row.calibration for row in rows.values()))]
    of = [(test, *(judged(name, row.calibration.get(name)) for name in names)) for test, row in rows.items()]
    heads = ("test", *(f">{name}" for name in names))
    yield html.table("Constants by test", "As each test has them.", heads, of, sorts=True)
    for name, together in constants.items():
        found = {test: row.calibration[name] for test, row in rows.items() if name in row.calibration}
        yield _picture(name, found, together)


def _picture(name: str, found: Mapping[str, Quantity], together: Together) -> Markup:
    """Of few tests each one's interval, of many their course with its limits; empty of fewer than two."""
    many = sum(quantity.value is not None for quantity in found.values()) >= FAMILY
    made = individuals(name, found) if many else strip(name, found, together.mean)
    return Markup('<figure><div class="plot">{}</div></figure>').format(made) if made else Markup()


def judged(name: str, quantity: Quantity | None) -> Markup:
    """The same with its verdict, where that is no good one."""
    verdict, plain = (quantity.verdict if quantity else None) or "", cell(name, quantity)
    return plain if not verdict or html.mark(verdict) == "good" else plain + Markup(" ") + html.verdict(verdict)


def _effects(stand: StandRow) -> Iterator[Markup]:
    """Each effect that some test names: in which, and its numbers together; then how probable it is by test."""
    if not stand.effects:
        yield html.paragraph("No effect is named in any of the tests.")
        return
    tests, rows = stand.tests, list[tuple[Any, ...]]()
    for name, found in stand.effects.items():
        where = tests_named(found.named_in, len(tests))
        rows.append((Markup("<strong>{}</strong>").format(called(name)), where, "", ""))
        for parameter, numbers in found.parameters.items():
            words = Markup('<span class="words">{}</span>').format(parameter.replace("_", " "))
            together = numbers.together
            rows.append((words, "", cell(parameter, together.mean), agreement(together)))
    caption = "Effects that some test names, and their numbers where they are named."
    yield html.table("Effects", caption, ("effect", "named in", ">together", "the tests"), rows)
    heads = ["test"]
    for name, found in stand.effects.items():
        heads += [f">{called(name)}", *(f">its {parameter.replace('_', ' ')}" for parameter in found.parameters)]
    of = [(test, *_of_test(test, stand)) for test in tests]
    yield html.table("Effects by test", "How probable each is, and its size where it is named.", heads, of, sorts=True)


def _of_test(test: str, stand: StandRow) -> Iterator[Markup]:
    for found in stand.effects.values():
        yield _chance(found.probability.get(test), test in found.named_in)
        yield from (cell(name, numbers.by_test.get(test)) for name, numbers in found.parameters.items())


def _chance(probability: float | None, named: bool) -> Markup:
    if probability is None:
        return NOTHING
    text = f"< {HIDDEN}" if probability < HIDDEN else fixed(probability, 2)
    told = Markup("<strong>{}</strong> named").format(text) if named else escape(text)
    return html.sorted_by(probability, told)


def _trends(stand: StandRow) -> Markup:
    """Every trend that was looked for, the steady ones and the others."""
    rows = [
        (one.of, in_words(one.over), len(one.tests), html.value(one.slope), by_chance(one.probability))
        for one in sorted(stand.trends, key=lambda one: one.probability)
    ]  # fmt: skip
    heads = ("constant", "with", ">tests", ">slope", ">by chance")
    caption = (
        "How probable so steady a trend is by chance, as many as were looked for; an error of a pressure's sensor may "
        "move both."
    )
    return html.table("Trends", caption, heads, rows)


def _sensors(stand: StandRow, rows: Mapping[str, TestRow]) -> Iterator[Markup]:
    """Zeros and gains by test, and the courses of those that drift or were off."""
    found = list(courses(stand.sensors))
    tests = [test for test in rows if any(test in course.by_test for *_, course in found)]
    units = {name: stand.sensors[name].channel for name, *_ in found}
    of = [
        (test, *(cell(units[name] if what == "zero" else "", course.by_test.get(test)) for name, what, course in found))
        for test in tests
    ]
    caption = (
        "What was taken off as a sensor's zero, in the order of dates, and as gain of the tank's cell the load that it "
        "showed over the one stated. Another serial number is another sensor."
    )
    heads = ("test", *(f">{name}{', gain' if what == 'gain' else ''}" for name, what, _ in found))
    yield html.table("Sensors", caption, heads, of, sorts=True)
    for name, what, course in found:
        if not (drifts(course) or course.left):
            continue
        if picture := individuals(units[name] if what == "zero" else what, course.by_test):
            frame = '<figure><div class="plot">{}</div><figcaption>{}</figcaption></figure>'
            yield Markup(frame).format(picture, f"{what.capitalize()} of {name}")
