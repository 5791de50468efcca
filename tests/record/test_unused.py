"""Nothing accepted is ignored: every key of the schema is read by something, or whoever states it is told it is not."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest

from hfanalysis.cli.engine_page import write_page
from hfanalysis.inference.subject import Subject
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import Statements
from hfanalysis.record.engine_file import EngineStatements, load_engine
from hfanalysis.record.log import read_log
from hfanalysis.record.schema import DERIVED, Section
from hfanalysis.record.sections import FuelSection, fuel_of
from hfanalysis.record.unused import OF_ENGINES, OF_TESTS, SPREADS_OF_TESTS
from hfanalysis.simulation import write
from hfanalysis.simulation.steady_run import design
from hfanalysis.simulation.unsteady_run import simulate
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to
from hfanalysis.units import Value

ROOT = Path(__file__).parents[2]
LABELS = {"schema", "engine.description", "engine.stand", "feed.p_loss", "channels.sensor"} | {
    f"test.{key}" for key in ("date", "description", "engine")
}
"""What only people read, or a campaign, or the reader of the file itself; and what it refuses."""

GEOMETRY = """
[rocket.geometry]
nose = { kind = "ogive", length = "0.6 m" }
body = { length = "3 m" }
fins = { count = 4, root = "0.3 m", tip = "0.1 m", span = "0.15 m", sweep = "0.1 m", position = "3.2 m" }
tail = { length = "0.2 m", diameter = "120 mm", position = "3.6 m" }
structure = { mass = "40 kg", center_of_gravity = "1.9 m" }
tank_position = "1.5 m"
chamber_position = "2.9 m"
"""


TOGETHER = '[covariance]\nnames = ["n"]\nstd = [0.01]\ncorrelation = [[1.0]]\n'


def keys(section: type, above: str = "") -> Iterator[tuple[str, type, str]]:
    """Every key of a schema that holds no section, dotted, with the section that holds it."""
    hints = get_type_hints(section)
    for field in fields(section):
        if field.metadata == DERIVED:
            continue
        name = f"{above}{field.name}"
        inner = next((t for t in _types(hints[field.name]) if isinstance(t, type) and issubclass(t, Section)), None)
        if inner is None:
            yield name, section, field.name
        else:
            yield from keys(inner, f"{name}.")


def _types(hint: Any) -> Iterator[Any]:
    yield hint
    for part in get_args(hint):
        yield from _types(part)


@contextmanager
def watched(patch: pytest.MonkeyPatch) -> Iterator[tuple[set[tuple[str, str]], set[int]]]:
    """Which keys of which sections are read, and of which values the deviation."""
    read: set[tuple[str, str]] = set()
    spreads: set[int] = set()

    def of_section(self: Section, name: str) -> Any:
        read.update((c.__name__, name) for c in type(self).__mro__ if name in getattr(c, "__dataclass_fields__", ()))
        return object.__getattribute__(self, name)

    def of_value(self: Value, name: str) -> Any:
        if name == "std":
            spreads.add(id(self))
        return object.__getattribute__(self, name)

    with patch.context() as during:
        during.setattr(Section, "__getattribute__", of_section)
        during.setattr(Value, "__getattribute__", of_value)
        yield read, spreads


@pytest.fixture(scope="module")
def patch() -> Iterator[pytest.MonkeyPatch]:
    with pytest.MonkeyPatch.context() as found:
        yield found


@pytest.fixture(scope="module")
def by_engines(patch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> set[tuple[str, str]]:
    """What ``hfa simulate`` and ``hfa design`` read of an engine file with a rocket that has a shape, and write."""
    folder = tmp_path_factory.mktemp("engines")
    text = (ROOT / "engines" / "maelstrom.toml").read_text().replace("drag_coefficient = 0.529\nfrontal", "frontal")
    text = text.replace('frontal_area = "19478 mm^2"', 'diameter = "157 mm"') + GEOMETRY
    (folder / "e.toml").write_text(f'{text}engine_mass = "9 kg"\nengine_center_of_gravity = "2.5 m"\n{TOGETHER}')
    files = [load_engine(path) for path in (folder / "e.toml", ROOT / "engines" / "maelstrom.toml")]
    with watched(patch) as (read, _):
        fuel_of(fuel())
        for file in files:
            found = simulate(file, None, 20)
            write.simulation(folder / "out", found)
            write_page(folder / "out", file, found)
            design(file)
    return read


@pytest.fixture(scope="module")
def by_stages(
    patch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> tuple[set[tuple[str, str]], set[str]]:
    """What the stages read of a test.toml, and of which keys the deviation."""
    read: set[tuple[str, str]] = set()
    spreads: set[str] = set()
    for text in (weighed(), by_fill()):
        found = run(text, patch, tmp_path_factory.mktemp("tests"))
        read |= found[0]
        spreads |= found[1]
    return read, spreads


def fuel() -> FuelSection:
    """A blend, and what alone states a fuel."""
    part = {"formula": "C20H42", "molar_enthalpy": "-554 kJ/mol", "share": "50 %"}
    other = {"formula": "C2H4", "enthalpy": "-2 MJ/kg", "share": "50 %"}
    for alone in ({k: v for k, v in one.items() if k != "share"} for one in (part, other)):
        fuel_of(FuelSection(**alone))  # type: ignore[arg-type]
    return FuelSection(name="blend", parts=[part, other])  # type: ignore[arg-type]


def weighed() -> str:
    """HF5's test.toml with all that a test may state beside it."""
    text = (ROOT / "raw_tests" / "HF5" / "test.toml").read_text()
    text = text.replace("[rocket.drogue]", f'wind_speed = "3 +/- 1 m/s"\n{GEOMETRY}[rocket.drogue]')
    text = text.replace('"1594 g"', '"1594 +/- 5 g"').replace("[tank]", '[tank]\ninner_diameter = "130 mm"')
    text = text.replace("[grain]", '[feed]\nK_loss = "6e8 1/m^4"\n[grain]\na = 4e-4')
    text += '[stand]\norientation = "nozzle up"\nfeed_line_tare = "5 N"\n'
    return text + '[[exclude]]\nchannels = ["thrust"]\nstart = "19 s"\nend = "19.2 s"\n'


def by_fill() -> str:
    """The same of a tank that nobody weighed, at an altitude, with other words for the rocket's balance."""
    text = weighed().replace('oxidizer_mass = "8.350 +/- 0.010 kg"', "ullage = 0.63").replace("m_tank", "other")
    text = text.replace('ambient_pressure = "1.013 bar"', 'altitude = "30 m"')
    return text.replace("structure = {", 'engine_mass = "9 kg"\nengine_center_of_gravity = "2.5 m"\nstructure = {')


def run(text: str, patch: pytest.MonkeyPatch, root: Path) -> tuple[set[tuple[str, str]], set[str]]:
    """What the stages read of a test.toml with this content, on every twentieth row of HF5's log."""
    folder = root / "raw_tests" / "HF5"
    folder.mkdir(parents=True)
    lines = (ROOT / "raw_tests" / "HF5" / "log.csv").read_text().splitlines(keepends=True)
    (folder / "log.csv").write_text("".join([lines[0], *lines[1::20]]))
    (folder / "test.toml").write_text(text)
    with watched(patch) as (read, spreads):
        context = open_test(root, "HF5")
        fuel_of(fuel())
        spreads.clear()
        settings = {"flight.flights": 10, "flight.gust_seeds": 1, "flight.winds": [2.0], "calibrate.samples": 20}
        run_to("flight", run_to("validate", replace(context, settings=settings)))
        segments = context.read(Segments)
        Subject(read_log(context.product("ingest.h5")), segments, None, context.definition).stated()
    shutil.rmtree(root)
    return read, {name for name, value in _values(context.definition, "") if id(value) in spreads}


def _values(section: Section, above: str) -> Iterator[tuple[str, Value]]:
    for field in fields(section):  # type: ignore[arg-type]
        value = getattr(section, field.name, None)
        if isinstance(value, Value):
            yield f"{above}{field.name}", value
        elif isinstance(value, Section):
            yield from _values(value, f"{above}{field.name}.")


def test_every_key_of_an_engine_file_is_read_or_named_as_unused(by_engines: set[tuple[str, str]]) -> None:
    unread = {name for name, section, key in keys(EngineStatements) if (section.__name__, key) not in by_engines}
    assert unread - LABELS == OF_ENGINES


def test_every_key_of_a_test_is_read_or_named_as_unused(by_stages: tuple[set[tuple[str, str]], set[str]]) -> None:
    unread = {name for name, section, key in keys(Statements) if (section.__name__, key) not in by_stages[0]}
    assert unread - LABELS == OF_TESTS


def test_the_deviations_that_go_into_intervals_are_read(by_stages: tuple[set[tuple[str, str]], set[str]]) -> None:
    stated = {"tank.volume", "tank.oxidizer_mass", "injector.hole_area", "grain.mass", "nozzle.throat_radius"}
    assert stated <= by_stages[1]
    assert by_stages[1] - {"log.time.offset"} <= SPREADS_OF_TESTS
