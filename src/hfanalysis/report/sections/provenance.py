"""What the page was made from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from markupsafe import Markup

from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section

_LAST = ("flight", "diagnosis", "validation", "calibration", "segments", "ingest")
"""Products whose provenance covers that of those after them, the farthest first."""

_OF_EACH = ("code", "parameters")
"""What every stage has of its own."""


def render(material: Material) -> Iterator[Block]:
    """Hashes, versions and settings, behind a fold."""
    rows: list[tuple[str | Markup, Markup]] = list(_entries(material))
    if material.adopted:
        rows.insert(0, ("adopted effects", Markup("{}").format(material.adopted)))
    caption = "SHA-256 of the files, versions and parameters behind every number on this page."
    yield html.table("Provenance", caption, ("what", "is"), rows)


def _entries(material: Material) -> Iterator[tuple[Markup, Markup]]:
    """Each fact once, from the last product that states it."""
    seen = set()
    for product in _LAST:
        found = material.products.get(product)
        for key, text in flat(found.provenance if found else {}):
            name = f"{product}: {key}" if key.startswith(_OF_EACH) else key
            if name not in seen:
                seen.add(name)
                yield Markup("<code>{}</code>").format(name), Markup("<code>{}</code>").format(text)


def flat(data: Mapping[str, Any], before: str = "") -> list[tuple[str, str]]:
    """Nested facts as rows."""
    rows: list[tuple[str, str]] = []
    for name, value in data.items():
        full = f"{before}{name}"
        rows += flat(value, f"{full} / ") if isinstance(value, Mapping) else [(full, str(value))]
    return rows


SECTION = Section("Made from", 95, ("ingest",), render, folded=True)
