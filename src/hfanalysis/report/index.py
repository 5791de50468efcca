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

_EMPTY: dict[str, Any] = {"kind": "", "date": "", "source": "measured", "sentence": "", "numbers": [], "spark": {}}


def write_index(folder: Path) -> Path:
    """Write ``index.html`` over the pages below ``folder`` (processed/); returns its path."""
    path = folder / "index.html"
    text = render("index.html.j2", rows=[_row(page) for page in sorted(folder.glob("*/report.html"))])
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
    return {**_EMPTY, **found, "id": page.parent.name, "href": f"{quote(page.parent.name)}/report.html"}
