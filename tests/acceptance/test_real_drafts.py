"""Published logs of other teams are drafted: every draft loads, and no column is taken for what it is not."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from benchmarks.real_logs.facts import Facts, all_facts, completed

from hfanalysis.drafting.new import new_test
from hfanalysis.record.definition import load_definition

LOGS = Path(os.environ.get("HFA_REAL_TESTS", Path(__file__).parents[3] / "shared" / "real_tests"))
CLOCKS = {
    "AJ-HF1": "s",
    "COMET-2026-03-29": "ms",
    "RICE-HF2": "ms",
    "SSI-2019-06-08": "ms",
    "SSI-coldflow-2019-05-26": "ms",
}
"""Log -> the unit of its time."""


@pytest.mark.parametrize("facts", all_facts(), ids=lambda facts: facts.name)
def test_a_published_log_is_drafted_and_its_facts_complete_it(facts: Facts, tmp_path: Path) -> None:
    if not (LOGS / facts.name).is_dir():
        pytest.skip(f"no log of {facts.name} in {LOGS}")
    made = new_test(tmp_path, facts.name, facts.logs(LOGS / facts.name))
    drafted = load_definition(made.path)
    stated = {table["column"]: name for name, table in facts.add.get("channels", {}).items()}
    taken = {spec.column: name for name, spec in drafted.channels.items() if name in ("p_tank", "p_run", "p_chamber")}
    assert {column: stated.get(column, name) for column, name in taken.items()} == taken
    if facts.name in CLOCKS:
        assert {file.time.unit for file in drafted.log.files if file.time} == {CLOCKS[facts.name]}
    made.path.write_text(completed(made.path.read_text(encoding="utf-8"), facts), encoding="utf-8")
    for name in facts.copy:
        (made.path.parent / name).write_bytes((LOGS / facts.name / name).read_bytes())
    assert set(facts.add.get("channels", {})) <= set(load_definition(made.path).channels)
