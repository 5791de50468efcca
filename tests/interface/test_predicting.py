"""``hfa predict`` and ``hfa score``: bands from what is known of the constants, frozen, and laid over the test."""

from __future__ import annotations

import hashlib
import json
import shutil
from dataclasses import replace
from math import log, sqrt
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from benchmarks.prediction import plan_of
from tests.cli.run import hfa

from hfanalysis.campaign.side_by_side import Ended
from hfanalysis.campaign.skill import record
from hfanalysis.effects import effect
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.inference.adopted.effects import Adopted
from hfanalysis.interface import predicting
from hfanalysis.interface.bringing import bring
from hfanalysis.products.calibration import Joint
from hfanalysis.products.disk import read_json, sha256_file
from hfanalysis.products.prediction import Foretold, Origin, Prediction
from hfanalysis.progress import silent
from hfanalysis.quantity import NOT_IDENTIFIABLE, Quantity
from hfanalysis.record.planned import PlannedTest, load_planned
from hfanalysis.simulation import plots
from hfanalysis.simulation import predict as prediction
from hfanalysis.simulation.foretelling import (
    QUANTITIES,
    Base,
    Change,
    changes,
    law_of,
    outcomes,
    planned,
    scatter_of,
    to_mean,
)
from hfanalysis.simulation.predict import misses_of, predict, score
from hfanalysis.simulation.scatter import PRIOR_FREEDOM, PRIOR_SCATTER
from hfanalysis.units import Value

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("root")
    for test in ("HF4", "HF5"):
        shutil.copytree(REPOSITORY / "raw_tests" / test, folder / "raw_tests" / test)
    return folder


@pytest.fixture(scope="module")
def base(root: Path) -> Base:
    """HF4, as a test to predict from."""
    return predicting._base(bring("validate", root, "HF4"))


@pytest.fixture
def plan(root: Path, base: Base) -> PlannedTest:
    """HF4 once more: the same load, holes and temperature."""
    return load_planned(plan_of(root, "HF4", f"{base.found.full.engine.temperature!r} K", "again"))


@pytest.fixture
def one_day(monkeypatch: pytest.MonkeyPatch) -> None:
    """Predictions of the planned temperature alone."""
    monkeypatch.setattr(prediction, "DAYS", ())


def test_the_same_test_planned_is_the_same_engine(plan: PlannedTest, base: Base) -> None:
    again = planned(plan, base)
    theirs = base.found.full.burnt
    impulse, thrust, pressure, t_v, _, apogee = outcomes([again.stand], [again.flying or again.stand], None)[0]
    assert impulse == pytest.approx(theirs.state("impulse")[-1], rel=1e-6)
    assert thrust == pytest.approx(theirs.output("thrust").max(), rel=1e-6)
    assert pressure == pytest.approx(theirs.output("chamber_pressure").max(), rel=1e-6)
    assert t_v == pytest.approx(theirs.liquid_out, rel=1e-6)
    assert 1000.0 < apogee < 2000.0


def test_holes_load_and_temperature_are_those_of_the_plan(root: Path, base: Base) -> None:
    engine = planned(load_planned(plan_of(root, "HF5", "20 degC")), base).stand
    own = base.found.full.engine
    assert engine.feed.area == pytest.approx(own.feed.area * 22 / 18)
    assert engine.oxidizer_mass == 8.35
    assert engine.temperature == pytest.approx(293.15)
    assert (engine.a, engine.n, engine.polytropic_exponent) == (own.a, own.n, own.polytropic_exponent)


def test_draws_have_the_errors_of_the_constants_together(plan: PlannedTest, base: Base) -> None:
    none = {name: found.but(drawn=0.0) for name, found in scatter_of([base]).items()}
    there = planned(plan, base)
    drawn = list(changes(base, there, none, 4000, 3, to_mean([base])[0]))
    joint = base.found.joint
    std = dict(zip(joint.names, joint.std, strict=True))
    made = [change.of(there.stand) for change in drawn]
    area, n, ln_a = (np.array(x) for x in zip(*((log(e.feed.area), e.n, log(e.a)) for e in made), strict=True))
    assert area.std() == pytest.approx(std["flow_area"] / base.found.full.engine.feed.area, rel=0.05)
    assert n.std() == pytest.approx(std["n"], rel=0.05)
    place = [joint.names.index(name) for name in ("n", "ln_a")]
    assert np.corrcoef(n, ln_a)[0, 1] == pytest.approx(joint.correlation[place[0]][place[1]], abs=0.03)
    assert np.std([c.oxidizer for c in drawn]) == pytest.approx(0.01, rel=0.05)


def test_scatter_between_tests_is_what_stands_have_and_what_these_tests_show(base: Base) -> None:
    def with_c(value: float) -> Base:
        calibration = base.found.calibration.but(C_i=Quantity(value, "", 0.01))
        return replace(base, found=replace(base.found, calibration=calibration))

    prior = PRIOR_SCATTER["C_i"]
    one, two = scatter_of([base])["C_i"], scatter_of([base, base])["C_i"]
    assert (one.std, one.freedom) == (pytest.approx(prior), PRIOR_FREEDOM)
    assert one.drawn == pytest.approx(prior * sqrt(2.0))
    assert two.std == pytest.approx(prior * sqrt(PRIOR_FREEDOM / (PRIOR_FREEDOM + 1)))  # two alike tell of little
    assert two.drawn == pytest.approx(two.std * sqrt(1.5))
    assert "simulated stands" in one.source
    apart = [0.2, 0.25, 0.3]
    three = scatter_of([with_c(value) for value in apart])["C_i"]
    squares = PRIOR_FREEDOM * prior**2 + 2.0 * np.var(np.log(apart), ddof=1)
    assert three.std == pytest.approx(sqrt(squares / (PRIOR_FREEDOM + 2)))
    assert three.drawn == pytest.approx(three.std * sqrt(4.0 / 3.0))
    assert three.freedom == PRIOR_FREEDOM + 2
    shifts = [shift["C_i"] for shift in to_mean([with_c(0.2), with_c(0.3)])]
    assert shifts == pytest.approx([0.5 * log(1.5), -0.5 * log(1.5)])


def test_what_the_plan_states_of_holes_and_exit_is_off_by_its_own(root: Path, base: Base) -> None:
    path = plan_of(root, "HF4", "20 degC", "loose")
    text = path.read_text(encoding="utf-8")
    stated = text.replace('"3.142 mm^2"', '"3.142 mm^2 +/- 4 %"').replace('"38.1 mm"', '"38.1 mm +/- 1 %"')
    none = {name: found.but(drawn=0.0) for name, found in scatter_of([base]).items()}

    def drawn(of: str, count: int) -> list[Change]:
        path.write_text(of, encoding="utf-8")
        return list(changes(base, planned(load_planned(path), base), none, count, 5, to_mean([base])[0]))

    loose, tight = drawn(stated, 2000), drawn(text, 5)
    assert np.std([log(c.area) for c in loose]) == pytest.approx(0.04, rel=0.1)
    assert np.std([log(c.exit) for c in loose]) == pytest.approx(0.02, rel=0.1)  # the area goes with the square
    assert {(c.area, c.exit) for c in tight} == {(1.0, 1.0)}


def test_what_is_off_in_the_fired_test_as_well_is_in_no_band(
    plan: PlannedTest, base: Base, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same test once more, none differing from the other: the errors of the constants, sensors' zeros and areas
    among them, move the engine by a per cent or two, and what is told of it by next to nothing."""
    none = {name: found.but(drawn=0.0) for name, found in scatter_of([base]).items()}
    monkeypatch.setattr(prediction, "scatter_of", lambda bases: none)
    monkeypatch.setattr(prediction, "LASTS", 0.0)
    there = planned(plan, base)
    table = prediction._drawn(plan, [base], [there], [prediction.misses_of(base)], 60, 1)
    made = [change.of(there.stand) for change in changes(base, there, none, 60, 1, to_mean([base])[0])]
    loose = outcomes(made, [], None)
    for name in ("total_impulse", "peak_chamber_pressure"):
        column = list(QUANTITIES).index(name)
        assert np.log(loose[:, column]).std() > 0.01
        assert np.log(table[:, column]).std() < 0.3 * np.log(loose[:, column]).std()


def test_effects_are_drawn_within_their_bounds(plan: PlannedTest, base: Base) -> None:
    heat = effect("tank_heat").at(power=900.0)
    adopted = Adopted((heat,), {"tank_heat": {"power": Value(900.0, 2000.0)}})
    other = replace(base, found=replace(base.found, adopted=adopted))
    own = planned(plan, other)
    drawn = [c.effects[0].named for c in changes(other, own, scatter_of([other]), 300, 1, to_mean([other])[0])]
    assert own.stand.effects == (heat,)
    assert min(d["power"] for d in drawn) == 0.0
    assert np.std([d["power"] for d in drawn]) > 800.0
    assert {d["lag"] for d in drawn} == {heat.named["lag"]}
    assert planned(plan, other, effects=False).stand.effects == ()


@pytest.mark.usefixtures("one_day")
def test_predictions_are_moved_by_what_the_model_missed_and_widen_by_half_of_it(plan: PlannedTest, base: Base) -> None:
    origins = {"HF4": Origin(raw={"log.csv": "x"}, test_toml="y", products={}, effects=())}
    found = predict(plan, [base], origins, draws=100)
    impulse = found.predicted["total_impulse"]
    assert impulse.low is not None
    assert impulse.high is not None
    assert impulse.low < base.found.full.burnt.state("impulse")[-1] < impulse.high
    assert found.rivals["as_last_time"]["peak_thrust"] == base.measured["peak_thrust"]
    assert found.rivals["without_effects"]["total_impulse"].value == pytest.approx(11908.3, rel=1e-3)
    assert misses_of(base)["t_v"] == pytest.approx(log(6.164 / 5.975), rel=0.01)
    wrong = replace(base, measured={**base.measured, "total_impulse": Quantity(20_000.0, "N s")})
    told = predict(plan, [wrong], origins, draws=100)
    moved = told.predicted["total_impulse"]
    assert moved.value == pytest.approx(20_000.0, rel=0.1)  # the same test again: what it measured
    assert told.misses["total_impulse"] == pytest.approx(log(20_000.0 / 11908.3), abs=0.01)
    assert moved.high is not None
    assert moved.low is not None
    assert moved.high - moved.low > 3.0 * (impulse.high - impulse.low)
    with pytest.raises(InputError, match="once each"):
        predict(plan, [base, base], origins, draws=20)
    with pytest.raises(InputError, match="is among the tests"):
        predict(plan, [base], {"again": origins["HF4"]}, draws=20)


@pytest.fixture(scope="module")
def frozen(root: Path) -> tuple[Path, str]:
    """HF5 predicted from HF4 by the command."""
    ended = hfa("predict", plan_of(root, "HF5", "24.8 +/- 2 degC"), "--from", "HF4", "--root", root, "--draws", 60)
    assert ended.status == 0, ended.err
    return root / "predictions" / "HF5.json", ended.err + ended.out


def test_a_prediction_is_frozen_with_all_it_was_made_from(root: Path, frozen: tuple[Path, str]) -> None:
    path, said = frozen
    before = path.read_bytes()
    product = Prediction.from_json(read_json(path))
    assert f"SHA-256 {hashlib.sha256(before).hexdigest()}" in said
    assert product.plan == sha256_file(root / "HF5.toml")
    origin = product.made_from["HF4"]
    assert origin.raw == {"log.csv": sha256_file(root / "raw_tests" / "HF4" / "log.csv")}
    assert origin.products["calibration.json"] == sha256_file(root / "processed" / "HF4" / "calibration.json")
    assert set(product.predicted) == set(QUANTITIES)
    assert any("no effect is adopted" in note for note in product.notes)
    again = hfa("predict", root / "HF5.toml", "--from", "HF4", "--root", root, "--draws", 60)
    assert again.status == 2
    assert "never written over" in again.err
    assert path.read_bytes() == before
    day = hfa("predict", root / "HF5.toml", "--from", "HF4", "--root", root, "--draws", 60, "--temperature", "10 degC")
    other = Prediction.from_json(read_json(root / "predictions" / "HF5.day.json"))
    assert day.status == 0
    assert other.temperature.value == pytest.approx(283.15)
    assert (other.predicted["peak_thrust"].value or 0.0) < (product.predicted["peak_thrust"].value or 0.0)


def test_a_prediction_is_told_over_the_temperature_of_the_tank(frozen: tuple[Path, str]) -> None:
    product = Prediction.from_json(read_json(frozen[0]))
    days = {float(day): of["peak_thrust"] for day, of in product.over_temperature.items()}
    assert list(days) == [5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0]
    medians = [one.value for one in days.values() if one.value is not None]
    assert medians == sorted(medians)
    near = product.predicted["peak_thrust"]
    assert (near.value, near.low, near.high) == pytest.approx(
        (days[25.0].value, days[25.0].low, days[25.0].high), rel=0.05
    )
    picture = ElementTree.parse(frozen[0].with_suffix(".svg")).getroot()
    bands = [one for one in picture.iter("{http://www.w3.org/2000/svg}path") if "band" in one.get("class", "")]
    assert len(bands) == 4  # impulse, both peaks, apogee


def test_a_load_that_does_not_fit_on_a_hot_day_has_no_band_there(root: Path, base: Base) -> None:
    path = plan_of(root, "HF5", "20 degC", "full")
    path.write_text(path.read_text().replace('oxidizer_mass = "8.350', 'oxidizer_mass = "10.9'))
    origins = {"HF4": Origin(raw={}, test_toml="", products={}, effects=())}
    days = predict(load_planned(path), [base], origins, draws=20).over_temperature
    assert days["5"]["total_impulse"].value is not None
    hot = days["35"]["total_impulse"]
    assert hot.value is None
    assert "expected" in (hot.reason or "")


def test_a_score_lays_the_test_over_it(root: Path, frozen: tuple[Path, str]) -> None:
    told = json.loads(hfa("score", "HF5", "--root", root, "--json").out)
    measured = {test: bring("flight", root, test).read_json("validation.json") for test in ("HF4", "HF5")}
    now, last = (measured[test]["performance"]["measured"]["peak_thrust"]["value"] for test in ("HF5", "HF4"))
    thrust = told["scored"]["peak_thrust"]
    assert told["prediction"] == sha256_file(frozen[0])
    assert thrust["measured"]["value"] == now
    assert thrust["error"] == pytest.approx(thrust["foretold"]["value"] / now - 1.0)
    assert thrust["rivals"]["as_last_time"] == pytest.approx(last / now - 1.0)
    assert told["of"] == 6
    assert told["held"] == sum(one["holds"] for one in told["scored"].values())
    assert told["mean_error"]["predicted"] < told["mean_error"]["as_last_time"]
    table = hfa("score", "HF5", "--root", root).out
    assert f"{told['held']} of 6 bands hold" in table


def test_a_campaign_keeps_the_record_of_predictions(root: Path, frozen: tuple[Path, str]) -> None:
    told = json.loads(hfa("score", "HF5", "--root", root, "--json").out)
    well = Ended(0, "")
    found = record(root, {"HF4": well, "HF5": well}, None, silent)
    assert (found["HF5"].held, found["HF5"].of) == (told["held"], told["of"])
    assert found["HF5"].mean_error == told["mean_error"]
    assert record(root, {"HF4": well}, None, silent) == {}


def test_a_test_that_killed_its_process_is_not_run_again_for_its_prediction(
    root: Path, frozen: tuple[Path, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(predicting, "score", lambda *_, **__: pytest.fail("it was run again"))
    found = record(root, {"HF5": Ended(1, "killed")}, None, silent)
    assert found["HF5"].reason == "the run of its test ended with a defect"


def test_a_prediction_that_has_no_number_is_frozen_without_a_picture(frozen: tuple[Path, str]) -> None:
    lacking = Foretold(value=None, low=None, high=None, unit="", reason="few engines have one")
    product = Prediction.from_json(read_json(frozen[0]))
    empty = product.model_copy(update={"predicted": dict.fromkeys(product.predicted, lacking)})
    assert plots.prediction(empty) is None


@pytest.mark.usefixtures("one_day")
def test_another_seed_moves_the_ends_of_the_bands_by_less_than_a_seventh_of_them(plan: PlannedTest, base: Base) -> None:
    origins = {"HF4": Origin(raw={}, test_toml="", products={}, effects=())}
    one, other = (predict(plan, [base], origins, seed=seed).predicted for seed in (1, 2))
    for name in ("total_impulse", "peak_thrust", "peak_chamber_pressure", "t_v", "apogee"):
        ends = np.array([[found[name].low, found[name].high] for found in (one, other)], dtype=float)
        assert np.abs(np.diff(ends, axis=0)).max() < np.diff(ends[0])[0] / 7.0


def test_a_log_that_was_among_the_inputs_proves_nothing(root: Path, frozen: tuple[Path, str]) -> None:
    ended = hfa("score", "HF5", "--test", "HF4", "--root", root)
    assert ended.status == 2
    assert "from which HF5 was predicted" in ended.err
    assert hfa("score", "HF6", "--root", root).status == 2


def test_holds_and_errors() -> None:
    band = Foretold(value=10.0, low=9.0, high=11.0, unit="s")
    lacking = Foretold(value=None, low=None, high=None, unit="m", reason="no rocket")
    made = Prediction(
        name="N", tests=("A",), temperature=Quantity(290.0, "K"), oxidizer_mass=Quantity(1.0, "kg"),
        injector_area=Quantity(1e-5, "m^2"), band=0.9, predicted={"t_v": band, "apogee": lacking},
        rivals={"as_last_time": {"t_v": Quantity(12.0, "s")}}, scatter={}, misses={}, draws=1, refused=0, seed=1,
        notes=(), plan="", made_from={}, hfanalysis="0",
    )  # fmt: skip

    early, last = (score(made, "", "N", {}, {"t_v": Quantity(t, "s")}, {}).scored["t_v"] for t in (8.0, 11.0))
    assert (early.holds, last.holds) == (False, True)
    assert (early.error, last.error) == pytest.approx((0.25, -1.0 / 11.0))
    found = score(made, "", "N", {}, {"t_v": Quantity(10.0, "s"), "apogee": Quantity(900.0, "m")}, {})
    assert (found.held, found.of, found.scored["apogee"].holds) == (1, 1, None)
    assert found.mean_error == {"predicted": 0.0, "as_last_time": pytest.approx(0.2)}
    with pytest.raises(AbsentError, match="no rocket"):
        score(made, "", "N", {}, {"apogee": Quantity(900.0, "m")}, {})


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[tank]", '[log]\nfiles = ["log.csv"]\n[tank]', r"found \[log\]; expected a test that is still to be fired"),
        ('oxidizer_mass = "8.350', 'oxidiser_mass = "8.350', "did you mean 'oxidizer_mass'"),
        ('temperature = "20 degC"', "", "'temperature' is missing; hfa predict needs it"),
        ("holes = 22", "", "'holes' is missing; hfa predict needs it"),
    ],
)
def test_a_plan_at_fault_is_refused(root: Path, base: Base, old: str, new: str, words: str) -> None:
    path = plan_of(root, "HF5", "20 degC", "faulty")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError, match=words):
        planned(load_planned(path), base)


def test_a_test_whose_n_no_engine_has_is_nothing_to_predict_from(root: Path, base: Base) -> None:
    calibration = base.found.calibration.but(n=Quantity(-0.3, "", 0.1))
    odd = replace(base, found=replace(base.found, calibration=calibration))
    with pytest.raises(AbsentError, match=r"HF4: it cannot be predicted from: -0\.30 is its n"):
        planned(load_planned(plan_of(root, "HF5", "20 degC", "odd")), odd)


def test_where_a_and_n_are_not_told_apart_n_is_that_of_fuels_and_the_rate_stays(base: Base) -> None:
    flux, std_n, std_rate = 150.0, 1.0, 0.05
    std_a = float(np.hypot(std_rate, std_n * log(flux)))  # ln a = ln r - n ln G
    mixed = -std_n * log(flux) / std_a
    joint = Joint(names=("n", "ln_a"), std=(std_n, std_a), correlation=((1.0, mixed), (mixed, 1.0)))
    unsure = base.found.calibration.but(
        a=Quantity(5e-3, "", 1.0), n=Quantity(-0.3, "", std_n, verdict=NOT_IDENTIFIABLE)
    )
    law = law_of(unsure, joint)
    assert law.n == pytest.approx(0.45, abs=0.05)
    assert law.a * flux**law.n == pytest.approx(5e-3 * flux**-0.3, rel=0.01)
    covariance = law.factor @ law.factor.T
    assert np.sqrt(covariance[0, 0]) == pytest.approx(0.2, rel=0.05)
    along = np.array([log(flux), 1.0])
    assert np.sqrt(along @ covariance @ along) == pytest.approx(std_rate, rel=0.05)
    sure = law_of(unsure.but(n=Quantity(0.3, "", 0.02)), joint)
    assert (sure.a, sure.n) == (5e-3, 0.3)


@pytest.mark.parametrize("tests", [1, 2, 3, 5])
def test_bands_by_the_scatter_hold_nine_of_ten_further_tests(base: Base, tests: int) -> None:
    """Stands that scatter as stands do, C_i of tests about one mean, and of a further one: how often it is in the band
    about those that are known."""
    rng = np.random.default_rng(7)
    spread = PRIOR_SCATTER["C_i"] * np.sqrt(PRIOR_FREEDOM / rng.chisquare(PRIOR_FREEDOM, 600))
    known, new = 0.25 * np.exp(spread[:, None] * rng.standard_normal((600, tests))), spread * rng.standard_normal(600)
    held = []
    for values, further in zip(known, new, strict=True):
        found = [base.found.calibration.but(C_i=Quantity(float(value), "", 0.01)) for value in values]
        bases = [replace(base, found=replace(base.found, calibration=calibration)) for calibration in found]
        scatter, shift = scatter_of(bases)["C_i"], to_mean(bases)[0]["C_i"]
        drawn = rng.standard_t(scatter.freedom or 0, 400)
        low, high = log(values[0] / 0.25) + shift + scatter.drawn * np.quantile(drawn, (0.05, 0.95))
        held.append(low <= further <= high)
    assert np.mean(held) == pytest.approx(0.90, abs=0.035)
