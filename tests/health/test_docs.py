"""Every kind of finding is explained, and every detector is of a kind."""

from __future__ import annotations

import re
from pathlib import Path

from hfanalysis.health import kinds
from hfanalysis.products.health import KINDS

DOCS = Path(__file__).parents[2] / "docs" / "health.md"


def test_docs_have_a_section_for_every_kind_and_no_other() -> None:
    assert re.findall(r"^### (.*)$", DOCS.read_text(encoding="utf-8"), re.MULTILINE) == list(KINDS)


def test_detectors_of_a_channel_are_named_after_their_kind() -> None:
    assert kinds.detectors()
    assert set(kinds.detectors()) <= set(KINDS)
