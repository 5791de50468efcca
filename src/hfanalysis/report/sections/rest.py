"""The tank at rest: whether pressure, loaded mass and volume fit together."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from markupsafe import Markup

from hfanalysis.errors import AbsentError
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import in_words, is_quantity


def render(material: Material) -> Iterator[Block]:
    """Quantities as rows, sentences as they are."""
    rest = material.product("calibration").get("rest") or {}
    rows = [(in_words(name), _finding(name, found)) for name, found in rest.items() if found not in (None, [], {})]
    if not rows:
        raise AbsentError("the calibration says nothing of the tank at rest")
    caption = "Whether pressure, loaded mass and volume fit a saturated tank."
    yield html.table("Tank at rest", caption, ("what", "finding"), rows)


def _finding(name: str, found: Any) -> Markup:
    if is_quantity(found):
        why = html.switchable(str(found.get("why") or found.get("reason") or ""))
        return Markup("{} {}").format(html.value(found, name), why)
    return html.switchable("; ".join(map(str, found)) if isinstance(found, list) else str(found))


SECTION = Section("The tank at rest", 75, ("calibration",), render)
