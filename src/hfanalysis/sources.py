"""Which files a piece of the package rests on, told from their text: the modules that it imports, directly or not, and
the data beside them.

Imports are import statements, at the top level of a module or inside its functions; modules that are named in full in a
string; and every module of a package that walks through itself or loads its modules by name (the readers by format,
the effects, the sections of the page). Statements that only a type checker sees do not count. Of a package that is
merely on the way to a module (``hfanalysis`` of ``hfanalysis.units``), what its functions import does not count: nobody
calls them.

Files are searched, not parsed: parsing takes seconds, and every command looks here before it does anything. What was
found is remembered while no file of the package has changed, by size, times and inode.
"""

from __future__ import annotations

import os
import re
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

from hfanalysis.remembered import Remembered

PACKAGE = Path(__file__).resolve().parent

_BEFORE = f"{PACKAGE}{os.sep}"
_TEXTS = ("'" * 3, '"' * 3)
_TYPING = re.compile(r"\nif TYPE_CHECKING:.*\n(?:[ \t].*\n|\n)*")
_STATEMENT = re.compile(r"\n([ \t]*)(?:from ([\w.]+) import (\([^)]*\)|.*)|import (.*))")
_NAMED = re.compile(rf'"({PACKAGE.name}(?:\.\w+)+)"')
_WALKS = ("(__path__)", 'import_module(f"{__name__}.')
_COMPILED = "__pycache__"
SETTLED_NS = 2_000_000_000
"""How old a file must be for its times to vouch for its content [ns]: file systems stamp no finer than 1 to 2 s.
Source: FAT stamps every 2 s."""

Imports = tuple[frozenset[str], frozenset[str]]
"""Dotted names that a file may import: at its top level, and anywhere."""


class State(NamedTuple):
    """Of all files of the package: what tells that none was touched, when one last was [ns], and whether that is long
    enough ago for it to be told."""

    mark: str
    newest: int
    settled: bool


@cache
def state() -> State:
    """That of the package when it was first asked for."""
    stats = sorted(_stats(str(PACKAGE)))
    latest = max(max(mtime, ctime) for _, _, mtime, ctime, _ in stats)
    return State(
        sha256(repr(stats).encode()).hexdigest(), max(mtime for _, _, mtime, *_ in stats),
        time.time_ns() - latest > SETTLED_NS,
    )  # fmt: skip


def _stats(folder: str) -> Iterator[tuple[str, int, int, int, int]]:
    """Path, size, times of modification and change [ns], and inode of every file."""
    with os.scandir(folder) as found:
        for entry in found:
            if not entry.is_dir():
                stat = entry.stat()
                yield entry.path, stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns, stat.st_ino
            elif entry.name != _COMPILED:
                yield from _stats(entry.path)


@cache
def _memory() -> Remembered:
    return Remembered(PACKAGE / _COMPILED / "sources.json", state().mark, state().settled)


def remembered(question: str, roots: Iterable[Path], find: Callable[[], Any]) -> Any:
    """What ``find`` gives, from memory if it follows from the package alone: from ``roots`` that lie in it."""
    names = [short(root) for root in roots]
    if any(PACKAGE / name != root for name, root in zip(names, roots, strict=True)):
        return find()
    return _memory()(f"{question} {' '.join(sorted(names))}", find)


def source_digest(root: Path, inside: bool = True) -> str:
    """:func:`digest` of a source's :func:`closure`."""
    path = root.resolve()
    return str(remembered(f"digest {inside:d}", [path], lambda: digest(closure(path, inside=inside))))


@cache
def closure(*roots: Path, inside: bool = True) -> frozenset[Path]:
    """The sources that the given ones rest on, themselves included.

    Args:
        roots: sources, of the package or not.
        inside: whether imports inside functions count; without them it is what compiled code can call.
    """
    seen: set[tuple[Path, bool]] = set()
    waiting = {(root.resolve(), inside) for root in roots}
    while waiting:
        seen |= waiting
        waiting = {(found, whole and inside) for item in waiting for found, whole in _next(*item)} - seen
    return frozenset(path for path, _ in seen)


def libraries(files: Iterable[Path]) -> list[str]:
    """The top-level names of what these sources import that is neither the package's nor Python's own, in order."""
    return sorted(set().union(*map(_libraries, files)))


@cache
def _libraries(path: Path) -> frozenset[str]:
    return frozenset(name.partition(".")[0] for name in _names(path)[1]) - sys.stdlib_module_names - {PACKAGE.name}


def data(files: Iterable[Path]) -> set[Path]:
    """What lies beside these sources that is none: the data files of their packages, in folders without modules too."""
    folders = {path.parent for path in files}
    return {path for path, folder in _tree()[1] if folder in folders}


@cache
def digest(files: frozenset[Path]) -> str:
    """SHA-256 over names and contents of files."""
    total = sha256()
    for name, content in sorted((short(path), _content(path)) for path in files):
        total.update(f"{name}\0{content}\n".encode())
    return total.hexdigest()


@cache
def _content(path: Path) -> str:
    return sha256(_read(path)).hexdigest()


@cache
def _read(path: Path) -> bytes:
    with open(path, "rb", buffering=0) as file:
        return file.readall()


@cache
def short(path: Path) -> str:
    """A file's path in the package; of one that is not in it the name."""
    return str(path).removeprefix(_BEFORE) if str(path).startswith(_BEFORE) else path.name


@cache
def _next(path: Path, inside: bool) -> tuple[tuple[Path, bool], ...]:
    """The sources of ours that a file itself rests on; False for packages that are merely on the way to it."""
    modules = _tree()[0]
    imported = ((modules[name], True) for name in _names(path)[inside] if name in modules)
    return (*imported, *((parent, False) for parent in _packages(path.parent)))


@cache
def _packages(folder: Path) -> tuple[Path, ...]:
    """The ``__init__`` of every package that a source in this folder lies in."""
    inits = (parent / "__init__.py" for parent in (folder, *folder.parents) if parent.is_relative_to(PACKAGE))
    return tuple(inits)


@cache
def _names(path: Path) -> Imports:
    code = _without_texts(_read(path).decode("utf-8", "replace"))
    walks = path.name == "__init__.py" and any(mark in code for mark in _WALKS)
    top: set[str] = set()
    inner = set(_NAMED.findall(code)) | (_of_package(path) if walks else set())
    for indent, module, names, plain in _STATEMENT.findall(_TYPING.sub("\n", code)):
        (inner if indent else top).update(_said(module, names or plain))
    return frozenset(top), frozenset(top | inner)


def _without_texts(source: str) -> str:
    """A source without its docstrings and other long texts, which may hold code of another program."""
    source = source.replace("\r\n", "\n")
    for mark in _TEXTS:
        source = mark.join(source.split(mark)[::2])
    return "\n" + source


def _said(module: str, names: str) -> Iterator[str]:
    """The modules that ``from module import names`` may mean, or ``import names``."""
    if module:
        yield module
    before = f"{module}." if module else ""
    for name in re.sub(r"#.*|[()]", "", names).split(","):
        if name.strip():
            yield before + name.split()[0]


def _of_package(path: Path) -> set[str]:
    """All modules of the package whose ``__init__`` this is."""
    before = f"{path.parent}{os.sep}"
    return {name for name, module in _tree()[0].items() if str(module).startswith(before)}


@cache
def _tree() -> tuple[dict[str, Path], list[tuple[Path, Path]]]:
    """The package's modules by name; its data files, each with the folder of modules that it belongs to."""
    modules: dict[str, Path] = {}
    beside: list[tuple[Path, Path]] = []
    owners: dict[str, Path] = {}
    for folder, inner, names in os.walk(PACKAGE):
        inner[:] = [name for name in inner if name not in _COMPILED]
        here = Path(folder)
        dotted = ".".join((PACKAGE.name, *here.relative_to(PACKAGE).parts))
        owner = owners[folder] = here if "__init__.py" in names else owners.get(str(here.parent), here)
        for name in names:
            if name.endswith(".py"):
                modules[f"{dotted}.{name[:-3]}".removesuffix(".__init__")] = here / name
            else:
                beside.append((here / name, owner))
    return modules, beside
