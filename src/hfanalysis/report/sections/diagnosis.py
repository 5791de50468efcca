"""The diagnosis: what the model lacks, where and when, what it is called, and the proof."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from markupsafe import Markup

from hfanalysis.errors import AbsentError
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.report import diagnosis_charts as charts
from hfanalysis.report import diagnosis_tables as tables
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.sentences import capitalised, joined

_SHARED = ("segments", "calibration")
"""Products without which there is no diagnosis: their absence is told once."""


def render(material: Material) -> Iterator[Block]:
    """The story in words, its numbers and pictures, and what is looked up, behind folds."""
    product = material.get(Diagnosis)
    if product is None:
        yield _absent(material)
        return
    yield from _story(product)
    yield tables.probabilities(product)
    yield tables.partners(product)
    yield tables.parameters(product)
    yield from charts.sources(material, product)
    yield from _gap(material, product)
    yield from tables.constants(product)
    yield from _unfound(product)
    yield from _folded("Equation by equation", [*charts.weak_form(material, product), _unasked(product)], _WEAK)
    yield from _remarks(product)


_WEAK = (
    "Each governing equation averaged over short stretches, with the measured channels put in and the base "
    "calibration: what it lacks, without running the model. Axes fit the usual band; a wider one leaves the chart."
)


def headline(product: Diagnosis) -> str:
    """The verdict in a sentence; empty where the product has none."""
    return next(iter(product.sentences), "")


def _absent(material: Material) -> Markup:
    """Why this test has no diagnosis; where more is missing than that, the page says it elsewhere."""
    reason = material.why_not("diagnosis")
    if reason in {material.absent.get(name) for name in _SHARED} or "diagnosis" not in material.absent:
        raise AbsentError(reason)
    words = Markup('<p class="absent"><strong>This test has no diagnosis:</strong> {}</p>')
    return words.format(html.switchable(reason))


def _story(product: Diagnosis) -> Iterator[Markup]:
    yield html.paragraph(html.switchable(headline(product)), "lead diagnosed")
    yield html.bullets(map(html.switchable, product.sentences[1:]), "told")
    untold = [text for text in product.decisive_measurements if not _told(product, text)]
    if untold:
        yield html.paragraph("What would decide:")
        yield html.bullets(map(html.switchable, untold), "said")
    for group in product.twins:
        if not set(group) & set(product.not_it):
            yield html.paragraph(f"These channels hardly tell apart: {', '.join(group)}.")


def _told(product: Diagnosis, text: str) -> bool:
    return any(text in sentence for sentence in product.sentences)


def _gap(material: Material, product: Diagnosis) -> Iterator[Block]:
    """The residual of every channel without and with what is missing, and the proof; nothing where no model ran."""
    if not product.gap.before:
        return
    yield from charts.residuals(material, product)
    if not charts.with_what(product):
        yield html.paragraph("Nothing is claimed to be missing, so there is no gap to close and nothing to prove.")
        return
    yield tables.gaps(product)
    yield from _folded("Gap by phase", [tables.gaps_by_phase(product)])
    yield tables.proof(product)


def _unfound(product: Diagnosis) -> Iterator[Block]:
    """What was looked for and not found."""
    names = ", ".join(product.not_it)
    excluded = html.paragraph(f"Tried, and not it: {names}.") if names else None
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
    """What was compared, and what to bear in mind."""
    for text in product.warnings:
        yield Markup('<p class="absent"><strong>Warning:</strong> {}</p>').format(html.switchable(text))
    compared = product.compared
    said = list(map(_sentence, product.notes))
    if compared.start is not None and compared.end is not None:
        span = f"from {html.seconds(compared.start)} to {html.seconds(compared.end)}"
        said.insert(0, f"Compared: {', '.join(compared.channels)}, {span}.")
    if said:
        yield html.bullets(map(html.switchable, said), "said")


def _sentence(text: str) -> str:
    return joined("", [capitalised(text), "."])


SECTION = Section("Diagnosis", 58, (), render)
