"""hfa diagnose --apply and --retract: what is named is written, what is not is refused, and all of it is undone."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.inference.adopted.firing import make_root
from tests.products.filled import filled

from hfanalysis.cli import main
from hfanalysis.cli.adopt import adopt, proved_as_before
from hfanalysis.cli.request import Request
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.inference.adopted.effects import read_adopted
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.products.disk import write_json
from hfanalysis.stages.base import Context
from hfanalysis.stages.open_test import open_test


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return make_root(tmp_path)


def opened(root: Path) -> Context:
    return open_test(root, "T1")


NAMED: dict[str, Any] = {
    "verdict": "named",
    "set90": ["tank_heat"],
    "effects": [
        {
            "name": "tank_heat",
            "probability": 0.83,
            "equation": "tank_energy",
            "parameters": {
                "power": {"value": 912.3456789, "unit": "W", "std": 152.1, "ci95": None},
                "lag": {"value": 0.2345678, "unit": "s", "std": 0.1, "ci95": None},
                "fade": {"value": 31.23456, "unit": "s", "std": 9.0, "ci95": None},
                "begun": {"value": 0.4123456, "unit": "", "std": 0.2, "ci95": None},
            },
        }
    ],
}


def test_what_a_diagnosis_names_is_adopted(root: Path) -> None:
    path = adopt(opened(root), filled(Diagnosis, NAMED))
    assert path == root / "engines" / "T1.effects.toml"
    text = path.read_text(encoding="utf-8")
    assert "tank_heat with probability 0.83" in text.splitlines()[1]
    assert "hfa diagnose T1 --retract" in text
    (effect,) = read_adopted(root, opened(root).definition).effects
    assert effect.values == (912.3456789, 0.2345678, 31.23456, 0.4123456)
    adopt(opened(root), filled(Diagnosis, NAMED))  # a diagnosis may write over a diagnosis
    path.write_text('[tank_heat]\npower = "1 kW"\n', encoding="utf-8")
    with pytest.raises(InputError, match="found a file that no diagnosis wrote"):
        adopt(opened(root), filled(Diagnosis, NAMED))
    path.unlink()


def test_how_far_the_name_can_be_believed_is_in_the_file(root: Path) -> None:
    tried = {"rate": 50.0, "rest": 9.0, "noise": 0.002, "load": 8.0, "like": 30, "sure": 14, "right": 13}
    path = adopt(opened(root), filled(Diagnosis, {**NAMED, "tried_on": tried}))
    assert path.read_text(encoding="utf-8").splitlines()[2] == (
        "# Of 14 statements above 0.9 on the 30 simulated tests most like this one 13 were right."
    )


def test_for_a_stand_it_is_adopted_for_all_its_tests(root: Path) -> None:
    path = adopt(opened(root), filled(Diagnosis, NAMED), stand=True)
    assert path.name == "paper.effects.toml"
    assert read_adopted(root, opened(root).definition).file == "paper.effects.toml"
    path.unlink()


@pytest.mark.parametrize(
    "diagnosis",
    [
        {"verdict": "unknown", "set90": ["unknown"], "effects": []},
        {"verdict": "named", "set90": ["tank_heat"], "effects": []},
        {**NAMED, "verdict": "ambiguous", "set90": ["tank_heat", "tank_wall_heat_capacity"]},
    ],
)
def test_what_is_not_named_is_not_adopted(root: Path, diagnosis: dict[str, Any]) -> None:
    found = filled(Diagnosis, diagnosis)
    with pytest.raises(AbsentError, match=f"nothing to adopt.*{found.verdict}.*{found.plain(found.set90[-1])}"):
        adopt(opened(root), found)
    assert not (root / "engines" / "T1.effects.toml").exists()


def test_a_diagnosis_beyond_the_bounds_of_an_effect_writes_nothing(root: Path) -> None:
    wild = {"name": "tank_heat", "probability": 1.0, "parameters": {"power": {"value": 1e6, "unit": "W", "std": None}}}
    with pytest.raises(InputError, match=r"diagnosis\.json, tank_heat\.power.*expected 0 to 20000 W"):
        adopt(opened(root), filled(Diagnosis, {**NAMED, "effects": [wild]}))
    assert not (root / "engines" / "T1.effects.toml").exists()


Run = Callable[..., int]


@pytest.fixture
def hfa(monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run ``hfa`` in this process; its exit status."""

    def run(*arguments: object) -> int:
        monkeypatch.setattr(sys, "argv", ["hfa", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        return int(ended.value.code or 0)

    return run


def test_apply_and_retract_on_the_command_line(
    root: Path, hfa: Run, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def diagnosed(_name: str, request: Request) -> Context:
        context = open_test(request.root, request.test)
        context.out.mkdir(parents=True, exist_ok=True)
        write_json(context.product("diagnosis.json"), filled(Diagnosis, NAMED))
        return context

    monkeypatch.setattr("hfanalysis.cli.adopt.stage", diagnosed)
    path = root / "engines" / "T1.effects.toml"
    raw = {p: p.read_bytes() for p in (root / "raw_tests").rglob("*") if p.is_file()}
    assert hfa("diagnose", "T1", "--root", root, "--apply") == 0
    assert path.is_file()
    assert hfa("diagnose", "T1", "--root", root, "--retract") == 0
    assert not path.exists()
    said = capsys.readouterr()
    assert said.out == ""
    assert "T1.effects.toml: written; every stage of T1" in said.err
    assert "the model of T1 is the base model again" in said.err
    assert hfa("diagnose", "T1", "--root", root, "--retract") == 3
    assert {p: p.read_bytes() for p in (root / "raw_tests").rglob("*") if p.is_file()} == raw


@pytest.mark.parametrize(
    "options", [("--apply", "--retract"), ("--stand",), ("--unknown",), ("--retract", "--unknown")]
)
def test_options_that_contradict_are_refused(root: Path, hfa: Run, options: tuple[str, ...]) -> None:
    assert hfa("diagnose", "T1", "--root", root, *options) == 2


def test_a_stand_that_is_not_stated_cannot_adopt(root: Path) -> None:
    toml = root / "raw_tests" / "T1" / "test.toml"
    toml.write_text(toml.read_text(encoding="utf-8").replace('stand = "paper"\n', ""), encoding="utf-8")
    with pytest.raises(InputError, match=r"test\.stand: is missing"):
        adopt(opened(root), filled(Diagnosis, NAMED), stand=True)


@pytest.mark.parametrize(
    ("stored", "asked", "expected"),
    [
        ("T2", (), ('diagnose.proof_test="T2"',)),
        ("T2", ('diagnose.proof_test="T3"',), ('diagnose.proof_test="T3"',)),
        ("", ("calibrate.samples=40",), ("calibrate.samples=40",)),
        (None, (), ()),
    ],
)
def test_what_is_adopted_is_proved_on_the_test_that_it_was(
    stored: str | None, asked: tuple[str, ...], expected: tuple[str, ...], root: Path
) -> None:
    """Or --apply would diagnose once more and lose the proof."""
    if stored is not None:
        context = opened(root)
        context.out.mkdir(parents=True, exist_ok=True)
        product = {**NAMED, "provenance": {"parameters": {"proof_test": stored}}}
        context.product("diagnosis.json").write_text(json.dumps(product), encoding="utf-8")
    assert proved_as_before(Request("T1", root, None, False, False, True, asked)).settings == expected
