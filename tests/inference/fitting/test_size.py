"""How large an effect is, as something that nobody knows beforehand."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from numpy.typing import NDArray
from scipy.stats import norm
from tests.inference import made

from hfanalysis.effects import effect
from hfanalysis.inference.fitting.hypothesis import DEPARTURE, OF_LAW, Free
from hfanalysis.inference.fitting.size import HOW_MANY, OF_LAWS, SIZES, of_any_size

Array = NDArray[np.float64]

PRECISE = some.floats(1.5, 1e7)
FAR = some.floats(-3.0, 3.0)


def integral(precision: float, x: float, size: float) -> float:
    """Of the likelihood whose product with N(0, 1) has its mean at ``x`` and this ``precision``, times N(0, size)."""
    if size == 0.0:
        return 1.0
    likelihood, pull = precision - 1.0, precision * x
    precise = likelihood + size**-2
    middle, width = pull / precise, precise**-0.5
    v = middle + width * np.linspace(-12.0, 12.0, 4001)
    height = np.exp(-0.5 * likelihood * v**2 + pull * v - 0.5 * pull * middle)
    total = float(np.sum(height * norm.pdf(v, scale=size)) * (v[1] - v[0]))
    return total * float(np.exp(0.5 * pull * middle))


@given(some.floats(1.5, 1e4), some.floats(-0.25, 0.25))
def test_the_change_is_that_of_an_integral_over_the_mixture(precision: float, x: float) -> None:
    mixed = np.mean([integral(precision, x, size) for size in SIZES])
    change = of_any_size(np.array([[precision]]), np.array([x]), [1])
    assert change == pytest.approx(float(np.log(mixed / integral(precision, x, 1.0))), abs=1e-6)


def test_of_several_strengths_most_are_nothing() -> None:
    precisions, x = np.array([900.0, 400.0, 100.0]), np.array([0.1, 0.02, -0.15])
    total = 0.0
    for number, share in enumerate(HOW_MANY, 1):
        among = list(combinations(range(3), number))
        for which in among:
            for size in SIZES:
                sizes = [size if i in which else 0.0 for i in range(3)]
                one = np.prod([integral(p, at, s) for p, at, s in zip(precisions, x, sizes, strict=True)])
                total += share / len(among) / len(SIZES) * float(one)
    as_it_is = np.prod([integral(p, at, 1.0) for p, at in zip(precisions, x, strict=True)])
    change = of_any_size(np.diag(precisions), x, [3])
    assert change == pytest.approx(float(np.log(total / as_it_is)), abs=1e-6)


@given(PRECISE, FAR, PRECISE, FAR)
def test_independent_effects_change_each_by_its_own(one: float, x: float, other: float, y: float) -> None:
    both = of_any_size(np.diag([one, other]), np.array([x, y]), [1, 1])
    alone = [of_any_size(np.array([[p]]), np.array([at]), [1]) for p, at in ((one, x), (other, y))]
    assert both == pytest.approx(sum(alone), rel=1e-6, abs=1e-6)


@given(PRECISE, FAR)
def test_an_effect_of_typical_size_loses_the_odds_of_the_other_sizes_at_most(precision: float, x: float) -> None:
    change = of_any_size(np.array([[precision]]), np.array([x]), [1])
    assert -np.log(len(SIZES)) - 1e-9 <= change


def test_a_weak_effect_that_is_seen_clearly_pays_no_more_than_a_strong_one() -> None:
    """Both of d' = 8; a fit takes the weak one to be a lucky guess among a hundred."""

    def cost(strength: float) -> float:
        precision = (8.0 / strength) ** 2
        taken = -0.5 * np.log(precision) - 0.5 * strength**2  # the prior's share in Laplace's approximation
        return float(taken + of_any_size(np.array([[precision]]), np.array([strength]), [1]))

    assert cost(0.01) == pytest.approx(cost(0.3), abs=0.5)
    assert cost(0.01) > cost(1.0) - 0.5
    assert -0.5 * np.log((8.0 / 0.01) ** 2) < cost(0.01) - 2.5


def test_the_base_model_has_no_strengths() -> None:
    assert made.hypothesis().strengths == []
    assert of_any_size(np.zeros((0, 0)), np.zeros(0), []) == 0.0


def test_strengths_of_one_effect_go_together() -> None:
    hypothesis = made.hypothesis().with_effect(effect("pressure_transducer_offset")).with_effect(effect("tank_heat"))
    names = [[hypothesis.names[i] for i in group] for group in hypothesis.strengths]
    assert names == [
        [f"pressure_transducer_offset.{channel}" for channel in ("p_tank", "p_run", "p_chamber")],
        ["tank_heat.power"],
    ]


def test_where_no_other_law_departs_one_hardly_does() -> None:
    """Ten laws, nine of which a test shows to be the library's: that the tenth is off by a deviation costs more."""
    precise = np.diag(np.full(10, 1e4))
    exact = of_any_size(precise, np.zeros(10), [], laws=10)
    one_off = of_any_size(precise, np.eye(10)[0], [], laws=10)
    all_off = of_any_size(precise, np.ones(10), [], laws=10)
    unseen = of_any_size(np.eye(10), np.zeros(10), [], laws=10)
    assert exact > one_off + 10.0
    assert all_off == pytest.approx(-np.log(len(OF_LAWS)), abs=1e-6)
    assert unseen == pytest.approx(0.0, abs=1e-9)


@given(PRECISE, FAR, PRECISE, FAR)
def test_an_effect_and_laws_change_each_by_their_own(one: float, x: float, law: float, y: float) -> None:
    both = of_any_size(np.diag([one, law]), np.array([x, y]), [1], laws=1)
    alone = of_any_size(np.array([[one]]), np.array([x]), [1])
    assert both == pytest.approx(alone + of_any_size(np.array([[law]]), np.array([y]), [], 1), rel=1e-6, abs=1e-6)


def test_only_departures_of_laws_are_of_one_size_together() -> None:
    table, law = Free(f"{DEPARTURE}table: pressure", 0.0, 1.0), Free(f"{OF_LAW}loss", 0.0, 1.0)
    hypothesis = made.hypothesis()
    hypothesis = replace(hypothesis, free=(*hypothesis.free, table, law))
    assert [hypothesis.names[i] for i in hypothesis.of_laws] == [law.name]
    assert [hypothesis.names[i] for i in hypothesis.of_departures] == [table.name, law.name]
