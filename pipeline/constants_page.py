"""Writes docs/constants.md, the ledger of the package's numeric constants, from the source itself: `make readme`.

A constant is a name in capitals at the top of a module with numbers in its value. What it is stands in the string below
it (or in the comment beside it), its unit there in brackets; where the number comes from follows `Source:` (a text, a
data sheet, a definition) or `Evidence:` (what was seen or breaks with another value).
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "src" / "hfanalysis"
PAGE = ROOT / "docs" / "constants.md"

_ORIGIN = re.compile(r"\b(Source|Evidence): (.*)", re.S)
_UNIT = re.compile(r"\[([^\]\s][^\]]{0,24})\]")
_WORDS = {
    "Seconds": "s",
    "Kelvin": "K",
    "Meters": "m",
    "Standard deviations": "standard deviations",
    "Samples": "samples",
}


@dataclass(frozen=True)
class Constant:
    """A number of the package: where it stands, what it is, and where it comes from ("" where nobody says)."""

    room: str
    module: str
    name: str
    value: str
    unit: str
    meaning: str
    origin: str


def constants(package: Path = PACKAGE) -> list[Constant]:
    """Every constant, by room, module and place in it."""
    return [found for path in sorted(package.rglob("*.py")) for found in _of_module(path, package)]


def _of_module(path: Path, package: Path) -> Iterator[Constant]:
    text = path.read_text(encoding="utf-8")
    lines, body = text.splitlines(), ast.parse(text).body
    module = path.relative_to(package).with_suffix("").as_posix().replace("/", ".")
    for statement, following in zip(body, [*body[1:], None], strict=True):
        for name, value in _named(statement):
            meaning, origin = _said(_below(following) or _beside(lines[statement.lineno - 1]))
            yield Constant(module.partition(".")[0], module, name, value, _unit(meaning), meaning, origin)


def _unit(meaning: str) -> str:
    """In brackets, or the first word where that is one."""
    found = _UNIT.search(meaning)
    return found[1] if found else next((unit for word, unit in _WORDS.items() if meaning.startswith(word)), "")


def _named(statement: ast.stmt) -> Iterator[tuple[str, str]]:
    """The constants of an assignment with their values as they are written."""
    if not isinstance(statement, ast.Assign | ast.AnnAssign) or statement.value is None:
        return
    targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
    for target in targets:
        names = target.elts if isinstance(target, ast.Tuple) else [target]
        apart = isinstance(statement.value, ast.Tuple) and len(names) == len(statement.value.elts) > 1
        values = statement.value.elts if apart else [statement.value] * len(names)  # type: ignore[attr-defined]
        for name, value in zip(names, values, strict=True):
            if isinstance(name, ast.Name) and name.id.isupper() and _numeric(value):
                yield name.id, ast.unparse(value)


def _numeric(value: ast.expr) -> bool:
    """Numbers, and what is made of numbers alone; no indices of a range, no text."""
    parts = list(ast.walk(value))
    numbers = [p for p in parts if isinstance(p, ast.Constant) and type(p.value) in (int, float)]
    texts = any(isinstance(p, ast.Constant) and isinstance(p.value, str | bytes) for p in parts)
    ranges = any(isinstance(p, ast.Name) and p.id == "range" for p in parts)
    calls = any(isinstance(p, ast.Call) for p in parts)
    return bool(numbers) and not (ranges or (texts and not isinstance(value, ast.Dict)) or (calls and texts))


def _below(following: ast.stmt | None) -> str:
    if isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant):
        return str(following.value.value)
    return ""


def _beside(line: str) -> str:
    return line.partition("  # ")[2]


def _said(text: str) -> tuple[str, str]:
    """What a constant is, and where it comes from."""
    text = " ".join(text.split())
    found = _ORIGIN.search(text)
    return (text[: found.start()].strip(), found[0]) if found else (text, "")


def page(found: list[Constant]) -> str:
    """The ledger as a page."""
    told = sum(bool(one.origin) for one in found)
    lines = [
        "# Constants",
        "",
        "Every number that stands at the top of a module, read from the source (`make readme`). *Source* is a text, a",
        "data sheet or a definition; *evidence* says what was seen, or what breaks with another value. A number with",
        "neither is a choice.",
        "",
        f"{len(found)} constants, {told} of them with source or evidence.",
        "",
        "| room | constants | with source or evidence |",
        "|---|---|---|",
    ]
    rooms = {room: list(rows) for room, rows in groupby(found, lambda one: one.room)}
    lines += [f"| [{r}](#{r}) | {len(rows)} | {sum(bool(o.origin) for o in rows)} |" for r, rows in rooms.items()]
    for room, rows in rooms.items():
        lines += [
            "",
            f"## {room}",
            "",
            "| constant | value | unit | what it is | where it comes from |",
            "|---|---|---|---|---|",
        ]
        lines += [_row(one) for one in rows]
    return "\n".join(lines) + "\n"


def _row(one: Constant) -> str:
    value = one.value if len(one.value) <= 48 else f"{one.value[:45]}…"
    cells = (f"`{one.module}.{one.name}`", f"`{value}`", one.unit, one.meaning, one.origin)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def main() -> None:
    PAGE.write_text(page(constants()), encoding="utf-8")


if __name__ == "__main__":
    main()
