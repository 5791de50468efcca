"""CONTRIBUTING.md: its examples do what it says, as they stand there, and its rooms are those of the package."""

from __future__ import annotations

import io
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import cast

import numpy as np
import pytest
from tests.engine.stand import engine_on_stand
from tests.record import make
from tests.report.sample import material, without

from hfanalysis.effects import effect
from hfanalysis.effects.trust import agree
from hfanalysis.engine.unsteady import burn
from hfanalysis.errors import InputError
from hfanalysis.record import formats, readers
from hfanalysis.report import sections

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
FILES = {path: code for code, path in re.findall(r"```python\n(# (src/\S+\.py)\n.*?)```", PAGE, re.S)}
PACKAGE = "src/hfanalysis"


def placed(path: str, folder: Path) -> Path:
    """The folder that an example's file now stands in."""
    (folder / Path(path).name).write_text(FILES[f"{PACKAGE}/{path}"], encoding="utf-8")
    return folder


def beside(room: ModuleType, path: str, folder: Path, patch: pytest.MonkeyPatch) -> None:
    """An example's file among the modules of its room."""
    patch.setattr(room, "__path__", [*room.__path__, str(placed(path, folder))])


@pytest.fixture
def reading_npy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    beside(readers, "record/readers/numpy_array.py", tmp_path, monkeypatch)
    ((row,),) = [re.findall(r"```python\n# a row of \S+formats\.py\n(.*?)```", PAGE, re.S)]
    for word, one in cast(dict[str, formats.Format], eval(f"{{{row}}}", vars(formats))).items():
        monkeypatch.setitem(formats.FORMATS, word, one)
    yield
    sys.modules.pop(f"{readers.__name__}.numpy_array", None)


@pytest.fixture
def with_feed_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    beside(sections, "report/sections/feed_line.py", tmp_path, monkeypatch)
    sections.sections.cache_clear()
    yield
    sections.sections.cache_clear()
    sys.modules.pop(f"{sections.__name__}.feed_line", None)


def test_the_effect_lets_more_flow_the_longer_the_engine_burns(tmp_path: Path) -> None:
    folder = placed("effects/injector_wear.py", tmp_path)
    agree(folder)
    wear = effect("injector_wear", folder)
    drained = [burn(engine_on_stand(effects=(wear.at(rate=rate),)), 4.0).states[-1, 0] for rate in (0.0, 0.05)]
    plain = burn(engine_on_stand(), 4.0).states[-1, 0]
    assert drained[0] == plain
    assert drained[1] < 0.97 * plain


def npy(
    values: np.ndarray[tuple[int, ...], np.dtype[np.void]] | np.ndarray[tuple[int, ...], np.dtype[np.float64]],
) -> bytes:
    file = io.BytesIO()
    np.save(file, values)
    return file.getvalue()


TOML = '[log]\nfiles = ["log.npy"]\ntime = { column = "t", unit = "s" }\n' + make.channel("p_tank", "bar")


def test_the_reader_is_found_by_its_row_and_reads_a_log(reading_npy: None, tmp_path: Path) -> None:
    log = np.zeros(50, dtype=[("t", "f8"), ("p_tank", "f4")])
    log["t"], log["p_tank"] = np.arange(50) / 10.0, 40.0 + np.arange(50) / 8.0
    found = make.read(tmp_path, TOML, {"log.npy": npy(log)})
    np.testing.assert_allclose(found["p_tank"].time, log["t"], atol=1e-9)
    np.testing.assert_allclose(found["p_tank"].values, 1e5 * log["p_tank"], rtol=1e-6)


def test_the_reader_refuses_what_has_no_names(reading_npy: None, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="without names"):
        make.read(tmp_path, TOML, {"log.npy": npy(np.zeros((50, 2)))})


def test_the_table_stands_on_the_page_with_what_was_found(with_feed_line: None, tmp_path: Path) -> None:
    (laid,) = [laid for laid in sections.lay_out(material(tmp_path)) if laid.key == "feed_line"]
    (block,) = map(str, laid.blocks)
    assert "11.43" in block
    assert "vapor" not in block  # of which the calibration says nothing
    (absent,) = [
        one for one in sections.lay_out(without(material(tmp_path), calibration="no liquid")) if one.key == laid.key
    ]
    assert absent.absent == "no liquid"


def test_the_rooms_are_those_of_the_contract() -> None:
    contract = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
    rows = [set(row.split(" | ")) for row in contract[0]["layers"]]
    folders = {path.parent.name for path in (ROOT / PACKAGE).glob("*/__init__.py")}
    told = [(int(number), room) for number, room in re.findall(r"^\| (\d+) \| `(\w+)` \|", PAGE, re.M)]
    assert {room for _, room in told} == folders
    for number, room in told:
        assert room in rows[number]  # row 0 is __main__
