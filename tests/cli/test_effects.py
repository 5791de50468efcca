"""``hfa effects`` as users and scripts hold on to it."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest
from tests.cli.run import Run

from hfanalysis.cli import trust
from hfanalysis.effects import library
from hfanalysis.effects import trust as agreed_to

SHIM = """
import numpy as np
from hfanalysis.engine.effect import Effect, Parameter

EFFECT = Effect(
    name="shim", equation="sensor", meaning="the thrust cell sits askew", reference="our stand",
    parameters=(Parameter("share", "-", "of the thrust that is not seen", 0.01),), phases=("liquid",),
    distort=lambda times, channels, values: {**channels, "thrust": channels["thrust"] * (1.0 - values["share"])},
)
"""


ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def stand(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A root with HF5."""
    root = tmp_path_factory.mktemp("stand")
    shutil.copytree(ROOT / "raw_tests" / "HF5", root / "raw_tests" / "HF5")
    return root


def test_people_see_every_effect_with_its_typical_strength(run: Run, tmp_path: Path) -> None:
    status, out, _ = run("effects", "--root", tmp_path)
    assert status == 0
    assert all(name in out for name in library())
    assert "power 1000 W" in out
    assert "depth 2 bar" in out


def test_json_has_all_of_it_in_si(run: Run, tmp_path: Path) -> None:
    status, out, _ = run("effects", "--json", "--root", tmp_path)
    found = json.loads(out)["effects"]
    assert status == 0
    assert list(found) == list(library())
    assert found["tank_heat"]["parameters"]["power"]["unit"] == "W"
    strengths = [p["strength"] for p in found["n2_purge"]["parameters"].values()]
    assert strengths == [True, *[False] * (len(strengths) - 1)]
    assert len(strengths) > 1
    offsets = found["pressure_transducer_offset"]["parameters"]
    assert [name for name, p in offsets.items() if p["strength"]] == ["p_tank", "p_run", "p_chamber"]


def test_a_teams_own_effect_is_listed_and_a_bound_that_is_not_there_is_null(run: Run, tmp_path: Path) -> None:
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "shim.py").write_text(SHIM, encoding="utf-8")
    status, out, said = run("effects", "--json", "--root", tmp_path)
    assert (status, out) == (2, "")
    assert "--trust-effects" in said
    status, out, said = run("effects", "--json", "--root", tmp_path, "--trust-effects")
    assert status == 0
    assert json.loads(out)["effects"]["shim"]["parameters"]["share"]["high"] is None
    assert "shim.py is run from now on" in said
    assert run("effects", "--root", tmp_path)[0] == 0
    (tmp_path / "effects" / "shim.py").write_text(SHIM + "raise SystemExit(0)\n", encoding="utf-8")
    assert run("effects", "--root", tmp_path)[0] == 2


def test_who_has_no_home_agrees_for_one_run(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("XDG_CONFIG_HOME")
    monkeypatch.setenv("HOME", "~")
    monkeypatch.setattr(agreed_to, "_agreed", set())
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "shim.py").write_text(SHIM, encoding="utf-8")
    assert run("effects", "--root", tmp_path, "--trust-effects")[0] == 0
    agreed_to._agreed.clear()  # as in another process
    assert run("effects", "--root", tmp_path)[0] == 2
    assert [path.name for path in tmp_path.iterdir()] == ["effects"]


def test_somebody_at_a_terminal_is_asked(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "shim.py").write_text(SHIM, encoding="utf-8")
    answers = iter([False, True])
    monkeypatch.setattr(trust, "_yes", lambda folder, names: next(answers))
    monkeypatch.setattr(trust, "_somebody", lambda: True)
    assert [run("effects", "--root", tmp_path)[0] for _ in range(3)] == [2, 0, 0]


def test_a_broken_file_ends_with_one_plain_message(run: Run, tmp_path: Path) -> None:
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "shim.py").write_text("EFFECT = 3", encoding="utf-8")
    status, out, said = run("effects", "--root", tmp_path, "--trust-effects")
    assert (status, out) == (2, "")
    assert "shim.py: found no EFFECT" in said


def test_people_see_what_a_test_can_tell_apart(run: Run, stand: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "170")
    status, out, _ = run("effects", "HF5", "--root", stand)
    assert status == 0
    assert all(effect.plain_name in out for effect in library().values())
    assert "HF5: what run tank pressure, nitrogen purge line pressure, run line pressure, chamber pressure" in out
    assert "twins: boiling that comes late and warm layers in the tank" in out
    assert "The library asks for: a thermocouple in the tank's liquid" in out


def _rows(text: str) -> dict[str, tuple[float, str]]:
    """By how much every effect stands out in the table that people see, and its closest rivals."""
    columns = [re.split(" {2,}", line.strip()) for line in text.splitlines()]
    names = [effect.plain_name for effect in library().values()]
    return {row[0]: (float(row[2]), row[4] if len(row) > 4 else "") for row in columns if row[0] in names}


def test_the_guide_shows_what_it_prints(run: Run, stand: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "170")
    guide = (Path(__file__).parents[2] / "docs" / "effects.md").read_text(encoding="utf-8")
    told = _rows(guide.partition("HF5: what run tank")[2].partition("```")[0])
    _, out, _ = run("effects", "HF5", "--root", stand)
    printed = _rows(out)
    assert list(told) == list(printed) == [effect.plain_name for effect in library().values()]
    for name, (seen, rival) in printed.items():
        assert told[name][0] == pytest.approx(seen, rel=0.02, abs=0.1), name
        assert re.sub(r"[\d.]+", "", told[name][1]) == re.sub(r"[\d.]+", "", rival), name


def test_json_has_what_a_test_can_tell_apart_beside_the_library(run: Run, stand: Path) -> None:
    status, out, _ = run("effects", "HF5", "--json", "--root", stand)
    found = json.loads(out)
    test = found["test"]
    assert status == 0
    assert list(found["effects"]) == list(test["effects"]) == list(library())
    heat = test["effects"]["tank_heat"]
    assert heat["seen_at"] * heat["detectability"] == pytest.approx(test["seen_from"] * heat["typical"])
    apart = [rival["apart"] for rival in heat["rivals"]]
    assert apart == sorted(apart)
    assert test["effects"]["tank_nonequilibrium"]["rivals"][0]["name"] == "tank_stratification"
    assert all(pair["apart"] < test["twins_below"] for pair in test["twins"])
    assert test["effects"]["fuel_sliver"]["seen_at"] is None
    assert {"throat_radius_after", "T_tank"} <= set(test["sensors"])
    pairs = [pair["effects"] for pair in test["twins"]]
    assert all([pair["effects"] for pair in sensor["twins"]] == pairs for sensor in test["sensors"].values())
    assert set(test["sensors"]).isdisjoint(test["channels"])


def test_a_test_that_is_not_there_ends_with_one_plain_message(run: Run, stand: Path) -> None:
    status, out, said = run("effects", "HF6", "--root", stand)
    assert (status, out) == (2, "")
    assert "'HF6'" in said
    assert "HF5" in said


def test_a_test_without_an_engine_says_that_there_is_nothing_to_run(run: Run, stand: Path) -> None:
    short = stand / "raw_tests" / "HF7"
    shutil.copytree(stand / "raw_tests" / "HF5", short)
    text = (short / "test.toml").read_text(encoding="utf-8").replace('"HF5"', '"HF7"')
    before, after = text.split("[nozzle]\n")
    (short / "test.toml").write_text(before + "[site]" + after.partition("[site]")[2], encoding="utf-8")
    status, out, said = run("effects", "HF7", "--root", stand)
    assert (status, out) == (3, "")
    assert "nozzle" in said
