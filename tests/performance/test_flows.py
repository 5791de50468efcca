"""The fuel that a given oxidizer flow burns."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.engine.stand import engine_on_stand

from hfanalysis.assembly.calibrated import Regression
from hfanalysis.errors import AbsentError
from hfanalysis.performance.flows import burn_fuel, whole

TIME = np.arange(-1.0, 3.0, 0.02)
FLOW = np.where(TIME > 0.0, 1.2, 0.0)


@pytest.mark.parametrize("n", [0.5, 0.0, -0.1])
def test_the_port_opens_at_the_rate_whatever_the_exponents_sign(n: float) -> None:
    engine = engine_on_stand()
    found = burn_fuel(engine, Regression(1e-4 * 300.0 ** (0.5 - n), n), TIME, FLOW)
    opened = np.concatenate(([0.0], np.cumsum(found.rate[1:] * np.diff(TIME))))
    assert found.port[TIME <= 0.0] == pytest.approx(engine.port_radius)
    assert found.port - engine.port_radius == pytest.approx(opened, rel=0.02, abs=1e-6)
    assert found.port[-1] > engine.port_radius + 1e-3


@pytest.mark.parametrize(("a", "n"), [(1e-4, 0.5), (4e-4, 0.2), (2e-5, 0.8)])
def test_port_and_fuel_are_those_of_the_grains_own_equation(a: float, n: float) -> None:
    """dr/dt = a (mdot / (pi r^2))^n, mdot_f = rho 2 pi r L dr/dt."""
    engine = engine_on_stand()
    found = burn_fuel(engine, Regression(a, n), TIME, FLOW)
    lit = TIME > 0.0
    since = TIME[lit] - TIME[~lit][-1]  # what flows at a sample has flowed since the one before
    done = solve_ivp(
        lambda t, r: a * (1.2 / (pi * r**2)) ** n, (0.0, 3.1), [engine.port_radius], t_eval=since, rtol=1e-8
    )
    port = done.y[0]
    rate = a * (1.2 / (pi * port**2)) ** n
    assert found.port[lit] - engine.port_radius == pytest.approx(port - engine.port_radius, rel=2e-3)
    assert found.rate[lit] == pytest.approx(rate, rel=2e-3)
    assert found.fuel[lit] == pytest.approx(
        engine.fuel_density * 2.0 * pi * port * engine.grain_length * rate, rel=3e-3
    )


def test_an_effects_factor_is_a_factor_of_the_rate() -> None:
    engine, law = engine_on_stand(), Regression(1e-4, 0.0)
    plain, half = (burn_fuel(engine, law, TIME, FLOW, factor) for factor in (1.0, np.full(TIME.size, 0.5)))
    assert half.port - engine.port_radius == pytest.approx(0.5 * (plain.port - engine.port_radius), rel=1e-9)


def test_a_flow_that_the_tanks_model_does_not_reach_is_refused_with_the_instant() -> None:
    time = np.arange(0.0, 10.0, 0.5)
    flow = np.where(time > 6.0, np.nan, 0.4)
    whole(time, flow, 6.0)
    with pytest.raises(AbsentError, match=r"beyond 6\.50 s, and the burn goes on to 8\.00 s"):
        whole(time, flow, 8.0)
    with pytest.raises(AbsentError, match="no samples before the burn's end"):
        whole(time[:0], flow[:0], 8.0)
