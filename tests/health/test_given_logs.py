"""Logs that once went wrong, and real ones: what is found in them. Those that are not there are skipped."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from hfanalysis.health.judge import judge
from hfanalysis.health.seen import Sister, look
from hfanalysis.products.health import Finding
from hfanalysis.record.definition import TestDefinition, load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import TestLog, read_log

ROOT = Path(__file__).parents[2]
SHARED = ROOT.parent / "shared"

CASES = {
    "logs/crash_low_chamber_gauge": {("scale", "p_chamber")},
    "logs/hf5_chamber_gauge_low": {("scale", "p_chamber")},
    "logs/water_flow_step_not_seen": {("dead", "p_tank"), ("dead", "thrust")},
    "files/K08_gauge_or_absolute/G_all/raw_tests/T": {("gauge_or_absolute", n) for n in ("p_chamber", "p_tank")},
    "files/K08_gauge_or_absolute/G_chamber_only/raw_tests/T": {("gauge_or_absolute", "p_chamber")},
    "files/K08_gauge_or_absolute/G_bar_unsaid/raw_tests/T": {("gauge_or_absolute", "p_chamber")},
    "files/K08_gauge_or_absolute/G_gauge_true_on_absolute/raw_tests/T": {("gauge_or_absolute", "p_chamber")},
    "files/K16_4_20_mA_fault/mA_fault_3p55/raw_tests/T": {("dropout", "p_tank")},
    "files/K20_sign/thrust_inverted/raw_tests/T": {("sign", "thrust")},
    "files/K21_ends_of_a_log/hx_first/raw_tests/T": {("edge", "thrust")},
    "files/K21_ends_of_a_log/hx_last/raw_tests/T": {("edge", "thrust")},
    "files/K21_ends_of_a_log/ds18b20_rare/raw_tests/T": {("edge", "T_tank")},
    "fuzz/silent_2777/raw_tests/S": {("dropout", "p_chamber")},
    "fuzz/silent_2348/raw_tests/S": {("clock", "p_chamber")},
    "fuzz/silent_961/raw_tests/S": {("lag", "p_run")},
    "fuzz/base/raw_tests/S": {("zero", "thrust")},
}  # fmt: skip
ALWAYS = {("zero", "thrust")}
"""The replica's own cell does not come back by 76 N."""


def read(folder: Path, scratch: Path) -> tuple[TestLog, TestDefinition]:
    """A test as ingested, and its definition."""
    definition = load_definition(folder / "test.toml")
    ingest(definition, scratch / f"{folder.name}.h5")
    return read_log(scratch / f"{folder.name}.h5"), definition


def findings(log: TestLog, definition: TestDefinition) -> list[Finding]:
    """All of its channels."""
    return [finding for channel in judge(log, definition).channels.values() for finding in channel.findings]


@pytest.mark.parametrize("case", CASES)
def test_what_went_wrong_is_found_and_nothing_else_is_left_out(case: str, tmp_path: Path) -> None:
    folder = SHARED / "faults" / case
    if not folder.is_dir():
        pytest.skip(f"no {folder}")
    found = findings(*read(folder, tmp_path))
    assert CASES[case] <= {(f.kind, name) for f in found for name in f.channels}
    lost = {name for f in found if f.verdict == "unusable" for name in f.channels}
    assert lost <= {name for _, name in CASES[case]}


@pytest.mark.parametrize("test", ["HF4", "HF5"])
def test_the_replicas_are_healthy_but_for_the_zero_of_their_cell(test: str, tmp_path: Path) -> None:
    found = findings(*read(ROOT / "raw_tests" / test, tmp_path))
    assert {(f.kind, name) for f in found for name in f.channels} == ALWAYS
    assert found[0].verdict == "suspect"


def mcgill(root: Path) -> dict[str, tuple[TestLog, TestDefinition]]:
    """The stand's third series, by the definitions kept with the acceptance tests."""
    out = {}
    for test in ("MRT-HF3.1", "MRT-HF3.3", "MRT-HF3.4"):
        if not (SHARED / "real_tests" / test / "log.csv").is_file():
            pytest.skip(f"no log of {test}")
        shutil.copytree(SHARED / "real_tests" / test, root / test)
        (root / test).chmod(0o755)
        shutil.copy(ROOT / "tests" / "acceptance" / "real" / test / "test.toml", root / test)
        out[test] = read(root / test, root)
    return out


def test_a_gain_of_two_is_told_by_the_other_tests_of_the_stand(tmp_path: Path) -> None:
    tests = mcgill(tmp_path)
    sisters = {
        name: Sister(definition, {n: seen.coarse for n, seen in look(log, definition).channels.items()})
        for name, (log, definition) in tests.items()
    }
    factors = {}
    for name, (log, definition) in tests.items():
        between = judge(log, definition, [s for other, s in sisters.items() if other != name]).between
        factors[name] = [f.gain for f in between if f.kind == "scale" and f.channels == ("thrust",)]
    assert factors["MRT-HF3.3"] == factors["MRT-HF3.4"] == []
    assert factors["MRT-HF3.1"] == [pytest.approx(0.993, abs=0.35)]
