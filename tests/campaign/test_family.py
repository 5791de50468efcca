"""Which test does not fit the rest, and which left the family."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.campaign.rows import made

from hfanalysis.campaign.conclusions import conclusions
from hfanalysis.campaign.family import FAMILY, left_the_family, odd_one
from hfanalysis.campaign.special import special
from hfanalysis.products.campaign import CommonLaw, Odd
from hfanalysis.quantity import Quantity


def family(rng: np.random.Generator, count: int, odd: float = 0.0, between: float = 0.0) -> dict[str, Quantity]:
    """Numbers of tests with deviations of 1 to 2 %, of which the first is off by a share."""
    stds = rng.uniform(0.01, 0.02, count)
    values = 1.0 + stds * rng.standard_normal(count) + between * rng.standard_normal(count)
    values[0] += odd
    return {f"T{i}": Quantity(float(v), "m/s", float(s)) for i, (v, s) in enumerate(zip(values, stds, strict=True))}


@pytest.mark.parametrize(
    ("count", "between", "most"), [(4, 0.0, 0.05), (7, 0.0, 0.05), (10, 0.0, 0.05), (4, 0.1, 0.35), (10, 0.1, 0.1)]
)
def test_sets_without_an_odd_one_rarely_name_one(count: int, between: float, most: float) -> None:
    """Also where tests differ by far more than they state: then they are no family, but of four three may look it."""
    rng = np.random.default_rng(11)
    named = sum(odd_one(family(rng, count, between=between)) is not None for _ in range(1000))
    assert named <= most * 1000


@pytest.mark.parametrize("count", [4, 7, 10])
def test_a_tenth_off_is_named(count: int) -> None:
    rng = np.random.default_rng(12)
    found = [odd_one(family(rng, count, odd=-0.1)) for _ in range(400)]
    assert sum(one is not None and one.test == "T0" for one in found) >= 0.9 * 400
    assert all(one.apart.value < 0.0 for one in found if one is not None and one.test == "T0" and one.apart.value)


def test_of_three_none_is_odd() -> None:
    assert odd_one({f"T{i}": Quantity(float(i), "", 0.01) for i in range(3)}) is None
    assert odd_one({f"T{i}": Quantity(float(i), "") for i in range(6)}) is None  # nobody knows how well each is known


def test_two_that_differ_are_no_odd_one() -> None:
    level = {f"T{i}": Quantity(1.0, "", 0.01) for i in range(6)}
    assert odd_one({**level, "X": Quantity(1.2, "", 0.01), "Y": Quantity(0.8, "", 0.01)}) is None


@given(st.lists(st.floats(0.5, 2.0), min_size=4, max_size=8), st.floats(1e-3, 1e3))
def test_the_unit_of_a_number_does_not_matter(values: list[float], factor: float) -> None:
    found = {f"T{i}": Quantity(v, "", 0.05) for i, v in enumerate(values)}
    scaled = {test: Quantity(factor * (q.value or 0.0), "", factor * 0.05) for test, q in found.items()}
    one, other = odd_one(found), odd_one(scaled)
    assert (one and one.test) == (other and other.test)


@pytest.mark.parametrize("count", [FAMILY, 12, 30])
def test_families_rarely_lose_one_by_chance(count: int) -> None:
    rng = np.random.default_rng(13)
    assert sum(bool(left_the_family(list(rng.standard_normal(count)))) for _ in range(2000)) <= 0.06 * 2000


def test_one_that_leaves_is_seen_where_there_is_a_family() -> None:
    rng = np.random.default_rng(14)
    values = list(rng.standard_normal(11))
    values[6] += 12.0
    assert left_the_family(values) == [6]
    assert left_the_family([*[0.0] * (FAMILY - 2), 9.0]) == []
    assert left_the_family([*[0.0] * 9, 0.001]) == []  # a step of the converter


def test_an_effect_that_one_test_alone_has_sets_it_apart(tmp_path: Path) -> None:
    rows = dict(made(tmp_path).tests)
    rows.pop("D")
    rows["C"], rows["A"] = rows["A"], rows["C"]
    rows["B"] = rows["A"]
    assert "the only one in which heat into the tank is named" in special("C", rows)
    assert not any("is named" in words for words in special("A", rows))


def test_what_else_sets_it_apart_is_said(tmp_path: Path) -> None:
    product = made(tmp_path)
    rows = dict(product.tests)
    rows.pop("D")
    rows["C"] = rows["C"].but(
        date="2026-05-01", injector_area=3e-5, performance={"burn_time": Quantity(9.0, "s", 0.05)}
    )
    for name in "AB":
        rows[name] = rows[name].but(date="2026-04-01", injector_area=2e-5)
    told = list(special("C", rows))
    assert told == ["the only one with its injector", "the last test", "the longest burn"]
    assert list(special("A", rows))[-1:] != ["the longest burn"]
    stand = product.stands["cell 3"]
    odd = Odd(test="C", apart=Quantity(0.08, "", 0.002), of=Quantity(0.3, ""), probability=1e-5, special=tuple(told))
    other = stand.but(constants={"C_i": stand.constants["C_i"].but(odd=odd, left=("C",))})
    said = conclusions(other, product.tests)
    assert (
        "C does not fit the rest: its effective injector coefficient is 26.7 ± 0.7 % above theirs "
        "(by chance: less than 0.001)." in said
    )
    assert "What else sets it apart: the only one with its injector, the last test and the longest burn." in said
    assert any(line.startswith("C left the family of the effective injector coefficient") for line in said)
    none = stand.but(constants={"C_i": stand.constants["C_i"].but(odd=odd.but(of=Quantity(0.0, "")))})
    assert "C does not fit the rest: its effective injector coefficient is not zero, as theirs is." in conclusions(
        none, product.tests
    )
    of_law = stand.but(regression=CommonLaw.model_construct(odd=odd.but(special=()), flux=220.0))
    said = conclusions(of_law, product.tests)
    assert any("its regression rate at 220 kg/(m² s) is" in line for line in said)
    assert "Nothing else that is known sets it apart: look at its fuel, its injector and its sensors." in said
