"""The page over all tests that have a page."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path
from typing import Any
from urllib.parse import quote

from hfanalysis.report import wording
from hfanalysis.report.page import render
from hfanalysis.testdata.products import atomic, read_json

_LEAD = re.compile(r'<p class="lead">(.*?)</p>', re.DOTALL)


def write_index(folder: Path) -> Path:
    """Write ``index.html`` over the pages below ``folder`` (processed/); returns its path."""
    path = folder / "index.html"
    text = render("index.html.j2", rows=[_row(page.parent) for page in sorted(folder.glob("*/report.html"))])
    if not (path.exists() and path.read_text(encoding="utf-8") == text):
        with atomic(path) as scratch:
            scratch.write_text(text, encoding="utf-8")
    return path


def _row(folder: Path) -> dict[str, Any]:
    """What the index says about a test."""
    about = _read(folder / "ingest.json")
    segments = _read(folder / "segments.json")
    kind = str(segments.get("kind", ""))
    lead = _LEAD.search((folder / "report.html").read_text(encoding="utf-8"))
    return {
        "id": folder.name,
        "kind": wording.KINDS.get(kind, kind) or "no firing found",
        "date": "",
        "source": str(about.get("source", "measured")),
        "sentence": unescape(lead[1]) if lead else "",
        "href": f"{quote(folder.name)}/report.html",
    }


def _read(path: Path) -> dict[str, Any]:
    try:
        return read_json(path)
    except (OSError, ValueError):
        return {}
