"""The tank at rest: whether pressure, loaded mass and volume fit together."""

from __future__ import annotations

from collections.abc import Iterator

from markupsafe import Markup

from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.sentences import joined
from hfanalysis.wording.numbers import in_words


def render(material: Material) -> Iterator[Block]:
    """Quantities as rows, sentences as they are."""
    rest = material.need(Calibration).rest
    if rest is None:
        raise AbsentError("the calibration says nothing of the tank at rest")
    rows = [(in_words(name), _finding(name, found)) for name, found in rest.quantities.items()]
    if rest.remarks:
        rows.append(("remarks", html.switchable(joined("; ", rest.remarks))))
    caption = "Whether pressure, loaded mass and volume fit a saturated tank."
    yield html.table("Tank at rest", caption, ("what", "finding"), rows)


def _finding(name: str, found: Quantity) -> Markup:
    return Markup("{} {}").format(html.value(found, name), html.remark(found, ()))


SECTION = Section("The tank at rest", 75, ("calibration",), render, folded=True)
