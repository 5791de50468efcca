"""``hfa effects`` as users and scripts hold on to it."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from hfanalysis.cli import main
from hfanalysis.effects import library

Run = Callable[..., tuple[int, str, str]]

SHIM = """
import numpy as np
from hfanalysis.engine.effect import Effect, Parameter

EFFECT = Effect(
    name="shim", equation="sensor", meaning="the thrust cell sits askew", reference="our stand",
    parameters=(Parameter("share", "-", "of the thrust that is not seen", 0.01),), phases=("liquid",),
    distort=lambda times, channels, values: {**channels, "thrust": channels["thrust"] * (1.0 - values["share"])},
)
"""


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run ``hfa`` in this process: status, standard output, standard error."""

    def run(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["hfa", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        return int(ended.value.code or 0), said.out, said.err

    return run


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
    assert [p["strength"] for p in found["n2_purge"]["parameters"].values()] == [True, False, False, False]
    assert all(p["strength"] for p in found["pressure_transducer_offset"]["parameters"].values())


def test_a_teams_own_effect_is_listed_and_a_bound_that_is_not_there_is_null(run: Run, tmp_path: Path) -> None:
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "shim.py").write_text(SHIM, encoding="utf-8")
    status, out, _ = run("effects", "--json", "--root", tmp_path)
    assert status == 0
    assert json.loads(out)["effects"]["shim"]["parameters"]["share"]["high"] is None


def test_a_broken_file_ends_with_one_plain_message(run: Run, tmp_path: Path) -> None:
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "shim.py").write_text("EFFECT = 3", encoding="utf-8")
    status, out, said = run("effects", "--root", tmp_path)
    assert (status, out) == (2, "")
    assert "shim.py: found no EFFECT" in said
