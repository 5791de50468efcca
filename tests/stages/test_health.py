"""The health stage: what every later stage gets of the log, and what the stand's other tests have to do with it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.health import fire
from tests.record import make

from hfanalysis.health import stand as detectors_of_stand
from hfanalysis.health.seen import SeenTest
from hfanalysis.products.health import Finding, Health
from hfanalysis.stages import freshness
from hfanalysis.stages.base import Context, load_stage
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to
from hfanalysis.stages.stand import MOST, nearest


def put(root: Path, name: str, date: str = "", stand: str = "pad", seed: int = 0) -> Path:
    """A healthy test of a stand."""
    folder = root / "raw_tests" / name
    folder.mkdir(parents=True)
    head = f'schema = 1\n[test]\nid = "{name}"\nkind = "hot_fire"\nsource = "synthetic"\nstand = "{stand}"\n'
    head += f"date = {date}\n" if date else ""
    (folder / "test.toml").write_text(head + fire.toml())
    (folder / "log.csv").write_text(make.csv(**fire.columns(seed)))
    return folder


def judged(root: Path, name: str) -> tuple[Context, Health]:
    context = run_to("health", open_test(root, name))
    return context, context.read(Health)


def test_a_product_says_which_other_tests_it_has_read(tmp_path: Path) -> None:
    put(tmp_path, "A")
    _, alone = judged(tmp_path, "A")
    assert alone.compared == ()
    other = put(tmp_path, "B", seed=1)
    put(tmp_path, "C", stand="elsewhere", seed=2)
    context, health = judged(tmp_path, "A")
    assert health.compared == ("B",)
    assert set(health.provenance["others"]["B"]) == {"test.toml", "log.csv"}
    content = context.product("health.json").read_bytes()
    (other / "log.csv").write_text(make.csv(**fire.columns(3)))
    context, _ = judged(tmp_path, "A")
    assert context.product("health.json").read_bytes() != content


def test_it_is_the_same_whichever_test_was_made_first(tmp_path: Path) -> None:
    for root, order in ((tmp_path / "1", "AB"), (tmp_path / "2", "BA")):
        put(root, "A")
        put(root, "B", seed=1)
        for name in order:
            judged(root, name)
    one, two = (tmp_path / n / "processed" / "A" / "health.json" for n in "12")
    assert one.read_bytes() == two.read_bytes()


def test_a_sister_that_cannot_be_read_is_left_out(tmp_path: Path) -> None:
    put(tmp_path, "A")
    (put(tmp_path, "B") / "log.csv").write_text("nothing\n")
    assert judged(tmp_path, "A")[1].compared == ()


def test_the_nearest_in_time_are_looked_at(tmp_path: Path) -> None:
    put(tmp_path, "A", "2024-05-05")
    for number in range(MOST + 2):
        put(tmp_path, f"B{number}", f"2024-0{6 + number // 2}-0{1 + number}" if number else "")
    context = open_test(tmp_path, "A")
    assert [other.test.id for other in nearest(context)] == [f"B{number}" for number in range(1, MOST + 1)]


def test_a_doubt_of_the_stand_is_in_the_product(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def twice(test: SeenTest) -> list[Finding]:
        (sister,) = test.sisters
        assert sister.channels["thrust"].plateau == pytest.approx(1700.0, rel=0.1)
        about = {"evidence": "half of B's", "means": "a gain of two", "cure": "scale = 2.0"}
        return [Finding(kind="scale", channels=("thrust",), verdict="unusable", **about)]

    monkeypatch.setattr(detectors_of_stand, "detectors", lambda: {"twice": twice})
    put(tmp_path, "A")
    put(tmp_path, "B", seed=1)
    assert judged(tmp_path, "A")[1].of("thrust").verdict == "suspect"


def test_no_stage_but_ingest_reads_the_log_by_itself() -> None:
    for name in ("segment", "calibrate", "validate", "diagnose", "flight"):
        stage = load_stage(name)
        text = Path(freshness._module(stage)).read_text(encoding="utf-8")
        assert "read_log(" not in text, name
        assert "health" in stage.needs, name


def test_numbers_of_a_frozen_cell_are_left_out_and_said(tmp_path: Path) -> None:
    columns = fire.columns()
    columns["thrust"][800:] = columns["thrust"][800]
    make.write(tmp_path, fire.toml() + '[observed]\nburn_time = "8 s"\n', {"log.csv": make.csv(**columns)})
    context = run_to("segment", open_test(tmp_path, "T"))
    log = context.log()
    assert log["thrust"].time[log["thrust"].good].max() < 3.01
    segments = json.loads(context.product("segments.json").read_text())
    assert "verdict" not in segments["t_open"]
    assert segments["t_fuel_out"]["value"] is None or segments["t_fuel_out"]["verdict"] == "doubted"
