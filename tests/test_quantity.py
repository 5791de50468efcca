"""A quantity that contradicts itself cannot be made."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.quantity import DOUBTED, IDENTIFIED, NOT_IDENTIFIABLE, STATED, UNPHYSICAL, Quantity

NUMBERS = st.floats(-1e9, 1e9)
SPREADS = st.floats(0.0, 1e9)
VERDICTS = st.sampled_from([IDENTIFIED, NOT_IDENTIFIABLE, UNPHYSICAL, STATED, DOUBTED, None])


def made(value: float, low: float, high: float, verdict: str | None) -> Quantity | None:
    try:
        return Quantity(value, "m", 1.0, (low, high), verdict=verdict)
    except ValueError:
        return None


@given(NUMBERS, NUMBERS, NUMBERS, VERDICTS)
def test_a_value_lies_in_its_interval_and_what_is_not_told_from_zero_is_not_identified(
    value: float, low: float, high: float, verdict: str | None
) -> None:
    found = made(value, low, high, verdict)
    assert (found is None) == (not low <= value <= high)
    if found is not None and low <= 0.0 <= high:
        assert found.verdict != IDENTIFIED
        assert found.verdict == (NOT_IDENTIFIABLE if verdict == IDENTIFIED else verdict)


@given(NUMBERS, SPREADS, VERDICTS, NUMBERS)
def test_a_doubt_widens_and_keeps_the_value_in(value: float, std: float, verdict: str | None, other: float) -> None:
    before = Quantity(value, "m", std, verdict=verdict)
    found = before.doubted("why", (other, other))
    assert before.interval is not None
    assert found.interval is not None
    assert found.interval[0] <= min(before.interval[0], other)
    assert found.interval[1] >= max(before.interval[1], other)
    assert (found.value, found.std is not None and found.std >= std) == (value, True)
    assert found.verdict not in (IDENTIFIED, None)
    assert "why" in (found.why or "")


def test_a_worse_verdict_stays_beside_a_doubt() -> None:
    found = Quantity(1.0, "", 0.1, verdict=UNPHYSICAL, why="too large").doubted("the gauge is off")
    assert (found.verdict, found.why) == (UNPHYSICAL, "the gauge is off; too large")


@pytest.mark.parametrize("std", [-1.0, math.nan, math.inf])
def test_a_deviation_is_a_number_that_is_not_negative(std: float) -> None:
    with pytest.raises(ValueError, match="standard deviation"):
        Quantity(1.0, "", std)


def test_what_is_not_told_from_zero_says_so_before_all_else() -> None:
    assert Quantity(0.04, "", 0.03, verdict=IDENTIFIED, why="from p_c").why == "its 95 % interval holds zero; from p_c"
