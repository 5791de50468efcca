"""At the stand: a quick look at a firing, and at each log as it lands."""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.cli.run import Run

from hfanalysis.cli import landing

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A root with the replica HF5."""
    root = tmp_path_factory.mktemp("root")
    shutil.copytree(REPOSITORY / "raw_tests" / "HF5", root / "raw_tests" / "HF5")
    return root


def files(folder: Path) -> set[str]:
    return {path.name for path in folder.rglob("*") if path.is_file() and not path.name.startswith(".")}


def test_a_quick_look_says_what_the_stages_say_and_writes_none_of_it(run: Run, root: Path, tmp_path: Path) -> None:
    status, out, _ = run("run", "HF5", "--quick", "--root", root, "--out", tmp_path, "--json")
    assert status == 0
    seen = json.loads(out)
    products = {"ingest.h5", "ingest.json", "health.json", "segments.json", "hashes.json", "run.log"}
    notes = {f"{stage}.json" for stage in ("ingest", "health", "segment")}
    assert files(tmp_path) <= products | notes
    run("validate", "HF5", "--root", root, "--out", tmp_path, "-q")
    calibrated = json.loads((tmp_path / "HF5" / "calibration.json").read_text("utf-8"))
    assert seen["C_i"] == calibrated["C_i"]
    measured = json.loads((tmp_path / "HF5" / "validation.json").read_text("utf-8"))["performance"]["measured"]
    assert seen["performance"]
    assert {name: measured[name] for name in seen["performance"]} == seen["performance"]
    assert seen["performance"]["total_impulse"]["verdict"] == "doubted"
    assert seen["health"]["thrust"] == "suspect"
    assert any("thrust suspect" in finding for finding in seen["findings"])
    segments = json.loads((tmp_path / "HF5" / "segments.json").read_text("utf-8"))
    assert seen["phases"] == {name: segments[name] for name in seen["phases"]}


def test_people_see_it_as_tables(run: Run, root: Path) -> None:
    status, out, _ = run("run", "HF5", "--quick", "--root", root)
    assert status == 0
    for words in ("quick look", "REPLICA", "thrust suspect", "peak chamber pressure", "C_i", "liquid gone"):
        assert words in out


def landed(root: Path, folder: Path, change: Callable[[str], str] = lambda text: text) -> Path:
    """HF5's log under another name in a logger's folder."""
    folder.mkdir()
    log = folder / "firing 6.csv"
    log.write_text(change((root / "raw_tests" / "HF5" / "log.csv").read_text("utf-8")), encoding="utf-8")
    return log


def test_a_log_that_lands_takes_the_last_tests_facts_and_doubts_its_load(run: Run, root: Path, tmp_path: Path) -> None:
    log = landed(root, tmp_path / "logs")
    before = files(root), log.read_bytes()
    status, out, _ = run("watch", log.parent, "--root", root, "--once", "--json")
    assert (status, files(root), log.read_bytes()) == (0, *before)
    seen = json.loads(out)
    assert seen["test"] == "firing_6"
    assert seen["source"] == "measured"
    assert "that of HF5" in seen["facts"]
    assert "8.350 kg of oxidizer" in seen["facts"]
    for found in (seen["C_i"], *(seen["performance"][name] for name in ("oxidizer_mass", "specific_impulse_loaded"))):
        assert found["verdict"] == "doubted"
        assert "with the load that HF5 had" in found["why"]
    assert "[observed]" not in seen["performance"]["burn_time"]["why"]  # HF5's video saw HF5
    assert seen["performance"]["peak_chamber_pressure"]["value"] == pytest.approx(12.556e5, rel=1e-3)


def test_columns_that_nobody_knows_get_a_draft_without_masses(run: Run, root: Path, tmp_path: Path) -> None:
    log = landed(root, tmp_path / "logs", lambda text: text.replace("PT-TANK", "P-OX-TANK", 1))
    status, out, _ = run("watch", log.parent, "--root", root, "--once", "--json")
    assert status == 0
    seen = json.loads(out)
    assert "draft" in seen["facts"]
    assert seen["C_i"]["value"] is None
    assert seen["performance"]["fuel_mass"]["value"] is None
    assert seen["performance"]["total_impulse"]["value"] == pytest.approx(16135.0, rel=0.05)


def test_a_log_that_cannot_be_read_stops_nobody(run: Run, root: Path, tmp_path: Path) -> None:
    log = landed(root, tmp_path / "logs", lambda _: "<html>not found</html>")
    status, out, err = run("watch", log.parent, "--root", root, "--once")
    assert (status, out) == (0, "")
    assert "firing 6.csv" in err


def test_a_folder_that_is_not_there_is_bad_input(run: Run, root: Path, tmp_path: Path) -> None:
    status, _, err = run("watch", tmp_path / "none", "--root", root)
    assert status == 2
    assert "no such folder" in err


def test_a_log_is_looked_at_once_it_no_longer_grows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    done: dict[Path, landing.State] = {}
    waiting: dict[Path, tuple[landing.State, float]] = {}
    log = tmp_path / "log.csv"

    def complete(after: float) -> list[Path]:
        now[0] += after
        return list(landing._complete(landing._files(tmp_path), done, waiting, landing.SETTLED))

    (tmp_path / "test.toml").write_text("schema = 1")
    assert complete(0.0) == []
    log.write_text("t\n")
    assert complete(0.5) == []
    log.write_text("t\n1\n")
    assert complete(0.6) == []
    assert complete(0.6) == []
    assert complete(0.6) == [log]
    assert complete(5.0) == []
    log.write_text("t\n1\n2\n")  # the logger had only paused
    assert complete(0.5) == []
    assert complete(1.1) == [log]
