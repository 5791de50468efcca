"""A test.toml that is lent to another log leaves out what was of its own day."""

from __future__ import annotations

import os
from pathlib import Path

from hfanalysis.record.definition import load_definition
from hfanalysis.record.lent import last_alike, lend

TOML = """\
schema = 1
[test]
id = "{id}"
kind = "cold_flow"
source = "replica"
date = {date}
stand = "the old barn"
[log]
files = ["log.csv"]
time = {{ column = "t", unit = "s" }}
[channels.p_tank]
column = "p"
unit = "bar"
trust = "calibrated that morning"
[tank]
volume = "16 L"
oxidizer_mass = "8 kg"
[observed]
burn_time = "6 s"
[segments]
t_v = "5 s"
[[exclude]]
channels = ["p_tank"]
start = "1 s"
end = "2 s"
[site]
altitude = "30 m"
"""


def made(root: Path, name: str, date: str, header: str = "t,p") -> Path:
    folder = root / "raw_tests" / name
    folder.mkdir(parents=True)
    (folder / "log.csv").write_text(f"{header}\n" + "".join(f"{i / 10},{50 + i % 3}\n" for i in range(30)))
    path = folder / "test.toml"
    path.write_text(TOML.format(id=name, date=date))
    return path


def test_the_last_test_with_the_very_columns_lends(tmp_path: Path) -> None:
    made(tmp_path, "A", "2024-05-01")
    latest = made(tmp_path, "B", "2024-07-01")
    made(tmp_path, "C", "2024-06-01")
    made(tmp_path, "D", "2024-08-01").write_text("no toml at all [")
    other = made(tmp_path, "E", "2024-09-01", "t,p_other")
    os.utime(latest, (0, 0))
    log = tmp_path / "new.csv"
    log.write_bytes((latest.parent / "log.csv").read_bytes())
    found = last_alike(tmp_path, log)
    assert found is not None
    assert found.test.id == "B"
    log.write_bytes((other.parent / "log.csv").read_bytes().replace(b"p_other", b"q"))
    assert last_alike(tmp_path, log) is None


def test_what_was_of_its_own_day_stays_with_it(tmp_path: Path) -> None:
    lender = load_definition(made(tmp_path, "A", "2024-05-01"))
    folder = tmp_path / "another" / "firing_2"
    folder.mkdir(parents=True)
    (folder / 'the "new".csv').write_bytes((lender.folder / "log.csv").read_bytes())
    found = lend(lender, folder, 'the "new".csv')
    assert found is not None
    assert (found.test.id, found.test.date, found.test.source) == ("firing_2", None, "measured")
    assert (found.observed, dict(found.segments), found.exclude) == (None, {}, ())
    assert found.channels["p_tank"].trust is None
    assert found.log.files[0].file == 'the "new".csv'
    assert found.test.stand == "the old barn"
    assert found.tank is not None
    assert found.tank.oxidizer_mass is not None
    assert found.site is not None


def test_what_cannot_be_told_apart_line_by_line_is_not_lent(tmp_path: Path) -> None:
    path = made(tmp_path, "A", "2024-05-01")
    text = path.read_text().replace('[observed]\nburn_time = "6 s"\n', "")
    path.write_text('observed = { burn_time = "6 s" }\n' + text)
    folder = tmp_path / "firing_2"
    folder.mkdir()
    (folder / "log.csv").write_bytes((path.parent / "log.csv").read_bytes())
    assert lend(load_definition(path), folder, "log.csv") is None
    assert not (folder / "test.toml").exists()
