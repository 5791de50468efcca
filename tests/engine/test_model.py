"""One evaluation of the equations: what is kept of earlier ones changes nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect
from hfanalysis.engine.equations import KEEPS, OUTPUTS, Equations, evaluate_rates
from hfanalysis.engine.unsteady import burn

ENGINE = engine_on_stand(effects=(effect("n2_purge").at(), effect("nozzle_throat_erosion").at(rate=2e-5)))
DONE = burn(ENGINE, 9.0, run_on=True, keep_idle=True)
STEPS = DONE.steps
FIRING = len(STEPS.times) // 3
"""A step in which the nozzle is choked."""


def evaluated(equations: Equations, at: int, state: np.ndarray) -> tuple[bytes, bytes]:
    dy, out = np.empty(state.size), np.empty(len(OUTPUTS))
    liquid, burning = STEPS.history.phases[at] == 1
    evaluate_rates(float(STEPS.times[at, 0]), state.copy(), bool(liquid), bool(burning), equations, dy, out)
    return dy.tobytes(), out.tobytes()


places = some.integers(0, len(STEPS.times) - 1)
columns = some.integers(0, STEPS.begin.shape[1] - 1)


@given(some.lists(some.tuples(places, columns, some.booleans()), min_size=2, max_size=12), places)
def test_the_same_question_gets_the_same_answer(moves: list[tuple[int, int, bool]], at: int) -> None:
    used = ENGINE.equations(STEPS.composition)
    evaluated(used, at, STEPS.begin[at])
    for other, column, keeps in moves:
        state = STEPS.begin[at].copy()
        state[column] = STEPS.begin[other, column]  # as the columns of a Jacobian are: one number is another
        used.kept[KEEPS] = float(keeps)
        assert evaluated(used, at, state) == evaluated(ENGINE.equations(STEPS.composition), at, state)


@pytest.mark.parametrize("changed", ["volume", "throat_area", "dead_volume"])
def test_a_parameter_is_part_of_the_question(changed: str) -> None:
    used = ENGINE.equations(STEPS.composition)
    evaluated(used, FIRING, STEPS.begin[FIRING])
    if changed == "volume":
        other = replace(ENGINE, feed=replace(ENGINE.feed, volume=1.01 * ENGINE.feed.volume))
    else:
        other = replace(ENGINE, **{changed: 1.01 * getattr(ENGINE, changed)})
    constants = burn(other, 1.0, keep_idle=True).steps.composition.constants
    fresh = ENGINE.equations(replace(STEPS.composition, constants=constants))
    moved = used._replace(c=constants)
    assert evaluated(moved, FIRING, STEPS.begin[FIRING]) == evaluated(fresh, FIRING, STEPS.begin[FIRING])
    assert evaluated(fresh, FIRING, STEPS.begin[FIRING]) != evaluated(used, FIRING, STEPS.begin[FIRING])
