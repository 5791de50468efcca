"""``hfa engine``: the engine file of a test is that test's model, and says where its numbers are from."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from tests.cli.run import hfa

from hfanalysis.effects import effect
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.inference.adopted.effects import Adopted
from hfanalysis.inference.full_run import run_full
from hfanalysis.interface.bringing import bring
from hfanalysis.interface.of_test import engine_of_test
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.campaign import Campaign, NoLaw, StandRow, Together
from hfanalysis.products.disk import write_json
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import EngineFile, load_engine
from hfanalysis.simulation.commented import write
from hfanalysis.simulation.of_test import OfTest, text_of
from hfanalysis.simulation.unsteady_run import Simulation, simulate
from hfanalysis.stages.base import Context, load_stage

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def context(tmp_path_factory: pytest.TempPathFactory) -> Context:
    """HF5 as far as validate."""
    root = tmp_path_factory.mktemp("root")
    shutil.copytree(REPOSITORY / "raw_tests" / "HF5", root / "raw_tests" / "HF5")
    return bring("validate", root, "HF5", settings={"calibrate.samples": 40})


@pytest.fixture(scope="module")
def found(context: Context) -> OfTest:
    return engine_of_test(context)


def as_file(found: OfTest, folder: Path, flight: bool = False) -> tuple[EngineFile, Simulation]:
    """The engine file written, read and run."""
    path = folder / "engine.toml"
    write(path, text_of(found, path, flight).text)
    file = load_engine(path)
    return file, simulate(file)


def check_same(simulation: Simulation, found: OfTest) -> None:
    """The file's burn is that of the test's model."""
    mine, theirs = simulation.burnt, found.full.burnt
    assert mine.state("impulse")[-1] == pytest.approx(theirs.state("impulse")[-1], rel=1e-6)
    assert mine.output("chamber_pressure").max() == pytest.approx(theirs.output("chamber_pressure").max(), rel=1e-6)
    assert mine.liquid_out == pytest.approx(theirs.liquid_out, rel=1e-6)


def with_effects(context: Context, found: OfTest) -> OfTest:
    """The same test with effects of tank, line and sensor adopted."""
    effects = (
        effect("tank_heat").at(power=900.0),
        effect("feed_line_fill").at(volume=1e-4),
        effect("combustion_efficiency").at(deficit=0.04),
        effect("load_cell_drift").at(drift=20.0),
    )
    log, definition = context.at(load_stage("validate")).believed()
    full = run_full(log, context.read(Segments).fired, context.read(Calibration), definition, effects)
    return replace(found, full=full, adopted=Adopted(effects, {}, "HF5.effects.toml"))


def test_the_file_runs_as_the_model_of_the_test(found: OfTest, context: Context, tmp_path: Path) -> None:
    _, simulation = as_file(found, tmp_path)
    check_same(simulation, found)
    column = context.read_json("validation.json")["performance"]["model"]
    for name in ("total_impulse", "peak_chamber_pressure", "peak_thrust", "burn_time"):
        assert getattr(simulation.product, name).value == pytest.approx(column[name]["value"], rel=1e-4), name


def test_with_effects_it_does_too(found: OfTest, context: Context, tmp_path: Path) -> None:
    adopted = with_effects(context, found)
    file, simulation = as_file(adopted, tmp_path)
    check_same(simulation, adopted)
    assert simulation.burnt.state("impulse")[-1] != pytest.approx(found.full.burnt.state("impulse")[-1], rel=1e-3)
    assert set(file.effects) == {"tank_heat", "feed_line_fill", "combustion_efficiency"}
    assert "load_cell_drift: it acts on what a sensor reads" in file.path.read_text()


def test_under_the_corrected_conventions_the_tank_followed_is_worth_a_few_thousandths(
    found: OfTest, context: Context, tmp_path: Path
) -> None:
    log, definition = context.at(load_stage("validate")).believed()
    model = replace(definition.model, conventions="corrected", properties="coolprop")
    definition = replace(definition, model=model)
    full = run_full(log, context.read(Segments).fired, context.read(Calibration), definition)
    other = replace(found, definition=replace(found.definition, model=model), full=full)
    _, simulation = as_file(other, tmp_path)
    assert simulation.product.total_impulse.value == pytest.approx(full.burnt.state("impulse")[-1], rel=4e-3)
    assert simulation.burnt.liquid_out == pytest.approx(full.burnt.liquid_out, rel=2e-3)
    assert "a few thousandths of the impulse" in (tmp_path / "engine.toml").read_text()


def test_in_flight_nothing_of_the_stand_is_left(found: OfTest, context: Context, tmp_path: Path) -> None:
    file, simulation = as_file(with_effects(context, found), tmp_path, flight=True)
    said = text_of(with_effects(context, found), file.path, flight=True).left_out
    assert set(file.effects) == {"combustion_efficiency"}
    assert file.feed.K_loss is not None
    assert file.feed.K_loss.value == 0.0
    assert [text.partition(":")[0] for text in said] == ["tank_heat", "feed_line_fill", "load_cell_drift", "K_loss"]
    assert "heating blankets" in said[0]
    assert simulation.product.flight.apogee.value is not None


def test_numbers_say_where_they_are_from_and_what_is_doubted(found: OfTest, tmp_path: Path) -> None:
    file, _ = as_file(found, tmp_path)
    text = file.path.read_text()
    lines = text.splitlines()
    assert "REPLICA: generated, not measured" in lines[1]
    keys = [
        i for i, line in enumerate(lines) if " = " in line and not line.startswith(("#", " ", "schema", "std", "corr"))
    ]
    assert keys
    assert [lines[i] for i in keys if "#" not in lines[i] and not lines[i - 1].startswith("#")] == []
    assert "UNPHYSICAL" in text[: text.index("polytropic_exponent")]
    assert text.count("CONDITIONAL") == 2
    injector, covariance = file.injector, file.covariance
    assert injector.C_i is not None
    assert injector.C_i.std == found.calibration.C_i.std
    assert covariance is not None
    assert covariance.names == found.joint.names
    assert covariance.std == pytest.approx(found.joint.std)
    assert {"flow_area", "K_loss", "m", "n", "ln_a"} <= set(covariance.names)


def test_only_what_it_wrote_is_written_over(found: OfTest, tmp_path: Path) -> None:
    path = tmp_path / "engine.toml"
    written = text_of(found, path).text
    write(path, written)
    write(path, written)
    path.write_text(path.read_text().replace('throat_radius = "23.3 mm"', 'throat_radius = "24 mm"'))
    with pytest.raises(InputError, match="changed since"):
        write(path, written)
    path.write_text("schema = 1\n")
    with pytest.raises(InputError, match="did not write"):
        write(path, written)
    assert path.read_text() == "schema = 1\n"
    with pytest.raises(InputError, match="cannot be written"):
        write(tmp_path, written)


@pytest.mark.parametrize(
    ("name", "quantity", "words"),
    [
        ("n", Quantity(-0.2, "", 0.1), "grain.n"),
        ("C_i", Quantity.absent("no p_run"), "C_i is missing"),
        ("C_i", Quantity(2.5, "", 0.1), "injector.C_i"),
    ],
)
def test_what_no_engine_can_have_is_refused_with_the_reason(
    found: OfTest, tmp_path: Path, name: str, quantity: Quantity, words: str
) -> None:
    other = replace(found, calibration=found.calibration.but(**{name: quantity}))
    with pytest.raises(AbsentError, match=words):
        text_of(other, tmp_path / "engine.toml")


def test_of_a_stand_it_has_the_constants_together(context: Context, tmp_path: Path) -> None:
    with pytest.raises(AbsentError, match="hfa campaign"):
        engine_of_test(context, "mcgill-replica")
    none = Together(mean=Quantity.absent("identified in no test; two are needed"))
    constants = {"C_i": Together(mean=Quantity(0.275, "", 0.02)), "K_loss": none, "m": none}
    row = StandRow(tests=("HF4", "HF5"), constants=constants, effects={}, regression=NoLaw(reason="no common law"))
    write_json(context.out.parent / Campaign.file, Campaign(tests={}, stands={"mcgill-replica (replica)": row}))
    try:
        file, _ = as_file(engine_of_test(context, "mcgill-replica"), tmp_path)
        with pytest.raises(AbsentError, match="has no stand 'other'"):
            engine_of_test(context, "other")
    finally:
        (context.out.parent / Campaign.file).unlink()
    text = file.path.read_text()
    assert file.injector.C_i is not None
    assert (file.injector.C_i.value, file.injector.C_i.std) == (0.275, 0.02)
    assert "of stand mcgill-replica, 2 tests together" in text
    assert "from HF5 alone, for stand mcgill-replica has none: no common law" in text


def test_the_command_writes_to_the_folder_of_engines(context: Context) -> None:
    ended = hfa("engine", "HF5", "--root", context.root)
    assert ended.status == 0
    assert "written; next: hfa simulate" in ended.err
    told = json.loads(hfa("simulate", context.root / "engines" / "HF5.toml", "--json").out)
    assert told["engine"] == "HF5"
    flown = hfa("engine", "HF5", "--flight", "--root", context.root)
    assert "left out: K_loss" in flown.err
    assert (context.root / "engines" / "HF5.flight.toml").is_file()
    (context.root / "engines" / "HF5.toml").write_text("mine")
    again = hfa("engine", "HF5", "--root", context.root)
    assert (again.status, (context.root / "engines" / "HF5.toml").read_text()) == (2, "mine")
