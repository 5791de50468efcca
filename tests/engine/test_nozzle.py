"""The nozzle in all its regimes: published tables, inverses, and the report's equations solved by iteration."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
from benchmarks.reference_engine import exit_behind_shock
from benchmarks.reference_engine import nozzle as reference_nozzle
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.engine.nozzle import (
    REGIMES,
    area_ratio,
    choked_flow_factor,
    mach_at_area,
    mach_at_pressure,
    nozzle_flow,
    pressure_after_shock,
    pressure_ratio,
    stagnation_after_shock,
)
from hfanalysis.thermo.combustion import Gas

SUBSONIC, SHOCK, SUPERSONIC = REGIMES
HOT = Gas(2666.0, 24.0, 1.26)
THROAT, EXIT = pi * 0.0233**2, pi * 0.0381**2
AMBIENT = 0.84623 * 101325.0

gammas = st.floats(1.1, 1.67)
ratios = st.floats(1.0, 30.0)


@pytest.mark.parametrize(
    ("mach", "area", "pressure"),
    [
        (0.2, 2.9635, 0.97250),
        (0.5, 1.3398, 0.84302),
        (0.8, 1.0382, 0.65602),
        (1.0, 1.0, 0.52828),
        (1.5, 1.1762, 0.27240),
        (2.0, 1.6875, 0.12780),
        (3.0, 4.2346, 0.02722),
        (5.0, 25.000, 0.00189),
    ],
)
def test_isentropic_flow_has_the_published_values(mach: float, area: float, pressure: float) -> None:
    """Tables of NACA report 1135, gamma 1.4."""
    assert area_ratio(mach, 1.4) == pytest.approx(area, abs=6e-5)
    assert pressure_ratio(mach, 1.4) == pytest.approx(pressure, abs=6e-6)


@pytest.mark.parametrize(
    ("mach", "static", "stagnation"),
    [(1.0, 1.0, 1.0), (1.5, 2.4583, 0.92979), (2.0, 4.5, 0.72087), (3.0, 10.3333, 0.32834), (5.0, 29.0, 0.06172)],
)
def test_normal_shocks_have_the_published_values(mach: float, static: float, stagnation: float) -> None:
    assert pressure_after_shock(mach, 1.4) == pytest.approx(static, abs=6e-5)
    assert stagnation_after_shock(mach, 1.4) == pytest.approx(stagnation, abs=6e-6)


@given(st.floats(0.01, 0.999), gammas)
def test_the_subsonic_area_inverts(mach: float, gamma: float) -> None:
    assert area_ratio(mach_at_area(area_ratio(mach, gamma), gamma, False), gamma) == pytest.approx(
        area_ratio(mach, gamma), rel=1e-12
    )
    assert mach_at_area(area_ratio(mach, gamma), gamma, False) == pytest.approx(mach, rel=1e-6)


@given(st.floats(1.001, 8.0), gammas)
def test_the_supersonic_area_inverts(mach: float, gamma: float) -> None:
    found = mach_at_area(area_ratio(mach, gamma), gamma, True)
    assert area_ratio(found, gamma) == pytest.approx(area_ratio(mach, gamma), rel=1e-12)
    assert found == pytest.approx(mach, rel=1e-6)


@given(st.floats(0.01, 8.0), gammas)
def test_the_pressure_inverts(mach: float, gamma: float) -> None:
    assert mach_at_pressure(pressure_ratio(mach, gamma), gamma) == pytest.approx(mach, rel=1e-9)


@given(st.floats(1.0, 8.0), gammas)
def test_a_shock_conserves_the_choked_flow(mach: float, gamma: float) -> None:
    """p_0 A* is the same on both sides; so is the stagnation pressure by either way round."""
    square = mach**2
    behind = sqrt((2.0 + (gamma - 1.0) * square) / (2.0 * gamma * square - (gamma - 1.0)))
    round_about = pressure_ratio(mach, gamma) * pressure_after_shock(mach, gamma) / pressure_ratio(behind, gamma)
    assert stagnation_after_shock(mach, gamma) == pytest.approx(round_about, rel=1e-10)
    assert stagnation_after_shock(mach, gamma) <= 1.0 + 1e-12


def borders(gas: Gas, throat: float, exit_area: float, ambient: float) -> tuple[float, float]:
    """Chamber pressures at which the nozzle chokes and at which the shock leaves it."""
    ratio = exit_area / throat
    first, last = mach_at_area(ratio, gas.gamma, False), mach_at_area(ratio, gas.gamma, True)
    swallowed = pressure_ratio(last, gas.gamma) * pressure_after_shock(last, gas.gamma)
    return ambient / pressure_ratio(first, gas.gamma), ambient / swallowed


def test_the_design_nozzle_passes_through_every_regime() -> None:
    choked, full = borders(HOT, THROAT, EXIT, AMBIENT)
    found = [nozzle_flow(HOT, p, AMBIENT, THROAT, EXIT).regime for p in (0.99 * choked, 1.01 * choked, 0.99 * full)]
    assert found == [SUBSONIC, SHOCK, SHOCK]
    assert nozzle_flow(HOT, 1.01 * full, AMBIENT, THROAT, EXIT).regime == SUPERSONIC


def test_at_sea_level_the_design_nozzle_flows_full_above_2_3_bar() -> None:
    assert borders(HOT, THROAT, EXIT, 101325.0)[1] == pytest.approx(2.3e5, rel=0.03)


@given(gammas, st.floats(1.0001, 30.0), st.sampled_from([0, 1]))
def test_flow_and_thrust_are_continuous_across_the_regimes(gamma: float, ratio: float, border: int) -> None:
    gas = Gas(2500.0, 24.0, gamma)
    p = borders(gas, THROAT, ratio * THROAT, AMBIENT)[border]
    below, above = (nozzle_flow(gas, p * (1.0 + s), AMBIENT, THROAT, ratio * THROAT) for s in (-1e-9, 1e-9))
    assert above.mass_flow == pytest.approx(below.mass_flow, rel=1e-5)
    assert above.thrust == pytest.approx(below.thrust, rel=1e-4, abs=1e-4)


@given(gammas, ratios, st.floats(1.0, 100.0))
def test_thrust_is_never_negative(gamma: float, ratio: float, pressure: float) -> None:
    flow = nozzle_flow(Gas(2500.0, 24.0, gamma), pressure * AMBIENT, AMBIENT, THROAT, ratio * THROAT)
    assert flow.thrust >= 0.0
    assert flow.mass_flow >= 0.0
    assert np.isfinite([flow.thrust, flow.mass_flow, flow.exit_mach, flow.exit_pressure]).all()


@pytest.mark.parametrize("pressure", [AMBIENT, 0.5 * AMBIENT, 1.0])
def test_nothing_leaves_a_chamber_at_or_below_ambient(pressure: float) -> None:
    flow = nozzle_flow(HOT, pressure, AMBIENT, THROAT, EXIT)
    assert (flow.mass_flow, flow.thrust, flow.regime) == (0.0, 0.0, SUBSONIC)


def test_flow_fades_to_nothing_as_the_chamber_reaches_ambient() -> None:
    flows = [nozzle_flow(HOT, AMBIENT * (1.0 + s), AMBIENT, THROAT, EXIT).mass_flow for s in (1e-2, 1e-6, 1e-10)]
    assert flows[0] > flows[1] > flows[2] > 0.0
    assert flows[2] < 1e-4 * flows[0] * 1.1


@given(gammas, ratios, st.floats(0.0, 1.0))
def test_a_choked_nozzle_passes_what_the_characteristic_velocity_says(gamma: float, ratio: float, above: float) -> None:
    gas = Gas(2500.0, 24.0, gamma)
    choked, _ = borders(gas, THROAT, ratio * THROAT, AMBIENT)
    p = choked * (1.0 + 1e-9 + 20.0 * above)
    flow = nozzle_flow(gas, p, AMBIENT, THROAT, ratio * THROAT)
    assert flow.mass_flow == pytest.approx(p * THROAT / gas.characteristic_velocity, rel=1e-7)
    heat = gas.gas_constant * gas.temperature
    assert flow.mass_flow == pytest.approx(choked_flow_factor(gamma) * p * THROAT / sqrt(heat), rel=1e-7)


@given(gammas, st.floats(1.05, 20.0), st.floats(1.02, 60.0))
def test_the_flow_solves_the_reports_equations(gamma: float, ratio: float, pressure: float) -> None:
    """Each regime's equations as the report prints them, solved by bracketing."""
    gas, p = Gas(2500.0, 24.0, gamma), pressure * AMBIENT
    flow, thrust = reference_nozzle(gas, p, AMBIENT, THROAT, ratio * THROAT)
    ours = nozzle_flow(gas, p, AMBIENT, THROAT, ratio * THROAT)
    assert ours.mass_flow == pytest.approx(flow, rel=1e-7)
    assert ours.thrust == pytest.approx(thrust, rel=1e-7)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_the_exit_behind_a_shock_is_where_iteration_finds_it(share: float) -> None:
    """M_x is chosen, p_0y, A_y* and M_e follow from the report's equations; the closed form finds the same exit."""
    last = mach_at_area(EXIT / THROAT, HOT.gamma, True)
    mach, pressure = exit_behind_shock(1.0 + share * (last - 1.0), EXIT / THROAT, HOT.gamma)
    flow = nozzle_flow(HOT, AMBIENT / pressure, AMBIENT, THROAT, EXIT)
    assert flow.regime == SHOCK
    assert flow.exit_mach == pytest.approx(mach, rel=1e-10)
    assert flow.exit_pressure == AMBIENT


def test_a_full_nozzle_does_not_feel_the_ambient_but_in_the_pressure_term() -> None:
    low, high = (nozzle_flow(HOT, 20e5, a, THROAT, EXIT) for a in (0.5e5, 1.0e5))
    assert low.exit_pressure == high.exit_pressure
    assert low.thrust - high.thrust == pytest.approx(0.5e5 * EXIT)


def test_a_nozzle_that_narrows_to_its_exit_is_refused() -> None:
    with pytest.raises(ValueError, match="smaller than the throat"):
        nozzle_flow(HOT, 20e5, AMBIENT, EXIT, THROAT)
