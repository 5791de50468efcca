"""What sensor effects do to readings, and that they leave the engine alone."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.effects.runs import OF_SENSORS, base, only, typical, with_effects

from hfanalysis.effects import effect
from hfanalysis.effects.chamber_tap_lag import lagged
from hfanalysis.effects.load_cell_drift import LEAST_OVERPRESSURE, heat_clock
from hfanalysis.engine.observe import CHANNELS, distorted, observe

Array = NDArray[np.float64]

TIMES = np.linspace(0.0, 8.0, 801)


@pytest.mark.parametrize("name", OF_SENSORS)
def test_a_sensor_effect_leaves_the_engine_alone(name: str) -> None:
    found = with_effects(typical(name))
    assert np.array_equal(found.states, base().states)
    assert np.array_equal(found.outputs, base().outputs)


@pytest.mark.parametrize("name", OF_SENSORS)
def test_strength_zero_reads_the_truth_to_the_last_bit(name: str) -> None:
    found = observe(base(), TIMES, [effect(name).at()])
    truth = observe(base(), TIMES, [])
    assert all(np.array_equal(found[channel], truth[channel]) for channel in CHANNELS)


@pytest.mark.parametrize("name", OF_SENSORS)
def test_a_distortion_changes_the_channels_that_it_names(name: str) -> None:
    found = effect(name)
    strong = found.at(**{p.name: p.typical for p in found.parameters[: found.strengths]})
    read, truth = observe(base(), TIMES, [strong]), observe(base(), TIMES, [])
    changed = {channel for channel in CHANNELS if not np.array_equal(read[channel], truth[channel])}
    assert changed == set(found.sites)


def test_readings_are_free_of_the_order_in_which_effects_are_named() -> None:
    chosen = [typical(name) for name in OF_SENSORS]
    one, other = observe(base(), TIMES, chosen), observe(base(), TIMES, chosen[::-1])
    assert all(np.array_equal(one[channel], other[channel]) for channel in CHANNELS)


def test_an_engines_own_effects_are_read_unless_others_are_given() -> None:
    found = only("load_cell_drift", drift=200.0)
    heat = heat_clock(TIMES, observe(found, TIMES)["p_chamber"], 0.5)[-1]
    drift = 200.0 * (1.0 - np.exp(-heat / 10.0))
    assert drift > 50.0
    assert observe(found, TIMES)["thrust"][-1] == pytest.approx(observe(found, TIMES, [])["thrust"][-1] + drift)


def test_the_tanks_scale_weighs_nitrogen_too() -> None:
    found = only("n2_purge", area=4e-6, supply_pressure=35e5)
    read = observe(found, np.array([9.0]))["m_tank"][0]
    states = found.steps.at(np.array([9.0]))[0][0]
    assert read == pytest.approx(states[0] + states[8])
    assert states[8] > 0.01


def test_a_drift_is_nothing_at_ignition_and_whole_when_the_cell_is_warm() -> None:
    drift = effect("load_cell_drift").at(drift=-300.0, time=1.0)
    read, truth = observe(base(), TIMES, [drift])["thrust"], observe(base(), TIMES, [])["thrust"]
    assert read[0] == truth[0]
    assert read[-1] - truth[-1] == pytest.approx(-300.0, rel=0.02)


@pytest.mark.parametrize(("power", "warmed"), [(0.0, 5.0), (0.5, 2.0 * 3.0**0.5), (1.0, 6.0)])
def test_a_cell_warms_with_a_power_of_the_pressure_and_by_time_where_that_is_not_known(
    power: float, warmed: float
) -> None:
    """Two seconds at 30 bar above the surroundings are six at 10, and once the fire is out nothing warms it; to the
    power of nothing all five seconds count."""
    times = np.linspace(-1.0, 5.0, 6001)
    pressure = np.where((times >= 0.0) & (times < 2.0), 31e5, 1e5)
    clock = heat_clock(times, pressure, power)
    assert clock[times < 0.0].max() == 0.0
    soaked = 3.0 * LEAST_OVERPRESSURE**power
    assert clock[-1] == pytest.approx(warmed + (soaked if power > 0.0 else 0.0), rel=1e-3)
    assert np.ptp(clock[times > 2.001]) == pytest.approx(soaked, rel=0.01)
    assert heat_clock(times, np.zeros(times.size), power) == pytest.approx(np.maximum(times, 0.0))


def test_one_transducer_can_be_off_by_itself() -> None:
    off = effect("pressure_transducer_offset").at(p_run=0.3e5, before=1.0)
    read, truth = observe(base(), TIMES, [off]), observe(base(), TIMES, [])
    assert not off.idle
    assert read["p_run"] - truth["p_run"] == pytest.approx(0.3e5)
    assert np.array_equal(read["p_tank"], truth["p_tank"])


def test_a_lag_delays_a_ramp_by_its_time_constant() -> None:
    ramp = 3e5 * TIMES
    assert lagged(TIMES, ramp, np.full(TIMES.size, 0.05))[-1] == pytest.approx(3e5 * (8.0 - 0.05), rel=1e-9)


def test_a_lag_answers_a_step_exponentially() -> None:
    times = np.array([0.0, 1e-9, 0.05, 0.1])
    assert lagged(times, np.array([0.0, 1.0, 1.0, 1.0]), np.full(4, 0.05)) == pytest.approx(
        [0.0, 0.0, 1.0 - np.exp(-1.0), 1.0 - np.exp(-2.0)], abs=1e-6
    )


def test_a_lag_of_nothing_reads_the_truth_and_grows_out_of_it_linearly() -> None:
    wave = np.sin(TIMES)
    assert np.array_equal(lagged(TIMES, wave, np.zeros(TIMES.size)), wave)
    small = lagged(TIMES, wave, np.full(TIMES.size, 1e-6)) - wave
    assert small[1:] / 1e-6 == pytest.approx(-np.diff(wave) / np.diff(TIMES), abs=1e-6)


@pytest.mark.parametrize("thinning", [0.0, 0.5, 1.0])
def test_a_tube_lags_the_more_the_thinner_its_gas(thinning: float) -> None:
    """The lag is stated at 10 bar; at 2.5 bar a ramp is read by 4^k of it late."""
    slope = 1e3
    ramp = 2.5e5 + slope * (TIMES - TIMES[-1])
    read = effect("chamber_tap_lag").at(lag=0.05, thinning=thinning)
    found = distorted({"p_chamber": ramp}, TIMES, [read])["p_chamber"]
    assert ramp[-1] - found[-1] == pytest.approx(slope * 0.05 * 4.0**thinning, rel=0.01)
