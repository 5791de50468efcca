"""The diagnosis: what the model lacks, where and when, what it is called, and the proof."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from markupsafe import Markup

from hfanalysis.diagnose.answer.words import headlines, place_sentence, poor_fit_sentence
from hfanalysis.errors import AbsentError
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.report import diagnosis_charts as charts
from hfanalysis.report import diagnosis_tables as tables
from hfanalysis.report import html
from hfanalysis.report.equation_map import equation_map
from hfanalysis.report.glance import included
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.sentences import capitalised, joined
from hfanalysis.wording.numbers import listed

_SHARED = ("segments", "calibration")
"""Products without which there is no diagnosis: their absence is told once."""


def render(material: Material) -> Iterator[Block]:
    """The story: what is missing, its course, every channel with it, and the proof; what is looked up, behind folds."""
    product = material.get(Diagnosis)
    if product is None:
        yield _absent(material)
        return
    yield from _story(material, product)
    yield tables.probabilities(product)
    yield from _pairs(charts.sources(material, product))
    yield from _proof(material, product)
    yield from _pairs(charts.channels(material, product))
    yield from _folded("What is left of each channel", _left(material, product))
    yield from _folded("Constants with and without it", [tables.parameters(product), *tables.constants(product)])
    yield from _unfound(product)
    yield equation_map(material, product)
    yield from _folded("Equation by equation", [*charts.weak_form(material, product), _unasked(product)], _WEAK)
    yield from _folded("What was compared, and all of it in words", _remarks(product))


def _pairs(drawn: Iterable[Block]) -> Iterator[Block]:
    """Charts beside each other where the screen has room."""
    kept = [chart for chart in drawn if chart is not None]
    if kept:
        yield Markup('<div class="beside">')
        yield from kept
        yield Markup("</div>")


_WEAK = (
    "Each governing equation averaged over short stretches, with the measured channels and the base calibration put "
    "in. What it lacks shows without running the model. Axes fit the usual band; a wider one leaves the chart."
)


def _absent(material: Material) -> Markup:
    """Why this test has no diagnosis; where more is missing than that, the page says it elsewhere."""
    reason = material.why_not("diagnosis")
    if reason in {material.absent.get(name) for name in _SHARED} or "diagnosis" not in material.absent:
        raise AbsentError(reason)
    words = Markup('<p class="absent"><strong>This test has no diagnosis:</strong> {}</p>')
    return words.format(html.switchable(reason))


def _story(material: Material, product: Diagnosis) -> Iterator[Markup]:
    """What is missing, or included by now, and what it is."""
    if words := included(material):
        yield html.paragraph(html.switchable(words), "lead diagnosed")
    lead = list(product.sentences[:1]) if product.constants is None else headlines(product)
    yield html.paragraph(html.switchable(joined(" ", lead)), "told" if words else "lead diagnosed")
    said = [line for line in product.sentences if line not in lead] if product.constants is None else []
    said = said or [f"{capitalised(product.plain(row.name))}: {row.meaning}." for row in product.effects]
    if not product.effects and product.constants is not None:
        said += [place_sentence(row, product.compared.end) for row in product.localisation]
    yield html.bullets(map(html.switchable, [*poor_fit_sentence(product), *said]), "told")


def _proof(material: Material, product: Diagnosis) -> Iterator[Block]:
    """How much of the misfit goes, and on which data; nothing where no model ran."""
    if not product.gap.before:
        return
    if charts.with_what(product):
        yield tables.proof(product)
    else:
        yield html.paragraph("Nothing is claimed to be missing, so there is no misfit to explain and nothing to prove.")


def _left(material: Material, product: Diagnosis) -> Iterator[Block]:
    """The residual of every channel, its size, and that by phase."""
    if not product.gap.before:
        return
    yield from charts.residuals(material, product)
    if charts.with_what(product):
        yield tables.gaps(product)
        yield tables.gaps_by_phase(product)


def _unfound(product: Diagnosis) -> Iterator[Block]:
    """What was looked for and not found."""
    names = [product.plain(name) for name in product.not_it]
    excluded = html.paragraph("Tried, and not it:") + html.bullets(names, "said") if names else None
    yield from _folded("What was not found", [excluded, tables.limits(product)])


def _unasked(product: Diagnosis) -> Markup | None:
    """Equations that lack a channel."""
    found = product.weak_form.items()
    texts = [f"{charts.place(name)}: {part.reason}" for name, part in found if part.reason is not None]
    return html.bullets(map(html.switchable, texts), "said") if texts else None


def _folded(head: str, blocks: Iterable[Block], words: str = "") -> Iterator[Block]:
    """Blocks behind a fold of their own, where there are any."""
    kept = [block for block in blocks if block is not None]
    if not kept:
        return
    yield Markup('<details class="more"><summary><h3>{}</h3></summary>').format(head)
    if words:
        yield html.paragraph(words)
    yield from kept
    yield Markup("</details>")


def _remarks(product: Diagnosis) -> Iterator[Markup]:
    """All of it in sentences, what was compared, and what to bear in mind."""
    yield html.bullets(map(html.switchable, product.sentences), "said")
    for text in product.warnings:
        yield Markup('<p class="absent"><strong>Warning:</strong> {}</p>').format(html.switchable(text))
    compared = product.compared
    said = list(map(_sentence, product.notes))
    if compared.start is not None and compared.end is not None:
        span = f"from {html.seconds(compared.start)} to {html.seconds(compared.end)}"
        said.insert(0, f"Compared: {listed([LONG_NAMES.get(c, c) for c in compared.channels])}, {span}.")
    if said:
        yield html.bullets(map(html.switchable, said), "said")


def _sentence(text: str) -> str:
    return joined("", [capitalised(text), "."])


SECTION = Section("What the model lacks", 11, (), render)
