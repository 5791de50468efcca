"""Lines put into a test.toml by hand of the program: everything else stays as it is written."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from tests.record import make

from hfanalysis.errors import InputError
from hfanalysis.record.amend import amended, write

TEXT = """\
# of the stand's notebook
schema = 1
[test]
id = "T"
kind = "hot_fire"

[log]
files = ["log.csv"]   # as the logger wrote it
time = { column = "time", unit = "s" }

[channels.p_tank]     # the old gauge
column = "p_tank"
unit = "bar"          # on its label
scale = 1.0           # as calibrated
# nothing else is known

[channels.thrust]
column = "thrust"
unit = "N"
"""


def test_a_key_goes_to_its_channel_and_comments_stay() -> None:
    found = amended(TEXT, "p_tank", "gauge = true")
    assert tomllib.loads(found)["channels"]["p_tank"]["gauge"] is True
    assert [row for row in found.split("\n") if row != "gauge = true"] == TEXT.split("\n")


def test_a_key_that_is_there_is_replaced_and_keeps_its_comment() -> None:
    found = amended(TEXT, "p_tank", "scale = 2.0")
    assert "scale = 2.0  # as calibrated\n" in found
    assert "scale = 1.0" not in found
    found = amended(TEXT, "p_tank", 'unit = "psi"')
    assert 'unit = "psi"  # on its label\n' in found


def test_a_stretch_is_added_once() -> None:
    cure = '[[exclude]]\nchannels = ["thrust"]\nstart = "1 s"\nend = "2 s"'
    found = amended(TEXT, "thrust", cure)
    assert tomllib.loads(found)["exclude"] == [{"channels": ["thrust"], "start": "1 s", "end": "2 s"}]
    assert amended(found, "thrust", cure) == found


def test_tables_of_channels_reach_other_channels() -> None:
    found = amended(TEXT, "p_tank", '[channels.p_tank]\ncolumn = "a"\n[channels.thrust]\ncolumn = "b"')
    channels = tomllib.loads(found)["channels"]
    assert (channels["p_tank"]["column"], channels["thrust"]["column"]) == ("a", "b")


def test_a_file_that_says_it_otherwise_is_left_to_people() -> None:
    text = TEXT.partition("[channels.p_tank]")[0] + '[channels]\np_tank = { column = "p_tank", unit = "bar" }\n'
    with pytest.raises(InputError, match="by hand"):
        amended(text, "p_tank", "gauge = true")


def test_what_does_not_load_is_not_written(tmp_path: Path) -> None:
    path = make.write(tmp_path, make.LOG + make.channel("p_tank", "bar"), {"log.csv": "time,p_tank\n0,1\n1,2\n"})
    before = path.read_bytes()
    with pytest.raises(InputError, match="nothing was written"):
        write(path, amended(path.read_text(), "p_tank", "scale = 0.0"))
    assert path.read_bytes() == before
    write(path, amended(path.read_text(), "p_tank", "scale = 2.0"))
    assert "scale = 2.0" in path.read_text()
    assert sorted(p.name for p in path.parent.iterdir()) == ["log.csv", "test.toml"]
