"""Departures of the table of nitrous oxide, and of laws, as constants of a hypothesis."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, reduce

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.engine.stand import engine_on_stand
from tests.inference import made

from hfanalysis.engine.effect import Parameter
from hfanalysis.inference.fitting.departures import with_departures
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.laws import LAWS
from hfanalysis.inference.fitting.predict import predict
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.thermo.departures import DEPARTURES, Departure, departed
from hfanalysis.thermo.saturation import Saturation

Array = NDArray[np.float64]

OFF = (4.0, 4.0, -4.0, 4.0, -4.0, -4.0, -4.0, 4.0)
"""Standard deviations by which a made-up table departs."""

COST = 0.65
"""Log evidence that a departure may cost which is none: all hypotheses have the same ones."""


def table_of(saturation: Saturation) -> Saturation:
    """The table that is OFF."""
    scaled = [replace(by, level=k * by.level, slope=k * by.slope) for k, by in zip(OFF, DEPARTURES, strict=True)]
    return reduce(departed, scaled, saturation)


@cache
def ready() -> tuple[Hypothesis, Observed]:
    return with_departures(made.hypothesis(), made.observed())


@cache
def elsewhere() -> Observed:
    """A test of the stand's engine on nitrous oxide by another table."""
    engine = engine_on_stand()
    return made.observed(engine=replace(engine, saturation=table_of(engine.saturation)))


def test_the_departures_are_constants_of_their_own() -> None:
    hypothesis, observed = ready()
    names = [*(f"table: {by.name}" for by in DEPARTURES), *(f"law: {law.name}" for law in LAWS.parameters)]
    assert [hypothesis.names[i] for i in hypothesis.of_departures] == [f"departure: {name}" for name in names]
    assert hypothesis.nuisances == hypothesis.size == made.hypothesis().size + len(names)
    assert not {hypothesis.names[i] for i in hypothesis.of_departures} & set(hypothesis.of_engine)
    assert all(c.departures is not None for c in observed.channels)
    assert {c.departures.shape[1] for c in observed.channels if c.departures is not None} == {len(names)}


@pytest.mark.parametrize("which", range(len(DEPARTURES)), ids=lambda i: DEPARTURES[i].name)
def test_what_a_departure_adds_is_what_a_run_by_such_a_table_reads(which: int) -> None:
    hypothesis, observed = ready()
    x = np.zeros(hypothesis.size)
    by, base = DEPARTURES[which], made.hypothesis()
    engine = replace(base.engine, saturation=departed(base.engine.saturation, _twice(by)))
    there = predict(replace(base, engine=engine), observed, x[: base.size], tangents=False).residual
    without = predict(hypothesis, observed, x, tangents=False).residual
    x[hypothesis.of_departures[which]] = 2.0
    added = predict(hypothesis, observed, x, tangents=False).residual
    assert np.abs(there - without).max() > 0.05
    assert added == pytest.approx(there, abs=0.05 * float(np.abs(there - without).max()))


def with_a_law(law: Parameter) -> tuple[Array, Array, Array]:
    """Residuals (observations,) of a law that departs by two deviations: by a run, by the departure, and without."""
    hypothesis, observed = ready()
    x, base = np.zeros(hypothesis.size), made.hypothesis()
    engine = replace(base.engine, effects=(LAWS.at(**{law.name: 2.0 * law.typical}),))
    there = predict(replace(base, engine=engine), observed, x[: base.size], tangents=False).residual
    without = predict(hypothesis, observed, x, tangents=False).residual
    x[hypothesis.names.index(f"departure: law: {law.name}")] = 2.0
    return there, predict(hypothesis, observed, x, tangents=False).residual, without


@pytest.mark.parametrize("law", LAWS.parameters, ids=lambda law: law.name)
def test_what_a_law_adds_is_what_an_engine_of_that_law_reads(law: Parameter) -> None:
    there, added, without = with_a_law(law)
    blocks = slice(sum(c.time.size for c in ready()[1].channels))  # what was weighed is left to the constants
    off, whole = (added - there)[blocks], (there - without)[blocks]
    assert np.abs(whole).max() > 0.05
    assert np.sqrt(np.mean(off**2)) < 0.15 * np.sqrt(np.mean(whole**2))


@pytest.mark.parametrize("name", ["port", "fuel's flux"])
def test_a_law_of_the_regression_moves_the_end_of_the_fuel(name: str) -> None:
    observed = ready()[1]
    there, added, without = with_a_law(next(law for law in LAWS.parameters if law.name == name))
    row = sum(c.time.size for c in observed.channels) + list(observed.events).index("t_fuel_out")
    assert abs(there[row] - without[row]) > 0.1
    assert added[row] - without[row] == pytest.approx(there[row] - without[row], rel=0.15)


def test_without_a_departure_the_laws_are_the_base_model_s() -> None:
    base, observed = made.hypothesis(), made.observed()
    idle = replace(base, engine=replace(base.engine, effects=(LAWS.at(),)))
    one, other = (predict(h, observed, np.zeros(base.size), tangents=False).residual for h in (base, idle))
    assert one == pytest.approx(other, abs=2e-3)


def test_another_law_is_no_effect_where_laws_may_depart() -> None:
    """A line whose loss goes with a power of 1.8 of the flow, a vapor of another coefficient, and c* that goes with the
    mixture: with the base model's laws that asks for something, with what they may be it does not."""
    laws = LAWS.at(loss=-0.2, vapor=0.06, mixture=0.04)
    engine = engine_on_stand()
    fixed, observed = made.hypothesis(), made.observed(engine=replace(engine, effects=(laws,)))
    free, told = with_departures(fixed, observed)
    without, found = fit(fixed, observed), fit(free, told)
    assert found.log_evidence > without.log_evidence + 10.0
    assert float(found.residual @ found.residual) / found.residual.size < 1.2


def _twice(by: Departure) -> Departure:
    return replace(by, level=2.0 * by.level, slope=2.0 * by.slope)


def test_slopes_are_those_of_the_residual() -> None:
    hypothesis, observed = ready()
    x = np.zeros(hypothesis.size)
    here = predict(hypothesis, observed, x, tangents=True)
    assert here.slopes is not None
    for place in hypothesis.of_departures:
        moved = x.copy()
        moved[place] = 1.0
        there = predict(hypothesis, observed, moved, tangents=False)
        assert there.residual - here.residual == pytest.approx(here.slopes[:, place], abs=1e-8)


def test_blocks_that_are_left_out_take_their_part_along() -> None:
    hypothesis, observed = ready()
    half = observed.without({c.name: c.time > 2.0 for c in observed.channels})
    assert all(c.departures is not None and c.departures.shape[0] == c.time.size for c in half.channels)
    assert predict(hypothesis, half, np.zeros(hypothesis.size), tangents=True).slopes is not None


def test_another_table_is_no_effect_where_tables_may_depart_and_is_one_where_not() -> None:
    fixed, observed = made.hypothesis(), elsewhere()
    free, told = with_departures(fixed, observed)
    without, found = fit(fixed, observed), fit(free, told)
    assert found.log_evidence > without.log_evidence + 10.0 - COST * len(LAWS.parameters)
    assert float(found.residual @ found.residual) / found.residual.size < 1.1
    departures = found.x[free.of_departures]
    assert float(np.linalg.norm(departures)) > 1.0


def test_a_table_that_is_right_costs_little() -> None:
    hypothesis, observed = ready()
    fixed = made.hypothesis()
    cost = fit(fixed, observed).log_evidence - fit(hypothesis, observed).log_evidence
    assert abs(cost) < COST * len(hypothesis.of_departures)


def test_what_cannot_be_run_is_left_as_it_is() -> None:
    hypothesis, observed = made.hypothesis(), made.observed()
    feed = replace(hypothesis.engine.feed, volume=1e-3)  # the load does not fit in
    broken = replace(hypothesis, engine=replace(hypothesis.engine, feed=feed))
    same, observations = with_departures(broken, observed)
    assert same is broken
    assert observations is observed
