"""Departures of the table of nitrous oxide as constants of a hypothesis."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, reduce

import numpy as np
import pytest
from tests.engine.stand import engine_on_stand
from tests.inference import made

from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import predict
from hfanalysis.inference.fitting.tables import with_other_tables
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.thermo.departures import DEPARTURES, Departure, departed
from hfanalysis.thermo.saturation import Saturation

OFF = (4.0, 4.0, -4.0, 4.0, -4.0, -4.0, -4.0, 4.0)
"""Standard deviations by which a made-up table departs."""


def table_of(saturation: Saturation) -> Saturation:
    """The table that is OFF."""
    scaled = [replace(by, level=k * by.level, slope=k * by.slope) for k, by in zip(OFF, DEPARTURES, strict=True)]
    return reduce(departed, scaled, saturation)


@cache
def ready() -> tuple[Hypothesis, Observed]:
    return with_other_tables(made.hypothesis(), made.observed())


@cache
def elsewhere() -> Observed:
    """A test of the stand's engine on nitrous oxide by another table."""
    engine = engine_on_stand()
    return made.observed(engine=replace(engine, saturation=table_of(engine.saturation)))


def test_the_departures_are_constants_of_their_own() -> None:
    hypothesis, observed = ready()
    assert [hypothesis.names[i] for i in hypothesis.of_tables] == [f"table: {by.name}" for by in DEPARTURES]
    assert hypothesis.nuisances == hypothesis.size == made.hypothesis().size + len(DEPARTURES)
    assert not {hypothesis.names[i] for i in hypothesis.of_tables} & set(hypothesis.of_engine)
    assert all(c.tables is not None and c.tables.shape == (c.time.size, len(DEPARTURES)) for c in observed.channels)


@pytest.mark.parametrize("which", range(len(DEPARTURES)), ids=lambda i: DEPARTURES[i].name)
def test_what_a_departure_adds_is_what_a_run_by_such_a_table_reads(which: int) -> None:
    hypothesis, observed = ready()
    x = np.zeros(hypothesis.size)
    by, base = DEPARTURES[which], made.hypothesis()
    engine = replace(base.engine, saturation=departed(base.engine.saturation, _twice(by)))
    there = predict(replace(base, engine=engine), observed, x[: base.size], tangents=False).residual
    without = predict(hypothesis, observed, x, tangents=False).residual
    x[hypothesis.of_tables[which]] = 2.0
    added = predict(hypothesis, observed, x, tangents=False).residual
    assert np.abs(there - without).max() > 0.05
    assert added == pytest.approx(there, abs=0.05 * float(np.abs(there - without).max()))


def _twice(by: Departure) -> Departure:
    return replace(by, level=2.0 * by.level, slope=2.0 * by.slope)


def test_slopes_are_those_of_the_residual() -> None:
    hypothesis, observed = ready()
    x = np.zeros(hypothesis.size)
    here = predict(hypothesis, observed, x, tangents=True)
    assert here.slopes is not None
    for place in hypothesis.of_tables:
        moved = x.copy()
        moved[place] = 1.0
        there = predict(hypothesis, observed, moved, tangents=False)
        assert there.residual - here.residual == pytest.approx(here.slopes[:, place], abs=1e-8)


def test_blocks_that_are_left_out_take_their_part_along() -> None:
    hypothesis, observed = ready()
    half = observed.without({c.name: c.time > 2.0 for c in observed.channels})
    assert all(c.tables is not None and c.tables.shape[0] == c.time.size for c in half.channels)
    assert predict(hypothesis, half, np.zeros(hypothesis.size), tangents=True).slopes is not None


def test_another_table_is_no_effect_where_tables_may_depart_and_is_one_where_not() -> None:
    fixed, observed = made.hypothesis(), elsewhere()
    free, told = with_other_tables(fixed, observed)
    without, found = fit(fixed, observed), fit(free, told)
    assert found.log_evidence > without.log_evidence + 10.0
    assert float(found.residual @ found.residual) / found.residual.size < 1.1
    departures = found.x[free.of_tables]
    assert float(np.linalg.norm(departures)) > 1.0


def test_a_table_that_is_right_costs_little() -> None:
    hypothesis, observed = ready()
    fixed = made.hypothesis()
    assert fit(hypothesis, observed).log_evidence == pytest.approx(fit(fixed, observed).log_evidence, abs=5.0)


def test_what_cannot_be_run_is_left_as_it_is() -> None:
    hypothesis, observed = made.hypothesis(), made.observed()
    feed = replace(hypothesis.engine.feed, volume=1e-3)  # the load does not fit in
    broken = replace(hypothesis, engine=replace(hypothesis.engine, feed=feed))
    same, observations = with_other_tables(broken, observed)
    assert same is broken
    assert observations is observed
