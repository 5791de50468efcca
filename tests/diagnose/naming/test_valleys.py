"""Two valleys of one candidate: which is told does not hang on last digits, and its intervals reach over both."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.inference import made

from hfanalysis.diagnose.diagnosis import _two_tops
from hfanalysis.diagnose.naming import valleys
from hfanalysis.diagnose.naming.valleys import among_valleys, told_otherwise, with_exponent
from hfanalysis.effects import effect
from hfanalysis.inference.candidate import Bench, Candidate, candidate, price
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.form import FINEST, Form

EROSION = effect("nozzle_throat_erosion")


@cache
def bench() -> Bench:
    return Bench(made.observed(EROSION.at(rate=1e-4)))


@cache
def eroding() -> Candidate:
    return candidate((EROSION.name,), fit(made.hypothesis().with_effect(EROSION), bench().observed), FINEST)


def place_of_n() -> int:
    return [f.name for f in eroding().fit.hypothesis.free].index("n")


def elsewhere(n: float, evidence: float, form: Form = FINEST) -> Candidate:
    """The same with n moved by so many standard deviations of its prior, and so much more evidence."""
    one = eroding()
    x = one.fit.x.copy()
    x[place_of_n()] += n
    return replace(one, fit=replace(one.fit, x=x, log_evidence=one.fit.log_evidence + evidence), form=form)


@pytest.mark.parametrize("last_digits", [-1e-3, 1e-3])
@pytest.mark.parametrize("order", [1, -1])
def test_which_of_two_is_told_does_not_hang_on_where_the_search_came_from(
    monkeypatch: pytest.MonkeyPatch, last_digits: float, order: int
) -> None:
    two = [elsewhere(0.0, last_digits), elsewhere(-1.0, 0.0, Form(0, 1))]
    two[1] = replace(two[1], fit=replace(two[1].fit, log_evidence=two[1].fit.log_evidence + price(two[1].form)))
    monkeypatch.setattr(valleys, "_valleys", lambda *_: two[::order])
    told = among_valleys(two[::order][0], bench())
    assert told.form == Form(0, 1)
    assert told.fit.values["n"] == two[1].fit.values["n"]
    own, apart = two[1].fit.stds["n"], two[0].fit.values["n"] - two[1].fit.values["n"]
    assert told.fit.stds["n"] == pytest.approx(np.hypot(own, np.sqrt(0.5) * apart), rel=0.02)
    weight, elsewhere_told = told_otherwise(told)
    here, there = elsewhere_told["n"]
    assert weight == pytest.approx(0.5, abs=0.01)
    assert there - here == pytest.approx(apart)
    (note,) = _two_tops(told)
    assert f"n {here:.3g}" in note
    assert "or with probability 0.5 n " in note
    assert "the intervals reach over both" in note


def test_a_deeper_valley_is_told_and_alone_where_the_other_is_far_less_probable(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    shallow, deep = elsewhere(0.0, 0.0), elsewhere(-1.0, 12.0)
    monkeypatch.setattr(valleys, "_valleys", lambda *_: [shallow, deep])
    told = among_valleys(replace(shallow, log_evidence=50.0), bench())
    assert told.fit.values["n"] == deep.fit.values["n"]
    assert told.log_evidence == pytest.approx(62.0)
    assert told.fit.stds["n"] == pytest.approx(deep.fit.stds["n"], rel=0.05)
    assert told_otherwise(told)[1] == {}
    assert _two_tops(told) == []


def test_a_candidate_that_its_neighbors_come_back_to_stays_as_it_is() -> None:
    """Its intervals are no narrower than its own."""
    found = bench().told(eroding())
    told = among_valleys(found, bench())
    assert told.form == found.form
    assert told.log_evidence == pytest.approx(found.log_evidence)
    assert told.fit.values == pytest.approx(found.fit.values)
    for name, std in found.fit.stds.items():
        assert told.fit.stds[name] > 0.9 * std


def test_n_is_not_held_where_it_cannot_be() -> None:
    assert with_exponent(eroding(), 100.0, bench().observed) is None


def stopped() -> Candidate:
    """A fit at the finest form that was stopped on its way, far from its end."""
    hypothesis = made.hypothesis().with_effect(EROSION)
    found = fit(hypothesis, bench().observed, np.full(hypothesis.size, 0.3), 1)
    assert not found.converged
    return candidate((EROSION.name,), found, FINEST)


@pytest.mark.parametrize(("beyond", "gone_on"), [(1.0, True), (1e4, False)])
def test_a_form_is_not_left_because_a_fit_to_it_was_stopped_on_its_way(
    monkeypatch: pytest.MonkeyPatch, beyond: float, gone_on: bool
) -> None:
    """It is gone on with where its slopes promise more than the candidate has, which it has not reached yet."""
    half_way = stopped()
    monkeypatch.setattr(Bench, "refitted", lambda *_: half_way)
    has = replace(eroding(), form=Form(1, 1), log_evidence=half_way.log_evidence + beyond)
    assert (bench().reach(half_way) > has.log_evidence) is gone_on
    (again,) = bench()._refitted(replace(has, fit=replace(has.fit, within=np.inf)), [FINEST])
    assert again is not None
    assert again.fit.converged is gone_on
