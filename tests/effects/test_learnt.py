"""Tables of what no name explains, as effects of the engine."""

from __future__ import annotations

import numpy as np
import pytest
from tests.effects.runs import base, channel, with_effects
from tests.engine.stand import engine_on_stand

from hfanalysis.diagnose.answer.effect_source import Evaluation
from hfanalysis.effects.learnt import KNOTS, STATES, hats, is_learnt, learnt, name_of, state_at, states_of, with_learnt
from hfanalysis.engine.effect import Active
from hfanalysis.engine.observe import observe, observe_tangents
from hfanalysis.engine.sensitivity import run_with_tangents
from hfanalysis.engine.sites import EQUATION_AND_UNIT
from hfanalysis.engine.unsteady import burn


def table(name: str, low: float, high: float, values: list[float], band: float = 0.0, **other: float) -> Active:
    """A table with these values."""
    numbers = {f"value_{k}": v for k, v in enumerate(values)} | {f"band_{k}": band for k in range(KNOTS)}
    return learnt(name).at(strength=1.0, low=low, high=high, **numbers, **other)


def test_a_table_of_one_value_is_that_factor() -> None:
    tenth = table("unknown_regression_factor_by_p_chamber", 0.0, 5e6, [0.1] * KNOTS)
    with_table, with_a = with_effects(tenth, rtol=1e-7), burn(engine_on_stand(a=1.1 * engine_on_stand().a), 10.0, 1e-7)
    for at in (1.0, 3.0):
        assert channel(with_table, "fuel_flow", at) == pytest.approx(channel(with_a, "fuel_flow", at), rel=1e-5)


@pytest.mark.parametrize("state", STATES)
def test_a_table_says_at_each_instant_what_it_has_at_that_state(state: str) -> None:
    low, high = {"p_chamber": (1e6, 2e6), "p_tank": (2e6, 5e6)}.get(state, (0.1, 5.0))
    values = [1000.0, 300.0, 800.0, 200.0, 900.0, 100.0, 700.0, 400.0]
    run = with_effects(table(name_of("tank_heat", state, False), low, high, values))
    there = Evaluation.of(run.steps.engine)
    for at in (0.5, 2.0, 3.5):
        found = there.at(at, run.steps.at(np.array([at]))[0][0], run.liquid_out is None or at < run.liquid_out, True)
        where = np.array([state_at(state, at, found.environment)])
        assert found.site("tank_heat") == pytest.approx(float(hats(where, low, high)[0] @ values), rel=1e-9)


def test_the_band_moves_all_of_it() -> None:
    plain = table("unknown_regression_factor_by_p_chamber", 0.0, 5e6, [0.1] * KNOTS, 0.05)
    off = table("unknown_regression_factor_by_p_chamber", 0.0, 5e6, [0.1] * KNOTS, 0.05, shift=-2.0)
    flow, less = (channel(with_effects(one), "fuel_flow", 1.0) for one in (plain, off))
    assert less == pytest.approx(channel(base(), "fuel_flow", 1.0), rel=1e-4)
    assert flow > less


def test_of_liquid_it_ends_with_the_liquid() -> None:
    loss = [2e5] * KNOTS
    wet = with_effects(table("unknown_feed_loss_by_p_tank_of_liquid", 0.0, 1e7, loss))
    always = with_effects(table("unknown_feed_loss_by_p_tank", 0.0, 1e7, loss))
    assert channel(wet, "run_pressure", 2.0) == pytest.approx(channel(always, "run_pressure", 2.0), rel=1e-6)
    assert wet.liquid_out is not None
    late = wet.liquid_out + 0.5
    lost = channel(wet, "tank_pressure", late) - channel(wet, "run_pressure", late)
    assert lost < channel(always, "tank_pressure", late) - channel(always, "run_pressure", late)


def test_tangents_hold() -> None:
    name = "unknown_regression_factor_by_p_chamber"
    engine = engine_on_stand(effects=(table(name, 5e5, 2e6, [0.1, 0.05, 0.0, 0.1, 0.2, 0.1, 0.0, 0.1]),))
    grid = np.linspace(0.5, 4.0, 8)
    found = run_with_tangents(engine, [f"{name}.value_4"], 5.0, rtol=1e-6, run_on=True, times=grid)
    both = []
    for value in (0.199, 0.201):
        moved = table(name, 5e5, 2e6, [0.1, 0.05, 0.0, 0.1, value, 0.1, 0.0, 0.1])
        run = burn(engine_on_stand(effects=(moved,)), 5.0, rtol=1e-8, run_on=True, times=grid)
        both.append(observe(run, grid)["p_chamber"])
    slope = (both[1] - both[0]) / 0.002
    own = observe_tangents(found, grid)["p_chamber"][:, 0]
    assert np.abs(slope).max() > 1e3
    assert own == pytest.approx(slope, abs=0.02 * float(np.abs(slope).max()))


def test_names_say_what_they_are() -> None:
    assert not is_learnt("unknown_tank_heat_by_colour")
    with pytest.raises(ValueError, match="not the name of an unknown over a state"):
        learnt("unknown_colour_by_time")
    assert list(with_learnt({}, ["tank_heat", "unknown_tank_heat_by_time"])) == ["unknown_tank_heat_by_time"]
    assert "oxidizer_flow" not in states_of("tank_pressure")  # which is set before it is known
    for site, (equation, _) in EQUATION_AND_UNIT.items():
        assert learnt(name_of(site, "time", True)).equation == equation
