"""The tank alone on the engine's equations: whatever stands behind it, and the engine's own course with effects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.effects.runs import typical
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect
from hfanalysis.engine.blowdown import TankAlone, blow_down
from hfanalysis.engine.equations import STATES
from hfanalysis.engine.unsteady import burn

TIME = np.linspace(0.0, 9.0, 1801)


def test_what_stands_behind_the_injector_and_next_to_no_heat_change_nothing() -> None:
    engine = engine_on_stand(effects=(effect("tank_heat").at(power=1e-9),))
    chamber = 14e5 - 5e4 * TIME
    run = TankAlone.of(engine).run(TIME, chamber)
    plain = blow_down(engine.saturation, engine.feed, engine.oxidizer_mass, engine.temperature, TIME, chamber, 1.1)
    assert run.t_v == pytest.approx(plain.t_v, abs=1e-9)
    assert run.pressure == pytest.approx(plain.pressure, rel=1e-9)
    assert run.flow == pytest.approx(plain.flow, rel=1e-8)
    assert run.mass == pytest.approx(plain.mass, rel=1e-9)


def test_an_exponent_that_the_engine_does_not_state_is_the_vapors_own() -> None:
    """c_p/c_v as the liquid ends, as in the engine's own course."""
    engine = engine_on_stand(polytropic_exponent=None)
    run = TankAlone.of(engine).run(TIME, np.full(TIME.size, 14e5))
    cv, cp = engine.saturation.heat_capacities(float(run.temperature[run.t_v > TIME][-1]))
    dry = run.t_v < TIME
    assert run.states[dry, STATES.index("vapor_exponent")] == pytest.approx(float(cp / cv), rel=1e-3)
    stated = TankAlone.of(replace(engine, polytropic_exponent=float(run.states[-1, STATES.index("vapor_exponent")])))
    assert run.pressure == pytest.approx(stated.run(TIME, np.full(TIME.size, 14e5)).pressure, rel=1e-12)


@pytest.mark.parametrize(
    "name", ["tank_heat", "tank_wall_heat_capacity", "n2_purge", "tank_stratification", "injector_choked_vapor",
             "injector_two_phase", "tank_nonequilibrium", "feed_line_fill"],
)  # fmt: skip
def test_on_the_engines_own_chamber_pressure_it_takes_the_engines_course(name: str) -> None:
    engine = engine_on_stand(effects=(typical(name),))
    done = burn(engine, TIME[-1], rtol=1e-7, run_on=True, times=TIME)
    run = TankAlone.of(engine).run(TIME, done.output("chamber_pressure"))
    assert done.liquid_out is not None
    later = TIME > 0.05  # the chamber lights within a few samples, between which its pressure is taken linear
    assert run.t_v == pytest.approx(done.liquid_out, abs=2e-3)
    assert run.pressure[later] == pytest.approx(done.output("tank_pressure")[later], rel=2e-3)
    assert run.run_pressure[later] == pytest.approx(done.output("run_pressure")[later], rel=5e-3)


def test_a_given_loss_takes_the_place_of_the_modeled_one() -> None:
    engine = engine_on_stand(effects=(effect("tank_heat").at(power=1.0),))
    found = TankAlone.of(engine).run(TIME[:100], np.full(100, 14e5), loss=np.full(100, 3e5))
    assert found.pressure - found.run_pressure == pytest.approx(3e5)


@pytest.mark.parametrize("name", ["feed_line_fill", "injector_choked_vapor"])
def test_with_the_engines_own_loss_given_the_vapor_phase_is_the_engines(name: str) -> None:
    """A line that gives away what it holds goes by its own loss, whatever else is lost between tank and injector."""
    engine = engine_on_stand(effects=(typical(name),))
    done = burn(engine, TIME[-1], rtol=1e-7, run_on=True, times=TIME)
    assert done.liquid_out is not None
    tank = TankAlone.of(engine)
    whole = tank.run(TIME, done.output("chamber_pressure"))
    dry = whole.time > whole.t_v + 0.01
    first = int(np.flatnonzero(dry)[0])
    state = dict(zip(STATES, whole.states[first], strict=False))
    kept = ("tank_mass", "tank_temperature", "tank_nitrogen", "vapor_compressibility", "vapor_exponent")
    begun = tank.at(own=whole.states[first, len(STATES) :], **{k: state[k] for k in kept})
    loss = (whole.pressure - whole.run_pressure)[dry]
    again = begun.run(TIME[dry], done.output("chamber_pressure")[dry], loss, vapor=True)
    assert again.pressure == pytest.approx(whole.pressure[dry], rel=2e-3)
    assert again.leak == pytest.approx(whole.leak[dry], abs=0.02)


def test_it_starts_where_it_is_told() -> None:
    tank = TankAlone.of(engine_on_stand(effects=(typical("tank_stratification"),)))
    moved = tank.at(tank_temperature=285.0, own=np.array([0.5, 4e4]))  # half of the layer is left
    first = moved.run(TIME[:2], np.full(2, 14e5))
    assert first.states[0, len(STATES) :].tolist() == [0.5, 4e4]
    assert first.pressure[0] == pytest.approx(float(tank.engine.saturation.pressure(285.0)) + 2e4)
