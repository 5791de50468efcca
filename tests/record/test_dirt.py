"""What loggers leave in a log beside its rows costs no row and makes no number."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.record import make, rows

from hfanalysis.errors import InputError
from hfanalysis.record.log import Flag
from hfanalysis.record.readers import delimited

WHOLE = rows.text()
TAILS = {
    "control z": b"\x1a",
    "form feed": b"\x0c",
    "erased flash": b"\xff" * 500,
    "zeros": b"\0" * 500,
    "zeros and line": b"\0" * 100 + b"\r\n",
    "exponent": b"21.0,4.4e",
    "minus": b"21.0,440.2,-",
    "number": b"21.0,4",
    "quote": b'"21.0","44',
    "zeros in a row": b"21.0,440.2" + b"\0" * 200,
    "marker": b"EOF",
    "footer": b"End of data\nrows: 120\n",
    "comment": b"# stopped by operator\n",
    "separators": b",,,\n,,,\n",
}


@pytest.mark.parametrize("tail", TAILS)
@pytest.mark.parametrize("mark", [",", "\t", " "])
def test_what_follows_the_last_row_is_no_row(tmp_path: Path, tail: str, mark: str) -> None:
    text = rows.text(mark=mark).encode() + TAILS[tail].replace(b",", mark.encode())
    log = rows.read(tmp_path, text)
    rows.assert_unspoilt(log)
    cut = any(c in b"0123456789" for c in TAILS[tail])
    assert any("left out" in warning for warning in log.warnings) >= cut


@pytest.mark.parametrize("lines_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("end", ["", "\n", "\n\n \n"])
def test_a_last_row_that_is_whole_counts(tmp_path: Path, lines_end: str, end: str) -> None:
    rows.assert_unspoilt(rows.read(tmp_path, (WHOLE.rstrip("\n") + end).replace("\n", lines_end)))


def test_a_last_cell_that_is_cut_is_no_number(tmp_path: Path) -> None:
    log = rows.read(tmp_path, WHOLE.rstrip("\n")[:-2])
    rows.assert_unspoilt(log, lost=1)
    assert any("line 121" in warning for warning in log.warnings)


@pytest.mark.parametrize(
    ("at", "what"),
    [
        (60, "time,PT,PR,LC"),
        (60, "# valve opened"),
        (60, "0.25,65"),
        (60, "35.1,118.0"),
        (60, "0.2,6535.1,118.0,0.2,6535.1,118.0"),
        (60, '0.2,"6535'),
        (3, "logger restarted"),
    ],
)
def test_what_stands_between_rows_is_left_out(tmp_path: Path, at: int, what: str) -> None:
    lines = WHOLE.splitlines()
    log = rows.read(tmp_path, "\n".join([*lines[:at], what, *lines[at:]]) + "\n")
    rows.assert_unspoilt(log)
    assert any(f"line {at + 1}" in warning for warning in log.warnings)


def test_a_row_broken_in_the_middle_gives_no_number(tmp_path: Path) -> None:
    lines = WHOLE.splitlines()
    broken = "\n".join([*lines[:60], lines[60][:12], lines[60][12:], *lines[61:]]) + "\n"
    log = rows.read(tmp_path, broken)
    assert len(log["p_tank"].time) == rows.COUNT - 1
    assert np.isin(np.round(log["p_tank"].values / 1e3, 3), rows.VALUES[:, 1]).all()


def test_lost_bytes_inside_a_number_make_it_none(tmp_path: Path) -> None:
    text = WHOLE.encode().replace(b"\n", b"\r\n")
    place = text.find(b".", 300) + 1
    log = rows.read(tmp_path, text[:place] + b"\0\0" + text[place:])
    assert sum((log[name].flags & Flag.DROPOUT).sum() for name in ("p_tank", "p_run", "thrust")) <= 1
    assert len(log["p_tank"].time) >= rows.COUNT - 1


@pytest.mark.parametrize("head", [b"\xff\xfe\x80\x12,.4,34.2\r\n", b"\x00\xf8\x80.4,34.2\r\n", b"\0" * 40 + b"\r\n"])
def test_a_broken_beginning_is_no_other_encoding(tmp_path: Path, head: bytes) -> None:
    rows.assert_unspoilt(rows.read(tmp_path, head + WHOLE.encode()))


def test_rows_that_leave_out_their_last_cells_keep_the_others(tmp_path: Path) -> None:
    lines = WHOLE.splitlines()
    short = [line if i % 4 == 0 else line.rpartition(",")[0] for i, line in enumerate(lines)]
    log = rows.read(tmp_path, "\n".join(short) + "\n")
    np.testing.assert_allclose(log["p_tank"].values / 1e3, rows.VALUES[:, 1])
    assert np.isfinite(log["thrust"].values).sum() == rows.COUNT // 4


def test_a_file_that_is_not_written_as_it_begins_is_refused(tmp_path: Path) -> None:
    lines = WHOLE.splitlines()
    others = [line + ",1" * (i % 40 + 1) for i, line in enumerate(lines[1:])]
    with pytest.raises(InputError, match=r"120 of its lines are no rows of 4 fields, the first in line 41"):
        rows.read(tmp_path, "\n".join([*lines[:40], *others, *lines[40:60]]) + "\n")


def test_segments_need_not_all_be_plain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(delimited, "SEGMENT", 400)
    text = WHOLE.replace("\n", "\n", 1).splitlines()
    text[50] = text[50].rpartition(",")[0] + ",ERR"
    log = rows.read(tmp_path, "\n".join(text) + "\n")
    assert np.flatnonzero(np.isnan(log["thrust"].values)).tolist() == [49]
    assert any("'ERR' in line 51" in warning for warning in log.warnings)
    np.testing.assert_allclose(log["p_tank"].values / 1e3, rows.VALUES[:, 1])


@pytest.mark.parametrize(("one", "zero"), [("True", "False"), ("ON", "OFF"), ("open", "closed")])
def test_words_for_one_and_zero_are_those(tmp_path: Path, one: str, zero: str) -> None:
    text = "time,valve\n" + "".join(f"{i},{one if i > 30 else zero}\n" for i in range(60))
    log = make.read(tmp_path, make.LOG + '[channels.valve]\ncolumn = "valve"\n', {"log.csv": text})
    np.testing.assert_array_equal(log["valve"].values, np.arange(60) > 30)
