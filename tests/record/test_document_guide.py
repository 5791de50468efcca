"""docs/test-toml.md says everything that a test.toml may say."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest

from hfanalysis.record.definition import Statements
from hfanalysis.record.schema import DERIVED

DOCS = Path(__file__).parents[2] / "docs"
GUIDE = (DOCS / "test-toml.md").read_text(encoding="utf-8")
OF_ENGINES = {
    "length",
    "ullage",
    "dip_tube",
    "outer_diameter",
    "polytropic_exponent",
    "C_i",
    "a",
    "n",
    "nitrogen_pressure",
}
"""Keys that the sections share with engine files, which alone need them."""


def sections(hint: Any) -> list[type]:
    """The sections in a type."""
    if isinstance(hint, type) and is_dataclass(hint):
        return [hint]
    return [found for part in get_args(hint) for found in sections(part)]


def keys(of: type, seen: set[type]) -> set[str]:
    """All keys of a section and of those in it."""
    hints, out = get_type_hints(of, include_extras=True), set()
    for field in fields(of):
        if field.metadata == DERIVED or field.name == "_":
            continue
        out.add(field.name)
        for part in sections(hints[field.name]):
            if part not in seen and part.__module__.startswith("hfanalysis.record"):
                out |= keys(part, seen | {part})
    return out


@pytest.mark.parametrize("key", sorted(keys(Statements, {Statements}) - OF_ENGINES))
def test_every_key_is_in_the_guide(key: str) -> None:
    words = GUIDE.replace("[", " ").replace("]", " ").replace("`", " ").replace(".", " ").split()
    assert key in words
