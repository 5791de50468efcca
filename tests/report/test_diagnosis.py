"""The diagnosis on the page: its story, its numbers, and what is said where there is none."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.products.filled import filled
from tests.report.diagnosed import DIAGNOSIS, NOTHING
from tests.report.sample import material, saying, without
from tests.report.test_page import HOSTILE, Reader

from hfanalysis.charts.chart import Chart
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.report.diagnosis_tables import parameters, probabilities
from hfanalysis.report.equation_map import deviations, equation_map
from hfanalysis.report.html import switchable
from hfanalysis.report.material import StoredVariable
from hfanalysis.report.page import page
from hfanalysis.report.sections import Laid, lay_out
from hfanalysis.sentences import said, text


def laid_out(folder: Path, product: dict[str, Any]) -> Laid:
    made = material(folder)
    return section(lay_out(saying(made, diagnosis=product)))


def section(found: list[Laid]) -> Laid:
    return next(laid for laid in found if laid.key == "diagnosis")


def told(laid: Laid) -> str:
    return "\n".join(str(block) for block in laid.blocks if not isinstance(block, Chart))


def charts(laid: Laid) -> dict[str, Chart]:
    return {chart.key: chart for chart in laid.charts}


def row(text: str, head: str) -> str:
    """The text of a table's row, without its tags."""
    found = [part for part in re.findall(r"<tr>.*?</tr>", text, re.DOTALL) if head in part]
    assert found, head
    return re.sub(r"<[^>]*>", " ", found[0])


def test_what_is_missing_leads_the_section_and_stands_on_the_first_screen(tmp_path: Path) -> None:
    text = page(material(tmp_path))
    first, section = text[text.index('<section id="verdict"') :].split('<section id="diagnosis"')
    assert "Missing from the model: heat into the tank (probability 0.83), of a size that is plausible." in first
    lead = "Missing from the model, with probability: heat into the tank (0.83)."
    assert f'<p class="lead diagnosed">{lead} Heat from the tank&#39;s wall (0.15) cannot be excluded.</p>' in section


def test_every_sentence_is_told_behind_a_fold(tmp_path: Path) -> None:
    laid = told(laid_out(tmp_path, DIAGNOSIS))
    found = unescape(re.sub(r"<[^>]*>", "", laid))
    for sentence in DIAGNOSIS["sentences"]:
        assert sentence in found
    assert found.count("a thermocouple on the tank's wall") == 1


def test_what_is_named_comes_first_with_size_twins_and_what_would_decide(tmp_path: Path) -> None:
    found = told(laid_out(tmp_path, DIAGNOSIS))
    table = found[found.index('aria-label="Probabilities: table"') :].partition("</table>")[0]
    names = re.findall(r'<th scope="row"><span>([^<]+)</span>', unescape(table))
    assert names == ["heat into the tank", "heat from the tank's wall", "nothing", "something without a name"]
    assert "2 other names are below 0.005 each" in table
    assert '<rect width="83.0" height="10"/>' in table
    first = unescape(row(table, "<span>heat into the tank"))
    assert "hardly told apart from heat from the tank's wall (0.15)" in first
    assert "900 ± 150 W" in re.sub(r"\s+", " ", first)
    assert re.search(r"plausible\s+power 0.9 kW \(limit 3 kW\)", first)
    assert "a thermocouple on the tank's wall" in first
    assert "hard to believe" in row(table, "<span>heat from the tank")
    assert "raw evidences, not calibrated" in table


def test_effects_beside_the_first_have_their_probabilities(tmp_path: Path) -> None:
    beside = {"fuel_sliver": 0.44, "load_cell_drift": 0.5, "n2_purge": 0.001}
    added = [*DIAGNOSIS["effects"], {**DIAGNOSIS["effects"][0], "name": "load_cell_drift"}]
    found = told(laid_out(tmp_path, {**DIAGNOSIS, "partners": beside, "effects": added}))
    table = found[found.index('aria-label="Probabilities: table"') :].partition("</table>")[0]
    names = re.findall(r'<th scope="row"><span>([^<]+)</span>', unescape(table))
    assert names[:3] == ["heat into the tank", "thrust cell that drifts", "fuel that ends unevenly"]
    assert "0.50" in row(table, "thrust cell that drifts")
    assert "0.44" in row(table, "fuel that ends unevenly")
    assert "nitrogen into the tank" not in table


def test_every_channel_is_drawn_measured_calibrated_and_with_the_effects(tmp_path: Path) -> None:
    made = material(tmp_path)
    left = made.stores["diagnosis"]["residuals/p_tank"]
    log = made.log["p_tank"]
    read = np.interp(left["time"].values, log.time - made.opening, log.values)
    stored = {**left, "measured": StoredVariable(read - 4e5, "Pa")}
    stores = {**made.stores, "diagnosis": {**made.stores["diagnosis"], "residuals/p_tank": stored}}
    chart = charts(section(lay_out(replace(made, stores=stores))))["diagnosis-channel-p-tank"]
    by_label = {one.label: one for one in chart.series}
    assert set(by_label) >= {"measured", "model with the effects"}
    # what is compared less an offset is drawn on what the sensor reads
    expected = read - left["after"].values
    assert by_label["model with the effects"].values == pytest.approx(expected, abs=2e3)
    assert "0.9 bar</span> (refitted)" in chart.caption
    assert "(with the effects); noise" in chart.caption


def test_where_the_model_fails_is_a_picture_with_a_row_for_each_equation(tmp_path: Path) -> None:
    product = filled(Diagnosis, DIAGNOSIS)
    found = equation_map(material(tmp_path), product)
    assert found is not None
    off = [deviations(product.weak_form[name]) for name in ("tank_energy", "feed")]
    assert off[0][0] == pytest.approx(10.0, rel=0.01)
    assert len(re.findall('class="cell little level-3"', found)) == sum(int((z >= 8.0).sum()) for z in off)
    nothing = product.but(weak_form={"nozzle": product.weak_form["nozzle"]})
    assert equation_map(material(tmp_path), nothing) is None


def test_a_source_is_drawn_with_its_band_in_the_unit_of_the_sentence(tmp_path: Path) -> None:
    chart = charts(laid_out(tmp_path, DIAGNOSIS))["diagnosis-source-1"]
    band, line = chart.series
    assert chart.unit == "kW"
    assert line.values[0] == pytest.approx(0.9)
    assert band.upper is not None
    assert (band.values[0], band.upper[0]) == pytest.approx((0.9 - 0.247, 0.9 + 0.247), abs=1e-3)
    assert chart.value_span is not None
    assert chart.value_span[0] <= 0.0
    assert chart.value_span[1] > band.upper[0]


def test_the_residual_is_drawn_without_and_with_beside_the_noise(tmp_path: Path) -> None:
    chart = charts(laid_out(tmp_path, DIAGNOSIS))["diagnosis-left-p-tank"]
    by_label = {one.label: one for one in chart.series}
    assert abs(by_label["refitted without"].values).max() == pytest.approx(9e4, rel=0.01)
    assert abs(by_label["with the effects"].values).max() == pytest.approx(9e3, rel=0.01)
    assert by_label["noise, 95 %"].upper is not None
    assert by_label["noise, 95 %"].upper[0] == pytest.approx(1.96 * 9e3)
    assert "solid: with what is missing" in chart.caption


def test_the_gap_closes_in_figures_by_channel_and_phase(tmp_path: Path) -> None:
    found = told(laid_out(tmp_path, DIAGNOSIS))
    assert re.search(r"0\.9 bar\s+0\.1 bar\s+0\.08 bar", row(found, "run tank pressure"))
    by_phase = found[found.index('aria-label="Gap by phase: table"') :]
    assert re.search(r"liquid\s+0\.91 bar\s+0\.05 bar", row(by_phase, "run tank pressure"))


def test_the_arms_of_the_proof_are_figures_or_words(tmp_path: Path) -> None:
    found = told(laid_out(tmp_path, DIAGNOSIS))
    assert "93 %" in row(found, "the same data")
    assert "88 %" in row(found, "held out")
    assert "no other test of this stand" in row(found, "another test")
    assert "−20 % (wider)" in row(found, "best wrong effect")
    assert "95 %" in row(found, "free curve")
    gap = {**DIAGNOSIS["gap"], "other_test": {"test": "HF4"}}
    gap["closed_fraction"] = {**gap["closed_fraction"], "other_test": 0.8}
    proved = told(laid_out(tmp_path, {**DIAGNOSIS, "gap": gap}))
    assert re.search(r"frozen \(HF4\)\s+80 %", row(proved, "another test"))


def test_m_is_told_without_and_with(tmp_path: Path) -> None:
    found = told(laid_out(tmp_path, DIAGNOSIS))
    assert "m 0.75 without, 1.08 with the effects." in found
    table = found[found.index('aria-label="Constants: table"') :]
    assert table.index("polytropic exponent") < table.index("effective area of the injector")


def test_what_was_not_found_is_limited_in_units_of_people(tmp_path: Path) -> None:
    found = told(laid_out(tmp_path, DIAGNOSIS))
    assert "Tried, and not it:" in found
    assert "<li>fuel that ends unevenly</li><li>nitrogen into the tank</li>" in found
    assert "0.075 mm/s" in row(found, "throat that erodes")
    assert "3 g/s" in row(found, "tank leak")
    assert "0.729 bar" in row(found, "pressure transducer off its zero")
    limits = found[found.index('aria-label="Upper limits: table"') :]
    assert "24522 J/K" in row(limits, "heat from the tank")


def test_every_equation_with_values_is_drawn(tmp_path: Path) -> None:
    drawn = charts(laid_out(tmp_path, DIAGNOSIS))
    assert {key for key in drawn if key.startswith("diagnosis-weak")} == {
        "diagnosis-weak-tank-energy",
        "diagnosis-weak-feed",
    }
    assert "it lacks 0.9 ± 0.09 kW on average" in drawn["diagnosis-weak-tank-energy"].caption
    assert drawn["diagnosis-weak-feed"].unit == "Pa"
    assert "Nowhere beyond two standard deviations" in drawn["diagnosis-weak-feed"].caption


def test_equations_that_cannot_be_asked_say_why(tmp_path: Path) -> None:
    assert "the nozzle&#39;s thrust or throat: the log has no thrust" in told(laid_out(tmp_path, DIAGNOSIS))


def test_notes_and_warnings_are_shown(tmp_path: Path) -> None:
    found = told(laid_out(tmp_path, {**DIAGNOSIS, "warnings": ["the last fit did not converge"]}))
    assert "Warning:</strong> the last fit did not converge" in found
    assert "There is no other test of this stand to prove it on." in found
    assert "Compared: run tank pressure and thrust, from 0.07 s to 12.30 s." in found


def test_where_nothing_is_missing_nothing_is_proved(tmp_path: Path) -> None:
    laid = laid_out(tmp_path, NOTHING)
    found = told(laid)
    assert "nothing to prove" in found
    assert 'aria-label="Proof: table"' not in found
    assert "m 0.75.</strong>" in found
    labels = [one.label for one in charts(laid)["diagnosis-left-thrust"].series]
    assert labels == ["noise, 95 %", "model", "zero"]


ALONE: dict[str, Any] = {
    **{
        name: DIAGNOSIS[name]
        for name in ("effects", "twins", "decisive_measurements", "plausibility", "called", "provenance")
    },
    "verdict": "named",
    "set90": ["load_cell_drift"],
    "posterior": {"load_cell_drift": 1.0},
    "localisation": [{k: v for k, v in DIAGNOSIS["localisation"][0].items() if k != "history"}],
    "gap": {"before": {}, "after": {}, "noise": {}, "closed_fraction": DIAGNOSIS["gap"]["closed_fraction"]},
    "upper_limits": {},
    "not_it": [],
    "compared": {"channels": ["thrust"]},
    "sentences": [
        "the thrust cell does not return to zero: 190 N",
        "No more can be said without a model to compare with.",
    ],
    "notes": ["only what the sensors show by themselves was judged"],
    "warnings": [],
}
"""A diagnosis where no engine is stated: what the sensors show by themselves."""


def test_without_an_engine_the_section_tells_the_sensors_and_claims_no_numbers(tmp_path: Path) -> None:
    made = without(material(tmp_path), "diagnosis")
    laid = section(lay_out(saying(made, diagnosis=ALONE)))
    found = told(laid)
    assert not laid.charts
    assert "<table>" not in found
    assert "No more can be said without a model to compare with." in found
    assert "Compared" not in found
    assert "Only what the sensors show by themselves was judged." in found
    assert "calibrated on" not in found


@pytest.mark.parametrize("effects", [ALONE["effects"], []])
def test_without_an_engine_what_is_beside_the_first_has_a_table(effects: list[Any], tmp_path: Path) -> None:
    beside = {**ALONE, "effects": effects, "partners": {"n2_purge": 0.98}}
    made = without(material(tmp_path), "diagnosis")
    found = told(section(lay_out(saying(made, diagnosis=beside))))
    first = "heat into the tank" if effects else "thrust cell that drifts"
    assert f"Effects beside {first}." in found
    assert "nitrogen into the tank" in found


def test_a_test_that_cannot_be_diagnosed_says_why_in_the_section(tmp_path: Path) -> None:
    bare = without(material(tmp_path), diagnosis="the engine is not stated: [engine] is missing")
    laid = section(lay_out(bare))
    assert "This test has no diagnosis:</strong> the engine is not stated" in told(laid)
    assert "lead diagnosed" not in page(bare)


def test_what_stops_the_calibration_too_is_not_told_again(tmp_path: Path) -> None:
    bare = without(material(tmp_path), diagnosis="no firing", calibration="no firing")
    laid = section(lay_out(bare))
    assert not laid.blocks
    assert laid.absent == "no firing"


def _attacked(data: Any) -> Any:
    """Every text and name of a product made hostile, but for those that pick what is drawn."""
    if isinstance(data, dict):
        return {name: value if name in _KEPT else _attacked(value) for name, value in data.items()}
    if isinstance(data, list):
        return [_attacked(value) for value in data]
    return HOSTILE if isinstance(data, str) else data


_KEPT = ("verdict", "unit", "channels", "set90", "probabilities_from")


def test_hostile_texts_of_a_diagnosis_are_shown_not_obeyed(tmp_path: Path) -> None:
    attacked = _attacked(DIAGNOSIS)
    for name in ("posterior", "plausibility", "upper_limits", "weak_form"):
        (first, *_) = attacked[name]
        attacked[name] = {**attacked[name], HOSTILE: attacked[name][first]}
    attacked["set90"] = [HOSTILE]
    made = material(tmp_path)
    text = page(saying(made, diagnosis=attacked))
    reader = Reader(text)
    assert reader.open == []
    assert "img" not in {tag for tag, _ in reader.tags}
    assert not any(name.startswith("on") for _, attrs in reader.tags for name in attrs)
    assert len(reader.all("script")) == len(Reader(page(made)).all("script"))
    ids = [attrs["id"] for _, attrs in reader.tags if "id" in attrs]
    assert len(ids) == len(set(ids))


def test_no_texts_of_a_page_depend_on_a_diagnosis_that_is_not_there(tmp_path: Path) -> None:
    bare = without(material(tmp_path), "diagnosis")
    text = page(bare)
    assert "What the model lacks" in text[text.index('id="absent"') :]
    assert Reader(text).open == []


def test_a_number_and_what_it_is_unsure_of_change_units_together() -> None:
    off, most = said(-3.91e5, "bar", ".2f", 8e4, ".1f"), said(16.6e5, "bar", ".1f")
    words = text(
        "It differs by {off}, at most {most}; {force}.", off=off, most=most, force=said(12.0, "N", "", 3.0, "")
    )
    found = str(switchable(words))
    assert 'data-si="−3.91 ± 0.8 bar" data-team="−57 ± 12 psi"' in found
    assert 'data-si="16.6 bar" data-team="241 psi"' in found
    assert 'data-si="12.0 ± 3.0 N" data-team="2.70 ± 0.67 lbf"' in found


def test_only_what_a_sentence_knows_to_be_a_quantity_changes_units() -> None:
    assert str(switchable("the gauge of 40 bar")) == "the gauge of 40 bar"
    found = str(switchable(text("{size} in HF-40 bar, 140 bar", size=said(40e5, "bar", ".0f"))))
    assert found == '<span data-si="40 bar" data-team="580 psi">40 bar</span> in HF-40 bar, 140 bar'


def test_sentences_are_set_like_the_rest_of_the_page() -> None:
    found = str(switchable("From 0.1 to -85 it is 36.2 mm^2 or 4e-05 (kg/m^2/s)^-1 of HF-5."))
    assert found == "From 0.1 to −85 it is 36.2 mm² or 4e-05 (kg/m²/s)⁻¹ of HF-5."


def test_effects_beside_the_first_do_not_count_among_the_improbable(tmp_path: Path) -> None:
    odds = {**DIAGNOSIS["posterior"], "load_cell_drift": 1e-4, "chamber_tap_lag": 1e-4}
    alone = str(probabilities(filled(Diagnosis, {**DIAGNOSIS, "posterior": odds, "partners": {}})))
    odd = {**DIAGNOSIS, "posterior": odds, "partners": {"load_cell_drift": 0.98}}
    beside = str(probabilities(filled(Diagnosis, odd)))
    count = [int(re.search(r"(\d+) other names are below", text)[1]) for text in (alone, beside)]  # type: ignore[index]
    assert count[0] == count[1] + 1


def test_the_effects_own_constants_are_on_the_page() -> None:
    found = str(parameters(filled(Diagnosis, DIAGNOSIS)))
    for name in DIAGNOSIS["effects"][0]["parameters"]:
        assert f"<td>{name.replace('_', ' ')}</td>" in found
    assert "±" in found
