"""The study of predictions: pairs of tests that are the same each time, and what is counted of them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from benchmarks.prediction import figures, fitted, rows_of
from simulated.worlds import pairs


def test_what_differences_of_two_tests_scatter_by_is_found() -> None:
    rng = np.random.default_rng(2)
    stands = 0.02 * np.sqrt(3.0 / rng.chisquare(3.0, 4000))
    scale, freedom = fitted([float(x) for x in stands * (rng.standard_normal(4000) - rng.standard_normal(4000))])
    assert scale == pytest.approx(0.02, rel=0.08)
    assert freedom == 3


def row(holds: bool, error: float, adopted: tuple[str, ...] = ()) -> dict[str, Any]:
    impulse = {"holds": holds, "error": error, "rivals": {"as_last_time": 0.2, "without_effects": -0.1}}
    lacking = {"holds": None, "error": None, "rivals": {"as_last_time": None, "without_effects": 0.1}}
    moved = {"C_i": 0.02, "regression rate": -0.04}
    return {"scored": {"total_impulse": impulse, "t_v": lacking}, "adopted": adopted, "moved": moved, "true": moved}


def test_shares_and_errors_count_what_all_have() -> None:
    refused = {"pair": "S9", "failure": "no burn\nit cannot be lit", "defect": False}
    lines = figures([row(True, 0.02), row(False, -0.06, ("tank_heat",)), refused])
    assert lines[0] == "3 pairs: 2 predicted and scored, 1 refused; in 1 an effect is adopted from the first test."
    assert "| total_impulse | 50 % (1 of 2) | 4.0 % | 20.0 % | 10.0 % |" in lines
    assert "| t_v | - | - | - | - |" in lines
    for name in ("total_impulse", "**all**"):
        assert f"| {name}, where effects are adopted | 0 % (0 of 1) | 6.0 % | 20.0 % | 10.0 % |" in lines
    assert lines[-1] == "- S9: it cannot be lit"


def test_what_another_version_found_is_found_anew(tmp_path: Path) -> None:
    kept = tmp_path / "scored.jsonl"
    assert rows_of(kept, "now") == []
    kept.write_text('{"pair": "a", "digest": "now"}\n{"pair": "b", "digest": "before"}\n')
    assert [found["pair"] for found in rows_of(kept, "now")] == ["a"]


def test_pairs_are_the_same_each_time_and_the_sets_share_no_seed(tmp_path: Path) -> None:
    assert pairs.plan("scored", 60) == pairs.plan("scored", 60)
    seeds = [{pair.seed for pair in pairs.plan(which, 60)} for which in pairs.SETS]
    assert not seeds[0] & seeds[1]
    assert sum(bool(pair.effects) for pair in pairs.plan("scored", 60)) == 30
    one = pairs.plan("development", 60)[0]
    for folder in ("a", "b"):
        pairs.write_pair(one, tmp_path / folder)
    first, second = ((tmp_path / "a" / "raw_tests" / test / "test.toml").read_text() for test in pairs.tests_of(one))
    assert first == (tmp_path / "b" / "raw_tests" / f"{one.id}-1" / "test.toml").read_text()
    loads = [next(line for line in text.splitlines() if "oxidizer_mass" in line) for text in (first, second)]
    assert loads[0] != loads[1]


def test_the_page_says_of_its_table_what_the_table_says() -> None:
    """Which rivals are beaten in what; a number that is said is one of the table's."""
    page = (Path(__file__).parents[2] / "docs" / "predict.md").read_text(encoding="utf-8")
    before, _, after = page.partition("<!-- prediction: begin -->")
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in after.splitlines() if line.count("|") == 6
    ]
    errors = {row[0]: [float(x.strip(" %")) for x in row[2:]] for row in rows if row[2].endswith("%")}
    adopted = ", where effects are adopted"
    better = {name for name, (own, last, without) in errors.items() if own < min(last, without)}
    quantities = {name for name in errors if adopted not in name and "all" not in name}
    assert quantities - better == {"t_v"}
    assert {name for name in quantities if name + adopted in better} == {"burn_time", "total_impulse", "apogee"}
    said = re.search(r"They hold 95 % (\(\d+ of \d+\))", before)
    assert said is not None
    assert next(row for row in rows if row[0] == "**all**")[1] == f"95 % {said[1]}"
