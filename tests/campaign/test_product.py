"""What the tests of a stand say together, from the products of each."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.campaign.rows import definition, made
from tests.products.filled import filled

from hfanalysis.campaign.page import page
from hfanalysis.campaign.product import probability_of, row_of, stand_of, stand_row
from hfanalysis.campaign.side_by_side import Ended
from hfanalysis.campaign.skill import skill_sentence
from hfanalysis.campaign.words import agreement, diagnosed
from hfanalysis.products.campaign import Campaign, Diagnosed, Predicted
from hfanalysis.products.diagnosis import NamedEffect
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import load_definition


@pytest.fixture(scope="module")
def product(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    return made(tmp_path_factory.mktemp("campaign"))


def test_only_what_is_identified_is_in_the_mean(product: Campaign) -> None:
    m = product.stands["cell 3"].constants["m"]
    assert m.tests == ("A", "B")
    assert m.mean.value == pytest.approx(1.04)
    assert m.agreement.verdict == "agree"


def test_tests_that_differ_are_said_to(product: Campaign) -> None:
    c_i = product.stands["cell 3"].constants["C_i"]
    assert c_i.agreement.verdict.startswith("disagree")
    assert c_i.between > 0.02
    assert "disagree" in agreement(c_i)
    assert "(p < 0.001; below 0.01 they do not)" in agreement(c_i)


def test_an_effect_has_its_probability_in_every_test_and_its_size_where_it_is_named(product: Campaign) -> None:
    heat = product.stands["cell 3"].effects["tank_heat"]
    assert heat.named_in == ("A", "B")
    assert heat.probability == {"A": 0.93, "B": 0.93, "C": 0.004}
    together = heat.parameters["power"].together
    assert together.mean.value == pytest.approx(1000.0)
    assert together.tests == ("A", "B")


def test_what_may_be_beside_the_first_effect_of_another_test_counts_as_that() -> None:
    diagnosis = filled(Diagnosed, {"posterior": {"tank_heat": 0.004}, "partners": {"tank_heat": 0.3}})
    assert probability_of(diagnosis, None, "tank_heat") == 0.3
    assert probability_of(diagnosis, filled(NamedEffect, {"probability": 0.9}), "tank_heat") == 0.9
    assert probability_of(filled(Diagnosed, {}), None, "tank_heat") is None


def test_without_a_law_of_two_tests_there_is_the_reason(product: Campaign) -> None:
    reason = product.stands["cell 3"].regression.reason
    assert reason == "two tests are needed, and a and n are known of none"
    assert reason in page(product)


def test_a_test_at_fault_is_listed_with_its_reason_and_nothing_else(product: Campaign, tmp_path: Path) -> None:
    row = product.tests["D"]
    assert row.status == "input at fault"
    assert row.calibration == {}
    assert row.page is None
    text = page(product)
    assert "input at fault: raw_tests/D/test.toml: &lt;b&gt;found nothing" in text
    assert "<b>found" not in text


@pytest.mark.parametrize(("status", "said"), [(2, "input at fault"), (1, "defect")])
def test_what_an_earlier_run_left_is_not_of_one_that_failed(tmp_path: Path, status: int, said: str) -> None:
    folder = tmp_path / "processed" / "A"
    made(tmp_path)
    row = row_of(definition(tmp_path / "again", "A"), folder, Ended(status, "no such column"))
    assert (row.status, row.calibration, row.diagnosis, row.page) == (said, {}, None, None)


def test_a_test_that_left_nothing_has_nothing(tmp_path: Path) -> None:
    row = row_of(definition(tmp_path, "E", None), tmp_path / "processed" / "E", Ended(3, "no firing"))
    assert (row.status, row.reason) == ("not in the log", "no firing")
    assert row.stand is None
    assert row.diagnosis is None
    assert diagnosed(row.diagnosis) == "not diagnosed"
    text = page(Campaign(tests={"E": row}, stands={}))
    assert "not diagnosed" in text
    assert "E/report.html" not in text


def test_a_stand_that_is_not_stated_is_known_by_its_tank(tmp_path: Path) -> None:
    text = definition(tmp_path, "F", None).path.read_text(encoding="utf-8")
    hardware = '[tank]\nvolume = "16.5 L"\n'
    path = tmp_path / "raw_tests" / "F" / "test.toml"
    path.write_text(text + hardware, encoding="utf-8")
    assert stand_of(load_definition(path)) == "not stated: the tank of 16.5 L (synthetic)"


def test_what_belongs_to_an_injector_is_not_pooled_over_two_of_them(tmp_path: Path) -> None:
    rows = {
        test: row.but(injector_area={"A": 6e-5, "B": 7e-5}[test])
        for test, row in made(tmp_path).tests.items()
        if test in "AB"
    }
    constants = stand_row(rows, tmp_path / "processed").constants
    assert constants["C_i"].to_json() == {"value": None, "reason": "the tests have different injectors"}
    assert constants["m"].mean.value == pytest.approx(1.04)


def test_a_test_alone_on_its_stand_is_compared_with_nothing(product: Campaign) -> None:
    text = page(product.but(stands={"cell 3": product.stands["cell 3"].but(tests=("A",))}))
    assert "A is the only test of this stand here" in text
    assert "Constants of the stand" not in text


def test_the_page_has_a_picture_of_each_constant_and_links_to_the_tests(product: Campaign) -> None:
    text = page(product)
    assert text.count('<svg class="chart"') == 3
    assert 'href="A/report.html"' in text
    assert '<a href="index.html">All tests</a>' in text
    assert "<strong>0.93</strong> named" in text
    assert "&lt; 0.01" in text


def test_what_is_doubted_is_marked_on_the_overview(product: Campaign) -> None:
    row = product.tests["A"]
    doubted = row.but(performance={"total_impulse": Quantity(2.0e4, "N s", 150.0, verdict="doubted", why="zero off")})
    overview = page(product.but(tests={"A": doubted}, stands={}))
    assert overview.count('class="verdict doubt"') == 1
    assert 'class="verdict' not in page(product.but(tests={"A": row}, stands={}))


def test_the_record_of_predictions_is_on_the_page_with_both_rivals(product: Campaign) -> None:
    assert "Predictions" not in page(product)
    errors = {"predicted": 0.02, "as_last_time": 0.2, "without_effects": 0.05}
    found = {
        "T9": Predicted(test="T9", held=5, of=6, mean_error=errors),
        "T8": Predicted(test="T8", held=4, of=4, mean_error={**errors, "predicted": 0.04}),
        "T7": Predicted(test="T7", reason="nothing of T7 can be compared"),
    }
    said = "Of 2 predictions 9 of 10 bands held: mean error 3.0 %, and 20.0 % as last time, 5.0 % without effects."
    assert skill_sentence(found) == said
    text = page(product.model_copy(update={"predictions": found}))
    assert said in text
    assert "5 of 6" in text
    assert "nothing of T7 can be compared" in text
    assert skill_sentence({}) == ""
