"""Fuel and chamber gas over the burn, against the grain's own differential equation and the law of ideal gases."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from tests.segment.stand import Trial, definition, fire, log_of, segments_of

from hfanalysis.measured_flight.firing import ChamberGas, _gas_mass
from hfanalysis.measured_flight.propellant import Propellant, _fuel
from hfanalysis.measured_flight.thrust import measured_thrust
from hfanalysis.quantity import Quantity
from hfanalysis.record.sections import Chamber, GrainSection
from hfanalysis.units import Value

LENGTH, DENSITY, OUTER, MASS = 0.6, 900.0, 40e-3, 1.6
TIME = np.linspace(0.0, 10.0, 1001)
FLOW = 1.2 - 0.08 * TIME


def stated(**change: Any) -> Any:
    grain = GrainSection(
        mass=Value(MASS), length=Value(LENGTH), density=Value(DENSITY), outer_radius=Value(OUTER), **change
    )
    return definition(grain=grain, chamber=Chamber(pre_volume=Value(0.2e-3), post_volume=Value(0.9e-3)))


def port(a: float, n: float) -> np.ndarray[Any, Any]:
    """dr/dt = a (mdot / (pi r^2))^n from the loaded grain's port on."""
    first = np.sqrt(OUTER**2 - MASS / (pi * DENSITY * LENGTH))
    found = solve_ivp(
        lambda t, r: a * (np.interp(t, TIME, FLOW) / (pi * r**2)) ** n, (0.0, 10.0), [first], t_eval=TIME, rtol=1e-8
    )
    return np.asarray(found.y[0])


@pytest.mark.parametrize("n", [0.3, 0.5, 0.8])
def test_the_fuel_goes_as_the_grain_regresses(n: float) -> None:
    """With the coefficient with which all of it is gone at the end."""
    a = brentq(lambda a: port(a, n)[-1] - OUTER, 1e-7, 1e-2, rtol=1e-6)
    expected = pi * DENSITY * LENGTH * (OUTER**2 - port(a, n) ** 2)
    found, _ = _fuel(stated(n=n), None, TIME, FLOW)
    assert found == pytest.approx(expected, abs=2e-3 * MASS)


def test_the_chamber_holds_what_its_volumes_and_the_port_do() -> None:
    """p V = m R T, before the burn and when all fuel is gone."""
    gas = ChamberGas(np.array([0.0, 1.0]), np.array([10e5, 10e5]), np.full(2, 1.25), np.full(2, 8e5))
    load = SimpleNamespace(time=TIME, fuel=MASS * (1.0 - TIME / 10.0))
    found = _gas_mass(np.array([0.0, 10.0]), gas, stated(), cast(Propellant, load))
    empty = 0.2e-3 + 0.9e-3 + pi * OUTER**2 * LENGTH
    assert found == pytest.approx([10e5 * (empty - MASS / DENSITY) / 8e5, 10e5 * empty / 8e5], rel=1e-6)


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=500.0)


@pytest.mark.parametrize("accuracy", [80.0, 160.0])
def test_what_a_tare_leaves_of_a_cell_is_its_error_of_span(burn: Trial, accuracy: float) -> None:
    """Half of the variance: that share of the peak, at which the cell was loaded most."""
    log = log_of(burn)
    cell = replace(log["thrust"], accuracy=accuracy, accuracy_stated=True, zero_std=2.0)
    phases = segments_of(burn, t_end=Quantity(9.0, "s", 0.01))
    found = measured_thrust(replace(log, channels={**log.channels, "thrust": cell}), phases, definition(burn.stand))
    peak = float(burn.values["thrust"].max())
    assert found.gain_std * peak == pytest.approx(np.sqrt(0.5) * accuracy, rel=0.02)
    assert found.bias_std == 2.0
