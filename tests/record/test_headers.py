"""Names stand above the columns that they name, or they are not used."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.record import rows

from hfanalysis.errors import InputError

DATA = rows.text().split("\n", 1)[1]


def with_column(cells: list[str], at: int = 0) -> str:
    """The rows with one field more, which has no name."""
    lines = [line.split(",") for line in DATA.splitlines()]
    return "".join(",".join([*line[:at], cell, *line[at:]]) + "\n" for line, cell in zip(lines, cells, strict=True))


COUNTERS = [str(i) for i in range(rows.COUNT)]


@pytest.mark.parametrize(
    "body",
    [
        with_column(COUNTERS),
        with_column([f"{20 * i}" for i in range(rows.COUNT)]),
        with_column(["2024-05-01"] * rows.COUNT),
        with_column([f'"{i}"' for i in range(1, rows.COUNT + 1)]),
        with_column([f"{i % 7}" for i in range(rows.COUNT)], at=4),
        with_column(COUNTERS).replace(",", ",x,", 1),
        "".join(line.partition(",")[2] + "\n" for line in DATA.splitlines()),
    ],
)
def test_names_that_are_more_or_fewer_than_the_columns_are_not_shifted(tmp_path: Path, body: str) -> None:
    with pytest.raises(InputError, match=r"the row of names has 4 fields .* which names which column cannot be told"):
        rows.read(tmp_path, ",".join(rows.NAMES) + "\n" + body)


def test_columns_without_sure_names_go_by_their_numbers(tmp_path: Path) -> None:
    toml = '[log]\nfiles = ["log.csv"]\ntime = 2\n'
    toml += '[channels.p_tank]\ncolumn = 3\nunit = "kPa"\n[channels.p_run]\ncolumn = 4\nunit = "kPa"\n'
    toml += '[channels.thrust]\ncolumn = 5\nunit = "N"\n'
    rows.assert_unspoilt(rows.read(tmp_path, ",".join(rows.NAMES) + "\n" + with_column(COUNTERS), toml))


@pytest.mark.parametrize(
    "head",
    [
        "time,PT,PR,LC,",
        "# time,PT,PR,LC",
        "#,time,PT,PR,LC",
        "time,PT,PR,LC\ns,kPa,kPa,N",
        "s,kPa,kPa,N\ntime,PT,PR,LC",
        "time,PT,PR,LC\ns,kPa,kPa,N\nCJC,AI0,AI1,AI2",
        "time,PT,PR,LC\n(elapsed),tank top,run line,thrust",
        '"TOA5","Stand","CR1000","77"\n"time","PT","PR","LC"\n"TS","kPa","kPa","N"\n"","Smp","Smp","Smp"',
        '"time","P\nT","PR","LC"'.replace("P\nT", "PT"),
        "Stand,somewhere\nDate,2024-05-01\n\ntime,PT,PR,LC",
        "\x00\x9f\x81.4,34.2\r\ntime,PT,PR,LC",
    ],
)
def test_the_row_of_names_is_found_among_others(tmp_path: Path, head: str) -> None:
    body = DATA.replace("\n", ",\n") if head.endswith(",") else DATA
    rows.assert_unspoilt(rows.read(tmp_path, head.encode("latin-1") + b"\n" + body.encode()))


def test_a_line_break_inside_quotes_does_not_end_the_names(tmp_path: Path) -> None:
    head = '"time\n(s)","PT\n(kPa)","PR\n(kPa)","LC\n(N)"\n'
    toml = rows.TOML.replace('"time", unit', '"time (s)", unit')
    for name, unit in (("PT", "kPa"), ("PR", "kPa"), ("LC", "N")):
        toml = toml.replace(f'column = "{name}"', f'column = "{name} ({unit})"')
    rows.assert_unspoilt(rows.read(tmp_path, head + DATA, toml))


def test_a_comma_with_a_blank_behind_it_stands_inside_a_name(tmp_path: Path) -> None:
    head = "time,PT,PR,Load cell, LC\n"
    rows.assert_unspoilt(rows.read(tmp_path, head + DATA))
    rows.assert_unspoilt(rows.read(tmp_path, head + DATA, rows.TOML.replace('"LC"', '"Load cell, LC"')))


@pytest.mark.parametrize("left", [False, True])
def test_empty_cells_of_columns_of_fixed_width_stay_empty(tmp_path: Path, left: bool) -> None:
    form = (lambda cell: f"{cell:<14}") if left else (lambda cell: f"{cell:>14}")
    lines = ["".join(map(form, rows.NAMES))]
    for i, row in enumerate(rows.VALUES):
        cells = [f"{value:.3f}" for value in row]
        cells[2] = cells[2] if i % 3 == 0 else ""
        lines.append("".join(map(form, cells)))
    log = rows.read(tmp_path, "\n".join(lines) + "\n")
    third = np.arange(rows.COUNT) % 3 == 0
    np.testing.assert_array_equal(np.isfinite(log["p_run"].values), third)
    np.testing.assert_allclose(log["p_run"].values[third], 1e3 * rows.VALUES[third, 2])
    np.testing.assert_allclose(log["thrust"].values, rows.VALUES[:, 3])


def test_empty_cells_between_blanks_are_not_guessed(tmp_path: Path) -> None:
    lines = [" ".join(rows.NAMES)]
    for i, row in enumerate(rows.VALUES):
        lines.append(" ".join(f"{value:.3g}" for j, value in enumerate(row) if j != 2 or i % 3 == 0))
    with pytest.raises(InputError, match="which cells are empty cannot be told"):
        rows.read(tmp_path, "\n".join(lines) + "\n")


@pytest.mark.parametrize("line", ["{t} -> {rest}", "[{t}] -> {rest}", "{t} -> PT:{p},PR:{r},LC:{f}"])
def test_a_serial_monitor_puts_its_time_before_each_line(tmp_path: Path, line: str) -> None:
    lines = []
    for i, (_, p, r, f) in enumerate(rows.VALUES):
        stamp = f"10:00:{0.02 * i:06.3f}"
        lines.append(line.format(t=stamp, rest=f"{p:.3f},{r:.3f},{f:.3f}", p=f"{p:.3f}", r=f"{r:.3f}", f=f"{f:.3f}"))
    toml = '[log]\nfiles = ["log.csv"]\ntime = 1\n'
    names = ("PT", "PR", "LC") if ":{p}" in line else (2, 3, 4)
    for channel, column, unit in zip(("p_tank", "p_run", "thrust"), names, ("kPa", "kPa", "N"), strict=True):
        toml += f"[channels.{channel}]\ncolumn = {column!r}\nunit = '{unit}'\n"
    rows.assert_unspoilt(rows.read(tmp_path, "\n".join(lines) + "\n", toml))


def test_of_names_in_several_rows_two_that_are_alike_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has 2 columns 'PT'"):
        rows.read(tmp_path, "time,PT,PT,LC\n" + DATA)
