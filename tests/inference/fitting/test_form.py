"""Sizes of the model-form error on the tank's side and of chamber and thrust."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.inference import made

from hfanalysis.diagnose.naming.base_model import base_model
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.search import Search
from hfanalysis.diagnose.naming.singles import singles_of
from hfanalysis.effects import effect
from hfanalysis.inference.candidate import SHORT, Bench, attempted, candidate
from hfanalysis.inference.fitting.form import COARSEST, FINEST, RATIO, STEPS, Form
from hfanalysis.inference.observations.recorded import TOGETHER

SIDES = st.integers(0, STEPS - 1)


@given(SIDES, SIDES)
def test_a_finer_form_is_one_step_on_both_sides_or_on_one(tank: int, chamber: int) -> None:
    form = Form(tank, chamber)
    steps = [finer for forms in form.finer for finer in forms]
    for finer in (*steps, *form.either_finer):
        assert finer != form
        assert form.tank - finer.tank in (0, 1)
        assert form.chamber - finer.chamber in (0, 1)
    assert (not form.finer) == (form == FINEST)
    assert len(form.either_finer) == (tank > 0) + (chamber > 0)
    assert len(set(steps)) == len(steps)


@given(SIDES, SIDES, st.booleans(), st.booleans())
def test_a_coarser_form_is_one_step_on_the_sides_asked_for(tank: int, chamber: int, one: bool, other: bool) -> None:
    coarser = Form(tank, chamber).coarser(one, other)
    assert coarser == Form(min(tank + one, STEPS - 1), min(chamber + other, STEPS - 1))
    assert COARSEST.coarser(one, other) == COARSEST


def test_each_step_is_three_times_as_large_on_its_side() -> None:
    tank, chamber = Form(2, 1).errors
    assert tank / FINEST.errors[0] == pytest.approx(RATIO**2)
    assert chamber / FINEST.errors[1] == pytest.approx(RATIO)


def test_the_error_of_one_side_leaves_the_other_s_readings_as_they_are() -> None:
    test = made.observed()
    coarse = Bench(test).at(Form(4, 0))
    for fine, c in zip(test.channels, coarse.channels, strict=True):
        same = np.array_equal(fine.form_covariance(test.errors), c.form_covariance(coarse.errors))
        assert same == (c.name in TOGETHER)


def test_what_is_left_open_is_told_by_side() -> None:
    test = made.observed()
    residual = np.concatenate([np.full(c.time.size, 2.0 if c.name in TOGETHER else 1.0) for c in test.channels])
    assert test.left_open(np.append(residual, 50.0)) == (pytest.approx(1.0), pytest.approx(4.0))
    assert test.only(("p_tank",)).left_open(np.ones(test.channels[0].time.size))[1] == 0.0


def test_a_tank_that_is_badly_understood_hides_nothing_in_the_chamber() -> None:
    """Heat into the tank that no name may explain, and a throat that erodes."""
    hidden = effect("tank_heat").at(power=6000.0), effect("nozzle_throat_erosion").at(rate=1.5e-4)
    bench = Bench(made.observed(*hidden))
    library = Catalogue({"nozzle_throat_erosion": effect("nozzle_throat_erosion")}, {})
    base, starts = base_model(made.hypothesis(), bench)
    singles = singles_of(base, starts, Search(bench, library))
    assert base.form.tank > 0
    assert singles[0].form.chamber < singles[0].form.tank
    coarse = Form(singles[0].form.tank, singles[0].form.tank)
    gains = {}
    for form in (singles[0].form, coarse):
        fits = [attempted(c.fit.hypothesis, bench.at(form), c.fit.x, SHORT) for c in (singles[0], base)]
        with_it, without = (candidate((), f, form).log_evidence for f in fits if f is not None)
        gains[form] = with_it - without
    assert gains[singles[0].form] > 2.0 * gains[coarse]
