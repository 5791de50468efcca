"""The study of spoilt logs: the same cases every time, and a judge that a silent number does not get past."""

from __future__ import annotations

import json
import tomllib
from argparse import Namespace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from benchmarks.fuzz import __main__ as study
from benchmarks.fuzz import cases, document, formats
from benchmarks.fuzz.explained import REASONS, reason
from benchmarks.fuzz.judge import judge
from benchmarks.fuzz.mutators import UNITS

from hfanalysis.record.definition import load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import read_log

BASE: dict[str, Any] = {
    "status": 0, "said": "hfa: warning: 7 of 1200 samples", "error": "",
    "found": {"C_i": {"value": 0.29, "std": 0.001, "verdict": "identified"}, "health": []},
}  # fmt: skip


@pytest.mark.parametrize("number", range(12))
def test_a_case_is_the_same_every_time(number: int) -> None:
    one, other = cases.build(number, 1), cases.build(number, 1)
    assert one.mutators == other.mutators
    assert one.text == other.text
    if one.format not in ("mat", "mat73", "hdf5"):  # which hold the date
        assert one.content == other.content


def test_most_numbers_are_cases_of_their_own() -> None:
    kinds = {tuple(cases.build(number, 1).mutators) for number in range(40)}
    assert len(kinds) > 20


@pytest.mark.parametrize("format", formats.NAMES)
def test_the_unspoilt_log_is_read_in_every_format(format: str, tmp_path: Path) -> None:
    case = cases.unspoilt("HF5", format)
    root = cases.put(case, tmp_path)
    definition = load_definition(root / "raw_tests" / document.ID / "test.toml")
    ingest(definition, tmp_path / "ingest.h5")
    found = read_log(tmp_path / "ingest.h5")["p_tank"]
    good = np.isfinite(found.values) & np.isfinite(case.log.channels["p_tank"])
    np.testing.assert_allclose(found.values[good], 6894.757293168361 * case.log.channels["p_tank"][good], rtol=1e-6)
    assert good.mean() > 0.98


def test_a_definition_written_anew_says_the_same() -> None:
    content = document.base("HF5", "csv")
    assert tomllib.loads(document.text(content)) == content
    odd = {"a": {"b": 'x"\\\n\x00ü', "c": [1, "d"], "e": True}}
    assert tomllib.loads(document.text(odd)) == odd
    assert len(set(UNITS)) == len(UNITS)


def spoilt(value: float, said: str = "", verdict: str = "identified", **more: Any) -> dict[str, Any]:
    found = {"C_i": {"value": value, "std": 0.001, "verdict": verdict}, "health": more.pop("health", [])}
    return {**BASE, "said": f"{BASE['said']}\n{said}", "found": found, "hit": ["p_tank"], **more}


@pytest.mark.parametrize(
    ("row", "moved", "points"),
    [
        (spoilt(0.2901), (), False),
        (spoilt(0.35), ("C_i",), False),
        (spoilt(0.35, "hfa: warning: 9 of 1200 samples"), ("C_i",), False),
        (spoilt(0.35, "hfa: warning: the purge gauge rests high"), ("C_i",), False),
        (spoilt(0.35, "hfa: warning: channel p_tank: suspect"), ("C_i",), True),
        (spoilt(0.35, health=["p_tank scale"]), ("C_i",), True),
        (spoilt(0.35, verdict="doubted"), ("C_i",), True),
    ],
)
def test_a_number_that_moved_has_to_say_why(row: dict[str, Any], moved: tuple[str, ...], points: bool) -> None:
    judged = judge(row, BASE)
    assert (judged.moved, judged.points, judged.silent) == (moved, points, bool(moved) and not points)


@pytest.mark.parametrize(
    ("change", "end"),
    [
        ({"status": 2}, "refused (2)"),
        ({"status": 3}, "refused (3)"),
        ({"status": 1}, "traceback"),
        ({"said": "Traceback (most recent call last):"}, "traceback"),
        ({"status": -1, "error": "hang"}, "hang"),
        ({"status": -1, "error": "killed by SIGSEGV"}, "killed"),
    ],
)
def test_how_a_case_ended(change: dict[str, Any], end: str) -> None:
    assert judge(spoilt(0.29) | change, BASE).end == end


@pytest.mark.parametrize(
    ("number", "mutators", "hit", "why"),
    [
        (212, ["clock: other pace"], [], "pace"),
        (106, ["values: scale"], [], "gain"),
        (318, ["values: drift"], [], "drift"),
        (107, ["toml: statement added"], ["model", "properties"], "table"),
        (212, ["clock: other pace", "values: scale"], [], None),
        (281, ["toml: statement added"], ["segments", "t_purge"], None),
        (262, ["rows: every nth"], [], None),
    ],
)
def test_what_no_log_can_tell_has_its_reason(number: int, mutators: list[str], hit: list[str], why: str | None) -> None:
    """By the size of what was done: these clocks and gauges are off by less than an engine's own efficiencies."""
    row = {"number": number, "mutators": mutators, "hit": hit}
    assert reason(row, 4) == (REASONS[why] if why else "")


def test_each_case_stands_beside_the_unspoilt_test_of_the_code_that_ran_it(tmp_path: Path) -> None:
    """By the new code the unspoilt number is another; what the old code left wrong is run anew first."""
    about = {"stand": "HF5", "format": "csv", "mutators": ["values: scale"]}
    old, new = {"code": "old"}, {"code": study.code()}
    moved = {**BASE, "found": {"C_i": {"value": 0.31, "std": 0.001, "verdict": "identified"}, "health": []}}
    rows: list[dict[str, Any]] = [
        {"number": -1, "base": "HF5.csv", **BASE, **old}, {"number": -1, "base": "HF5.csv", **moved, **new},
        {"number": 0, **about, **spoilt(0.29), **old}, {"number": 1, **about, **spoilt(0.31), **old},
        {"number": 2, **about, **spoilt(0.31), **new},
    ]  # fmt: skip
    (tmp_path / "9-0-of-1.jsonl").write_text("\n".join(map(json.dumps, rows)) + '\n{"number": 3, "sta')
    options = Namespace(out=tmp_path, seed=9, n=5, jobs=1, number=0, again=True)
    assert [bool(judged.moved) for _, judged in study._judged(options)] == [False, True, False]
    assert study._to_run(options, study.code()) == [1, 3, 4, 0]
    options.again = False
    assert study._to_run(options, study.code()) == [3, 4]
