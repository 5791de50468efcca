"""Which files a piece of the package rests on is told from their text, and told right."""

from __future__ import annotations

import ast
import importlib.metadata
from collections.abc import Iterator
from pathlib import Path

import pytest

from hfanalysis import sources
from hfanalysis.sources import PACKAGE, closure, data, libraries, short
from hfanalysis.stages.freshness import library_versions

ALL = frozenset(PACKAGE.rglob("*.py"))
BY_NAME = {"import_module", "iter_modules", "walk_packages", "__import__", "spec_from_file_location", "load_module"}


def parsed(path: Path) -> tuple[set[str], set[str]]:
    """The names that the compiler says a source imports: outside functions, and anywhere."""
    tree = ast.parse(path.read_text("utf-8"))
    return set(said(tree, inside=False)), set(said(tree, inside=True))


def said(node: ast.AST, inside: bool) -> Iterator[str]:
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        return
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    if isinstance(node, ast.ImportFrom):
        assert node.level == 0, "imports of the package are written in full"
        yield from (str(node.module), *(f"{node.module}.{alias.name}" for alias in node.names))
    if inside or not isinstance(node, ast.FunctionDef):
        for child in ast.iter_child_nodes(node):
            yield from said(child, inside)


def misread(path: Path) -> set[str]:
    """What is found of a source's imports and is none, or is one and is not found; modules of ours may be more."""
    (top, anywhere), (real_top, real) = sources._names(path), parsed(path)
    return (top ^ real_top) | (real - anywhere) | {name for name in anywhere - real if name not in sources._tree()[0]}


def test_every_import_of_the_package_is_found_and_nothing_else() -> None:
    assert {short(path): wrong for path in ALL if (wrong := misread(path))} == {}


def test_a_statement_may_be_written_in_many_ways(tmp_path: Path) -> None:
    path = tmp_path / "one.py"
    path.write_text(
        '"""import a.docstring\nimport another\n"""\n'
        "import numpy as np, h5py  # import pandas\nfrom a import (\n    b as c,  # from d import e\n    f,\n)\n"
        "if TYPE_CHECKING:\n    from g import h\n\n    import i\n\ndef j():\n    from k.l import m\n"
        'def n():\n    """import o"""\n    import p.q\nTEXT = \'\'\'\nimport r\n"""\nimport s\n\'\'\'\n'
    )
    top, anywhere = sources._names(path)
    assert top == {"numpy", "h5py", "a", "a.b", "a.f"}
    assert anywhere - top == {"k.l", "k.l.m", "p.q"}
    assert libraries([path]) == ["a", "h5py", "k", "numpy", "p"]


def loads_by_name(path: Path) -> bool:
    return any(
        isinstance(node, ast.Name | ast.Attribute) and (node.id if isinstance(node, ast.Name) else node.attr) in BY_NAME
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
    )


def test_modules_are_loaded_by_name_only_where_that_is_known() -> None:
    """Who adds one sees to it that the closure has what it loads.

    ``stages/base.py`` loads stages for the runner: what they make is among the inputs of the stages after them. The
    package itself loads its public names for those who ask for them from without; ``stages/file_locks.py`` loads a
    module of the operating system's, and ``report/names.py`` only lists the effects.
    """
    found = {short(path) for path in ALL if loads_by_name(path)}
    known = {
        "__init__.py",
        "effects/__init__.py",
        "health/kinds/__init__.py",
        "health/stand/__init__.py",
        "health/ties/__init__.py",
        "inference/unknowns/__init__.py",
        "report/names.py",
        "report/sections/__init__.py",
        "record/readers/__init__.py",
        "stages/base.py",
        "stages/file_locks.py",
    }
    assert found == known


@pytest.mark.parametrize("name", ["effects", "inference/unknowns", "report/sections", "record/readers"])
def test_what_a_package_loads_by_name_is_found_through_it(name: str) -> None:
    loading = PACKAGE / name / "__init__.py"
    known = {path for path in (PACKAGE / name).glob("*.py") if not path.name.startswith("_")}
    assert len(known) > 5
    readers_used_by_readers = {PACKAGE / "record/readers" / f"{helper}.py" for helper in ("stamps", "table")}
    assert known - readers_used_by_readers <= closure(loading)


def test_compiled_code_rests_on_what_its_module_imports_at_the_top() -> None:
    pitch = PACKAGE / "flight" / "pitch.py"
    assert {PACKAGE / "thermo" / "air.py", PACKAGE / "thermo" / "constants.py"} <= closure(pitch, inside=False)
    assert "scipy" in libraries([PACKAGE / "thermo" / "saturation.py"])
    assert closure(PACKAGE / "stages" / "flight.py", inside=False) < closure(PACKAGE / "stages" / "flight.py")


def test_a_package_on_the_way_brings_no_imports_of_its_functions() -> None:
    """``load_residuals`` of the package itself imports the whole of validate; nobody calls it who imports a unit."""
    assert PACKAGE / "__init__.py" in closure(PACKAGE / "units.py")
    assert not [path for path in closure(PACKAGE / "units.py") if "validate" in path.parts]
    assert PACKAGE / "validate" / "load.py" in closure(PACKAGE / "__init__.py")


def test_every_data_file_belongs_to_a_package() -> None:
    there = {path for path in PACKAGE.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
    assert data(ALL) == there - ALL
    assert {short(path) for path in data([PACKAGE / "diagnose" / "answer" / "posterior.py"])} == {
        "diagnose/answer/probabilities.json",
        "diagnose/answer/worlds.json",
    }


def test_every_library_has_the_version_of_the_distribution_that_brings_it() -> None:
    brings = importlib.metadata.packages_distributions()
    expected = {}
    for name in libraries(ALL):
        (distribution,) = set(brings[name])
        expected[name] = importlib.metadata.version(distribution)
    assert library_versions(libraries(ALL)) == expected
    assert {"numpy", "cea", "numba", "pint", "xarray", "jinja2"} <= set(expected)
