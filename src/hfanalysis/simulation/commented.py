"""Files that say where every number is from, and that are written over only as long as nobody has changed them."""

from __future__ import annotations

import hashlib
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic
from hfanalysis.record.written import value_text

MARK = "# Written by hfa engine; sha256 of what follows:"
"""How a file begins that may be written over as long as what follows is as it was written."""

WIDTH = 110
"""Columns of a comment. Source: by choice, as wide as the pages' sources."""


@dataclass
class Table:
    """A section of such a file: its keys in order, and what is said of each."""

    keys: dict[str, Any] = field(default_factory=dict)
    said: dict[str, str] = field(default_factory=dict)

    def put(self, key: str, value: Any, said: str) -> None:
        """A key with its value, and what is said of it."""
        self.keys[key], self.said[key] = value, said

    def lines(self, name: str) -> Iterator[str]:
        """As TOML, what is said beside a line or above it."""
        yield f"\n[{name}]"
        for key, value in self.keys.items():
            line, said = f"{key} = {value_text(value)}", comment(self.said[key])
            beside = len(said) == 1 and len(line) + len(said[0]) + 2 <= WIDTH
            yield from [f"{line}  {said[0]}"] if beside else [*said, line]


def marked(body: str) -> str:
    """The file of such a text, with the mark by which it is known again."""
    return f"{MARK} {_hash(body)}\n{body}"


def write(path: Path, text: str) -> None:
    """Write it whole or not at all. Raises InputError for a file there that no such text is, or that was changed, and
    where nothing can be written."""
    try:
        if path.exists() and not _own(path):
            raise InputError(f"{path}: found a file that this command did not write, or changed since; move it away")
        with atomic(path) as scratch:
            scratch.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); expected a file's name") from None


def _own(path: Path) -> bool:
    first, _, body = path.read_text(encoding="utf-8", errors="replace").partition("\n")
    return first == f"{MARK} {_hash(body)}"


def _hash(body: str) -> str:
    return hashlib.sha256(body.encode()).hexdigest()


def comment(text: str) -> list[str]:
    """A text as comments, nothing in it that cannot be seen."""
    flat = "".join(mark if mark.isprintable() else "?" for mark in " ".join(text.split()))
    return [f"# {line}" for line in textwrap.wrap(flat, WIDTH, break_long_words=False, break_on_hyphens=False)]
