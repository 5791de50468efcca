"""What a run prints: one screen, in plain words, as narrow as a terminal may be."""

from __future__ import annotations

import io
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.cli.run import hfa
from tests.report.prose import CODE, SYMBOLS, words_of
from tests.report.sample import HEALTH, material, saying

from hfanalysis.cli import paper, tables
from hfanalysis.cli.perform import MOST_WARNINGS, _warn
from hfanalysis.cli.request import named
from hfanalysis.quantity import Quantity
from hfanalysis.report.glance import four
from hfanalysis.stages import material as stages_material
from hfanalysis.wording.plain import sentences_of


def printed(monkeypatch: pytest.MonkeyPatch, folder: Path, width: int) -> str:
    """What is printed of a run, at a terminal of some columns."""
    made = saying(material(folder), health=HEALTH)
    console = paper._Paper(file=io.StringIO(), force_terminal=True, no_color=True, width=width, highlight=False)
    monkeypatch.setattr(tables, "paper", lambda: console)
    monkeypatch.setattr(stages_material, "load", lambda context: made)
    context: Any = SimpleNamespace(definition=made.definition, id="HF0", product=lambda name: Path(name))
    tables.show_run(context)
    return re.sub(r"\x1b\[[0-9;]*m", "", console.file.getvalue())  # type: ignore[attr-defined]


@pytest.mark.parametrize("width", [50, 80, 140])
def test_a_run_prints_one_screen_in_plain_words(width: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    text = printed(monkeypatch, tmp_path, width)
    lines = text.splitlines()
    assert len(lines) <= 40
    assert all(len(line) <= width for line in lines)
    for words in ("It burned for 12.4 s", "Missing from the model: heat", "18340", "2815", "report.html", "--verbose"):
        assert words in " ".join(text.split())
    prose = [line for line in lines if "report.html" not in line]
    assert set(CODE.findall(" ".join(prose))) <= SYMBOLS
    told = [told.words for told in four(saying(material(tmp_path), health=HEALTH))]
    assert len(told) == 4
    assert all(words_of(sentence) <= 25 for words in told for sentence in sentences_of(words))


@pytest.mark.parametrize(
    ("width", "kept"),
    [(50, ["value", "unit"]), (75, ["value", "± std", "unit"]), (110, ["value", "± std", "verdict"])],
)
def test_columns_go_before_digits_do(width: int, kept: list[str]) -> None:
    found = {
        "K_loss": Quantity(5.658e8, "1/m^4", 1.1e7, verdict="identified"),
        "a": Quantity(4.04e-4, "m/s (kg/m^2/s)^-n", 9e-5, verdict="not identifiable"),
        "oxidizer_mass_liquid_phase": Quantity(6.478, "kg", 0.042, verdict="identified"),
    }
    out = io.StringIO()
    console = paper._Paper(file=out, force_terminal=True, no_color=True, width=width, highlight=False)
    paper.print_quantities(console, found, "calibration")
    text = out.getvalue()
    assert "×10⁸ 1/m⁴" in text
    assert "×10⁻⁴ m/s (kg/m²/s)⁻ⁿ" in text
    assert "6.478" in text
    assert all(name in text for name in kept)
    assert ("identified" in text) == (width > 100)
    assert ("± std" in text) == ("± std" in kept)


def test_a_test_is_named_by_its_folder_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "raw_tests" / "HF9"
    folder.mkdir(parents=True)
    (folder / "test.toml").write_text("schema = 1", encoding="utf-8")
    assert named(f"{folder}/", Path()) == ("HF9", tmp_path)
    assert named(str(folder / "test.toml"), Path()) == ("HF9", tmp_path)
    assert named(str(folder), Path("elsewhere")) == ("HF9", Path("elsewhere"))
    monkeypatch.chdir(tmp_path)
    assert named("raw_tests/HF9/", Path()) == ("HF9", tmp_path)
    assert named("HF9", Path()) == ("HF9", Path())
    assert named("no/such", Path()) == ("no/such", Path())


def test_of_many_warnings_a_run_says_the_first_and_how_many_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    texts = [f"warning {n}" for n in range(MOST_WARNINGS + 2)]
    _warn(texts, whole=False)
    said = capsys.readouterr().err
    assert said.count("warning: ") == MOST_WARNINGS
    assert "2 more warnings on the page, or with --verbose" in said
    _warn(texts, whole=True)
    assert capsys.readouterr().err.count("warning: ") == MOST_WARNINGS + 2


def test_the_version_has_a_short_option_and_parameters_are_listed(tmp_path: Path) -> None:
    assert hfa("-V").out == hfa("--version").out
    (tmp_path / "raw_tests" / "T1").mkdir(parents=True)
    (tmp_path / "raw_tests" / "T1" / "test.toml").write_text(TOML, encoding="utf-8")
    (tmp_path / "raw_tests" / "T1" / "log.csv").write_text("t,p\n0,1\n", encoding="utf-8")
    ended = hfa("ingest", "T1", "--root", tmp_path, "--set", "help")
    assert ended.status == 2
    assert "calibrate.samples=" in ended.err


TOML = """\
schema = 1
[test]
id = "T1"
kind = "hot_fire"
[log]
files = ["log.csv"]
time = { column = "t", unit = "s" }
[channels.p_tank]
column = "p"
unit = "bar"
"""
