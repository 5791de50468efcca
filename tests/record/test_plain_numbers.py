"""The fast parser of plain numbers reads what Python reads, to the bit, or leaves the text to pandas."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.record import make

from hfanalysis.record import spool
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers import delimited, open_log
from hfanalysis.record.readers.plain_numbers import parse

WRITTEN = ("{:.4f}", "{:.0f}", "{:.3e}", "{:+.6f}", "{:.12g}", " {:.2f} ")
T = np.arange(0.0, 60.0, 0.01)
TOML = make.LOG + make.channel("p_tank", "bar") + make.channel("T_tank", "K")


def plain(text: bytes, columns: int) -> NDArray[np.float64] | None:
    return parse(text, ",", ".", np.arange(columns), columns)


@pytest.mark.parametrize("form", WRITTEN)
def test_numbers_are_those_that_python_reads(form: str) -> None:
    rng = np.random.default_rng(3)
    values = rng.normal(size=(3, 500)) * 10.0 ** rng.integers(-3, 9, size=(3, 500))
    rows = [",".join(map(form.format, row)) for row in values.T]
    found = plain("\n".join(rows).encode(), 3)
    np.testing.assert_array_equal(found, np.array([[float(cell) for cell in row.split(",")] for row in rows]).T)


def test_cells_that_are_empty_or_not_there_are_no_number() -> None:
    found = plain(b"1,,3\r\n\n4\n   \n,5,6\n", 3)
    np.testing.assert_array_equal(found, [[1.0, 4.0, np.nan], [np.nan, np.nan, 5.0], [3.0, np.nan, 6.0]])


@pytest.mark.parametrize(
    "text", [b"1,x\n", b'1,"2"\n', b"1,12345678901234567890\n", b"1,2e\n", b"1,--2\n", b"1,2\r3,4\r5,6\n"]
)
def test_anything_else_is_left_to_pandas(text: bytes) -> None:
    assert plain(text, 2) is None


@pytest.mark.parametrize("end", ["", "\n", "\n\n   \n"])
def test_a_log_in_many_pieces_is_the_log_in_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end: str) -> None:
    text = make.csv(time=T, p_tank=50.0 + np.sin(T), T_tank=290.0 + np.cos(T)).rstrip("\n") + end
    whole = make.read(tmp_path / "whole", TOML, {"log.csv": text})
    monkeypatch.setattr(delimited, "SEGMENT", 1000)
    monkeypatch.setattr(spool, "BLOCK", 700)
    for memory in (1 << 30, 30_000):
        monkeypatch.setattr(spool, "IN_MEMORY", memory)
        pieces = make.read(tmp_path / str(memory), TOML, {"log.csv": text})
        for name in ("p_tank", "T_tank"):
            np.testing.assert_array_equal(pieces[name].values, whole[name].values)
            np.testing.assert_array_equal(pieces[name].time, whole[name].time)
        assert pieces.provenance["raw"] == {"log.csv": hashlib.sha256(text.encode()).hexdigest()}
    assert len(whole["p_tank"].values) == len(T)


def test_a_column_taken_may_be_changed_and_is_gone(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(make.csv(time=T, p_tank=T))
    columns = spool.Spool(open_log(tmp_path / "log.csv", FileSpec(file="log.csv")), tmp_path)
    columns.fill([1], [0], lambda share: None)
    taken = columns.take(1)
    taken += 1.0
    np.testing.assert_allclose(taken, T + 1.0)
    assert columns.rows(1) == 0
    np.testing.assert_allclose(columns.look(0), T)
