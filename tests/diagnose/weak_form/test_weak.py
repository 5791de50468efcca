"""What each governing equation lacks, from the channels of runs whose truth is known."""

from __future__ import annotations

from dataclasses import replace
from math import pi, sqrt
from time import process_time
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from tests.diagnose.recorded import (
    NOISE,
    TANK,
    Reading,
    Record,
    calibrated,
    of,
    recorded,
    residuals,
    run_of,
    wet,
    worst,
)
from tests.effects.runs import own_state
from tests.engine.stand import engine_on_stand
from tests.products.filled import loaded

from hfanalysis.diagnose.weak_form.spread import Spread
from hfanalysis.diagnose.weak_form.weak import UNITS, weak_residuals
from hfanalysis.diagnose.weak_form.weak_product import Z90, significance, weak_product
from hfanalysis.effects import effect
from hfanalysis.engine.equations import NITROGEN, O_CHAMBER_PRESSURE, O_TANK_PRESSURE, STATES, TEMPERATURE
from hfanalysis.inference.fitting.hypothesis import base_hypothesis
from hfanalysis.quantity import Quantity


def test_a_run_without_effects_lacks_nothing() -> None:
    """A percent of the deviations, and a few watts of the fifty kilowatts that the outflow carries."""
    for residual in of().values():
        assert worst(residual) < 0.1, residual.equation
    assert np.abs(of()["tank_energy"].value).max() < 30.0
    assert np.abs(of()["injector"].value).max() < 5e-4


def test_bands_of_ninety_percent_hold_nine_in_ten() -> None:
    inside: dict[str, list[float]] = {name: [] for name in UNITS}
    for seed in range(60):
        found = residuals(recorded(run_of(), seed, spacing=0.04), calibrated(seed))
        for name, residual in found.items():
            inside[name].append(float((np.abs(residual.value) < Z90 * residual.std).mean()))
    shares = {name: float(np.mean(values)) for name, values in inside.items()}
    assert 0.85 < float(np.mean(list(shares.values()))) < 0.95, shares
    # offsets and constants move all windows of a test together: sixty tests tell a share to about five percent
    assert all(0.80 < share < 0.98 for share in shares.values()), shares


def test_chi_square_is_as_large_as_its_degrees_of_freedom() -> None:
    ratios = []
    for seed in range(20):
        for residual in residuals(recorded(run_of(), seed, spacing=0.04), calibrated(seed)).values():
            found = significance(residual)
            ratios.append(found.chi_square / found.degrees_of_freedom)
    assert float(np.mean(ratios)) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize(
    ("power", "lag", "fade"), [(2000.0, 0.02, 500.0), (6000.0, 0.02, 8.0), (-3000.0, 0.02, 30.0), (6000.0, 2.0, 20.0)]
)
def test_heat_is_read_in_watts(power: float, lag: float, fade: float) -> None:
    found = of(effect("tank_heat").at(power=power, lag=lag, fade=fade, begun=0.0))
    energy = found["tank_energy"]
    heat, liquid = power * (1.0 - np.exp(-energy.time / lag)) * np.exp(-energy.time / fade), wet(energy)
    assert energy.value[liquid] == pytest.approx(heat[liquid], rel=0.02, abs=20.0)
    assert energy.value[~liquid] == pytest.approx(heat[~liquid], rel=0.1)
    for name in ("feed", "chamber_mass", "nozzle"):
        assert worst(found[name]) < 0.1, name


def test_one_channel_cannot_tell_heat_from_flow() -> None:
    """The adiabatic tank reads heat as flow that does not leave: both residuals move."""
    found = of(effect("tank_heat").at(power=6000.0, begun=1.0))
    injector = found["injector"].value[wet(found["injector"])]
    assert (injector < -0.08).all()


def test_nitrogen_takes_volume_in_the_tank() -> None:
    purge = effect("n2_purge").at(area=1e-5, supply_pressure=46e5)
    run, found = run_of(purge), of(purge)
    opened = float(run.time[np.argmax(run.output("nitrogen_inflow") > 0.0)])
    volume = found["tank_volume"]
    before = volume.time < opened - 0.5
    assert np.abs(volume.value[before]).max() < 0.02
    after = wet(volume) & (volume.time > opened + 0.5)
    assert (np.diff(volume.value[after]) > 0.0).all()
    states, outputs = run.steps.at(volume.time[after])
    taken = 296.8 * states[:, NITROGEN] * states[:, TEMPERATURE] / outputs[:, O_TANK_PRESSURE] * 1e3
    # its pressure is read as warmer oxidizer, which would be less vapor: that comes on top of the volume it takes
    assert (volume.value[after] > taken).all()
    assert (volume.value[after] < 3.0 * taken).all()
    injector = found["injector"]
    assert (injector.value[injector.time > opened + 0.5] < -0.1).all()
    assert worst(found["nozzle"]) < 0.1


def test_a_wider_throat_is_lacking_in_chamber_and_nozzle() -> None:
    erosion = effect("nozzle_throat_erosion").at(rate=2e-4)
    run, found = run_of(erosion), of(erosion)
    radius = sqrt(engine_on_stand().throat_area / pi)
    at = 4.0
    wider = (1.0 + own_state(run, 0, at) / radius) ** 2 - 1.0
    truth = {name: float(np.interp(at, run.time, run.output(name))) for name in ("nozzle_flow", "thrust")}
    chamber, nozzle = found["chamber_mass"], found["nozzle"]
    lacking = float(np.interp(at, chamber.time, chamber.value))
    assert lacking == pytest.approx(-truth["nozzle_flow"] * wider / (1.0 + wider), rel=0.02)
    thrust = float(np.interp(at, nozzle.time, nozzle.value))
    assert thrust == pytest.approx(truth["thrust"] * wider / (1.0 + wider), rel=0.3)
    for name in (*TANK, "feed"):
        assert worst(found[name]) < 0.5, name


def test_a_filling_line_is_lacking_in_the_feed_and_as_mass() -> None:
    """Of the feed's pressure e^k V / (V + 4 mL) (p_T - p_c), e the share of the line that is empty."""
    fill = effect("feed_line_fill").at(volume=4e-4, steepness=1.5, boiling=0.0, throttled=0.0)
    run, found = run_of(fill), of(fill)
    feed = found["feed"]
    states, outputs = run.steps.at(feed.time)
    driving = outputs[:, O_TANK_PRESSURE] - outputs[:, O_CHAMBER_PRESSURE]
    lacking = states[:, len(STATES) + 1] ** 1.5 * (4e-4 / 4.04e-4) * driving * 1e-5
    assert feed.value[0] > 1.0
    late, liquid = feed.time > 1.5, wet(feed)
    assert feed.value[late & liquid] == pytest.approx(lacking[late & liquid], abs=0.01)
    assert feed.value[~liquid] == pytest.approx(0.0, abs=0.01)
    closing = found["tank_volume"].closing
    assert closing is not None
    assert run.liquid_out is not None
    in_line = own_state(run, 0, run.liquid_out - 0.01)
    assert closing[0] == pytest.approx(in_line, rel=0.15)


def test_a_better_injector_passes_more() -> None:
    """The calibration's area is 4 % too small: the tank loses 4 % more than the injector would pass."""
    engine = engine_on_stand()
    small = replace(engine, feed=replace(engine.feed, area=engine.feed.area * 0.96))
    found = residuals(recorded(run_of()), small)["injector"]
    flow = np.interp(found.time, run_of().time, run_of().output("oxidizer_flow"))
    assert found.value[wet(found)] == pytest.approx(0.04 * flow[wet(found)], rel=0.03)


@pytest.mark.parametrize("offset", [-200.0, 35.0, 500.0])
def test_an_offset_of_thrust_is_lacking_in_the_nozzle_alone(offset: float) -> None:
    test = recorded(run_of(), seed=3)
    plain, moved = residuals(test), residuals(test.plus("thrust", offset))
    for name in UNITS:
        expected = plain[name].value + (offset if name == "nozzle" else 0.0)
        assert moved[name].value == pytest.approx(expected, rel=1e-9, abs=1e-9), name


def test_what_was_not_recorded_is_said() -> None:
    test = recorded(run_of())
    reasons = {name: r.reason for name, r in residuals(test.without("p_run", "thrust")).items()}
    assert reasons["feed"] == "p_run is missing"
    assert reasons["nozzle"] == "thrust is missing"
    assert all(reasons[name] is None for name in (*TANK, "chamber_mass"))
    entry = weak_product(tuple(residuals(test.without("p_run")).values()))["feed"]
    assert entry.to_json() == {"unit": "bar", "reason": "p_run is missing"}
    alone = residuals(test.without("p_tank", "p_run"))
    assert alone["feed"].reason == "p_tank and p_run are missing"
    assert np.abs(alone["nozzle"].value).max() < 5.0
    assert all(r.reason for name, r in residuals(test.without("p_chamber")).items())


def test_without_the_run_line_the_flow_follows_from_the_tank() -> None:
    found = residuals(recorded(run_of()).without("p_run"))
    for name in (*TANK, "chamber_mass"):
        assert worst(found[name]) < 0.1, name


def test_test_functions_stay_out_of_gaps() -> None:
    test = recorded(run_of())
    kept = tuple(
        replace(c, time=c.time[k], value=c.value[k], covariance=c.covariance[np.ix_(k, k)])
        for c in test.channels
        for k in [np.flatnonzero((c.time < 2.0) | (c.time > 2.6) | (c.name != "p_chamber"))]
    )
    found = residuals(replace(test, channels=kept))["nozzle"]
    assert not ((found.time > 1.75) & (found.time < 2.85)).any()
    assert found.time.size > 5


def test_the_engines_own_effects_explain_what_they_do() -> None:
    heat = effect("tank_heat").at(power=6000.0, begun=1.0)
    test = recorded(run_of(heat))
    found = residuals(test, engine_on_stand(effects=(heat,)))
    energy = found["tank_energy"]
    assert energy.explained == pytest.approx(energy.value, rel=0.02)
    assert np.abs(of(heat)["tank_energy"].explained).max() == 0.0


def test_the_product_says_where_and_how_much() -> None:
    heat = effect("tank_heat").at(power=6000.0, begun=1.0)
    entries = weak_product(tuple(residuals(recorded(run_of(heat), seed=5)).values()))
    entry = entries["tank_energy"]
    mean, start = entry.mean, entry.t_start
    assert isinstance(mean, Quantity)
    assert mean.value is not None
    assert mean.std is not None
    assert abs(mean.value - 6000.0) < 3.0 * mean.std
    assert entry.phase == "liquid"
    assert start.value < 1.0
    assert entry.significance.chi_square > 5.0 * entry.significance.degrees_of_freedom
    quiet = weak_product(tuple(of().values()))["tank_energy"]
    assert quiet.phase is None
    assert quiet.mean.reason == "nowhere beyond two standard deviations"


def test_its_time_grows_with_a_log_no_faster_than_its_length_squared() -> None:
    """Side by side in one run, the best of several: what other work the machine has does not count."""
    taken = {seconds: min(_time_of(_stretched(seconds)) for _ in range(5)) for seconds in (8.5, 17.0)}
    assert taken[17.0] < 4.0 * taken[8.5]


def _stretched(seconds: float) -> Record:
    """A run drawn out to a length, at 50 Hz."""
    test, time = recorded(run_of()), np.arange(0.05, seconds, 0.02)
    slow = tuple(
        Reading(c.name, time, np.interp(6.46 / seconds * time, c.time, c.value), NOISE[c.name] ** 2 * np.eye(time.size))
        for c in test.channels
    )
    return Record(slow, {"liquid": 0.0, "vapor": 0.765 * seconds, "end": seconds}, seconds)


def _time_of(record: Record) -> float:
    start = process_time()
    residuals(record)
    return process_time() - start


def test_a_constant_that_is_not_known_here_is_refused() -> None:
    with pytest.raises(ValueError, match="throat_radius"):
        Spread.of({"throat_radius": 1e-4})


def test_the_spread_of_a_fit_is_that_of_its_constants() -> None:
    engine = engine_on_stand()
    hypothesis = base_hypothesis(engine, loaded(engine.oxidizer_mass, 0.3))
    size = hypothesis.size
    fitted = SimpleNamespace(hypothesis=hypothesis, x=np.zeros(size), covariance=0.25 * np.eye(size))
    spread = Spread.of_fit(cast("Any", fitted))
    deviations = dict(zip(spread.names, np.sqrt(spread.covariance.diagonal()), strict=True))
    assert deviations["oxidizer_mass"] == pytest.approx(0.15)
    assert deviations["area"] == pytest.approx(0.5 * hypothesis.jacobian(np.zeros(size))[0, 0])


def test_a_tank_above_the_critical_pressure_is_refused_with_its_reason() -> None:
    test = recorded(run_of()).plus("p_tank", 40e5)
    found = residuals(test)
    for name in (*TANK, "feed", "chamber_mass"):
        assert found[name].reason == "the tank's pressure leaves the range of saturated nitrous oxide"
    assert np.abs(found["nozzle"].value).max() < 5.0


def test_a_small_injector_area_is_known_as_well_as_a_large_loss_factor() -> None:
    """Their variances differ by twenty-eight orders of magnitude."""
    engine = engine_on_stand()
    both = Spread.of({"area": 0.01 * engine.feed.area, "loss_factor": 0.01 * engine.feed.loss_factor})
    flow = {r.equation: r for r in weak_residuals(recorded(run_of()), engine, both)}["chamber_mass"]
    alone = Spread.of({"area": 0.01 * engine.feed.area})
    less = {r.equation: r for r in weak_residuals(recorded(run_of()), engine, alone)}["chamber_mass"]
    exact = {r.equation: r for r in weak_residuals(recorded(run_of()), engine)}["chamber_mass"]
    # a percent of the area is a percent of the oxidizer's flow, and n percent of the fuel's
    assert np.sqrt(less.std[3] ** 2 - exact.std[3] ** 2) == pytest.approx(0.01 * 1.3, rel=0.2)
    assert flow.std == pytest.approx(less.std, rel=1e-6)
