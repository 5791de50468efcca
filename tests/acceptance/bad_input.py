"""A good small test, and the ways to spoil it: each with what the message about it must name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

TOML = """schema = 1
[test]
id = "HF1"
kind = "hot_fire"
date = 2022-04-03
source = "synthetic"
description = "a small test"
stand = "here"
[model]
conventions = "corrected"
[log]
files = ["log.csv"]
time = { column = "time", unit = "s" }
[channels.p_tank]
column = "PT-TANK"
unit = "psi"
accuracy = "2 psi"
[channels.p_chamber]
column = "PT-CC"
unit = "psi"
zero = "ambient"
[channels.thrust]
column = "LC"
unit = "lbf"
tare = "auto"
[channels.m_tank]
column = "LC-TANK"
unit = "kg"
[tank]
volume = "16.5 L"
oxidizer_mass = "8.35 +/- 0.05 kg"
temperature = "20 degC"
[injector]
holes = 22
hole_area = "3.142 mm^2"
[purge]
cracking_pressure = "4.27 bar"
[grain]
mass = "1594 g"
length = "610 mm"
density = "788.9 kg/m^3"
outer_radius = "39.497 mm"
[chamber]
pre_volume = "0.218 L"
[nozzle]
throat_radius = "23.3 mm"
exit_radius = "38.1 mm"
[site]
altitude = "30 m"
[observed]
burn_time = "17 s"
[segments]
t_open = "3 s"
t_v = "5.27 s"
[[exclude]]
channels = ["thrust"]
start = "4 s"
end = "4.5 s"
[rocket]
dry_mass = "52.5 kg"
drag_coefficient = 0.529
launch_angle = "6 deg"
[rocket.geometry]
nose = { kind = "ogive", length = "0.5 m" }
[rocket.main]
drag_coefficient = 2.2
area = "10.5 m^2"
"""


def log() -> str:
    """A firing at 3 s, 20 samples a second."""
    rows = ["time,PT-TANK,PT-CC,LC,LC-TANK"]
    for i in range(200):
        on = 60 <= i < 160
        wobble = 0.1 * ((7 * i) % 11)
        rows.append(f"{i / 20:.2f},{(900 - 4 * (i - 60) * on) + wobble:.2f},{14.7 + 200 * on + wobble:.2f},"
                    f"{600 * on + wobble:.2f},{8.35 - 0.08 * on * (i - 60) + wobble / 100:.3f}")  # fmt: skip
    return "\n".join(rows) + "\n"


@dataclass(frozen=True)
class Bad:
    """One way to spoil the test: what is done to its folder, and words the message must hold."""

    name: str
    spoil: Callable[[Path], None]
    words: tuple[str, ...]
    test: str = "HF1"


def write_good(root: Path) -> Path:
    """The good test under ``root``; returns its folder."""
    folder = root / "raw_tests" / "HF1"
    folder.mkdir(parents=True)
    (folder / "test.toml").write_text(TOML)
    (folder / "log.csv").write_text(log())
    return folder


def toml(old: str, new: str, *words: str) -> Bad:
    """test.toml with ``old`` replaced; its message names the file."""

    def spoil(folder: Path) -> None:
        assert TOML.count(old) == 1, old
        (folder / "test.toml").write_text(TOML.replace(old, new))

    return Bad(f"{old.strip()} -> {new.strip()}"[:80], spoil, ("test.toml", *words))


def logged(name: str, edit: Callable[[str], str | bytes], *words: str) -> Bad:
    """The log edited; its message names the log."""

    def spoil(folder: Path) -> None:
        edited = edit(log())
        (folder / "log.csv").write_bytes(edited.encode() if isinstance(edited, str) else edited)

    return Bad(name, spoil, ("log.csv", *words))


def column(text: str, index: int, cell: str) -> str:
    """The log with every cell of a column replaced."""
    head, *rows = text.splitlines()
    return "\n".join([head, *(",".join(_put(row.split(","), index, cell)) for row in rows)]) + "\n"


def _put(cells: list[str], index: int, cell: str) -> list[str]:
    return [*cells[:index], cell, *cells[index + 1 :]]


def _remove(name: str) -> Callable[[Path], None]:
    return lambda folder: (folder / name).unlink()


def _nothing(folder: Path) -> None:
    """The test stays good; what is asked for is not."""


def _link_outside(folder: Path) -> None:
    (folder / "log.csv").rename(folder.parent / "log.csv")
    (folder / "log.csv").symlink_to(folder.parent / "log.csv")


def _bytes(content: bytes) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        (folder / "test.toml").write_bytes(content)

    return spoil


V, M, T = 'volume = "16.5 L"', 'oxidizer_mass = "8.35 +/- 0.05 kg"', 'temperature = "20 degC"'
TANK, CC = 'column = "PT-TANK"', 'column = "PT-CC"'

CASES = [
    # which test
    Bad("a test that is not there", _nothing, ("HF2", "did you mean 'HF1'"), "HF2"),
    Bad("a path upwards", _nothing, ("../HF1", "path separators"), "../HF1"),
    Bad("an absolute path", _nothing, ("/etc", "path separators"), "/etc"),
    Bad("two dots", _nothing, ("'..'",), ".."),
    Bad("no name", _nothing, ("raw_tests",), ""),
    Bad("a backslash", _nothing, ("HF1\\\\x",), "HF1\\x"),
    Bad("a NUL", _nothing, ("path separators",), "HF1\0"),
    Bad("no test.toml", _remove("test.toml"), ("test.toml", "not found")),
    # the file as such
    Bad("an empty test.toml", _bytes(b""), ("test.toml", "[test]", "missing")),
    Bad("a test.toml that is no text", _bytes(b"\xff\xfe\x00\x01"), ("test.toml", "UTF-8")),
    toml("schema = 1", "schema = ", "TOML", "line 1"),
    toml("schema = 1", "schema = 2", "schema", "2", "schema = 1"),
    toml("schema = 1\n", "", "schema"),
    toml('id = "HF1"', 'id = "HF1"\nid = "HF1"', "TOML", "line"),
    toml('description = "a small test"', "description = 'a", "TOML"),
    toml("schema = 1", f"schema = {'[' * 5000}", "TOML"),
    toml("schema = 1", f"schema = {'9' * 5000}", "TOML"),
    # names that are places elsewhere, or nowhere
    toml('stand = "here"', 'stand = "../../x"', "test.stand", "path separators"),
    toml('stand = "here"', f'stand = "{"x" * 300}"', "test.stand", "bytes"),
    toml('stand = "here"', 'stand = "a\\nb"', "test.stand"),
    toml('files = ["log.csv"]', 'files = ["log\\u0000.csv"]', "log.files", "own folder"),
    toml('files = ["log.csv"]', f'files = ["{"x" * 999}"]', "log.files", "own folder"),
    Bad("a name longer than files have", _nothing, ("path separators",), "x" * 300),
    # sections and keys
    toml("[tank]", "[tnak]", "'tnak'", "did you mean 'tank'"),
    toml("[injector]", "[injectors]", "'injectors'", "did you mean 'injector'"),
    toml("[channels.p_tank]", "[channel.p_tank]", "'channel'", "did you mean 'channels'"),
    toml("[site]", "[weather]", "'weather'", "expected some of"),
    toml(V, 'volme = "16.5 L"', "tank", "'volme'", "did you mean 'volume'"),
    toml(M, 'oxidiser_mass = "8.35 kg"', "'oxidiser_mass'", "did you mean 'oxidizer_mass'"),
    toml('kind = "hot_fire"', 'knid = "hot_fire"', "test", "'knid'", "did you mean 'kind'"),
    toml("[nozzle]\nthroat_radius", "[nozzle]\nthroat_diameter", "'throat_diameter'", "throat_radius"),
    toml(TANK, 'colum = "PT-TANK"', "channels.p_tank", "'colum'", "did you mean 'column'"),
    toml(TANK + "\n", "", "channels.p_tank", "'column'", "missing"),
    toml('unit = "psi"\naccuracy = "2 psi"', "", "channels.p_tank", "'unit'", "missing"),
    toml('id = "HF1"\n', "", "'id'", "missing"),
    toml('kind = "hot_fire"\n', "", "'kind'", "missing"),
    toml('files = ["log.csv"]\n', "", "'files'", "missing"),
    toml('nose = { kind = "ogive", length = "0.5 m" }', 'nose = { kind = "ogive" }', "rocket.geometry.nose", "'length'"),  # noqa: E501
    toml('nose = { kind = "ogive", length = "0.5 m" }', "noes = {}", "rocket.geometry", "did you mean 'nose'"),
    toml("[grain]", "[tank.grain]", "'grain'", "tank"),
    toml("[chamber]", "chamber = 3\n[x]", "test.toml"),
    # [test] and [model]
    toml('id = "HF1"', 'id = "HF2"', "test.id", "'HF2'", "'HF1'"),
    toml('id = "HF1"', 'id = "../HF1"', "test.id", "path separators"),
    toml('id = "HF1"', "id = 1", "test.id", "text in quotes"),
    toml('id = "HF1"', 'id = ""', "test.id", "text in quotes"),
    toml('"hot_fire"', '"hotfire"', "test.kind", "'hotfire'", "did you mean 'hot_fire'"),
    toml('"hot_fire"', '["hot_fire"]', "test.kind"),
    toml('"synthetic"', '"simulated"', "test.source", "'simulated'", "'measured'"),
    toml("date = 2022-04-03", 'date = "3.4.22"', "test.date", "2022-04-03"),
    toml("date = 2022-04-03", "date = 2022", "test.date", "2022"),
    toml("date = 2022-04-03", "date = 2022-02-30", "TOML"),
    toml('"corrected"', '"correct"', "model.conventions", "did you mean 'corrected'"),
    # values and units
    toml(V, "volume = 16.5", "tank.volume", "16.5", "volume with its unit"),
    toml(V, 'volume = "16.5"', "tank.volume", "16.5", "volume with its unit"),
    toml(V, 'volume = "16.5 kg"', "tank.volume", "'kg'", "mass", "unit of volume"),
    toml(V, 'volume = "16.5 litr"', "tank.volume", "'litr'", "did you mean 'lit"),
    toml(V, 'volume = "16,5 L"', "tank.volume", "'16,5 L'", "point"),
    toml(V, 'volume = "about 16 L"', "tank.volume", "'about 16 L'"),
    toml(V, 'volume = "-16.5 L"', "tank.volume", "'-16.5 L'", "more than zero"),
    toml(V, 'volume = "0 L"', "tank.volume", "more than zero"),
    toml(V, 'volume = ""', "tank.volume"),
    toml(V, "volume = true", "tank.volume", "True"),
    toml(V, "volume = nan", "tank.volume", "nan"),
    toml(V, 'volume = "nan L"', "tank.volume", "nan"),
    toml(V, 'volume = "1e999 L"', "tank.volume", "1e999"),
    toml(V, 'volume = ["16.5 L"]', "tank.volume"),
    toml(V, 'volume = "…"', "tank.volume", "…"),
    toml(M, 'oxidizer_mass = "-8.35 kg"', "tank.oxidizer_mass", "more than zero"),
    toml(M, 'oxidizer_mass = "8.35 +/- -1 kg"', "tank.oxidizer_mass", "not negative"),
    toml(M, 'oxidizer_mass = "8.35 +/- kg"', "tank.oxidizer_mass", "+/-"),
    toml(M, 'oxidizer_mass = "835 kg"', "tank.oxidizer_mass", "835", "16.5 L", "20.6"),
    toml(T, 'temperature = "20 bar"', "tank.temperature", "'bar'", "temperature"),
    toml(T, 'temperature = "-400 degC"', "tank.temperature", "182 to 350 K"),
    toml(T, 'temperature = "293 degC"', "tank.temperature", "182 to 350 K"),
    toml("holes = 22", "holes = 0", "injector.holes", "0", "at least 1"),
    toml("holes = 22", "holes = -3", "injector.holes", "-3"),
    toml("holes = 22", "holes = 22.5", "injector.holes", "22.5"),
    toml("holes = 22", 'holes = "22"', "injector.holes", "'22'"),
    toml("holes = 22", "holes = true", "injector.holes", "True"),
    toml('hole_area = "3.142 mm^2"', 'hole_area = "3.142 mm"', "injector.hole_area", "length", "area"),
    toml("holes = 22", 'holes = 22\nhole_diameter = "2 mm"', "injector", "hole_area", "hole_diameter"),
    toml('"4.27 bar"', '"-4.27 bar"', "purge.cracking_pressure", "zero or more"),
    toml('mass = "1594 g"', 'mass = "15940 g"', "grain.outer_radius", "15.94 kg"),
    toml('outer_radius = "39.497 mm"', 'outer_radius = "3.9 mm"', "grain.outer_radius", "3.9 mm"),
    toml('density = "788.9 kg/m^3"', 'density = "788.9 g/m^3"', "grain.density", "100"),
    toml('length = "610 mm"', 'length = "-610 mm"', "grain.length", "more than zero"),
    toml('exit_radius = "38.1 mm"', 'exit_radius = "3.81 mm"', "nozzle.exit_radius", "3.81 mm", "23.3 mm"),
    toml('throat_radius = "23.3 mm"', 'throat_radius = "0 mm"', "nozzle.throat_radius", "more than zero"),
    toml('altitude = "30 m"', 'altitude = "30 km"', "site.altitude", "9000 m"),
    toml('altitude = "30 m"', 'ambient_pressure = "1 MPa"', "site.ambient_pressure", "1.2 bar"),
    toml('altitude = "30 m"', 'ambient_pressure = "0 psig"', "site.ambient_pressure", "gauge"),
    toml('burn_time = "17 s"', 'burn_time = "-17 s"', "observed.burn_time", "more than zero"),
    toml('burn_time = "17 s"', 'burntime = "17 s"', "observed", "did you mean 'burn_time'"),
    toml('t_v = "5.27 s"', 't_v = "-5.27 s"', "segments.t_v", "more than zero"),
    toml('t_v = "5.27 s"', 't_vapor = "5.27 s"', "segments", "'t_vapor'"),
    toml("drag_coefficient = 0.529", 'drag_coefficient = "0.529 kg"', "rocket.drag_coefficient", "dimensionless"),
    toml("drag_coefficient = 0.529", "drag_coefficient = -0.5", "rocket.drag_coefficient", "more than zero"),
    toml("drag_coefficient = 0.529", 'drag_table = "drag.csv"', "rocket.drag_table", "'drag.csv'"),
    toml('launch_angle = "6 deg"', 'launch_angle = "96 deg"', "rocket.launch_angle", "90"),
    toml('kind = "ogive"', 'kind = "ogiv"', "rocket.geometry.nose.kind", "did you mean 'ogive'"),
    # channels
    toml(TANK, 'column = "PT-TNK"', "channels.p_tank", "column 'PT-TNK' not in log.csv", "did you mean 'PT-TANK'"),
    toml(TANK, 'column = "xyz"', "channels.p_tank", "'xyz'", "log.csv", "'PT-CC'"),
    toml(TANK, "column = 9", "channels.p_tank", "9", "5 columns"),
    toml(TANK, "column = 0", "channels.p_tank.column", "counted from 1"),
    toml(TANK, "column = 2.0", "channels.p_tank.column", "2.0"),
    toml(TANK, 'column = "time"', "channels.p_tank.column", "time stamps"),
    toml(CC, TANK, "channels.p_chamber.column", "'PT-TANK'", "p_tank"),
    toml(CC, "column = 2", "channels.p_chamber.column", "p_tank"),
    toml('unit = "psi"\naccuracy', 'unit = "kg"\naccuracy', "channels.p_tank.unit", "'kg'", "mass", "pressure"),
    toml('unit = "psi"\naccuracy', 'unit = "pis"\naccuracy', "channels.p_tank.unit", "'pis'", "did you mean 'psi'"),
    toml('unit = "psi"\naccuracy', "unit = 3\naccuracy", "channels.p_tank.unit", "3"),
    toml('unit = "lbf"', 'unit = "lb/in"', "channels.thrust.unit", "'lb/in'", "force"),
    toml('accuracy = "2 psi"', 'accuracy = "-2 psi"', "channels.p_tank.accuracy", "zero or more"),
    toml('accuracy = "2 psi"', "accuracy = 2", "channels.p_tank.accuracy", "with its unit"),
    toml('accuracy = "2 psi"', 'accuracy = "2 K"', "channels.p_tank.accuracy", "'K'"),
    toml('accuracy = "2 psi"', "scale = 0", "channels.p_tank.scale", "not zero"),
    toml('accuracy = "2 psi"', "scale = inf", "channels.p_tank.scale", "inf"),
    toml('accuracy = "2 psi"', 'scale = "2"', "channels.p_tank.scale", "'2'"),
    toml('accuracy = "2 psi"', 'offset = "1 psi"', "channels.p_tank.offset", "without quotes"),
    toml('accuracy = "2 psi"', 'gauge = "yes"', "channels.p_tank.gauge", "true or false"),
    toml('unit = "psi"\naccuracy', 'unit = "psia"\ngauge = true\naccuracy', "channels.p_tank", "psia", "gauge"),
    toml('unit = "psi"\naccuracy', 'unit = "barg"\ngauge = false\naccuracy', "channels.p_tank", "barg", "gauge"),
    toml('zero = "ambient"', 'zero = "ambiant"', "channels.p_chamber.zero", "did you mean 'ambient'"),
    toml('tare = "auto"', 'tare = "atuo"', "channels.thrust.tare", "did you mean 'auto'"),
    toml('tare = "auto"', 'zero = "ambient"', "channels.thrust.zero", "pressures"),
    toml('zero = "ambient"', 'tare = "auto"', "channels.p_chamber.tare", "forces"),
    toml('tare = "auto"', 'file = "other.csv"', "channels.thrust.file", "'other.csv'", "log.csv"),
    toml("[channels.m_tank]", "[channels.time]", "channels.time", "name"),
    toml("[channels.m_tank]", '[channels."m tank"]', "channels.m tank", "name"),
    # [log] and [[exclude]]
    toml('files = ["log.csv"]', 'files = ["lgo.csv"]', "log.files", "'lgo.csv'", "did you mean 'log.csv'"),
    toml('files = ["log.csv"]', 'files = ["../log.csv"]', "log.files", "inside the test's own folder"),
    toml('files = ["log.csv"]', 'files = ["/etc/passwd"]', "log.files", "inside the test's own folder"),
    toml('files = ["log.csv"]', 'files = "log.csv"', "log.files", "list"),
    toml('files = ["log.csv"]', "files = []", "log.files", "list"),
    toml('files = ["log.csv"]', 'files = ["log.csv", "log.csv"]', "log.files", "twice"),
    toml('files = ["log.csv"]', 'files = ["test.toml"]', "test.toml"),
    toml('files = ["log.csv"]', 'files = ["log.csv"]\nformat = "xls"', "log.format", "'xls'", "'csv'"),
    toml('files = ["log.csv"]', 'files = ["log.csv"]\ndelimiter = "x"', "log.delimiter", "'x'"),
    toml('files = ["log.csv"]', 'files = ["log.csv"]\nencoding = "utf-9"', "log.encoding", "'utf-9'"),
    toml('files = ["log.csv"]', 'files = ["log.csv"]\nheader_rows = -1', "log.header_rows", "-1"),
    toml('files = ["log.csv"]', 'files = ["log.csv"]\ndelimiter = ","\ndecimal = ","', "delimiter", "decimal"),
    toml('column = "time"', 'column = "tiem"', "log.time.column", "'tiem'", "did you mean 'time'"),
    toml('column = "time", unit = "s"', 'column = "time", unit = "psi"', "log.time.unit", "'psi'", "time"),
    toml('time = { column = "time", unit = "s" }', "", "log.time", "missing", "'time'"),
    toml('time = { column = "time", unit = "s" }', 'time = { unit = "s" }', "log.time", "column", "rate"),
    toml('time = { column = "time", unit = "s" }', 'time = { rate = "0 Hz" }', "log.time.rate", "more than zero"),
    toml('end = "4.5 s"', 'end = "3.5 s"', "exclude[0]", "start", "end"),
    toml('end = "4.5 s"', "", "exclude[0]", "'end'", "missing"),
    toml('channels = ["thrust"]', 'channels = ["thurst"]', "exclude[0]", "'thurst'", "did you mean 'thrust'"),
    toml("[[exclude]]", "[exclude]", "exclude", "list"),
    # the log
    Bad("no log", _remove("log.csv"), ("test.toml", "log.files", "'log.csv'")),
    Bad("a link out of the folder", _link_outside, ("test.toml", "log.files", "inside the test's own folder")),
    logged("an empty log", lambda text: "", "empty"),
    logged("blanks only", lambda text: "\n\n   \n", "empty"),
    logged("a header only", lambda text: text.splitlines()[0] + "\n", "no data"),
    logged("a single row", lambda text: "\n".join(text.splitlines()[:2]) + "\n", "1 row of data"),
    logged("prose", lambda text: "The firing went well.\nWe were happy.\n" * 30, "no data"),
    logged("a column of text", lambda text: column(text, 1, "OK"), "PT-TANK", "line 2", "'OK'"),
    logged("a column of NaN", lambda text: column(text, 1, "NaN"), "PT-TANK", "not one number"),
    logged("an empty column", lambda text: column(text, 2, ""), "PT-CC", "empty"),
    logged("stamps of text", lambda text: column(text, 0, "noon"), "time", "'noon'"),
    logged("stamps of NaN", lambda text: column(text, 0, "nan"), "time", "stamp"),
    logged("a spreadsheet", lambda text: b"PK\x03\x04" + b"\0" * 100, "spreadsheet"),
    logged("HDF5", lambda text: b"\x89HDF\r\n\x1a\n" + b"\0" * 100, "HDF5"),
    logged("compressed", lambda text: b"\x1f\x8b\x08" + b"\1" * 100, "gzip"),
    logged("a column twice", lambda text: text.replace("PT-CC", "PT-TANK", 1), "PT-TANK", "2 columns"),
]  # fmt: skip
