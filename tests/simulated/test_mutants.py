"""Errors are put where they are named, and tests that pass with one in are seen to."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import pytest
from benchmarks.mutants import workshop
from benchmarks.mutants.__main__ import known, result
from benchmarks.mutants.catalogue import CATALOGUE, catalogue
from benchmarks.mutants.generated import generated, of_file
from benchmarks.mutants.mutant import Edit, Mutant, files, source, tree
from benchmarks.mutants.page import page
from benchmarks.mutants.workshop import Ran, room_tests, state


@pytest.fixture(scope="module")
def by_hand() -> list[Mutant]:
    return list(catalogue())


def test_every_error_of_the_catalogue_is_in_one_place_and_leaves_source_that_can_be_read(by_hand: list[Mutant]) -> None:
    assert len({m.name for m in by_hand}) == len(by_hand)
    assert {m.name for m in by_hand} > {error.name for error in CATALOGUE}
    for mutant in by_hand:
        assert mutant.edit.applied != source(mutant.edit.file)
        ast.parse(mutant.edit.applied)


def test_every_error_has_room_tests_its_room(by_hand: list[Mutant]) -> None:
    for mutant in by_hand:
        assert (workshop.ROOT / room_tests(mutant)).exists(), mutant.name


def test_a_symbol_that_is_nowhere_is_said() -> None:
    with pytest.raises(LookupError, match="is in 0 places"):
        replace(CATALOGUE[0], symbol="no_such_symbol").mutant()


@pytest.mark.parametrize("room", ["performance", "flight"])
def test_errors_by_rule_are_the_same_for_a_seed_and_can_be_read(room: str) -> None:
    first, again, other = (generated(room, 10, seed) for seed in (1, 1, 2))
    assert first == again != other
    assert len({m.name for m in first}) == 10
    for mutant in first:
        assert mutant.edit.file.parts[0] == room
        ast.parse(mutant.edit.applied)


def test_rules_find_constants_thresholds_spreads_and_columns_but_no_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    text = (
        "LIMIT = 0.5\nCOUNT = 20\ndef f(x):\n    if x > 3.0:\n"
        "        x_std = x * x\n        out['flow'] = x - 1\n    return Quantity(x, 'm', x)\n"
    )
    monkeypatch.setattr("benchmarks.mutants.generated.source", lambda _: text)
    monkeypatch.setattr("benchmarks.mutants.mutant.source", lambda _: text)
    found = {(m.kind, m.edit.old, m.edit.new) for m in of_file(Path("a.py"))}
    assert found == {
        ("constant", "0.5", "(2.0 * (0.5))"),
        ("constant", "0.5", "(0.1 * (0.5))"),
        ("threshold", "3.0", "(2.0 * (3.0))"),
        ("threshold", "3.0", "(0.1 * (3.0))"),
        ("spread", "x * x", "(2.0 * (x * x))"),
        ("spread", "x", "(2.0 * (x))"),
        ("column", "x - 1", "(2.0 * (x - 1))"),
    }


def test_a_result_holds_while_definition_and_tests_are_the_same(by_hand: list[Mutant]) -> None:
    mutant = by_hand[0]
    row = result(mutant, Ran(True, "", 1.0))
    assert row["verdict"] == "survived"
    assert known(row, mutant)
    assert not known(None, mutant)
    assert not known({**row, "tests": "other"}, mutant)
    assert known({**row, "tests": "other", "verdict": "killed"}, mutant)
    assert not known({**row, "state": "other", "verdict": "killed"}, mutant)


def test_the_page_names_what_nothing_notices(by_hand: list[Mutant]) -> None:
    rows = [result(by_hand[0], Ran(False, "tests/a/test_b.py::test_c", 1.0)), result(by_hand[1], Ran(True, "", 1.0))]
    text = page(rows)
    assert "`test_b.py::test_c`" in text
    assert f"| {by_hand[1].name} | not explained yet |" in text


def test_an_error_in_the_copy_is_noticed_by_its_tests(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package of one constant with one test, and another number in its place."""
    package = tmp_path / "src" / "hfanalysis"
    for folder in (package / "room", tmp_path / "tests" / "room"):
        folder.mkdir(parents=True)
    for path in (package / "__init__.py", package / "room" / "__init__.py"):
        path.write_text("")
    (package / "room" / "a.py").write_text("SHARE = 0.25\n")
    test = "from hfanalysis.room.a import SHARE\n\ndef test_a():\n    assert SHARE == 0.25\n"
    (tmp_path / "tests" / "room" / "test_a.py").write_text(test)
    (tmp_path / "pyproject.toml").write_text("[tool.pytest.ini_options]\n")
    monkeypatch.setattr(workshop, "ROOT", tmp_path)
    for place in ("benchmarks.mutants.workshop.PACKAGE", "benchmarks.mutants.mutant.PACKAGE"):
        monkeypatch.setattr(place, package)
    for known_so_far in (source, files, tree):
        known_so_far.cache_clear()
    try:
        bench = workshop.Workshop(tmp_path / "scratch")
        mutant = Mutant("share", "by hand", Edit(Path("room/a.py"), 8, 12, "0.05"))
        assert bench.clean(room_tests(mutant)).passed
        assert bench.tried(mutant).failed == "tests/room/test_a.py::test_a"
        assert (bench.copy / "src" / "hfanalysis" / "room" / "a.py").read_text() == "SHARE = 0.25\n"
        assert state(mutant, True) != state(mutant, False)
    finally:
        for known_so_far in (source, files, tree):
            known_so_far.cache_clear()
