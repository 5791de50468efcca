"""A small error in the source: where it is put, and what it says there."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "hfanalysis"


@dataclass(frozen=True)
class Edit:
    """In a file of the package, relative to it: ``new`` instead of what stands from ``start`` to ``end``."""

    file: Path
    start: int
    end: int
    new: str

    @property
    def old(self) -> str:
        """What stands there."""
        return source(self.file)[self.start : self.end]

    @property
    def line(self) -> int:
        """Where it begins."""
        return source(self.file).count("\n", 0, self.start) + 1

    @property
    def applied(self) -> str:
        """The file with the error in."""
        text = source(self.file)
        return text[: self.start] + self.new + text[self.end :]

    @property
    def around(self) -> str:
        """The definition at the top of the module that it is in, with the error in."""
        text = source(self.file)
        spans = (span(text, node) for node in tree(self.file).body)
        start, end = next(s for s in spans if s[0] <= self.start and self.end <= s[1])
        return text[start : self.start] + self.new + text[self.end : end]


@dataclass(frozen=True)
class Mutant:
    """An error by name; ``kind``: of the catalogue, or what was made of what when it was generated."""

    name: str
    kind: str
    edit: Edit

    @property
    def room(self) -> str:
        """The package that it is in."""
        return self.edit.file.parts[0] if len(self.edit.file.parts) > 1 else ""


@cache
def source(file: Path) -> str:
    """A file of the package."""
    return (PACKAGE / file).read_text(encoding="utf-8")


@cache
def tree(file: Path) -> ast.Module:
    """A file of the package, parsed."""
    return ast.parse(source(file))


@cache
def files() -> tuple[Path, ...]:
    """All files of the package, relative to it."""
    return tuple(sorted(p.relative_to(PACKAGE) for p in PACKAGE.rglob("*.py")))


def places(symbol: str) -> Iterator[tuple[Path, int, int]]:
    """Every definition of a symbol at the top of a module, wherever it is: file, where it starts and ends."""
    for file in files():
        if re.search(rf"^(?:def |class )?{symbol}\b", source(file), re.MULTILINE):
            for node in tree(file).body:
                if symbol in _defines(node):
                    yield file, *span(source(file), node)


def _defines(node: ast.stmt) -> set[str]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return {node.name}
    targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
    return {name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)}


def span(text: str, node: ast.stmt | ast.expr) -> tuple[int, int]:
    """Where a node starts and ends in its source."""
    assert node.end_lineno is not None
    assert node.end_col_offset is not None
    return _at(text, node.lineno, node.col_offset), _at(text, node.end_lineno, node.end_col_offset)


def _at(text: str, line: int, column: int) -> int:
    start = 0
    for _ in range(line - 1):
        start = text.index("\n", start) + 1
    return start + len(text[start:].split("\n", 1)[0].encode()[:column].decode())
