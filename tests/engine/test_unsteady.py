"""The unsteady engine: certified answers, conservation, the reference solver, and engines nobody would build."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import pi

import numpy as np
import pytest
from benchmarks.random_engines import Outcome, attempt, faults, random_engine
from benchmarks.reference_engine import Reference, Run, differences, in_our_states, solve
from numpy.typing import NDArray
from simulated.engines import hf5_like, maelstrom

from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.grain import flux_power
from hfanalysis.engine.injector import mass_flow, mass_flow_with_feed
from hfanalysis.engine.unsteady import Burn, Engine, burn, vapor_compressibility
from hfanalysis.thermo.combustion import equilibrium
from hfanalysis.thermo.combustion_table import CombustionTable, build
from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS

Array = NDArray[np.float64]


@cache
def table() -> CombustionTable:
    return build()


@cache
def engine() -> Engine:
    return maelstrom(table())


@cache
def burnt() -> Burn:
    return burn(engine())


@cache
def reference() -> Run:
    return solve(engine())


def grain_mass(of: Engine, radius: Array) -> Array:
    return np.asarray(pi * of.fuel_density * of.grain_length * (of.outer_radius**2 - radius**2))


def reported(done: Burn) -> dict[str, float]:
    """The numbers of the report's tables."""
    impulse = float(done.state("impulse")[-1])
    return {
        "liquid_out": done.liquid_out or np.nan,
        "burn_time": done.burn_time,
        "impulse": impulse,
        "specific_impulse": impulse / (9.80665 * (7.035 + 1.639)),
        "peak_thrust": float(done.output("thrust").max()),
        "average_thrust": impulse / done.burn_time,
        "peak_pressure": float(done.output("chamber_pressure").max()),
        "vapour_left": float(done.state("tank_mass")[-1]),
        "speed": float(done.state("speed")[-1]),
        "altitude": float(done.state("altitude")[-1]),
    }


@pytest.mark.parametrize(
    ("quantity", "certified"),
    [
        ("impulse", 16844.0),
        ("specific_impulse", 198.0),
        ("peak_thrust", 6750.0),
        ("average_thrust", 5055.0),
        ("peak_pressure", 27.53e5),
        ("vapour_left", 0.6775),
    ],
)
def test_the_design_point_is_the_certified_one(quantity: str, certified: float) -> None:
    assert reported(burnt())[quantity] == pytest.approx(certified, rel=0.005)


@pytest.mark.parametrize(("event", "certified"), [("liquid_out", 2.660), ("burn_time", 3.332)])
def test_its_events_are_certified_to_10_ms(event: str, certified: float) -> None:
    assert reported(burnt())[event] == pytest.approx(certified, abs=0.010)


def test_its_hottest_gas_is_the_start_up_spike() -> None:
    pressure, of = burnt().output("chamber_pressure"), burnt().output("of_ratio")
    early, later = burnt().time < 0.002, (burnt().time > 0.05) & (burnt().time < 2.0)
    hottest = max(equilibrium(float(p), float(r)).temperature for p, r in zip(pressure[early], of[early], strict=True))
    rest = [equilibrium(float(p), float(r)).temperature for p, r in zip(pressure[later], of[later], strict=True)]
    assert hottest == pytest.approx(2811.0, rel=0.005)
    assert (rest[0], rest[-1]) == pytest.approx((2600.0, 2520.0), rel=0.005)


def test_the_tank_starts_at_the_certified_pressure() -> None:
    assert burnt().output("tank_pressure")[0] == pytest.approx(57.3e5, rel=0.005)


def test_tightening_the_tolerance_tenfold_moves_no_reported_number() -> None:
    tight = reported(burn(engine(), rtol=1e-8))
    assert reported(burnt()) == pytest.approx(tight, rel=1e-4)


def closure(of: Engine, done: Burn) -> float:
    """Mass that tank, grain, chamber and the nozzle's flow do not account for, relative to what was loaded."""
    held = done.state("tank_mass") + grain_mass(of, done.state("port_radius"))
    held = held + done.state("chamber_oxidizer") + done.state("chamber_fuel")
    rate = done.output("nozzle_flow")
    # the flow has a corner where the liquid runs out
    borders = [0, len(done.time) - 1]
    if done.liquid_out is not None:
        borders.insert(1, int(np.searchsorted(done.time, done.liquid_out)))
    ejected = sum(spline_integral(done.time[a : b + 1], rate[a : b + 1]) for a, b in pairwise(borders))
    return float((held[0] - held[-1] - ejected) / held[0])


def spline_integral(time: Array, rate: Array) -> float:
    from scipy.interpolate import Akima1DInterpolator

    return float(Akima1DInterpolator(time, rate).integrate(time[0], time[-1]))


def test_mass_closes() -> None:
    assert abs(closure(engine(), burn(engine(), rtol=1e-10))) < 1e-6


def test_the_fuel_burns_to_its_outer_radius_and_no_further() -> None:
    radius = burnt().state("port_radius")
    assert radius[-1] == pytest.approx(engine().outer_radius, abs=1e-9)
    assert (np.diff(radius) >= 0.0).all()


def test_the_saturated_tank_closes_in_energy() -> None:
    """The report's equation U' = -mdot h_l holds with one consistent source of properties: dU = h_l dM."""
    from hfanalysis.thermo.nitrous import saturation
    from hfanalysis.thermo.saturation import Property

    source = saturation("coolprop")
    done = burn(replace(engine(), saturation=source, oxidizer_mass=7.0), rtol=1e-9)
    wet = done.time <= (done.liquid_out or 0.0)
    mass, temperature = done.state("tank_mass")[wet], done.state("tank_temperature")[wet]
    v_l, v_v = source.liquid_volume(temperature)[0], source.vapor_volume(temperature)[0]
    liquid = (mass * v_v - done_volume()) / (v_v - v_l)
    u_l = source.energy(Property.LIQUID_ENERGY, temperature)[0]
    u_v = source.energy(Property.VAPOR_ENERGY, temperature)[0]
    energy = liquid * u_l + (mass - liquid) * u_v
    h_l = source.energy(Property.LIQUID_ENTHALPY, temperature)[0]
    order = slice(None, None, -1)
    left = spline_integral(mass[order], h_l[order])
    assert energy[0] - energy[-1] == pytest.approx(left, rel=1e-5)


def done_volume() -> float:
    return engine().feed.volume


def test_the_gas_laws_pressure_moves_as_the_reports_rate_says() -> None:
    """dp_c/dt by differences of our history, and by the report's equation at the same states.

    It is a small difference of flows that the chamber's 2 ms make large, so that 1e-5 of R T already shows.
    """
    done, right_hand_side = burn(engine(), rtol=1e-10), Reference(engine())
    for t in (0.02, 0.3, 1.0, 2.0):
        i = int(np.searchsorted(done.time, t))
        window = slice(i - 3, i + 4)
        p = np.polynomial.Polynomial.fit(done.time[window], done.output("chamber_pressure")[window], 4)
        x = their_state(done, i)
        x[6] = done.output("chamber_pressure")[i]
        assert right_hand_side(t, x)[6] == pytest.approx(float(p.deriv()(done.time[i])), rel=2e-2)


def their_state(done: Burn, i: int) -> Array:
    y, source, volume = done.states[i], engine().saturation, engine().feed.volume
    v_l, v_v = float(source.liquid_volume(y[1])[0]), float(source.vapor_volume(y[1])[0])
    liquid = (y[0] * v_v - volume) / (v_v - v_l)
    moles = np.array([y[0] - liquid, liquid]) / OXIDIZER_MOLAR_MASS
    return np.array([*moles, y[1], y[2], y[3], y[4], 0.0, y[5], y[6], y[7], 0.0])


def test_the_reference_solver_finds_the_same_events_and_totals() -> None:
    assert (burnt().liquid_out, burnt().burn_time) == pytest.approx(reference().events, rel=1e-4)
    assert burnt().state("impulse")[-1] == pytest.approx(reference().end[9], rel=1e-5)
    assert burnt().states[-1][:8] == pytest.approx(in_our_states(reference().end)[:8], rel=1e-4)


def test_the_reference_solver_has_the_same_states_at_aligned_times() -> None:
    """To 1e-4 of the range, the 0.2 ms in which condensed carbon appears included."""
    assert max(differences(burnt(), reference()).values()) < 1e-4


def test_without_condensed_carbon_the_chamber_too_agrees() -> None:
    """The liquid phase of the design point stays above O/F 3.4."""
    whole, run = burnt(), reference()
    wet = whole.time <= (whole.liquid_out or 0.0)
    assert whole.output("of_ratio")[wet].min() > 3.4
    theirs = in_our_states(run.phases[0].sol(whole.time[wet] / (whole.liquid_out or 1.0) * run.events[0]))
    ours = np.vstack([whole.states[wet].T[:8], whole.output("chamber_pressure")[wet]])
    assert (np.abs(ours - theirs).max(axis=1) / np.ptp(theirs, axis=1)).max() < 1e-4


def with_loss(factor: float) -> Engine:
    return replace(engine(), feed=FeedSystem(engine().feed.volume, 3.79e-5, factor))


def test_a_quadratic_feed_loss_runs_and_slows_the_burn() -> None:
    free, lossy = burn(with_loss(0.0)), burn(with_loss(6.4e8))
    assert lossy.burn_time > free.burn_time
    assert lossy.output("chamber_pressure").max() < free.output("chamber_pressure").max()
    drop = lossy.output("tank_pressure") - lossy.output("chamber_pressure")
    i = len(lossy.time) // 2
    assert lossy.output("oxidizer_flow")[i] < free.output("oxidizer_flow").max()
    assert drop[i] > 0.0


def test_a_quadratic_feed_loss_agrees_with_the_reference() -> None:
    lossy = with_loss(6.4e8)
    found = differences(burn(lossy), solve(lossy))
    assert max(found.values()) < 1e-3


def test_an_engine_whose_fuel_goes_first_ends_with_liquid_in_the_tank() -> None:
    done = burn(replace(engine(), fuel_mass=0.6))
    assert done.liquid_out is None
    assert done.fuel_out
    assert done.state("port_radius")[-1] == pytest.approx(engine().outer_radius, abs=1e-9)
    assert done.state("tank_mass")[-1] > 3.0
    assert vapor_compressibility(engine(), done) is None


def test_the_vapours_compressibility_follows_from_the_state_at_the_liquids_end() -> None:
    assert vapor_compressibility(engine(), burnt()) == pytest.approx(0.66, abs=0.15)


def test_a_rocket_too_heavy_burns_on_its_pad() -> None:
    heavy = replace(engine(), vehicle=replace(engine().vehicle, dry_mass=2000.0))
    done = burn(heavy)
    assert done.state("altitude") == pytest.approx(1402.0, abs=1e-9)
    assert np.ptp(done.state("speed")) == 0.0


def test_flow_and_regression_end_smoothly_at_nothing() -> None:
    """A finite slope at zero, and joined without a step: solvers do not stall."""
    for f in (lambda x: mass_flow(1e-5, 700.0, x), lambda x: mass_flow_with_feed(1e-5, 1e8, 700.0, x)):
        assert f(-1.0) == f(0.0) == 0.0
        assert f(1e-9) / 1e-9 == pytest.approx(f(1e-6) / 1e-6, rel=1e-3)
        assert f(10.0 + 1e-9) == pytest.approx(f(10.0 - 1e-9), rel=1e-8)
    assert flux_power(0.0, 0.5) == 0.0
    assert flux_power(0.01 + 1e-12, 0.5) == pytest.approx(flux_power(0.01 - 1e-12, 0.5), rel=1e-8)
    assert flux_power(300.0, 0.555) == 300.0**0.555


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"fuel_mass": 5.0}, "do not fit"),
        ({"fuel_mass": 0.0}, "has to be positive"),
        ({"oxidizer_mass": 12.0}, "a saturated tank holds"),
        ({"oxidizer_mass": 0.5}, "a saturated tank holds"),
        ({"temperature": 320.0}, "no saturated tank"),
        ({"temperature": float("nan")}, "no saturated tank"),
        ({"exit_area": 1e-4}, "smaller than the throat"),
        ({"temperature": 185.0, "oxidizer_mass": 3.0}, "nothing flows"),
    ],
)
def test_an_engine_that_cannot_be_lit_is_refused(change: dict[str, float], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        burn(replace(engine(), **change))  # type: ignore[arg-type]


@cache
def random_outcomes() -> list[Outcome]:
    rng = np.random.default_rng(20)
    return [attempt(random_engine(rng, table())) for _ in range(30)]


def test_random_engines_run_or_are_refused_with_a_reason() -> None:
    assert [f for o in random_outcomes() for f in faults(o)] == []


def test_some_random_engines_run_and_some_do_not() -> None:
    ran = sum(o.burn is not None for o in random_outcomes())
    assert 5 < ran < 30


def test_states_that_are_not_numbers_give_rates_that_are_not_and_no_crash() -> None:
    from hfanalysis.engine.equations import OUTPUTS, STATES, evaluate_rates

    equations = engine().equations(burnt().steps.composition)
    dy, out = np.zeros(len(STATES)), np.zeros(len(OUTPUTS))
    for liquid in (True, False):
        evaluate_rates(0.0, np.full(len(STATES), np.nan), liquid, True, equations, dy, out)
        assert np.isnan(dy[:2]).all()


def test_the_reference_solver_agrees_through_vapour_and_cold_gas() -> None:
    run = solve(hf5_like(), longest=17.0, run_on=True)
    ours = burn(hf5_like(), 17.0, run_on=True)
    assert (ours.liquid_out, ours.burn_time) == pytest.approx(run.events[:2], rel=1e-4)
    assert max(differences(ours, run).values()) < 1e-4


def test_a_last_digit_changes_no_step() -> None:
    """Errors are rounded off; steps that followed their digits would make of one of 1e-13 one of the tolerance."""
    engine = hf5_like()
    one, other = (burn(replace(engine, a=a), 10.0, run_on=True).steps for a in (engine.a, engine.a * (1.0 + 1e-13)))
    assert other.times == pytest.approx(one.times, rel=1e-9)
    assert other.end[:, :6] == pytest.approx(one.end[:, :6], rel=1e-7)
