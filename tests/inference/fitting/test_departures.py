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
from hfanalysis.inference.fitting.departures import with_departures, with_its_laws
from hfanalysis.inference.fitting.fit import Fit, fit
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.laws import LAWS, engine_by_laws
from hfanalysis.inference.fitting.predict import FINE, added, predict
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
    observed = made.observed()
    return with_departures(made.hypothesis(), observed), observed


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
    assert hypothesis.departures is not None
    reads = hypothesis.departures.reads
    assert {name: read.shape for name, read in reads.items()} == {
        c.name: (observed.grid.size, len(names)) for c in observed.channels
    }


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
    without, found = fit(fixed, observed), fit(with_departures(fixed, observed), observed)
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
    x = np.zeros(hypothesis.size)
    x[hypothesis.of_departures] = 1.0
    for channel, whole in zip(half.channels, observed.channels, strict=True):
        kept = np.isin(whole.time, channel.time)
        assert 0 < kept.sum() < kept.size
        one, other = added(hypothesis, half, x, channel), added(hypothesis, observed, x, whole)[kept]
        assert one == pytest.approx(other, abs=1e-9 * float(np.abs(other).max()))


def test_another_table_is_no_effect_where_tables_may_depart_and_is_one_where_not() -> None:
    fixed, observed = made.hypothesis(), elsewhere()
    free = with_departures(fixed, observed)
    without, found = fit(fixed, observed), fit(free, observed)
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
    assert with_departures(broken, observed) is broken


@cache
def far() -> tuple[Fit, Observed]:
    """A fit by linear laws to a test of an engine whose laws depart far."""
    laws = LAWS.at(**{law.name: 1.5 * law.typical for law in LAWS.parameters})
    observed = made.observed(engine=replace(engine_on_stand(), effects=(laws,)))
    return fit(with_departures(made.hypothesis(), observed), observed), observed


def test_laws_that_depart_far_are_run() -> None:
    linear, observed = far()
    hypothesis = with_its_laws(linear, observed)
    assert hypothesis is not None
    assert hypothesis.runs_laws
    assert hypothesis.names == linear.hypothesis.names
    assert with_its_laws(fit(hypothesis, observed, linear.x), observed) is None


def test_a_run_by_laws_is_that_of_an_engine_that_has_them() -> None:
    linear, observed = far()
    hypothesis = with_its_laws(linear, observed)
    assert hypothesis is not None
    x = linear.x.copy()
    x[[i for i in hypothesis.of_departures if i not in hypothesis.of_laws]] = 0.0
    engine = engine_by_laws(replace(hypothesis, departures=None).at(x), x[hypothesis.of_laws])
    fixed = replace(made.hypothesis(), engine=engine, free=())
    own, other = (predict(h, observed, at, tangents=False).residual for h, at in ((hypothesis, x), (fixed, x[:0])))
    assert own == pytest.approx(other, abs=1e-9)


def test_slopes_with_laws_that_are_run_are_those_of_the_residual() -> None:
    linear, observed = far()
    hypothesis = with_its_laws(linear, observed)
    assert hypothesis is not None
    here = predict(hypothesis, observed, linear.x, tangents=True, accuracy=FINE)
    assert here.slopes is not None
    for place in hypothesis.of_laws:
        moved = linear.x.copy()
        moved[place] += 1e-2
        there = predict(hypothesis, observed, moved, tangents=False, accuracy=FINE)
        found = (there.residual - here.residual) / 1e-2
        assert found == pytest.approx(here.slopes[:, place], abs=0.02 * float(np.abs(found).max()) + 1e-3)


def test_laws_that_hardly_depart_stay_linear() -> None:
    linear, observed = far()
    hardly = linear.x.copy()
    hardly[linear.hypothesis.of_laws] *= 0.05
    assert with_its_laws(replace(linear, x=hardly), observed) is None
