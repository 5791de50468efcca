"""The page's sections, one small file each; adding a section is adding a file.

A module of this package defines ``SECTION``::

    # sections/purge.py
    def render(material: Material) -> Iterator[Block]:
        (pressure,) = required(material.table("performance"), "purge_flow")   # AbsentError: the reason is shown
        yield over_time(material, "purge", "Purge", ("flow", "kg/s"), [...])  # a chart; None draws nothing
        yield html.paragraph("…")                                            # or HTML

    SECTION = Section("Purge", place=45, needs=("performance",), render=render)
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

from markupsafe import Markup

from hfanalysis.charts.chart import Chart
from hfanalysis.errors import AbsentError
from hfanalysis.report.material import Material

Block = Chart | Markup | None
"""What a section is made of: charts and HTML, in the order of the page."""


@dataclass(frozen=True)
class Section:
    """A part of the page.

    Attributes:
        title: its heading.
        place: where it stands; sections are sorted by it.
        needs: the products without which it has nothing to show (``"calibration"``, ``"residuals"``).
        render: what it shows; may raise :class:`AbsentError` with the reason why it has nothing to show.
        folded: whether the page opens with it closed: what is looked up, not read.
        unasked: whether nobody misses it where it has nothing to show, so that the page does not say so.
    """

    title: str
    place: float
    needs: tuple[str, ...]
    render: Callable[[Material], Iterable[Block]]
    folded: bool = False
    unasked: bool = False


@dataclass(frozen=True)
class Laid:
    """A section as it is shown for one test: its blocks, or why there are none."""

    key: str
    title: str
    blocks: tuple[Chart | Markup, ...]
    absent: str = ""
    folded: bool = False

    @property
    def charts(self) -> list[Chart]:
        """Its charts."""
        return [block for block in self.blocks if isinstance(block, Chart)]


@functools.cache
def sections() -> tuple[tuple[str, Section], ...]:
    """All sections with their keys, in the order of the page."""
    found = []
    for module in pkgutil.iter_modules(__path__):
        section = importlib.import_module(f"{__name__}.{module.name}").SECTION
        assert isinstance(section, Section)
        found.append((module.name, section))
    return tuple(sorted(found, key=lambda item: (item[1].place, item[0])))


def lay_out(material: Material) -> list[Laid]:
    """Every section as it is shown for this test."""
    return [_laid(key, section, material) for key, section in sections()]


def _laid(key: str, section: Section, material: Material) -> Laid:
    out = Laid(key, section.title, (), folded=section.folded)
    missing = [name for name in section.needs if not material.has(name)]
    if missing:
        return replace(out, absent=material.why_not(missing[0]))
    try:
        blocks = tuple(block for block in section.render(material) if block is not None)
    except AbsentError as error:
        return replace(out, absent=str(error))
    return replace(out, blocks=blocks, absent="" if blocks or section.unasked else "there is nothing to draw")


def charts(material: Material) -> Iterator[Chart]:
    """All charts of the page, each line once."""
    for laid in lay_out(material):
        yield from (chart for chart in laid.charts if not chart.repeats)
