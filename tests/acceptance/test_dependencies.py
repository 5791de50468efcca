"""The package requires what it imports, and nothing else."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from hfanalysis.sources import PACKAGE, libraries

REPOSITORY = Path(__file__).parents[2]
COMES_WITH = {
    "PIL": "pillow",
    "markdown_it": "markdown-it-py",
    "pydantic_core": "pydantic",
    "python_calamine": "python-calamine",
}
"""Imported modules that come in a distribution of another name."""
BY_NAME = {"h5netcdf"}
"""Required, and loaded by xarray, which is told its name."""


def required() -> set[str]:
    """The distributions named in pyproject.toml, in lower case."""
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["project"]
    return names(project["dependencies"])


def optional() -> set[str]:
    """The distributions of extras for who uses the package."""
    extras = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    return set().union(*(names(texts) for extra, texts in extras.items() if extra != "dev"))


def names(texts: list[str]) -> set[str]:
    """Of requirements, without versions and conditions."""
    return {re.split(r"[\s<>=!~;\[]", text, maxsplit=1)[0].lower() for text in texts}


def pinned(lock: str) -> dict[str, set[str]]:
    """The versions that a lock file pins of each distribution, by its name in lower case."""
    found: dict[str, set[str]] = {}
    for name, version in re.findall(r"(?m)^([\w.-]+)==(\S+)", (REPOSITORY / lock).read_text().lower()):
        found.setdefault(name, set()).add(version)
    return found


def test_what_is_imported_is_required_and_the_other_way_round() -> None:
    imported = {COMES_WITH.get(name, name).lower() for name in libraries(PACKAGE.rglob("*.py"))}
    assert imported | BY_NAME == required() | optional()
    assert required() & optional() == set()


def test_what_an_extra_brings_is_asked_for_by_the_extra_s_name() -> None:
    """Where it is imported, its absence is met, and the message says what to install."""
    for path in PACKAGE.rglob("*.py"):
        for name in optional() & {name.lower() for name in libraries([path])}:
            assert "except ImportError" in path.read_text(), f"{path.name}: {name}"
            assert "hfanalysis[" in path.read_text(), f"{path.name}: {name}"


def test_what_is_required_is_locked() -> None:
    assert (required() | optional()) - pinned("requirements.lock").keys() == set()


def test_what_flights_are_compared_with_is_no_part_of_the_package_and_pinned_apart() -> None:
    """RocketPy has an environment of its own; what both environments have is of the same versions."""
    product, compared = pinned("requirements.lock"), pinned("requirements-rocketpy.lock")
    assert "rocketpy" in compared
    assert "rocketpy" not in product
    assert {name for name in product.keys() & compared.keys() if product[name] != compared[name]} == set()
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text())["project"]
    assert "rocketpy" not in str([project["dependencies"], project["optional-dependencies"]]).lower()


@pytest.mark.parametrize("lock", ["requirements.lock", "requirements-rocketpy.lock"])
def test_every_locked_package_has_a_hash(lock: str) -> None:
    entries = re.split(r"(?m)^(?=[\w.-]+==)", (REPOSITORY / lock).read_text())[1:]
    assert len(entries) > 20
    assert [entry.splitlines()[0] for entry in entries if "--hash=sha256:" not in entry] == []
