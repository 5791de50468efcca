"""Nothing is redone that has not changed; everything is redone that has."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from tests.stages.fake_way import FAULTS, RUNS, STAGES, AbsentError, InputError, ran

from hfanalysis.stages import freshness, runner


def products(root: Path) -> dict[str, bytes]:
    """The products by name, without what is kept apart."""
    return {p.name: p.read_bytes() for p in (root / "processed/T1").iterdir() if p.suffix in (".bin", ".json", ".html")}


def edit(path: Path, before: str, after: str) -> None:
    path.write_text(path.read_text().replace(before, after))


def test_a_stage_runs_what_it_needs_first(root: Path) -> None:
    assert ran(root, "third") == ["first", "second", "third"]


def test_a_second_run_does_nothing(root: Path) -> None:
    ran(root, "third")
    assert ran(root, "third") == []


def test_force_redoes_the_stage_and_all_before_it(root: Path) -> None:
    ran(root, "third")
    assert ran(root, "second", force=True) == ["first", "second"]


CHANGES: dict[str, Callable[[Path], None]] = {
    "raw file": lambda root: edit(root / "raw_tests/T1/log.csv", "2,48", "2,47"),
    "test.toml": lambda root: edit(root / "raw_tests/T1/test.toml", "[log]", "description = 'x'\n[log]"),
    "product damaged": lambda root: edit(root / "processed/T1/first.bin", "end", "END"),
    "product deleted": lambda root: (root / "processed/T1/first.json").unlink(),
    "state deleted": lambda root: (root / "processed/T1/.state/first.json").unlink(),
    "state garbled": lambda root: (root / "processed/T1/.state/first.json").write_text("{"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_changed_is_redone(root: Path, change: str) -> None:
    ran(root, "second")
    CHANGES[change](root)
    assert "first" in ran(root, "second")
    assert ran(root, "second") == []


def test_a_raw_file_of_the_same_size_and_time_is_still_seen_to_have_changed(root: Path) -> None:
    log = root / "raw_tests/T1/log.csv"
    os.utime(log, ns=(10**18, 10**18))
    ran(root, "first")
    edit(log, "2,48", "2,47")
    os.utime(log, ns=(10**18, 10**18))
    assert ran(root, "first") == ["first"]


def test_a_changed_program_redoes_everything(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran(root, "second")
    monkeypatch.setattr(freshness, "code_hash", lambda files: "another")
    assert ran(root, "second") == ["first", "second"]


def test_another_library_version_redoes_everything(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran(root, "second")
    monkeypatch.setattr(freshness, "library_versions", lambda files: {"numpy": "0"})
    assert ran(root, "second") == ["first", "second"]


def test_a_parameter_redoes_its_stage_and_what_rests_on_it(root: Path) -> None:
    ran(root, "third")
    assert ran(root, "third", second__factor=2) == ["second", "third"]
    assert ran(root, "third", second__factor=2) == []
    assert json.loads((root / "processed/T1/second.json").read_text())["provenance"]["parameters"] == {"factor": 2}


def test_an_adopted_effect_redoes_everything(root: Path) -> None:
    ran(root, "second")
    (root / "engines").mkdir()
    (root / "engines/T1.effects.toml").write_text("[tank_heat]\npower = '0.9 kW'\n")
    assert ran(root, "second") == ["first", "second"]


def test_a_teams_own_effect_redoes_what_tries_effects_and_what_rests_on_it(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    trying = replace(STAGES["second"], tries_effects=True)
    monkeypatch.setitem(STAGES, "second", trying)
    ran(root, "third")
    (root / "effects").mkdir()
    (root / "effects/slosh.py").write_text("EFFECT = 1\n")
    assert ran(root, "third") == ["second", "third"]
    assert ran(root, "third") == []


def test_a_touched_file_is_not_a_changed_file(root: Path) -> None:
    ran(root, "third")
    (root / "raw_tests/T1/log.csv").touch()
    assert ran(root, "third") == []


def test_make_finds_fresh_products_no_older_than_their_inputs(root: Path) -> None:
    ran(root, "third")
    log = root / "raw_tests/T1/log.csv"
    log.touch()
    ran(root, "third")
    assert all(path.stat().st_mtime_ns >= log.stat().st_mtime_ns for path in (root / "processed/T1").glob("*.json"))


def test_products_are_byte_identical_from_run_to_run(root: Path) -> None:
    ran(root, "third")
    before = products(root)
    assert ran(root, "third", force=True) == ["first", "second", "third"]
    assert products(root) == before
    assert len((root / "processed/T1/run.log").read_text().splitlines()) == 6


def test_products_say_what_they_are_made_from(root: Path) -> None:
    ran(root, "second")
    found = json.loads((root / "processed/T1/second.json").read_text())["provenance"]
    assert set(found["raw"]) == {"log.csv"}
    assert {len(found["test_toml"]), len(found["raw"]["log.csv"]), len(found["code"])} == {64}
    assert found["hfanalysis"]
    assert set(found["inputs"]) == {"first.bin", "first.json"}


def test_processed_may_be_deleted(root: Path) -> None:
    import shutil

    ran(root, "third")
    shutil.rmtree(root / "processed")
    assert ran(root, "third") == ["first", "second", "third"]


def test_processed_may_be_deleted_while_a_stage_runs(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import shutil
    from dataclasses import replace

    from tests.stages.fake_way import STAGES, first

    def robbed(context: object) -> None:
        if len(RUNS) == 0:
            shutil.rmtree(root / "processed")
        first(context)  # type: ignore[arg-type]

    monkeypatch.setitem(STAGES, "first", replace(STAGES["first"], run=robbed))
    try:
        ran(root, "second")
    except FileNotFoundError:
        pytest.fail("a run must outlive the loss of its product folder")
    assert (root / "processed/T1/second.json").exists()


def test_an_absence_stops_what_needs_it_and_is_remembered(root: Path) -> None:
    FAULTS["first"] = AbsentError("no firing")
    for _ in range(2):
        with pytest.raises(AbsentError, match="no firing"):
            ran(root, "second")
    assert RUNS == []


def test_an_absence_is_told_to_what_only_wants_it(root: Path) -> None:
    FAULTS["second"] = AbsentError("no liquid phase")
    assert ran(root, "third") == ["first", "second", "third"]
    assert (root / "processed/T1/third.html").read_text() == "no liquid phase"
    assert ran(root, "third") == []


def test_what_stands_aside_is_taken_as_it_was_last_asked_for(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "ASIDE", ("second",))
    page = root / "processed" / "T1" / "third.html"
    ran(root, "third")
    assert "hfa second T1" in page.read_text()
    ran(root, "second", second__factor=3)
    assert ran(root, "third") == ["third"]
    assert page.read_text() == "all there"
    assert ran(root, "third", second__factor=4) == ["third"]
    assert "hfa second T1" in page.read_text()


def test_products_that_no_longer_follow_from_the_input_are_removed(root: Path) -> None:
    ran(root, "second")
    FAULTS["first"] = InputError("bad log")
    edit(root / "raw_tests/T1/log.csv", "2,48", "2,x")
    with pytest.raises(InputError):
        ran(root, "second")
    assert products(root) == {}


def test_a_log_that_changes_while_it_is_read_is_refused(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import replace

    from tests.stages.fake_way import STAGES, first

    def grown(context: object) -> None:
        first(context)  # type: ignore[arg-type]
        with (root / "raw_tests/T1/log.csv").open("a") as file:
            file.write("3,47\n")

    monkeypatch.setitem(STAGES, "first", replace(STAGES["first"], run=grown))
    with pytest.raises(InputError, match=r"log\.csv: the file changed while it was being read"):
        ran(root, "first")
    assert products(root) == {}


def test_a_folder_that_cannot_be_written_is_named(root: Path) -> None:
    (root / "processed").write_text("a file in the way")
    with pytest.raises(InputError, match="--out DIR"):
        ran(root, "first")


def test_products_can_go_elsewhere(root: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    out = tmp_path_factory.mktemp("elsewhere")
    ran(root, "second", out=out)
    assert (out / "T1/second.json").exists()
    assert not (root / "processed").exists()
