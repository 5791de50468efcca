"""A team's own limits: kept, broken, or open where the numbers do not tell."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from tests.report.sample import CALIBRATION, material, quantity, saying

from hfanalysis.errors import InputError
from hfanalysis.products.validation import Validation
from hfanalysis.record.limits import Rule, read_limits
from hfanalysis.report.limits import BROKEN, KEPT, OPEN, judged, known_quantities
from hfanalysis.report.material import Last, Material
from hfanalysis.report.page import page, summary

FILE = """
[[rule]]
quantity = "peak_chamber_pressure"
max = "40 bar"
[[rule]]
quantity = "total_impulse"
min = "9 kN s"
[[stand.north.rule]]
quantity = "peak_chamber_pressure"
max = "300 psi"
"""


@pytest.fixture
def sample(tmp_path: Path) -> Material:
    """Of an impulse of 18,340 +/- 60 N s."""
    return material(tmp_path)


def states(sample: Material, *rules: Rule) -> list[str]:
    return [one.state for one in judged(replace(sample, rules=rules))]


def test_the_rules_of_a_stand_take_the_place_of_the_general_ones(tmp_path: Path) -> None:
    (tmp_path / "limits.toml").write_text(FILE, encoding="utf-8")
    of = {stand: read_limits(tmp_path, stand, known_quantities()) for stand in ("north", "south", None)}
    assert [rule.max for rule in of["south"]] == [rule.max for rule in of[None]] == ["40 bar", None]
    assert [(rule.quantity, rule.max) for rule in of["north"]] == [
        ("total_impulse", None),
        ("peak_chamber_pressure", "300 psi"),
    ]
    assert read_limits(tmp_path / "elsewhere", "north", known_quantities()) == ()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[[rule]]\nquantity = "peak_chamber_presure"\nmax = "1 bar"', "did you mean 'peak_chamber_pressure'"),
        ('[[rule]]\nquantity = "C_i"', "a rule without a limit; expected min, max or within"),
        ('[[rule]]\nquantity = "C_i"\nmost = 1', "unknown key 'most'"),
        ('[[rules]]\nquantity = "C_i"', "unknown key 'rules'"),
        ("rule = 3", "found 3"),
    ],
)
def test_what_is_no_rule_is_refused_with_its_place(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "limits.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"limits\.toml") as caught:
        read_limits(tmp_path, None, known_quantities())
    assert said in str(caught.value)


def test_a_number_keeps_a_rule_or_breaks_it_in_any_unit_of_its_kind(sample: Material) -> None:
    above, below = "27 kN s", "9 kN s"
    assert states(sample, Rule("total_impulse", max=above), Rule("total_impulse", max=below)) == [KEPT, BROKEN]
    assert states(sample, Rule("total_impulse", min=above), Rule("total_impulse", min=below)) == [BROKEN, KEPT]
    with pytest.raises(InputError, match=r"limits\.toml, total_impulse\.max.*'3 bar'.*'1 N s'"):
        states(sample, Rule("total_impulse", max="3 bar"))


def test_a_limit_within_the_interval_is_open(sample: Material) -> None:
    (found,) = judged(replace(sample, rules=(Rule("total_impulse", max="18.3 kN s"),)))
    assert found.state == OPEN
    assert "interval holds the limit" in found.words


def test_what_is_missing_or_doubted_is_neither_kept_nor_broken(sample: Material) -> None:
    doubted = {**CALIBRATION, "C_i": quantity(0.29, "", 0.01, verdict="doubted", why="the cell")}
    rules = (Rule("C_i", max=1.0), Rule("fuel_mass", min="1 kg"))
    first, second = judged(replace(saying(sample, calibration=doubted), rules=rules))
    assert (first.state, second.state) == (OPEN, OPEN)
    assert "doubted: the cell" in first.words
    assert second.words == "not known: the grain was not weighed after the firing"


def test_within_is_of_the_stand_s_test_before(sample: Material) -> None:
    rules = (Rule("total_impulse", within="5 %"), Rule("total_impulse", within="60 %"))
    assert states(sample, *rules) == [OPEN, OPEN]
    then = sample.products["validation"].to_json()
    then["performance"]["measured"]["total_impulse"] = quantity(12_000.0, "N s", 60.0)
    before = Last("HF1", None, {"validation": Validation.from_json(then)})
    first, second = judged(replace(sample, rules=rules, last=before))
    assert (first.state, second.state) == (BROKEN, KEPT)
    assert "last time" in first.words


def test_page_and_index_show_what_is_broken_first(sample: Material) -> None:
    assert 'class="limits"' not in page(sample)
    made = replace(sample, rules=(Rule("total_impulse", min="1 N s"), Rule("total_impulse", max="1 N s")))
    text = page(made)
    assert text.index(">breaks<") < text.index(">keeps<")
    assert summary(made)["limits"] == [[BROKEN, "total impulse"]]
    assert summary(made)["kept"] == 1
