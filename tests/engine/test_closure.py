"""What the model leaves open in energy, against energy balances of the finished run."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect
from hfanalysis.engine.batch import burn_many
from hfanalysis.engine.closure import chamber_energy, vapor_heat, vapor_heat_total
from hfanalysis.engine.equations import OUTPUTS
from hfanalysis.engine.unsteady import Burn, Engine, burn

Array = NDArray[np.float64]

SECONDS = 12.0


@cache
def run() -> Burn:
    return burn(engine_on_stand(polytropic_exponent=0.75), SECONDS, rtol=1e-8, run_on=True)


def dry(of: Burn) -> NDArray[np.bool_]:
    return of.time > (of.liquid_out or np.inf) + 1e-6


def test_the_vapors_heat_closes_its_energy() -> None:
    """V dp = k_s p V d ln rho + G dQ: integrated along the run, from pressure and mass alone."""
    of, on = run(), dry(run())
    mass, t, source = of.state("tank_mass")[on], of.state("tank_temperature")[on][0], of.steps.engine.saturation
    p, volume = of.output("tank_pressure")[on], of.steps.engine.feed.volume
    expanded = source.isentropic_exponent(t) * np.trapezoid(p * volume, np.log(mass))
    heat = (volume * (p[-1] - p[0]) - expanded) / source.grueneisen(t)
    assert heat == pytest.approx(vapor_heat_total(of), rel=1e-3)


def test_a_small_exponent_needs_tens_of_kilowatts_and_an_adiabatic_one_none() -> None:
    assert vapor_heat(run())[dry(run())][0] > 10e3
    t = run().steps.begin[run().steps.events.tolist().index(0) + 1, 1]
    exponent = float(run().steps.engine.saturation.isentropic_exponent(t))
    adiabatic = burn(engine_on_stand(polytropic_exponent=exponent), SECONDS, run_on=True)
    assert abs(vapor_heat(adiabatic)[dry(adiabatic)][0]) < 100.0


def test_heat_into_the_vapor_raises_its_pressure_as_grueneisens_parameter_has_it() -> None:
    """V dp = m p V d ln rho + G Q dt beside the polytropic exponent m, whatever the vapor's temperature stands for."""
    heated = engine_on_stand(
        polytropic_exponent=1.1, effects=(effect("tank_heat").at(power=5e3, begun=1.0, fade=500.0),)
    )
    of = burn(heated, SECONDS, rtol=1e-8, run_on=True)
    on = dry(of)
    p, volume, mass = of.output("tank_pressure")[on], heated.feed.volume, of.state("tank_mass")[on]
    g = heated.saturation.grueneisen(np.clip(of.state("tank_temperature")[on], 185.0, 305.0))
    raised = np.diff(p) * volume - 1.1 * 0.5 * (p[1:] + p[:-1]) * volume * np.diff(np.log(mass))
    power = raised / (0.5 * (g[1:] + g[:-1])) / np.diff(of.time[on])
    assert np.median(power) == pytest.approx(5e3, rel=0.02)


def test_while_there_is_liquid_no_heat_is_implied() -> None:
    assert not vapor_heat(run())[run().time < (run().liquid_out or 0.0)].any()


def test_the_chamber_holds_its_pressure_times_its_volume() -> None:
    of = run()
    gas = of.state("chamber_oxidizer") + of.state("chamber_fuel")
    burning = of.time < of.burn_time
    held = (gas * of.output("chamber_temperature_by_mass"))[burning]
    assert chamber_energy(of)[burning] == pytest.approx(held, rel=1e-6)


def integral(of: Burn, output: str) -> float:
    """Of an output over the run: Gauss's rule within each of the solver's steps, which end on every corner."""
    node, weight = np.polynomial.legendre.leggauss(6)
    start, length = of.steps.times[:, :1], np.diff(of.steps.times, axis=1)
    at = start + 0.5 * length * (1.0 + node)
    rate = of.steps.at(at.ravel())[1][:, OUTPUTS.index(output)].reshape(at.shape)
    return float(np.sum(0.5 * length * weight * rate))


def purged() -> Engine:
    return engine_on_stand(effects=(effect("n2_purge").at(area=4e-6, supply_pressure=35e5),))


@pytest.mark.parametrize("engine", [engine_on_stand(), purged()], ids=["plain", "with nitrogen"])
def test_mass_closes_through_vapor_nitrogen_and_cold_gas(engine: Engine) -> None:
    of = burn(engine, SECONDS, rtol=1e-10, run_on=True)
    held = sum(of.state(n) for n in ("tank_mass", "tank_nitrogen", "chamber_oxidizer", "chamber_nitrogen"))
    held = held + of.state("chamber_fuel") + of.state("cold_gas")
    e, radius = engine, of.state("port_radius")
    held = held + np.pi * e.fuel_density * e.grain_length * (e.outer_radius**2 - radius**2)
    left = integral(of, "nozzle_flow") - integral(of, "nitrogen_inflow")
    assert held[0] - held[-1] == pytest.approx(left, abs=1e-6 * held[0])


def test_many_engines_at_once_are_those_one_by_one() -> None:
    engines = [engine_on_stand(oxidizer_mass=m) for m in (7.0, 8.0, 20.0)]
    first, second, third = burn_many(engines, longest=5.0, run_on=True)
    assert isinstance(first, Burn)
    assert isinstance(second, Burn)
    assert np.array_equal(first.states, burn(engines[0], 5.0, run_on=True).states)
    assert np.array_equal(second.states, burn(engines[1], 5.0, run_on=True).states)
    assert isinstance(third, str)
    assert "saturated tank holds" in third
