"""The same numbers come out whatever the dialect a log is written in."""

from __future__ import annotations

import codecs
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.record import make

from hfanalysis.record.log import Flag

ROWS = st.lists(st.tuples(st.floats(-1e5, 1e5, width=32), st.floats(-50, 50, width=32)), min_size=3, max_size=12)
CHANNELS = make.channel("p_tank", "Pa") + make.channel("T_run", "K", "offset = 300")


def table(rows: list[tuple[float, float]], delimiter: str, decimal: str, quoted: bool, trailing: bool) -> list[str]:
    """The lines of a log: names, then time and two columns."""
    cells = [["time", "p_tank", "T_run"]]
    cells += [[repr(0.01 * i), f"{p:.7g}", f"{t:.5g}"] for i, (p, t) in enumerate(rows)]
    mark = (lambda c: f'"{c}"') if quoted else (lambda c: c)
    return [delimiter.join(mark(c.replace(".", decimal)) for c in row) + delimiter * trailing for row in cells]


@settings(max_examples=60, deadline=None)
@given(
    rows=ROWS,
    delimiter=st.sampled_from([",", ";", "\t", "|", "  ", ", "]),
    decimal=st.sampled_from([".", ","]),
    quoted=st.booleans(),
    trailing=st.booleans(),
    preamble=st.sampled_from([[], ["# made by a logger"], ["Stand: here", "Date: 2022-04-03", ""]]),
    units=st.sampled_from([[], ["s", "Pa", "K"]]),
    end=st.sampled_from(["\n", "\r\n", "\r"]),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "cp1252"]),
)
def test_numbers_survive_the_dialect(
    rows: list[tuple[float, float]], delimiter: str, decimal: str, quoted: bool, trailing: bool, preamble: list[str],
    units: list[str], end: str, encoding: str,
) -> None:  # fmt: skip
    if "," in delimiter and decimal == ",":
        decimal = "."
    lines = table(rows, delimiter, decimal, quoted, trailing and delimiter != "  ")
    text = end.join([*preamble, lines[0], *([delimiter.join(units)] if units else []), *lines[1:]]) + end
    with tempfile.TemporaryDirectory() as folder:
        log = make.read(Path(folder), make.LOG + CHANNELS, {"log.csv": text.encode(encoding)})
    np.testing.assert_allclose(log["p_tank"].time, 0.01 * np.arange(len(rows)), rtol=1e-15)
    for name, j, offset in (("p_tank", 0, 0.0), ("T_run", 1, 300.0)):
        seen = (log[name].flags & Flag.DROPOUT) == 0
        expected = np.array([float(f"{row[j]:{'.7g' if j == 0 else '.5g'}}") + offset for row in rows])
        np.testing.assert_allclose(log[name].values[seen], expected[seen], rtol=1e-15)


UVIC = "psi,kg,,s,\nP,M,stamp,time\n11.2,0.1,2025-02-08 11:30:37.93,2650.5\n9.5,0.2,2025-02-08 11:30:37.94,2650.6\n"


def test_a_units_row_before_the_names_and_a_field_longer(tmp_path: Path) -> None:
    toml = make.LOG + '[channels.p_tank]\ncolumn = "P"\nunit = "psi"\n[channels.m_tank]\ncolumn = "M"\nunit = "kg"\n'
    log = make.read(tmp_path, toml, {"log.csv": UVIC})
    np.testing.assert_allclose(log["m_tank"].values, [0.1, 0.2])
    np.testing.assert_allclose(log["m_tank"].time, [2650.5, 2650.6])


@pytest.mark.parametrize("mark", [codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE])
def test_a_log_without_header_is_addressed_by_number(tmp_path: Path, mark: bytes) -> None:
    name = {3: "utf-8"}.get(len(mark), "utf-16-le" if mark == codecs.BOM_UTF16_LE else "utf-16-be")
    toml = '[log]\nfiles = ["log.csv"]\ntime = 1\n[channels.p_tank]\ncolumn = 3\nunit = "bar"\n'
    log = make.read(tmp_path, toml, {"log.csv": mark + "0.0 7 50.5\n0.1 7 50.25\n".encode(name)})
    np.testing.assert_allclose(log["p_tank"].values, [50.5e5, 50.25e5])


@pytest.mark.parametrize(
    ("stamps", "expected"),
    [
        (["2025-02-08 11:30:37.5", "2025-02-08 11:30:38.25"], [41437.5, 41438.25]),
        (["2025-02-08T23:59:59.5", "2025-02-09T00:00:00.5"], [86399.5, 86400.5]),
        (["11:30:37.5", "11:30:38.25"], [41437.5, 41438.25]),
        (["23:59:59.5", "00:00:00.5"], [86399.5, 86400.5]),
    ],
)
def test_stamps_in_words_become_seconds_since_midnight(
    tmp_path: Path, stamps: list[str], expected: list[float]
) -> None:
    text = "time,p_tank\n" + "".join(f"{stamp},{i}\n" for i, stamp in enumerate(stamps))
    log = make.read(tmp_path, make.LOG + make.channel("p_tank", "Pa"), {"log.csv": text})
    np.testing.assert_allclose(log["p_tank"].time, expected)


def test_text_among_numbers_is_a_dropout_and_is_told(tmp_path: Path) -> None:
    text = "time,p_tank\n0,1.5\n1,ERR\n2,2.5\n3,\n4,3.5\n"
    log = make.read(tmp_path, make.LOG + make.channel("p_tank", "Pa"), {"log.csv": text})
    np.testing.assert_array_equal(log["p_tank"].flags == Flag.DROPOUT, [False, True, False, True, False])
    np.testing.assert_array_equal(np.isnan(log["p_tank"].values), log["p_tank"].flags > 0)
    assert any("'ERR' in line 3" in warning for warning in log.warnings)
