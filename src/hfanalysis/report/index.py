"""The page over all tests that have a page."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from urllib.parse import quote

from hfanalysis.products.disk import atomic
from hfanalysis.report.page import SUMMARY, render

_HEAD = 64_000
"""Characters from the start of a page within which its summary ends [characters]."""

_EMPTY: dict[str, Any] = {"kind": "", "date": "", "source": "measured", "sentence": "", "numbers": [], "spark": {},
                          "compared": [], "limits": [], "kept": 0}  # fmt: skip


def write_index(folder: Path) -> Path:
    """Write ``index.html`` over the pages below ``folder`` (processed/); returns its path."""
    path = folder / "index.html"
    rows = [_row(page) for page in sorted(folder.glob("*/report.html"))]
    campaign = "campaign.html" if (folder / "campaign.html").is_file() else ""
    text = render("index.html.j2", rows=rows, campaign=campaign)
    if not (path.exists() and path.read_text(encoding="utf-8") == text):
        with atomic(path) as scratch:
            scratch.write_text(text, encoding="utf-8")
    return path


def _row(page: Path) -> dict[str, Any]:
    """What the index says about a test, as its page has it."""
    with page.open(encoding="utf-8") as file:
        _, _, rest = file.read(_HEAD).partition(SUMMARY)
    try:
        found = json.loads(rest.partition("</script>")[0])
    except ValueError:
        found = {}
    name = page.parent.name
    beside = {path.stem.removeprefix("compare_"): path.name for path in sorted(page.parent.glob("compare_*.html"))}
    compared = [(other, f"{quote(name)}/{quote(file)}") for other, file in beside.items()]
    return {**_EMPTY, **found, "id": name, "href": f"{quote(name)}/report.html", "compared": compared}
