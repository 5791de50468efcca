"""Sections read from TOML: one message for the first fault, the same for engine files; frozen once read."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from pathlib import Path

import pytest
from tests.acceptance.bad_input import TOML, write_good

from hfanalysis.errors import InputError
from hfanalysis.record.definition import load_definition
from hfanalysis.record.document import read_toml, validate
from hfanalysis.record.schema import Section, section
from hfanalysis.record.sections import DesignSection, EngineSection, Feed, GrainSection, Injector, Model, Tank
from hfanalysis.units import Value

ENGINE = """[engine]
id = "maelstrom"
[model]
conventions = "report"
[tank]
oxidizer_mass = "7.035 kg"
ullage = 0.20
dip_tube = { outer_diameter = "6.35 mm", inner_diameter = "4.572 mm" }
polytropic_exponent = "c_p/c_v"
[feed]
p_loss = "0.345 bar"
[injector]
holes = 10
hole_diameter = "2 +/- 0.02 mm"
C_i = 1
[grain]
a = 1.32e-4
n = 0.555
[design]
oxidizer_flow = "2.50 kg/s"
"""


@section
class EngineFile(Section):
    """Some sections of an engine file."""

    engine: EngineSection
    tank: Tank
    feed: Feed
    injector: Injector
    grain: GrainSection
    design: DesignSection
    model: Model = Model()


def engine(path: Path, old: str = "", new: str = "") -> EngineFile:
    """The engine file with something replaced in it."""
    assert old in ENGINE
    path.write_text(ENGINE.replace(old, new, 1))
    return validate(EngineFile, read_toml(path)[1], path)


def definition_message(root: Path, old: str, new: str) -> str:
    """What is said about test.toml after a replacement in it."""
    folder = write_good(root)
    assert TOML.count(old) == 1
    (folder / "test.toml").write_text(TOML.replace(old, new))
    with pytest.raises(InputError) as refused:
        load_definition(folder / "test.toml")
    return str(refused.value)


def test_the_sections_of_a_test_make_an_engine_file(tmp_path: Path) -> None:
    made = engine(tmp_path / "engine.toml")
    assert made.tank.dip_tube is not None
    assert made.tank.dip_tube.inner_diameter.value == pytest.approx(4.572e-3)
    assert made.tank.polytropic_exponent == "c_p/c_v"
    assert made.model.properties == "coolprop"
    assert made.design.oxidizer_flow == Value(2.5)
    assert made.grain.n == Value(0.555)


def test_a_hole_of_known_diameter_has_an_area_and_its_spread(tmp_path: Path) -> None:
    area = engine(tmp_path / "engine.toml").injector.area
    assert area is not None
    assert area.value == pytest.approx(10 * 3.14159265e-6)
    assert area.std == pytest.approx(0.02 * area.value)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("p_loss", "ploss", "engine.toml, feed: unknown key 'ploss'; did you mean 'p_loss' or 'K_loss'?"),
        ('p_loss = "0.345 bar"', 'p_loss = "1 bar"\nK_loss = "1 1/m^4"', "feed: both 'p_loss' and 'K_loss' are given"),
        ('id = "maelstrom"', "", "engine.toml, engine: key 'id' is missing"),
        ("[design]", "[desing]", "engine.toml: unknown key 'desing'; did you mean 'design'?"),
        ('[design]\noxidizer_flow = "2.50 kg/s"', "", "engine.toml: section [design] is missing"),
        ('"6.35 mm"', '"4.35 mm"', "tank.dip_tube: the inner diameter is not smaller than the outer diameter"),
        ('"c_p/c_v"', '"c_p"', "tank.polytropic_exponent: found 'c_p'; expected 'c_p/c_v', or a number"),
        ('"c_p/c_v"', "-1", "tank.polytropic_exponent: found -1; expected 'c_p/c_v', or a number"),
        ("ullage = 0.20", "ullage = -0.2", "tank.ullage: found -0.2; expected a number that is zero or more"),
        ("C_i = 1", "C_i = 3", "injector.C_i: found 3; expected a number that is between 0 and 2"),
        ("C_i = 1", "C_i = true", "injector.C_i: found True; expected a finite number such as 0.529"),
        ("C_i = 1", f"C_i = 1{'0' * 400}", "injector.C_i: found 1"),
        ("a = 1.32e-4", "a = 0.0", "grain.a: found 0.0; expected a number that is more than zero"),
        ("[model]", "[[model]]", "engine.toml, model: found [{'conventions': 'report'}]; expected a table of keys"),
    ],
)
def test_the_first_fault_is_said_with_its_place(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(InputError) as refused:
        engine(tmp_path / "engine.toml", old, new)
    assert said in str(refused.value)
    assert "pydantic" not in str(refused.value)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('tare = "auto"', 'tare = "auto"\nname = "push"', "channels.thrust: unknown key 'name'"),
        ('tare = "auto"', 'tarre = "auto"', "channels.thrust: unknown key 'tarre'; did you mean 'tare'?"),
        ('tare = "auto"', "missing = [999, true]", "channels.thrust.missing[1]: found True"),
        ('files = ["log.csv"]', 'files = [{ file = "log.csv", decimal = "," }]\ndelimiter = ","', "log: delimiter and"),
        ('files = ["log.csv"]', 'files = [{ file = "log.csv", decmal = "," }]', "log.files[0]: unknown key 'decmal'"),
        ('column = "LC-TANK"', 'column = "LC"', "channels.m_tank.column: column 'LC' is already thrust"),
        ('t_open = "3 s"', 't_end = "0 s"', "segments.t_end: found 0 s; expected a time after the opening"),
        ('end = "4.5 s"', 'end = "4.5"', "exclude[0].end: found '4.5'; expected a time with its unit"),
    ],
)
def test_a_fault_within_the_log_or_a_channel_is_said_with_its_place(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    assert said in definition_message(tmp_path, old, new)


def test_what_no_key_gives_is_not_offered_as_one(tmp_path: Path) -> None:
    message = definition_message(tmp_path, 'tare = "auto"', 'quux = "auto"')
    assert "expected some of column, unit" in message
    assert "name" not in message.rsplit("expected", 1)[1]


def test_what_the_log_states_holds_for_its_files(tmp_path: Path) -> None:
    folder = write_good(tmp_path)
    log = 'files = [{ file = "log.csv", header_rows = 1 }]\nheader_rows = 0\nencoding = "UTF8"\ndelimiter = "comma"'
    (folder / "test.toml").write_text(TOML.replace('files = ["log.csv"]', log))
    spec = load_definition(folder / "test.toml").log.named("log.csv")
    assert (spec.header_rows, spec.encoding, spec.delimiter) == (1, "utf-8", ",")
    assert spec.time is not None
    assert spec.time.column == "time"


def test_a_definition_cannot_be_changed(tmp_path: Path) -> None:
    definition = load_definition(write_good(tmp_path) / "test.toml")
    for thing, key in ((definition, "tank"), (definition.tank, "volume"), (definition.channels["thrust"], "unit")):
        with pytest.raises(FrozenInstanceError):
            setattr(thing, key, None)
