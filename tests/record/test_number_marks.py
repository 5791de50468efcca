"""Numbers come out as they were written, whatever marks they are written with, or the mark is named."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.record import make, rows

from hfanalysis.errors import InputError
from hfanalysis.record.readers.marks import decimal_mark


def grouped(value: float, decimals: int, thousands: str, decimal: str) -> str:
    """A number with a mark between thousands."""
    return f"{value:,.{decimals}f}".replace(",", "\0").replace(".", decimal).replace("\0", thousands)


DIALECTS = [
    (",", ".", ";"),
    (".", ",", ";"),
    (" ", ",", ";"),
    ("\u00a0", ",", ";"),
    ("\u202f", ",", "\t"),
    ("'", ".", ","),
    ("\u2019", ".", ";"),
    (" ", ".", ","),
]


@pytest.mark.parametrize("quoted", [False, True])
@pytest.mark.parametrize("decimals", [0, 1, 2, 3])
@pytest.mark.parametrize(("thousands", "decimal", "delimiter"), DIALECTS)
def test_thousands_marks(
    tmp_path: Path, thousands: str, decimal: str, delimiter: str, decimals: int, quoted: bool
) -> None:
    lines = [delimiter.join(rows.NAMES)]
    for t, *values in rows.VALUES:
        cells = [f"{t:.3f}".replace(".", decimal), *(grouped(v, decimals, thousands, decimal) for v in values)]
        lines.append(delimiter.join(f'"{cell}"' if quoted else cell for cell in cells))
    rows.assert_unspoilt(rows.read(tmp_path, "\n".join(lines) + "\n"), decimals)


def test_a_comma_between_quotes_sets_thousands_apart_wherever_it_first_comes(tmp_path: Path) -> None:
    lines = [",".join(rows.NAMES)]
    for t, p, r, f in rows.VALUES:
        lines.append(f'{t:.3f},"{p:,.0f}","{r:,.0f}",{f:.0f}'.replace('"118"', "118"))
    rows.assert_unspoilt(rows.read(tmp_path, "\n".join(lines) + "\n"), 0)


def test_a_comma_that_may_be_either_is_asked_for(tmp_path: Path) -> None:
    text = "time;PT\n" + "".join(f"{i};1,{100 + i}\n" for i in range(20))
    toml = make.LOG + '[channels.p_tank]\ncolumn = "PT"\nunit = "kPa"\n'
    with pytest.raises(InputError, match=r"'1,100' the comma may be a decimal mark or set thousands apart"):
        rows.read(tmp_path, text, toml)
    for mark, first in ((",", 1.1), (".", 1100.0)):
        stated = toml.replace("[log]\n", f'[log]\ndecimal = "{mark}"\n')
        assert rows.read(tmp_path / str(first), text, stated)["p_tank"].values[0] == pytest.approx(1e3 * first)


@pytest.mark.parametrize(
    ("columns", "mark"),
    [
        ([["1,5"], ["2,25"]], ","),
        ([["1.234", "2.345"]], "."),
        ([["1.234", "118"], ["0,5"]], ","),
        ([["1.234", "118"]], ","),
        ([["1,234", "118"]], "."),
        ([["1,234,567"]], "."),
        ([["1.234,5"]], ","),
        ([["0,123", "0,456"]], ","),
        ([["7", "8"]], "."),
    ],
)
def test_the_cells_of_a_file_tell_its_decimal_mark_together(columns: list[list[str]], mark: str) -> None:
    assert decimal_mark(columns, "log.csv") == mark


@pytest.mark.parametrize(
    ("plain", "written"),
    [("-", "\u2212"), ("-", "\uff0d"), ("e+", "D+"), ("e-", "d-"), ("e+", "E+")],
)
def test_signs_and_exponents_that_are_not_plain(tmp_path: Path, plain: str, written: str) -> None:
    rows.assert_unspoilt(rows.read(tmp_path, rows.text("{:.8e}").replace(plain, written)))


def test_a_plus_is_no_text(tmp_path: Path) -> None:
    rows.assert_unspoilt(rows.read(tmp_path, rows.text("{:+.3f}")))


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300), min_size=3))
def test_numbers_are_rounded_correctly(values: list[float]) -> None:
    text = "time,p_tank\n" + "".join(f"{i},{value!r}\n" for i, value in enumerate(values))
    with tempfile.TemporaryDirectory() as folder:
        path = make.write(Path(folder), make.LOG + make.channel("p_tank", "Pa"), {"log.csv": text})
        found = numbers_of(path.parent / "log.csv", 1)
    np.testing.assert_array_equal(found, np.array(values))


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.integers(-(10**9), 10**9), min_size=4, max_size=12),
    st.integers(0, 6),
    st.sampled_from(DIALECTS),
)
def test_written_and_read_again_is_the_same_number(
    whole: list[int], decimals: int, dialect: tuple[str, str, str]
) -> None:
    thousands, decimal, delimiter = dialect
    values = [0.5, 2000000.25, *(number / 10**decimals for number in whole)]
    cells = ["0" + decimal + "5", grouped(2000000.25, 2, thousands, decimal)]
    cells += [grouped(value, decimals, thousands, decimal) for value in values[2:]]
    lines = [f"time{delimiter}p_tank", *(f"{i}{delimiter}{cell}" for i, cell in enumerate(cells))]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        found = numbers_of(path, 1)
    np.testing.assert_array_equal(found, [float(f"{value:.{decimals}f}") for value in values[:0]] + values)


def numbers_of(path: Path, column: int) -> np.ndarray:
    """A column as the reader gives it."""
    from hfanalysis.record.logspec import FileSpec
    from hfanalysis.record.readers import open_log

    chunks = open_log(path, FileSpec(file=path.name)).chunks([column], [], lambda share: None)
    return np.concatenate([chunk.columns[column] for chunk in chunks])
