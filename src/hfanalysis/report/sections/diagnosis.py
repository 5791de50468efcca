"""The diagnosis: what the model lacks, where and when, what it is called, and the proof."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from markupsafe import Markup

from hfanalysis.errors import AbsentError
from hfanalysis.report import diagnosis_charts as charts
from hfanalysis.report import diagnosis_tables as tables
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section

_SHARED = ("segments", "calibration")
"""Products without which there is no diagnosis: their absence is told once."""


def render(material: Material) -> Iterator[Block]:
    """The story in words, its numbers and pictures, and what is looked up, behind folds."""
    if not material.has("diagnosis"):
        yield _absent(material)
        return
    product = material.product("diagnosis")
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


def headline(product: Mapping[str, Any]) -> str:
    """The verdict in a sentence; empty where the product has none."""
    return str(next(iter(product.get("sentences") or ()), ""))


def _absent(material: Material) -> Markup:
    """Why this test has no diagnosis; where more is missing than that, the page says it elsewhere."""
    reason = material.why_not("diagnosis")
    if reason in {material.absent.get(name) for name in _SHARED} or "diagnosis" not in material.absent:
        raise AbsentError(reason)
    words = Markup('<p class="absent"><strong>This test has no diagnosis:</strong> {}</p>')
    return words.format(html.switchable(reason))


def _story(product: Mapping[str, Any]) -> Iterator[Markup]:
    yield html.paragraph(html.switchable(headline(product)), "lead diagnosed")
    yield html.bullets(map(html.switchable, map(str, product["sentences"][1:])), "told")
    untold = [text for text in product["decisive_measurements"] if not _told(product, text)]
    if untold:
        yield html.paragraph("What would decide:")
        yield html.bullets(map(html.switchable, untold), "said")
    for group in product["twins"]:
        if not set(group) & set(product["not_it"]):
            yield html.paragraph(f"These channels hardly tell apart: {', '.join(map(str, group))}.")


def _told(product: Mapping[str, Any], text: str) -> bool:
    return any(str(text) in sentence for sentence in product["sentences"])


def _gap(material: Material, product: Mapping[str, Any]) -> Iterator[Block]:
    """The residual of every channel without and with what is missing, and the proof; nothing where no model ran."""
    if not product["gap"]["before"]:
        return
    yield from charts.residuals(material, product)
    if not charts.with_what(product):
        yield html.paragraph("Nothing is claimed to be missing, so there is no gap to close and nothing to prove.")
        return
    yield tables.gaps(product)
    yield from _folded("Gap by phase", [tables.gaps_by_phase(product)])
    yield tables.proof(product)


def _unfound(product: Mapping[str, Any]) -> Iterator[Block]:
    """What was looked for and not found."""
    names = ", ".join(map(str, product["not_it"]))
    excluded = html.paragraph(f"Tried, and not it: {names}.") if names else None
    yield from _folded("What was not found", [excluded, tables.limits(product)])


def _unasked(product: Mapping[str, Any]) -> Markup | None:
    """Equations that lack a channel."""
    found = (product.get("weak_form") or {}).items()
    texts = [f"{charts.place(name)}: {part['reason']}" for name, part in found if "reason" in part]
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


def _remarks(product: Mapping[str, Any]) -> Iterator[Markup]:
    """What was compared, and what to bear in mind."""
    for text in product["warnings"]:
        yield Markup('<p class="absent"><strong>Warning:</strong> {}</p>').format(html.switchable(str(text)))
    compared = product["compared"]
    said = list(map(_sentence, product["notes"]))
    if "end" in compared:
        span = f"from {html.seconds(compared['start'])} to {html.seconds(compared['end'])}"
        said.insert(0, f"Compared: {', '.join(map(str, compared['channels']))}, {span}.")
    if said:
        yield html.bullets(map(html.switchable, said), "said")


def _sentence(note: Any) -> str:
    text = str(note)
    return f"{text[:1].upper()}{text[1:]}."


SECTION = Section("Diagnosis", 58, (), render)
