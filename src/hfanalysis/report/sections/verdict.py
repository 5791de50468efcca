"""The first screen: four sentences, six numbers, thrust and chamber pressure."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from markupsafe import Markup

from hfanalysis.charts.chart import Chart
from hfanalysis.health.reasons import marked
from hfanalysis.products.health import TRUSTED
from hfanalysis.quantity import DOUBTED, Quantity
from hfanalysis.record.channels import LONG_NAMES, unit_of
from hfanalysis.report import html
from hfanalysis.report.glance import Against, against_last, four, key_numbers, motor_class, sensors_then
from hfanalysis.report.limits import BROKEN, KEPT, OPEN, judged
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.time_charts import lines_of, over_time
from hfanalysis.wording.numbers import MINUS, fixed, in_words

_DRAWN = ("thrust", "p_chamber", "p_tank", "m_tank")
"""Channels of which the first two that the log has are drawn."""

_COMMAND = re.compile(r"\b(hfa [a-z]+ [\w.-]*\w(?: --[a-z]+)?)")
"""A command of the package in a sentence."""

SAME = 5e-4
"""Share below which a number is the same as last time [-]: it would read 0.0 %. Source: definition."""

_HEIGHT = 250.0
"""Of a chart of the first screen [px]."""


def render(material: Material) -> Iterator[Block]:
    """The team's own limits, the sentences beside the numbers, and the charts below them."""
    yield _limits(material)
    yield Markup('<div class="glance">')
    yield _sentences(material)
    yield _numbers(key_numbers(material), material)
    yield Markup("</div>")
    yield Markup('<div class="beside">')
    yield from glance_charts(material)
    yield Markup("</div>")
    yield _last(material)
    for stage, reason in absence_reasons(material).items():
        absent = Markup('<p class="absent"><strong>{}:</strong> {}</p>')
        yield absent.format(stage, html.switchable(reason))


_MARKS = {KEPT: ("good", "keeps"), BROKEN: ("bad", "breaks"), OPEN: ("", "open")}
"""How a rule's outcome is shown: by color, and by a word."""


def _limits(material: Material) -> Markup | None:
    """What the team's own rules say, what is broken first; nothing without any."""
    found = sorted(judged(material), key=lambda one: (BROKEN, OPEN, KEPT).index(one.state))
    if not found:
        return None
    item = Markup('<li><span class="verdict {}">{}</span> {}: {}</li>')
    items = (item.format(*_MARKS[one.state], one.name, html.switchable(one.words)) for one in found)
    return Markup('<ul class="limits" aria-label="The team\'s own limits">{}</ul>').format(Markup().join(items))


def glance_charts(material: Material) -> list[Chart]:
    """Thrust and chamber pressure; where the log lacks one, the tank's pressure, or its mass."""
    drawn = (_chart(material, name) for name in _DRAWN if name in material.log and material.log[name].good.any())
    return [chart for chart in drawn if chart is not None][:2]


def _chart(material: Material, name: str) -> Chart | None:
    words = LONG_NAMES[name]
    lines = lines_of(material, material.log[name], words, name)
    about = (words, unit_of(name))
    key = f"glance-{name.replace('_', '-')}"
    return over_time(material, key, words.capitalize(), about, lines, height=_HEIGHT, repeats=True)


def absence_reasons(material: Material) -> dict[str, str]:
    """Why there are no phases or no calibration, each reason once."""
    told: dict[str, str] = {}
    for name, words in (("segments", "phases"), ("calibration", "calibration"), ("validation", "validation")):
        if not material.has(name) and name in material.absent and material.absent[name] not in told.values():
            told[words] = material.absent[name]
    return told


def _last(material: Material) -> Markup | None:
    """What else there is against the stand's test before: the injector's coefficient, and the sensors."""
    coefficient = next((row for row in against_last(material) if row.name == "C_i"), None)
    if material.last is None:
        return None
    when = f" of {material.last.date}" if material.last.date else ""
    parts = [Markup("Last time on this stand: <bdi>{}</bdi>{}.").format(material.last.id, when)]
    if coefficient is not None:
        parts.append(Markup("{} was {}, now {}.").format(
            html.symbol("C_i"), html.value(replace(coefficient.was, std=None)), _change(coefficient)))  # fmt: skip
    if then := sensors_then(material):
        parts.append(Markup("Sensors then: {}.").format(then))
    return html.paragraph(Markup(" ").join(parts), "last")


def _was(name: str, material: Material) -> Markup:
    """What a number was last time, and its change."""
    row = next((row for row in against_last(material) if row.name == name), None)
    if row is None or material.last is None:
        return Markup()
    was = Markup('<span class="was"><bdi>{}</bdi> {}, {}</span>')
    return was.format(material.last.id, html.value(replace(row.was, std=None), name), _change(row))


def _change(row: Against) -> str:
    if row.change is None:
        return "from zero"
    if abs(row.change) < SAME:
        return "the same"
    text = fixed(100.0 * row.change, 0 if abs(row.change) >= 0.1 else 1)
    return f"{text} %" if text.startswith(MINUS) else f"+{text} %"


def _sentences(material: Material) -> Markup:
    item = Markup("<div><dt>{}</dt><dd>{}</dd></div>")
    items = (item.format(told.head, _with_commands(html.switchable(told.words))) for told in four(material))
    return Markup('<dl class="four">{}</dl>').format(Markup().join(items))


def _with_commands(words: Markup) -> Markup:
    """The text with commands set as such; it is escaped already."""
    return Markup(_COMMAND.sub(r"<code>\1</code>", str(words)))


def _numbers(found: Mapping[str, Quantity], material: Material) -> Markup | None:
    if not found:
        return None
    item = Markup("<div><dt>{}</dt><dd>{}</dd></div>")
    items = (
        item.format(in_words(name), _key_number(name, quantity, material) + _was(name, material))
        for name, quantity in found.items()
    )
    return Markup('<dl class="key-numbers">{}</dl>').format(Markup().join(items))


def _key_number(name: str, quantity: Quantity, material: Material) -> Markup:
    """With the class of an impulse, and a badge where it is doubted, or rests on a channel that the engineer trusts,
    which says why.
    """
    number, why = html.value(quantity, name, True), quantity.why or ""
    letter = motor_class(material) if name == "total_impulse" else ""
    if letter:
        number += Markup(' <span class="class">class {}</span>').format(letter)
    if quantity.verdict != DOUBTED and TRUSTED not in why:
        return number
    badge = html.verdict(DOUBTED) if quantity.verdict == DOUBTED else Markup("(trusted)")
    numbers, _ = marked(quantity, material.reasons)
    doubt = Markup('{} <span class="doubt" title="{}">{}</span> {}')
    return doubt.format(number, why, badge, html.marks(numbers))


SECTION = Section("At a glance", 10, (), render)
