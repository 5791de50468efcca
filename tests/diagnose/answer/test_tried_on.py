"""How a test compares with those on which the diagnosis was tried."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.products.filled import filled

from hfanalysis.diagnose.answer.tried_on import NEAREST, Conditions, Row, mixed, rows, tried_on, tried_sentences
from hfanalysis.products.diagnosis import Diagnosis, TriedOn

SLOW, FAST = Conditions(50.0, 20.0, 2e-3, 8.0), Conditions(2000.0, 0.5, 2e-3, 8.0)


def table(slow_right: int, fast_right: int, each: int = 40) -> tuple[Row, ...]:
    """Tests by a slow and by a fast logger, all stated at 0.95, so many of which were right."""
    return tuple(
        Row(world, conditions, 0.95, i < right)
        for world, conditions, right in (("slow", SLOW, slow_right), ("fast", FAST, fast_right))
        for i in range(each)
    )


def test_a_test_is_compared_with_those_like_it() -> None:
    known = table(40, 20)
    of_slow, of_fast = (tried_on(one, known) for one in (replace(SLOW, rate=60.0), replace(FAST, rest=0.4)))
    assert of_slow is not None
    assert of_fast is not None
    assert (of_slow.like, of_slow.sure, of_slow.right) == (NEAREST, NEAREST, NEAREST)
    assert of_fast.right <= 20
    assert of_slow.outside == of_fast.outside == ()
    assert of_slow.misled == 0.0


@pytest.mark.parametrize(
    ("own", "said"),
    [
        (replace(SLOW, rate=10.0), "10 samples a second, tried with 50 to 2e+03"),
        (replace(SLOW, load=90.0), "90 kg of oxidizer, tried with 8 to 8"),
        (replace(SLOW, noise=0.02), "2 % of noise in a mean, tried with 0.2 to 0.2"),
        (replace(SLOW, lacks=("thrust",)), "none without thrust was tried"),
    ],
)
def test_outside_of_all_it_counts_as_the_worst_world(own: Conditions, said: str) -> None:
    found = tried_on(own, table(40, 30))
    assert found is not None
    assert found.outside == (said,)
    assert found.misled == pytest.approx(10.5 / 44.0)  # ten of forty wrong, and four more as the average, an eighth
    product = filled(Diagnosis, {"verdict": "named"}).but(tried_on=found)
    told = tried_sentences(product)
    assert said in told[0]
    assert "24 % of sure statements were wrong" in told[1]


@pytest.mark.parametrize("better", [{"rate": 20_000.0}, {"rest": 3600.0}, {"noise": 1e-5}])
def test_what_is_better_than_all_that_was_tried_is_not_outside(better: dict[str, float]) -> None:
    found = tried_on(replace(SLOW, **better), table(40, 30))
    assert found is not None
    assert found.outside == ()


def test_a_claim_is_told_with_how_often_such_were_right() -> None:
    found = TriedOn(rate=50.0, rest=20.0, noise=2e-3, load=8.0, like=30, sure=14, right=13)
    product = filled(Diagnosis, {"verdict": "named"}).but(tried_on=found)
    assert tried_sentences(product) == [
        "Of 14 statements above 0.9 on the 30 simulated tests most like this one 13 were right."
    ]
    assert tried_sentences(product.but(verdict="none")) == []
    assert tried_sentences(product.but(tried_on=None)) == []


def test_of_a_test_whose_conditions_are_not_known_nothing_is_said() -> None:
    assert tried_on(None, table(1, 1)) is None


@given(st.dictionaries(st.sampled_from("abcde"), st.floats(0.0, 1.0), min_size=1), st.floats(0.0, 0.9))
def test_no_probability_exceeds_what_held_in_the_worst_world(drawn: dict[str, float], misled: float) -> None:
    total = sum(drawn.values()) + 1.0
    posterior = {"none": 0.5 / total, "unknown": 0.5 / total, **{k: p / total for k, p in drawn.items()}}
    found = mixed(posterior, misled)
    assert sum(found.values()) == pytest.approx(1.0)
    assert max(found.values()) <= 1.0 - misled + misled * 0.6 + 1e-9
    assert list(found) == list(posterior)


def test_the_table_has_worlds_whose_loggers_and_loads_differ() -> None:
    known = rows()
    assert len(known) >= 60
    assert len({row.world for row in known}) >= 8
    assert {"thrust"} in [set(row.conditions.lacks) for row in known]
    assert sum(row.sure for row in known) >= 15
