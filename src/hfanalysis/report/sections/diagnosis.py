"""Where the model departs from the measurement: sources over time, and the residual without and with them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from hfanalysis.diagnose.words import gap_line, sentence
from hfanalysis.report import html
from hfanalysis.report.chart import Chart, Series, over_time
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section


def render(material: Material) -> Iterator[Block]:
    """The sentences, the sources over time, and the gap per channel."""
    product = material.product("diagnosis")
    places = product["localisation"]
    if not places:
        yield html.paragraph(
            "The model with its calibrated constants explains what was measured: no source is claimed."
        )
    yield html.bullets((html.switchable(sentence(place)) for place in places), "plain")
    for place in places:
        yield _source(material, place)
    lines = (html.switchable(gap_line(name, product["gap"])) for name in product["compared"]["channels"])
    yield html.bullets(lines, "plain")


def _source(material: Material, place: dict[str, Any]) -> Chart | None:
    table = material.table("diagnosis", f"sources/{place['site']}")
    if "mean" not in table:
        return None
    time, mean, std = (table[name].values for name in ("time", "mean", "std"))
    series = [
        Series("95 % band", "p_run", time, mean - 1.96 * std, "band", mean + 1.96 * std),
        Series(place["site"], "p_run", time, mean),
    ]
    title = f"What the model lacks in {place['equation'].replace('_', ' ')}: {place['site']}"
    key = f"diagnosis-{place['site'].replace('_', '-').replace(' ', '-')}"
    unit = "" if place["source"]["unit"] == "1" else place["source"]["unit"]
    caption = "The source that explains the disagreement best, with all calibrated constants free."
    return over_time(material, key, title, (place["site"], unit), series, caption, height=240.0)


SECTION = Section("Where the model departs", 65, ("diagnosis",), render)
