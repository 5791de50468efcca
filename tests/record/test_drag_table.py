"""Drag tables as people keep them, and what is said of those that are none."""

from __future__ import annotations

from pathlib import Path

import pytest

from hfanalysis.errors import InputError
from hfanalysis.record.drag_table import read_drag_table


def table(folder: Path, text: str) -> Path:
    path = folder / "drag.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "text",
    [
        "0.15,0.402\n0.8,0.45\n",
        "Mach,Cd\n0.15,0.402\n0.8,0.45\n",
        "# OpenRocket\n0.15;0.402\n0.8;0.45",
        "0,15;0,402\r\n0,8;0,45\r\n",
        "0.15 0.402\n\n0.8\t0.45\n".replace("\t", " "),
        "\ufeff0.15\t0.402\textra\n0.8\t0.45\textra\n",
    ],
)
def test_a_table_reads_the_same_however_it_is_separated(tmp_path: Path, text: str) -> None:
    found = read_drag_table(table(tmp_path, text))
    assert found.mach == (0.15, 0.8)
    assert found.coefficient == (0.402, 0.45)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no numbers"),
        ("Mach,Cd\n", "no numbers"),
        ("0.1,0.4\n0.1,0.5\n", "increase"),
        ("0.5,0.4\n0.1,0.5\n", "Mach 0.1 after 0.5"),
        ("0.1,0.4\n0.2\n", "line 2"),
        ("0.1,0.4\n0.2,much\n", "line 2"),
        ("0.1,-0.4\n", "line 1"),
        ("-0.1,0.4\n", "line 1"),
        ("0.1,52.9\n", "between 0 and 20"),
        ("nan,0.4\n", "line 1"),
    ],
)
def test_a_table_that_is_none_is_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as refusal:
        read_drag_table(table(tmp_path, text))
    assert "drag.csv" in str(refusal.value)


def test_a_table_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"drag\.csv: not found"):
        read_drag_table(tmp_path / "drag.csv")
