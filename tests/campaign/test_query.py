"""Tests that meet a condition on their quantities."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from tests.campaign.rows import definition
from tests.cli.run import hfa

from hfanalysis.campaign.query import Asked, asked_of, matching, names_in
from hfanalysis.errors import InputError
from hfanalysis.products.tidy import rows_of_test


def products(root: Path, test: str, c_i: float, verdict: str, impulse: float) -> Path:
    """A test with products, its test.toml on the stand "north"."""
    definition(root, test, "north")
    folder = root / "processed" / test
    folder.mkdir(parents=True)
    (folder / "segments.json").write_text(json.dumps({"test": test, "t_v": {"value": 4.0, "unit": "s"}}))
    quantity = {"value": c_i, "unit": "", "std": 0.002, "verdict": verdict}
    (folder / "calibration.json").write_text(
        json.dumps({"one_by_one": {"C_i": {**quantity, "value": 9.0}}, "C_i": quantity})
    )
    measured: dict[str, Any] = {"total_impulse": {"value": impulse, "unit": "N s"}}
    modeled: dict[str, Any] = {"total_impulse": {"value": 1.0, "unit": "N s"}}
    body = {"performance": {"measured": measured, "model": modeled}}
    (folder / "validation.json").write_text(json.dumps(body))
    return folder


@pytest.fixture
def root(tmp_path: Path) -> Path:
    products(tmp_path, "A", 0.30, "identified", 2e4)
    products(tmp_path, "B", 0.45, "identified", 1e4)
    products(tmp_path, "C", 0.50, "doubted", 1e4)
    return tmp_path


def asked(root: Path) -> dict[str, Asked]:
    return {name: asked_of(rows_of_test(root / "processed" / name), {"test": name, "stand": "north"}) for name in "ABC"}


@pytest.mark.parametrize(
    ("condition", "names"),
    [
        ("C_i > 0.4", ["B"]),
        ("C_i < 0.4 and stand == 'north'", ["A"]),
        ("total_impulse between 5e3 and 1.5e4", ["B", "C"]),
        ("validation.performance.model.total_impulse < 2", ["A", "B", "C"]),
        ('"calibration.one_by_one.C_i" = 9', ["A", "B"]),
        ("C_i is null", ["C"]),
        ("abs(C_i - 0.3) < 0.01 or test = 'C'", ["A", "C"]),
        ("stand like 'sou%'", []),
    ],
)
def test_tests_that_meet_a_condition(root: Path, condition: str, names: list[str]) -> None:
    assert matching(asked(root), condition) == names


def test_a_doubted_number_counts_only_where_all_are_asked_for(root: Path) -> None:
    assert matching(asked(root), "C_i > 0.4", doubted=True) == ["B", "C"]


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        ("C_j > 0.4", "'C_j': expected a quantity of these tests.*did you mean 'C_i'"),
        ("C_i >", "is no condition"),
        ("C_i > 0.4; drop table tests", "expected a quantity"),
        ("load_extension('x') > C_i", "is no condition: not authorized"),
        (
            "C_i in (with recursive x(n) as (select 1 union all select n + 1 from x) select n from x)",
            "expected a quantity",
        ),
    ],
)
def test_what_is_no_condition_is_refused(root: Path, condition: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        matching(asked(root), condition)


def test_a_name_in_a_text_is_none() -> None:
    assert names_in("stand = 'C_i' and m < 1 and not max(n, 2) = 3") == ["stand", "m", "n"]


def test_at_the_terminal(root: Path) -> None:
    ended = hfa("find", "C_i > 0.2 and stand = 'north'", "--root", root)
    assert ended.status == 0
    assert "2 of 3 tests" in ended.out
    assert "0.45 ± 0.002" in ended.out
    assert "north" in ended.out
    told = json.loads(hfa("find", "C_i > 0.2", "--root", root, "--all", "--json").out)
    assert list(told["tests"]) == ["A", "B", "C"]
    assert told["tests"]["C"]["quantities"][0]["verdict"] == "doubted"
    refused = hfa("find", "C_j > 0", "--root", root)
    assert (refused.status, refused.err.count("\n")) == (2, 1)
    assert "none of 3 tests" in hfa("find", "C_i > 7", "--root", root).out
    assert hfa("find", "C_i > 0", "--root", root / "raw_tests").status == 3
