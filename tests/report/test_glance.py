"""The first screen: what it says of every kind of test, what it was last time, and the sheet of paper of it."""

from __future__ import annotations

import datetime
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.products.filled import filled
from tests.report.diagnosed import DIAGNOSIS, NOTHING
from tests.report.sample import (
    CALIBRATION,
    HEALTH,
    SEGMENTS,
    VALIDATION,
    material,
    quantity,
    saying,
    without,
)

from hfanalysis.products.calibration import Calibration
from hfanalysis.products.health import Health
from hfanalysis.products.validation import Validation
from hfanalysis.report.glance import against_last, four, key_numbers, motor_class, sensors_then
from hfanalysis.report.material import Last, Material
from hfanalysis.report.one_page import SIZES, write_summary
from hfanalysis.report.page import page

_DEAD = {
    "kind": "dead",
    "channels": ["p_chamber"],
    "verdict": "unusable",
    "evidence": "reads 3.2 bar throughout",
    "means": "the sensor is dead",
    "cure": None,
}
_STOOD_STILL = {
    **_DEAD,
    "kind": "stuck",
    "channels": ["p_tank", "p_run", "p_chamber", "p_purge", "thrust", "m_tank"],
    "start": 104.83,
    "end": 104.84,
    "evidence": "14 rows repeat the one before them exactly",
    "means": "the logger stood still",
    "cure": "[[exclude]]",
}
DEAD: dict[str, Any] = {
    **HEALTH,
    "channels": {"p_chamber": {"verdict": "unusable", "findings": [_STOOD_STILL, _DEAD]}},
    "between": [],
    "quoted": {},
}


def told(made: Material) -> dict[str, str]:
    """The four sentences by their heads."""
    return {one.head: one.words for one in four(made)}


def test_the_four_sentences_of_a_whole_test(tmp_path: Path) -> None:
    found = told(material(tmp_path))
    assert list(found) == ["Result", "Measurement", "Model", "Next"]
    assert found["Result"] == "It burned for 12.4 s; how smoothly was not judged."
    assert found["Measurement"] == "No sensor looks wrong, as far as known kinds of fault show."
    assert found["Model"].startswith("Missing from the model: heat into the tank (probability 0.83), of a size that is")
    assert "a thermocouple on the tank's wall" in found["Next"]
    assert "--apply" in found["Next"]


@pytest.mark.parametrize(
    ("products", "head", "words"),
    [
        ({"segments": {**SEGMENTS, "misfire": True}}, "Result", "misfire"),
        ({"segments": {**SEGMENTS, "kind": "cold_flow"}}, "Result", "did not burn"),
        (
            {"health": DEAD},
            "Measurement",
            "Chamber pressure (dead and stuck): what is unusable is left out",
        ),
        ({"health": DEAD}, "Next", "Repair or replace the sensor of chamber pressure before the next test."),
        ({"health": HEALTH}, "Measurement", "Thrust (zero off) and thrust and chamber pressure (scale off)"),
        ({"diagnosis": NOTHING}, "Model", "what they cannot show may be"),
        ({"diagnosis": NOTHING}, "Next", "a test of another load"),
    ],
)
def test_what_the_sentences_say_goes_by_what_was_found(
    products: dict[str, Any], head: str, words: str, tmp_path: Path
) -> None:
    assert words in told(saying(material(tmp_path), **products))[head]


def test_a_size_that_is_hard_to_believe_is_said_in_the_sentence_of_its_name(tmp_path: Path) -> None:
    (effect,) = DIAGNOSIS["effects"]
    wide = {**effect, "plausibility": {**effect["plausibility"], "plausible": False}}
    made = saying(material(tmp_path), diagnosis={**DIAGNOSIS, "effects": [wide]})
    assert told(made)["Model"].endswith("(probability 0.83), though the size of it is hard to believe.")
    two = [wide, {**effect, "name": "fuel_sliver"}]
    made = saying(material(tmp_path), diagnosis={**DIAGNOSIS, "effects": two})
    assert told(made)["Model"].endswith("and one more, though the size of one is hard to believe.")


def test_a_log_without_a_firing_says_so_and_what_to_do(tmp_path: Path) -> None:
    names = ("segments", "calibration", "validation", "residuals", "performance", "diagnosis")
    found = told(without(material(tmp_path), **dict.fromkeys(names, "the valve never opens")))
    assert found["Result"].endswith("nothing can be calibrated: the valve never opens.")
    assert found["Next"].startswith("Look at the log")


def test_the_six_numbers_end_with_the_apogee_and_the_impulse_has_its_class(tmp_path: Path) -> None:
    performance = {**VALIDATION["performance"], "motor_class": "N (10240 to 20480 N s)"}
    made = saying(material(tmp_path), validation={**VALIDATION, "performance": performance})
    assert list(key_numbers(made)) == [
        "total_impulse", "burn_time", "peak_thrust", "peak_chamber_pressure", "apogee"
    ]  # fmt: skip
    assert motor_class(made) == "N"
    assert '<span class="class">class N</span>' in page(made)


def last(made: Material) -> Last:
    """A test before with less impulse and another injector, and a thrust cell that did not come back."""
    measured = {**VALIDATION["performance"]["measured"], "total_impulse": quantity(12_000.0, "N s", 50.0)}
    products = {
        "validation": filled(Validation, {**VALIDATION, "performance": {"measured": measured, "model": {}}}),
        "calibration": filled(Calibration, {**CALIBRATION, "C_i": quantity(0.26, "", 0.01, verdict="identified")}),
        "health": filled(Health, HEALTH),
    }
    return Last("HF9", datetime.date(2024, 5, 1), products)


def test_numbers_stand_beside_those_of_last_time(tmp_path: Path) -> None:
    made = material(tmp_path)
    assert against_last(made) == []
    assert sensors_then(made) == ""
    then = replace(made, last=last(made))
    rows = {row.name: row for row in against_last(then)}
    assert rows["total_impulse"].change == pytest.approx(18_340.0 / 12_000.0 - 1.0)
    assert rows["C_i"].was.value == 0.26
    assert rows["peak_thrust"].change == pytest.approx(0.0)
    assert "apogee" not in rows
    text = re.sub("<[^>]*>", "", page(then))
    assert "HF9 12000 N s, +53 %" in text
    assert "HF9 2430 N, the same" in text
    assert re.search(r"Last time on this stand: HF9 of 2024-05-01\. Ci was 0\.2600\s*, now \+13 %\.", text)
    assert "Sensors then: Thrust (zero off)" in text
    assert "Last time" not in page(made)


@pytest.mark.parametrize("size", sorted(SIZES))
def test_the_summary_is_one_page_with_all_of_it(size: str, tmp_path: Path) -> None:
    made = material(tmp_path)
    for name in ("one.pdf", "two.pdf"):
        write_summary(replace(made, last=last(made)), tmp_path / name, size)
    first, second = ((tmp_path / name).read_bytes() for name in ("one.pdf", "two.pdf"))
    assert first == second
    assert first.startswith(b"%PDF")
    assert len(re.findall(rb"/Type /Page\b", first)) == 1
    width, height = (float(end) for end in re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", first)[0])
    assert (width, height) == pytest.approx([72.0 * side for side in SIZES[size]], abs=0.6)
    if shutil.which("pdftotext"):
        text = subprocess.run(
            ["pdftotext", tmp_path / "one.pdf", "-"], capture_output=True, text=True, check=True
        ).stdout
        for words in ("REPLICA", "It burned for 12.4 s", "18340 N s", "HF9: 12000 N s, +53 %", "thrust [N]"):
            assert words in text
