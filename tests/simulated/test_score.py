"""The scorer, on products made up for the purpose."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from simulated.blind.figures import paired_share, quantile, share
from simulated.blind.judged import Case, load, twins
from simulated.blind.score import reliability, score, table
from tests.simulated.made_up import answer, product


def figure(cases: list[Case], name: str) -> Any:
    return score(cases)["figures"][name]


def test_wilson_limits_are_those_of_the_textbook() -> None:
    f = share([True] * 81 + [False] * 182)
    assert (f.low, f.high) == pytest.approx((0.2553, 0.3662), abs=1e-4)
    assert share([]).n == 0


def test_an_exact_name_counts_only_where_it_can_be_told_apart() -> None:
    right = Case(answer("nozzle_divergence"), product("nozzle_divergence"))
    wrong = Case(answer("nozzle_divergence"), product("n2_purge"))
    near = Case(answer("nozzle_divergence", against={"n2_purge": 3.0}), product("n2_purge"))
    faint = Case(answer("nozzle_divergence", d=4.0), product("none"))
    assert figure([right, wrong, near, faint], "exact_name") == pytest.approx(
        {"value": 0.5, "n": 2, "k": 1} | _limits(1, 2)
    )
    assert figure([right, wrong, near, faint], "exact_name_no_twin_allowance")["n"] == 3


def _limits(k: int, n: int) -> dict[str, float]:
    f = share([True] * k + [False] * (n - k))
    return {"low": f.low, "high": f.high}


def test_twins_are_declared_by_the_benchmark_and_forgiven_in_the_group() -> None:
    close = answer("tank_heat", against={"tank_wall_heat_capacity": 2.0, "n2_purge": 8.0})
    groups = twins([close])
    assert groups["tank_heat"] == {"tank_heat", "tank_wall_heat_capacity"}
    assert groups["n2_purge"] == {"n2_purge"}
    case = Case(close, product("tank_wall_heat_capacity"))
    assert figure([case], "twin_group")["value"] == 1.0
    assert figure([case], "sure_and_wrong")["value"] == 0.0
    assert figure([Case(close, product("n2_purge"))], "sure_and_wrong")["value"] == 1.0
    assert figure([Case(close, product("n2_purge", 0.8))], "sure_and_wrong")["value"] == 0.0


def test_sets_cover_over_all_strengths_and_are_measured_where_there_is_something_to_see() -> None:
    wide = ["tank_heat", "n2_purge", "none"]
    cases = [
        Case(answer("tank_heat", d=1.0), product("none", set90=wide)),
        Case(answer("tank_heat"), product("tank_heat")),
    ]
    cases.append(Case(answer(None, d=0.0), product("n2_purge")))
    assert figure(cases, "set90_coverage")["k"] == 2
    assert figure(cases, "set90_size") | {"low": 0, "high": 0} == {"value": 1.0, "low": 0, "high": 0, "n": 1, "k": None}


def test_a_false_alarm_is_anything_but_none_where_there_is_none() -> None:
    cases = [Case(answer(None, d=0.0), product(x)) for x in ("none", "none", "tank_heat", "unknown")]
    assert figure(cases, "false_alarm")["k"] == 2
    assert score(cases)["false_alarm_by_noise"]["ar1"]["n"] == 4


def test_an_outsider_must_be_unknown_in_the_right_equation() -> None:
    strange = answer("vent_leak", kind="outside", inside=False)
    here, there = {"equation": "tank_energy", "phase": "liquid"}, {"equation": "nozzle", "phase": "liquid"}
    cases = [Case(strange, product("unknown", place=here)), Case(strange, product("unknown", place=there)),
             Case(strange, product("tank_heat", place=here)),
             Case(strange | {"after_best_of_library": 5.0}, product("tank_heat"))]  # fmt: skip
    assert (figure(cases, "outside_unknown")["k"], figure(cases, "outside_unknown")["n"]) == (2, 3)
    assert figure(cases, "outside_unknown_and_equation")["k"] == 1


def test_of_two_effects_both_must_be_named_where_both_can_be_seen() -> None:
    two = answer("tank_heat+n2_purge", kind="pair", given_others={"tank_heat": 9.0, "n2_purge": 12.0})
    both = product("tank_heat", effects=[{"name": "n2_purge"}, {"name": "tank_heat"}])
    faint = two | {"given_others": {"tank_heat": 3.0, "n2_purge": 12.0}}
    cases = [Case(two, both), Case(two, product("tank_heat")), Case(faint, product("n2_purge"))]
    assert (figure(cases, "pair_both")["k"], figure(cases, "pair_both")["n"]) == (1, 2)


def test_the_most_significant_place_counts_and_its_band_must_hold_the_onset() -> None:
    rows = [{"equation": "nozzle", "phase": "vapor", "significance": 3.0},
            {"equation": "tank_energy", "phase": "liquid", "significance": 9.0,
             "t_start": {"value": 1.1, "unit": "s", "std": 0.1}, "t_end": 5.0,
             "source": {"value": 560.0, "unit": "W", "std": 40.0},
             "history": {"unit": "W", "time": [2.0, 3.0], "low90": [450.0, 510.0],
                         "high90": [550.0, 600.0]}}]  # fmt: skip
    cases = [Case(answer("tank_heat"), product("tank_heat", localisation=rows))]
    for name, value in {"equation_first": 1.0, "phase": 1.0, "onset_in_95_band": 1.0, "size_in_90_interval": 1.0,
                        "source_in_90_band": 0.5}.items():  # fmt: skip
        assert figure(cases, name)["value"] == value, name


def test_a_place_may_be_first_without_being_claimed() -> None:
    """Which equation comes first is one question, whether anything is claimed there another."""
    likely, other = ({"equation": e, "phase": p} for e, p in (("tank_energy", "liquid"), ("nozzle", "vapor")))
    cases = [Case(answer("tank_heat"), product("none", likeliest_place=likely)),
             Case(answer("tank_heat"), product("none", likeliest_place=other)),
             Case(answer("tank_heat"), product("none", likeliest_place=None)),
             Case(answer("tank_heat"), product("tank_heat", place=likely, likeliest_place=None)),
             Case(answer(None, d=0.0), product("none", likeliest_place=likely))]  # fmt: skip
    for name, k in {"equation_first": 2, "phase": 2, "equation_claimed": 1, "phase_claimed": 1}.items():
        assert (figure(cases, name)["k"], figure(cases, name)["n"]) == (k, 4), name
    assert figure(cases, "no_source_on_none")["k"] == 1


def test_stated_probabilities_that_come_true_have_no_calibration_error() -> None:
    rng = np.random.default_rng(0)

    def cases(right: float) -> list[Case]:
        names = np.where(rng.uniform(size=1000) < right, "tank_heat", "n2_purge")
        return [Case(answer("tank_heat"), product(str(n), 0.8)) for n in names]

    assert reliability(cases(0.8))[0].value < 0.03
    assert reliability(cases(0.5))[0].value == pytest.approx(0.3, abs=0.05)


def test_gaps_are_medians_over_the_tests_with_an_answer() -> None:
    closed = [{"same": x, "held_out": 0.9, "other_test": None, "placebo": 0.1} for x in (0.9, 0.95, 1.0)]
    cases = [Case(answer("tank_heat"), product("tank_heat", gap={"closed_fraction": c})) for c in closed]
    assert figure(cases, "gap_closed_same")["value"] == 0.95
    assert figure(cases, "gap_closed_other_test")["n"] == 0


def test_always_none_is_right_on_nothing_but_none() -> None:
    cases = [Case(answer("tank_heat"), product("tank_heat")), Case(answer(None, d=0.0), product("none"))]
    result = score(cases)["baselines"]
    assert result["always_none"]["exact_name"]["value"] == 0.0
    assert result["always_none"]["label"]["value"] == 0.5
    assert result["always_unknown"]["label"]["value"] == 0.0
    assert result["prior_only"]["false_alarm"]["n"] == 1


def test_missing_and_broken_products_are_counted_and_left_out(tmp_path: Path) -> None:
    for name in ("A", "B", "C"):
        (tmp_path / "answers").mkdir(exist_ok=True)
        (tmp_path / "answers" / f"{name}.json").write_text(json.dumps(answer("tank_heat")))
        (tmp_path / "products" / name).mkdir(parents=True)
    (tmp_path / "products" / "A" / "diagnosis.json").write_text(json.dumps(product("tank_heat")))
    (tmp_path / "products" / "B" / "diagnosis.json").write_text("{")
    cases, missing = load(tmp_path / "answers", tmp_path / "products")
    assert (len(cases), missing) == (1, ["B", "C"])
    assert "2 without a diagnosis" in table(score(cases, missing))
    assert "0 cases" in table(score([], missing))


def test_a_failed_diagnosis_is_wrong_wherever_something_should_have_been_found_and_claims_nothing(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "answers"
    folder.mkdir()
    for name, hidden in {"A": answer("tank_heat"), "B": answer(None, d=0.0), "C": answer("tank_heat")}.items():
        (folder / f"{name}.json").write_text(json.dumps(hidden))
    cases, missing = load(folder, tmp_path, {"A": "no pressure", "B": "no pressure"})
    result = score(cases, missing)
    assert (result["cases"], result["failed"], missing) == (2, 2, ["C"])
    for name, k in {"exact_name": 0, "twin_group": 0, "set90_coverage": 0, "no_source_on_none": 0, "false_alarm": 0,
                    "sure_and_wrong": 0}.items():  # fmt: skip
        assert result["figures"][name]["k"] == k, name
        assert result["figures"][name]["n"] > 0, name
    assert result["figures"]["set90_size"]["n"] == 0


def test_the_limits_of_the_calibration_error_hold_the_true_one_about_as_often_as_they_say() -> None:
    rng, hits = np.random.default_rng(3), 0
    for _ in range(200):
        stated = rng.uniform(0.3, 0.95, 400)
        names = np.where(rng.uniform(size=400) < stated - 0.1, "tank_heat", "n2_purge")
        cases = [Case(answer("tank_heat"), {"posterior": {str(n): p}}) for n, p in zip(names, stated, strict=True)]
        found = reliability(cases)[0]
        hits += found.low <= 0.1 <= found.high
    assert 0.90 <= hits / 200 <= 1.0


def test_quantiles_come_with_limits_that_hold_the_true_one() -> None:
    rng = np.random.default_rng(5)
    found = [quantile(rng.uniform(size=300), 0.9) for _ in range(300)]
    assert 0.91 <= np.mean([f.low <= 0.9 <= f.high for f in found]) <= 0.99
    assert quantile([3.0, 1.0, None], 1.0).value == 3.0


def test_a_paired_difference_knows_more_than_two_shares_apart() -> None:
    one = [True] * 80 + [False] * 20
    other = [True] * 70 + [False] * 30
    f = paired_share(one, other)
    assert f.value == pytest.approx(0.1)
    assert f.low > 0.0  # ten gained, none lost
    mixed = paired_share(one, [not x for x in one])
    assert mixed.high - mixed.low > 2 * (f.high - f.low)
