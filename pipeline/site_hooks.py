"""For the documentation's builder: equations between `$$` become MathML when a page is made, so that it loads nothing;
links to files of the repository that are no pages become their names."""

from __future__ import annotations

import re
from typing import Any

EQUATION = re.compile(r"^\$\$(.+?)\$\$$", re.MULTILINE | re.DOTALL)
OUTSIDE = re.compile(r"\[([^\]]+)\]\((?:\.\./[^)]*|schemas/?)\)")


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Called for every page."""
    from latex2mathml.converter import convert

    inside = OUTSIDE.sub(r"\1", markdown)
    return EQUATION.sub(lambda found: convert(" ".join(found[1].split()), display="block"), inside)
