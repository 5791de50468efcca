"""The package requires what it imports, and nothing else."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
COMES_WITH = {"pydantic_core": "pydantic", "sksundae": "scikit-sundae"}
"""Imported modules that come in a distribution of another name."""


def imported() -> Iterator[str]:
    """Top-level names of the modules that the package imports anywhere."""
    for path in (REPOSITORY / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                yield from (alias.name.split(".")[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                yield node.module.split(".")[0]


def required() -> set[str]:
    """The distributions named in pyproject.toml, in lower case."""
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["project"]
    return {re.split(r"[\s<>=!~;\[]", text, maxsplit=1)[0].lower() for text in project["dependencies"]}


def test_what_is_imported_is_required_and_the_other_way_round() -> None:
    third_party = set(imported()) - set(sys.stdlib_module_names) - {"hfanalysis"}
    assert {COMES_WITH.get(name, name).lower() for name in third_party} == required()


def test_what_is_required_is_locked() -> None:
    lock = (REPOSITORY / "requirements.lock").read_text().lower()
    assert {name for name in required() if not re.search(rf"(?m)^{re.escape(name)}==", lock)} == set()
