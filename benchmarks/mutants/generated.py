"""Errors made by rule: of constants, thresholds, standard deviations and derived columns; a sample of each room."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from hashlib import sha256
from itertools import islice, zip_longest
from pathlib import Path

from benchmarks.mutants.mutant import Edit, Mutant, files, source, span

SPREAD = re.compile(r"(^|_)(std|sigma|spread|error|errors)$")
KINDS = ("spread", "column", "threshold", "constant")
FACTORS = ("2.0", "0.1")


def generated(room: str, number: int, seed: int) -> list[Mutant]:
    """A sample of a room's errors, of all kinds alike; that of a seed changes with the code that it is in alone."""
    drawn = sorted(of_room(room), key=lambda m: sha256(f"{seed} {m.name}".encode()).digest())
    kinds = [[m for m in drawn if m.kind == kind] for kind in KINDS]
    in_turn = (m for row in zip_longest(*kinds) for m in row if m is not None)
    return sorted(islice(in_turn, number), key=lambda m: m.name)


def of_room(room: str) -> Iterator[Mutant]:
    """Every error that can be made of a package, or of one within it."""
    for file in files():
        if file.is_relative_to(room):
            yield from of_file(file)


def of_file(file: Path) -> Iterator[Mutant]:
    """Every error that can be made of a file."""
    text, seen = source(file), dict[str, int]()
    for kind, owner, node, factor in _every(ast.parse(text)):
        start, end = span(text, node)
        name = f"{file.as_posix()}: {owner}: {' '.join(text[start:end].split())[:60]} x {factor}"
        seen[name] = seen.get(name, 0) + 1
        again = f" ({seen[name]})" if seen[name] > 1 else ""
        yield Mutant(name + again, kind, Edit(file, start, end, f"({factor} * ({text[start:end]}))"))


def _every(tree: ast.Module) -> Iterator[tuple[str, str, ast.expr, str]]:
    """Kind, owner, what is changed, and the factor."""
    for statement in tree.body:
        if isinstance(statement, ast.Assign | ast.AnnAssign) and statement.value is not None:
            target = statement.targets[0] if isinstance(statement, ast.Assign) else statement.target
            for number in _numbers(statement.value):
                yield from (("constant", ast.unparse(target), number, factor) for factor in FACTORS)
        for function in (n for n in ast.walk(statement) if isinstance(n, ast.FunctionDef)):
            yield from _in_function(function)


def _in_function(function: ast.FunctionDef) -> Iterator[tuple[str, str, ast.expr, str]]:
    for node in _own(function):
        if isinstance(node, ast.Compare):
            for number in (n for side in (node.left, *node.comparators) for n in _numbers(side)):
                yield from (("threshold", function.name, number, factor) for factor in FACTORS)
        elif isinstance(node, ast.Return) and node.value is not None and SPREAD.search(function.name):
            yield "spread", function.name, node.value, "2.0"
        for kind, value in _derived(node):
            yield kind, function.name, value, "2.0"


def _own(function: ast.FunctionDef) -> Iterator[ast.AST]:
    """What a function holds, without the functions in it."""
    for part in ast.iter_child_nodes(function):
        waiting = [part]
        while waiting:
            node = waiting.pop()
            if not isinstance(node, ast.FunctionDef):
                yield node
                waiting.extend(ast.iter_child_nodes(node))


def _derived(node: ast.AST) -> Iterator[tuple[str, ast.expr]]:
    """Standard deviations that are computed or passed on, and columns that are computed."""
    if isinstance(node, ast.Assign) and _computed(node.value):
        target = node.targets[0]
        if isinstance(target, ast.Name) and SPREAD.search(target.id):
            yield "spread", node.value
        if isinstance(target, ast.Subscript) and _is_text(target.slice):
            yield "column", node.value
    elif isinstance(node, ast.keyword) and node.arg and SPREAD.search(node.arg) and not _is_none(node.value):
        yield "spread", node.value
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Quantity":
        yield from (("spread", v) for v in node.args[2:3] if not _is_none(v) and not isinstance(v, ast.Starred))
    elif isinstance(node, ast.Dict):
        yield from (("column", v) for k, v in zip(node.keys, node.values, strict=True) if _is_text(k) and _computed(v))


def _numbers(node: ast.expr) -> Iterator[ast.expr]:
    """Numbers in an expression but 0; integers are left alone: they count or name places."""
    for part in ast.walk(node):
        if isinstance(part, ast.Constant) and isinstance(part.value, float) and part.value != 0.0:
            yield part


def _computed(node: ast.expr) -> bool:
    """Whether a value is arithmetic, and not of words or sets."""
    words = any(isinstance(n, ast.JoinedStr) or _is_text(n) for n in ast.walk(node))
    return isinstance(node, ast.BinOp) and not isinstance(node.op, ast.BitOr | ast.BitAnd) and not words


def _is_text(node: ast.AST | None) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None
