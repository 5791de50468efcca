"""Efficiencies and balances of a burn that is the model's own: whole, and those of textbooks."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.engine.stand import engine_on_stand

from hfanalysis.engine.unsteady import Burn, burn
from hfanalysis.performance.closing import balance, closure
from hfanalysis.performance.efficiency import efficiencies, ideal
from hfanalysis.performance.flows import HISTORY_STEP, Flows
from hfanalysis.performance.measured import Fire
from hfanalysis.thermo.combustion import equilibrium

AMBIENT = 101_325.0
FIRE = Fire(4.5, 0.01, "video")


@cache
def run() -> Burn:
    return burn(engine_on_stand(oxidizer_enthalpy=engine_on_stand().oxidizer_enthalpy), 10.0)


def histories() -> tuple[dict[str, np.ndarray], Flows]:
    """Chamber pressure, thrust and flows of the liquid phase on an even clock."""
    time = np.arange(0.0, 5.0, HISTORY_STEP)
    found = {n: np.interp(time, run().time, run().output(n)) for n in
             ("chamber_pressure", "thrust", "oxidizer_flow", "fuel_flow")}  # fmt: skip
    flows = Flows(time, found["oxidizer_flow"], found["fuel_flow"], np.zeros(time.size), np.zeros(time.size))
    return {"p_chamber": found["chamber_pressure"], "thrust_corrected": found["thrust"]}, flows


@pytest.fixture(scope="module")
def engine():  # type: ignore[no-untyped-def]
    """With the enthalpy that its oxidizer enters with."""
    enters = float(np.median(run().output("oxidizer_enthalpy")))
    return engine_on_stand(oxidizer_enthalpy=enters)


def test_the_models_own_burn_is_whole(engine) -> None:  # type: ignore[no-untyped-def]
    """It burns in equilibrium and has the ideal nozzle."""
    measured, flows = histories()
    found = efficiencies(measured, flows, engine, ideal(measured, flows, engine, AMBIENT, FIRE, None))
    steady = (flows.time > 0.5) & (flows.time < 4.3)
    for name in ("c_star_efficiency_frozen", "thrust_coefficient_efficiency_frozen"):
        assert found[name][steady] == pytest.approx(1.0, abs=0.015), name


def test_c_star_is_that_of_the_gas_and_the_thrust_is_its_coefficient_times_p_c_a_t(engine) -> None:  # type: ignore[no-untyped-def]
    measured, flows = histories()
    found = efficiencies(measured, flows, engine, ideal(measured, flows, engine, AMBIENT, FIRE, None))
    for i in np.flatnonzero((flows.time > 0.5) & (flows.time < 4.3))[::40]:
        gas = equilibrium(float(measured["p_chamber"][i]), float(flows.of_ratio[i]), engine.oxidizer_enthalpy)
        assert found["c_star"][i] == pytest.approx(gas.characteristic_velocity, rel=0.015)
        by_hand = measured["thrust_corrected"][i] / (measured["p_chamber"][i] * engine.throat_area)
        assert found["thrust_coefficient"][i] == pytest.approx(by_hand, rel=0.01)
        assert 1.2 < by_hand < 1.6


def test_what_went_through_the_injector_and_off_the_grain_went_through_the_nozzle(engine) -> None:  # type: ignore[no-untyped-def]
    measured, flows = histories()
    found = {n: q.value for n, q in closure(flows, measured, engine, AMBIENT, FIRE, None).items()}
    burnt = flows.time <= FIRE.end
    assert found["oxidizer_through_injector"] == pytest.approx(np.trapezoid(flows.oxidizer[burnt], flows.time[burnt]))
    assert found["fuel_burned"] == pytest.approx(np.trapezoid(flows.fuel[burnt], flows.time[burnt]))
    entered = found["oxidizer_through_injector"] + found["fuel_burned"]
    assert found["propellant_through_nozzle"] == pytest.approx(entered, rel=0.02)


def test_a_flow_that_is_not_known_throughout_closes_no_balance(engine) -> None:  # type: ignore[no-untyped-def]
    measured, flows = histories()
    holed = replace(flows, fuel=np.where(flows.time > 1.0, np.nan, flows.fuel))
    found = closure(holed, measured, engine, AMBIENT, FIRE, None)
    assert found["fuel_burned"].value is None
    assert "not known throughout" in str(found["fuel_burned"].reason)
    assert found["oxidizer_through_injector"].value is not None


@pytest.mark.parametrize(("factor", "purge", "verdict"), [(1.0, None, "closes"), (1.1, None, "does not close"),
                                                          (1.0, 2.0, "closes")])  # fmt: skip
def test_masses_close_or_do_not_until_nitrogen_enters(engine, factor: float, purge: float | None, verdict: str) -> None:  # type: ignore[no-untyped-def]
    """A gauge that reads a tenth too much lets a tenth too much out; what comes after the purge does not count."""
    measured, flows = histories()
    later = flows.time > (np.inf if purge is None else purge)
    read = {**measured, "p_chamber": measured["p_chamber"] * np.where(later, 2.0, factor)}
    found = ideal(read, flows, engine, AMBIENT, FIRE, purge, "aft")
    assert found is not None
    judged = balance(flows, read, engine, AMBIENT, FIRE, purge, found, (0.003, 0.003, 0.01))
    assert judged.verdict == verdict
    assert judged.until.value == (FIRE.end if purge is None else purge)
    assert judged.difference.interval is not None
    assert (judged.difference.interval[0] <= 0.0 <= judged.difference.interval[1]) == (verdict == "closes")
