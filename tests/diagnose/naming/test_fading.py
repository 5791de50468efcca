"""Fuel whose end is not seen: a surface that fades is fitted from where it fades."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.diagnose.naming.test_naming import catalogue
from tests.inference import made

from hfanalysis.diagnose.naming import fading
from hfanalysis.diagnose.naming.fading import FROM_SHAPES, STRENGTH, fades_unseen, unseen_fits
from hfanalysis.diagnose.naming.search import Search
from hfanalysis.diagnose.naming.variants import Settings
from hfanalysis.engine.equations import RADIUS
from hfanalysis.inference.candidate import Bench
from hfanalysis.inference.fitting.fit import Fit, fit


@pytest.fixture(scope="module")
def search() -> Search:
    seen = made.observed()
    unseen = replace(seen, events={name: event for name, event in seen.events.items() if name != "t_fuel_out"})
    return Search(Bench(unseen), catalogue(("fuel_sliver", "tank_heat")), Settings(), lambda *_: None)


@pytest.fixture(scope="module")
def base(search: Search) -> Fit:
    hypothesis = made.hypothesis()
    return fit(hypothesis, search.bench.observed, np.zeros(hypothesis.size), 3)


def with_wall(base: Fit, beyond: float) -> Fit:
    """The fit with its wall so far beyond [m] what has burnt at the end."""
    last = base.burnt.steps.at(np.array([made.observed().end]))[0][0, RADIUS]
    hypothesis = base.hypothesis
    return replace(base, hypothesis=replace(hypothesis, engine=replace(hypothesis.engine, outer_radius=last + beyond)))


def test_fuel_that_a_model_burns_up_may_have_ended_unseen(search: Search, base: Fit) -> None:
    observed, left, gone = search.bench.observed, with_wall(base, 1e-4), with_wall(base, -1e-4)
    assert fades_unseen([left, gone], search, "fuel_sliver", observed)
    assert not fades_unseen([left], search, "fuel_sliver", observed)
    assert not fades_unseen([gone], search, "tank_heat", observed)
    assert not fades_unseen([gone], search, "fuel_sliver", made.observed())  # its end was seen


def test_it_is_fitted_from_several_shapes_and_from_both_constants(
    search: Search, base: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    starts: list[np.ndarray] = []
    monkeypatch.setattr(fading, "followed", lambda made, own, observed, x: starts.append(x))
    assert unseen_fits(base, search, "fuel_sliver", search.bench.observed) == [None] * 2 * FROM_SHAPES.size
    size = base.x.size
    assert [x[size + 1] for x in starts] == [*FROM_SHAPES, *FROM_SHAPES]
    assert {x[size] for x in starts} == {STRENGTH}
    assert all(np.array_equal(x[:size], base.x) for x in starts[: FROM_SHAPES.size])
    assert not any(x[:size].any() for x in starts[FROM_SHAPES.size :])
