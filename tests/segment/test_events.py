"""The single events, each from the signals that show it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from simulated.stand import noise
from tests.segment.stand import AMBIENT, Stand, Trial, fire, signal

from hfanalysis.arrays import Array
from hfanalysis.engine.tank import mass_along_blowdown
from hfanalysis.record.signals import Signal
from hfanalysis.segment.end_of_burn import CRITICAL_RATIO, find_low_pressure
from hfanalysis.segment.falls import abrupt_falls
from hfanalysis.segment.feed import find_line_full
from hfanalysis.segment.fuel import find_fuel_end
from hfanalysis.segment.fuel_at_once import _dated
from hfanalysis.segment.kind import Known, recognize
from hfanalysis.segment.liquid import dry_pressure, find_liquid_end
from hfanalysis.segment.purge import find_nitrogen
from hfanalysis.thermo.nitrous import SOURCES, saturation

RATE = 500.0
TIME = np.arange(-4.0, 10.0, 1.0 / RATE)


def noisy(name: str, value: Array, white: float = 5e3, seed: int = 0) -> Signal:
    return signal(name, TIME, value + noise(np.random.default_rng(seed), TIME.size, RATE, white, 1e4))


def since(instant: float) -> Array:
    return np.maximum(TIME - instant, 0.0)


def signals_of(test: Trial, white: float = 5e3) -> dict[str, Signal]:
    rate = 1.0 / float(np.median(np.diff(test.time)))
    generator = np.random.default_rng(1)
    scale = {"thrust": 2e-3}
    return {
        n: signal(n, test.time, v + scale.get(n, 1.0) * noise(generator, v.size, rate, white, 1e4))
        for n, v in test.values.items()
    }


# --- the line is full -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fill", [0.1, 0.25])
def test_the_line_is_full_at_98_per_cent_of_its_highest_pressure(fill: float) -> None:
    """p_run = p_a + 40 bar (1 - e^(-t/fill)) exceeds 98 % of its maximum at -fill ln(0.02 (1 + p_a/40 bar))."""
    run = noisy("p_run", AMBIENT + 40e5 * (1.0 - np.exp(-since(0.0) / fill)))
    found = find_line_full(run, 6.0)
    assert not isinstance(found, str)
    expected = -fill * np.log(0.02 * (1.0 + AMBIENT / 40e5))
    assert found[0] == pytest.approx(expected, abs=max(0.03, 3.0 * found[1]))
    assert found[1] < 0.1


def test_only_the_time_before_the_liquid_is_gone_counts() -> None:
    """A nitrogen pressure above that of the liquid phase is no filling line."""
    rise = AMBIENT + 40e5 * (1.0 - np.exp(-since(0.0) / 0.1)) + 30e5 * (TIME > 7.0)
    found = find_line_full(noisy("p_run", rise), 6.0)
    assert not isinstance(found, str)
    assert found[0] < 0.6


def test_a_line_that_is_full_at_once_shows_no_filling() -> None:
    run = noisy("p_run", np.where(TIME >= 0.0, 40e5 - 2e5 * TIME, AMBIENT))
    assert "no filling to see" in str(find_line_full(run, 6.0))


def test_a_line_with_hardly_a_sample_shows_nothing() -> None:
    run = noisy("p_run", AMBIENT + 40e5 * (1.0 - np.exp(-since(0.0) / 0.1)))
    assert find_line_full(run, 0.01) == "too few good samples of p_run before the liquid is gone"


def test_a_line_that_stays_at_ambient_is_never_full() -> None:
    assert isinstance(find_line_full(noisy("p_run", np.full(TIME.size, AMBIENT)), 6.0), str)


# --- the liquid is gone -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("source", SOURCES)
def test_a_tank_runs_dry_at_the_pressure_that_its_mass_and_energy_allow(source: str) -> None:
    test = fire(Stand(source=source))
    expected = dry_pressure(saturation(source), test.stand.volume, test.stand.mass, float(test.values["p_tank"][0]))
    assert expected == pytest.approx(test.p_v, rel=2e-3)


def test_a_tank_that_cannot_be_saturated_has_no_such_pressure() -> None:
    nitrous = saturation()
    assert dry_pressure(nitrous, 16.5e-3, 10.0, 80e5) is None
    least = float(mass_along_blowdown(nitrous, 16.5e-3, 292.0, np.array([293.15]))[0])
    assert dry_pressure(nitrous, 16.5e-3, 0.5 * least, 50e5) is None


def test_the_knee_of_the_tank_pressure_dates_the_end_of_the_liquid() -> None:
    test = fire(rate=RATE)
    only_tank = {"p_tank": signals_of(test)["p_tank"]}
    found = find_liquid_end(only_tank, test.t_purge, test.p_v)
    assert found is not None
    assert found.channels == ("p_tank",)
    assert found.time == pytest.approx(test.t_v, abs=3.0 * found.std)
    assert found.std < 0.05


@pytest.mark.parametrize("step", [0.2, 0.4, 0.58, 0.7])
def test_a_slow_log_dates_it_badly_and_says_so(step: float) -> None:
    """Its windows reach from the rest before the opening to the nitrogen, whose corners are none of the liquid."""
    test = fire(rate=RATE)
    every = slice(None, None, round(step * RATE))
    slow = {n: signal(n, s.time[every], s.value[every]) for n, s in signals_of(test).items()}
    found = find_liquid_end(slow, test.t_purge, test.p_v)
    assert found is not None
    assert abs(found.time - test.t_v) < 2.0 * found.std
    assert found.std < 2.0 * step


def test_chamber_and_thrust_fall_with_the_liquid_and_date_it_best() -> None:
    test = fire(rate=RATE)
    found = find_liquid_end(signals_of(test), test.t_purge, test.p_v)
    assert found is not None
    assert set(found.channels) == {"p_tank", "p_chamber", "thrust"}
    assert found.time == pytest.approx(test.t_v, abs=3.0 * found.std)
    assert found.std < 0.002


def test_a_tank_without_a_knee_shows_no_end_of_the_liquid() -> None:
    slow = noisy("p_tank", 50e5 - 2e5 * since(0.0))
    assert find_liquid_end({"p_tank": slow}, 9.0, None) is None


def test_of_two_knees_the_one_at_the_dry_pressure_is_taken() -> None:
    """The later one is sharper: there the supply was shut. Mass and energy tell that the liquid went at the first."""
    pressure = 50e5 - 3e5 * since(0.0) - 9e5 * since(4.0) + 6e5 * since(4.5) - 14e5 * since(5.5)
    tank = noisy("p_tank", np.maximum(pressure, AMBIENT))
    first = find_liquid_end({"p_tank": tank}, 6.5, 38e5)
    later = find_liquid_end({"p_tank": tank}, 6.5, 27e5)
    assert first is not None
    assert later is not None
    assert first.time == pytest.approx(4.0, abs=0.1)
    assert later.time == pytest.approx(5.5, abs=0.1)


# --- nitrogen enters --------------------------------------------------------------------------------------------------


def sagging(instant: float, level: float = 30e5) -> Array:
    return np.asarray(level * (1.0 - 0.25 * (1.0 - np.exp(-since(instant) / 1.5))))


def test_nitrogen_enters_when_its_line_starts_to_sag() -> None:
    found = find_nitrogen(noisy("p_purge", sagging(6.3)), 9.9, noisy("p_tank", np.full(TIME.size, 25e5)))
    assert not isinstance(found, str)
    assert found[0] == pytest.approx(6.3, abs=max(4.0 * found[1], 0.01))
    assert found[1] < 0.02


@pytest.mark.parametrize("early", [0.1, 0.15, 0.18, 0.3])
def test_the_corner_at_the_end_of_the_liquid_is_not_that_of_the_nitrogen(early: float) -> None:
    """The line follows the tank, slowly, and three times as fast once the liquid is gone."""
    purge = 30e5 - 3.3e5 * since(6.3) - 9e5 * since(6.3 + early)
    tank = noisy("p_tank", np.full(TIME.size, 25e5))
    found = find_nitrogen(noisy("p_purge", np.maximum(purge, 6e5)), 9.9, tank, knee=6.3 + early)
    assert not isinstance(found, str)
    assert found[0] == pytest.approx(6.3, abs=max(4.0 * found[1], 0.01))
    assert found[1] < 0.03


@pytest.mark.parametrize("seed", range(3))
def test_noise_ten_times_a_sensors_makes_the_date_less_sure_and_not_later(seed: int) -> None:
    """The sag shows itself above the noise a second or two after it has begun."""
    line = signal("p_purge", TIME[::5], noisy("p_purge", sagging(4.3), 1.2e5, seed).value[::5])
    found = find_nitrogen(line, 9.9, None)
    assert not isinstance(found, str)
    assert abs(found[0] - 4.3) < 2.6 * found[1]
    assert 0.02 < found[1] < 0.5


def test_valve_hammer_is_no_nitrogen() -> None:
    purge = sagging(6.3)
    purge[(TIME > 2.0) & (TIME < 2.05)] -= 10e5
    purge[(TIME > 4.0) & (TIME < 4.002)] -= 25e5
    found = find_nitrogen(noisy("p_purge", purge), 9.9, None)
    assert not isinstance(found, str)
    assert found[0] == pytest.approx(6.3, abs=0.02)


def test_a_line_that_keeps_its_pressure_lets_no_nitrogen_in() -> None:
    found = find_nitrogen(noisy("p_purge", np.full(TIME.size, 30e5)), 9.9, None)
    assert found == "the purge line keeps its pressure to the end of the log"


def test_nothing_enters_a_tank_that_stands_above_the_line() -> None:
    found = find_nitrogen(noisy("p_purge", sagging(6.3)), 9.9, noisy("p_tank", np.full(TIME.size, 45e5)))
    assert isinstance(found, str)
    assert "(45.0 bar) stands above it (30.0 bar): no nitrogen can enter" in found


def test_without_a_quiet_time_before_the_opening_the_line_says_nothing() -> None:
    purge = noisy("p_purge", sagging(6.3)).between(0.0, 10.0)
    assert find_nitrogen(purge, 9.9, None) == "the log has no quiet purge line before the opening"


# --- the fuel is gone -------------------------------------------------------------------------------------------------


def test_a_sudden_end_of_the_fuel_is_dated() -> None:
    test = fire(Stand(t_fuel_out=3.4), rate=RATE)
    found = find_fuel_end(signals_of(test), AMBIENT, 0.1, (test.t_v, 1e-3), 9.0)
    assert not isinstance(found, str)
    assert found.time == pytest.approx(3.4, abs=3.0 * found.std)
    assert found.std < 0.02
    assert found.gone == pytest.approx(3.4, abs=2.0 * found.gone_std)
    assert found.time < found.gone < 3.42
    assert found.at_once


def test_a_fall_that_the_thrust_does_not_share_is_no_end_of_the_fuel() -> None:
    test = fire(Stand(t_fuel_out=3.4), rate=RATE)
    signals = signals_of(test)
    signals["thrust"] = signals_of(fire(rate=RATE))["thrust"]
    found = find_fuel_end(signals, AMBIENT, 0.1, (test.t_v, 1e-3), 9.0)
    assert isinstance(found, str)


def test_the_end_of_the_liquid_is_not_taken_for_that_of_the_fuel() -> None:
    test = fire(rate=RATE)
    found = find_fuel_end(signals_of(test), AMBIENT, 0.1, (test.t_v, 1e-3), 9.0)
    assert isinstance(found, str)
    assert "do not fall against the feed" in found


def ending_beside_the_liquid(apart: float, rate: float = RATE) -> Trial:
    """A test whose fuel is gone ``apart`` seconds after the liquid, whose end moves with that of the fuel."""
    test = fire(Stand(t_fuel_out=5.7 + apart), rate=rate)
    for _ in range(3):
        test = fire(Stand(t_fuel_out=test.t_v + apart), rate=rate)
    return test


def rippled(test: Trial, share: float = 0.03) -> dict[str, Signal]:
    """Its signals with a combustion oscillation of 43 Hz."""
    ripple = 1.0 + share * np.sin(2.0 * np.pi * 43.0 * test.time + 1.0)
    chamber = AMBIENT + (test.values["p_chamber"] - AMBIENT) * ripple
    values = {**test.values, "p_chamber": chamber, "thrust": test.values["thrust"] * ripple}
    return signals_of(replace(test, values=values))


@pytest.mark.parametrize("rate", [250.0, 1000.0])
@pytest.mark.parametrize("apart", [-0.3, -0.2, -0.16, -0.1, 0.09, 0.12, 0.2, 0.3, 0.5])
def test_fuel_and_liquid_that_end_close_to_each_other_are_told_apart(apart: float, rate: float) -> None:
    test = ending_beside_the_liquid(apart, rate)
    signals = rippled(test)
    liquid = find_liquid_end(signals, 8.0, test.p_v)
    assert liquid is not None
    assert liquid.time == pytest.approx(test.t_v, abs=0.006)
    fuel = find_fuel_end(signals, AMBIENT, 0.1, (liquid.time, 1e-3), 9.0)
    assert not isinstance(fuel, str)
    assert fuel.time == pytest.approx(test.t_v + apart, abs=0.006)


def test_near_the_end_of_the_liquid_too_the_thrust_has_to_fall_with_the_chamber() -> None:
    test = ending_beside_the_liquid(0.09)
    signals = signals_of(test)
    signals["thrust"] = signals_of(fire(rate=RATE))["thrust"]
    assert isinstance(find_fuel_end(signals, AMBIENT, 0.1, (test.t_v, 1e-3), 9.0), str)


@pytest.mark.parametrize("relaxation", [0.005, 0.02, 0.05, 0.15])
def test_a_chamber_that_empties_slowly_after_the_liquid_is_no_end_of_the_fuel(relaxation: float) -> None:
    test = fire(rate=1000.0)
    gone = np.maximum(test.time - test.t_v, 0.0)
    fed = test.values["thrust"] / np.where(gone > 0.0, 0.35 + 0.65 * np.exp(-gone / 0.004), 1.0)
    thrust = fed * (0.35 + 0.65 * np.exp(-gone / relaxation))
    chamber = AMBIENT + thrust * np.ptp(test.values["p_chamber"]) / np.ptp(test.values["thrust"])
    slow = replace(test, values={**test.values, "p_chamber": chamber, "thrust": thrust})
    assert isinstance(find_fuel_end(signals_of(slow), AMBIENT, 0.1, (test.t_v, 1e-3), 9.0), str)


def test_a_bend_in_the_noise_near_ambient_cannot_be_dated_and_is_no_sudden_fall() -> None:
    ramp = np.interp(TIME, [5.0, 6.0, 6.4, 7.0], [0.45e5, 0.35e5, 0.1e5, 0.08e5])
    assert _dated({"p_chamber": noisy("p_chamber", AMBIENT + ramp, 8e3)}, 6.2, 3.0) is None
    step = np.where(TIME < 6.2, 1.5e5, 0.7e5)
    sudden = _dated({"p_chamber": noisy("p_chamber", AMBIENT + step, 8e3)}, 6.2, 3.0)
    assert sudden is not None
    assert sudden.time == pytest.approx(6.2, abs=0.01)


def test_abrupt_falls_are_told_apart_and_a_tail_or_a_swing_is_none() -> None:
    def level(*falls: float, relaxation: float = 0.004) -> Array:
        return np.prod([0.6 + 0.4 * np.exp(-since(t) / relaxation) for t in falls], axis=0) * 10e5

    assert abrupt_falls(noisy("p_chamber", level(3.0, 3.08)), 0.0, 2.0, 4.0) == pytest.approx([3.0, 3.08], abs=0.015)
    assert abrupt_falls(noisy("p_chamber", level(3.0, relaxation=0.3)), 0.0, 2.0, 4.0) == []
    swing = 10e5 * (1.0 - 0.4 * np.exp(-0.5 * ((TIME - 3.0) / 0.02) ** 2))
    assert abrupt_falls(noisy("p_chamber", swing), 0.0, 2.0, 4.0) == []
    assert abrupt_falls(noisy("p_chamber", level(3.0)), 0.0, 20.0, 21.0) == []


def test_fuel_that_thins_out_before_the_liquid_is_gone_is_dated_where_its_fade_begins() -> None:
    run = noisy("p_run", np.full(TIME.size, 35e5))
    level = np.interp(TIME, [-4.0, 0.0, 0.05, 4.0, 5.2, 10.0], [0.0, 0.0, 12e5, 12e5, 4e5, 4e5])
    signals = {"p_run": run, "p_chamber": noisy("p_chamber", AMBIENT + level)}
    found = find_fuel_end(signals, AMBIENT, 0.1, (5.3, 1e-3), 5.3)
    assert not isinstance(found, str)
    assert found.time == pytest.approx(4.0, abs=0.15)
    assert 0.02 < found.std < 0.12
    assert found.gone is None
    assert "goes on to the end of the liquid" in found.hidden
    shared = find_fuel_end({**signals, "thrust": noisy("thrust", 2e-3 * level, 5.0)}, AMBIENT, 0.1, (5.3, 1e-3), 5.3)
    assert shared == found
    not_shared = {**signals, "thrust": noisy("thrust", np.full(TIME.size, 2400.0), 5.0)}
    assert isinstance(find_fuel_end(not_shared, AMBIENT, 0.1, (5.3, 1e-3), 5.3), str)


def fading_fire(run: Array, goes: float = 5.3) -> dict[str, Signal]:
    """Signals of a fire that fades for 0.4 s after the liquid is gone (at 4 s), until what is left of it goes out."""
    level = np.interp(TIME, [0.0, 0.05, 4.0, 4.01, 4.9], [0.0, 12e5, 10e5, 3e5, 2.4e5])
    level = level * np.interp(TIME, [4.9, 5.0, 5.1, 5.2, 5.3], [1.0, 0.9, 0.7, 0.5, 0.35])
    level = level * np.where(goes > TIME, 1.0, 0.05 + 0.95 * np.exp(-since(goes) / 0.003))
    thrust = 2e-3 * level + noise(np.random.default_rng(1), TIME.size, RATE, 5.0, 0.0)
    read = {"p_run": noisy("p_run", run), "p_chamber": noisy("p_chamber", AMBIENT + level)}
    return {**read, "thrust": signal("thrust", TIME, thrust)}


EMPTYING = 20e5 * np.exp(-np.maximum(TIME - 4.0, 0.0) / 3.0)


def test_a_fire_that_fades_is_dated_where_what_is_left_of_it_goes_out() -> None:
    found = find_fuel_end(fading_fire(EMPTYING), AMBIENT, 0.1, (4.0, 1e-3), 9.0)
    assert not isinstance(found, str)
    assert found.time == pytest.approx(5.3, abs=0.01)
    assert found.std < 0.01
    assert found.gone == pytest.approx(5.3, abs=0.02)
    assert found.at_once


@pytest.mark.parametrize("then", [0.0, 1.15], ids=["ahead of its sensor", "behind it"])
def test_where_the_feed_ends_a_fire_goes_out_with_fuel_left(then: float) -> None:
    closed = np.where(TIME < 5.3, 1.0, then + (1.0 - then) * np.exp(-since(5.3) / 0.03))
    assert isinstance(find_fuel_end(fading_fire(EMPTYING * closed), AMBIENT, 0.1, (4.0, 1e-3), 9.0), str)


def test_a_fire_that_fades_to_its_end_goes_out_at_no_instant() -> None:
    signals = fading_fire(EMPTYING, goes=np.inf)
    assert isinstance(find_fuel_end(signals, AMBIENT, 0.1, (4.0, 1e-3), 9.0), str)


def test_without_the_run_line_the_fuel_cannot_be_told_from_the_feed() -> None:
    test = fire(Stand(t_fuel_out=3.4), rate=RATE)
    signals = {n: s for n, s in signals_of(test).items() if n != "p_run"}
    assert "without p_run" in str(find_fuel_end(signals, AMBIENT, 0.1, (test.t_v, 1e-3), 9.0))


def test_a_chamber_at_ambient_says_nothing_of_the_fuel() -> None:
    signals = {
        "p_run": noisy("p_run", np.full(TIME.size, 35e5)),
        "p_chamber": noisy("p_chamber", np.full(TIME.size, AMBIENT)),
    }
    assert "not above ambient for long enough" in str(find_fuel_end(signals, AMBIENT, 0.1, (5.0, 1e-3), 9.0))


# --- the chamber's pressure falls for good ----------------------------------------------------------------------------


def test_a_chamber_that_empties_between_two_samples_dates_its_own_end() -> None:
    chamber = noisy("p_chamber", AMBIENT + 2e5 * ((TIME > 0.0) & (TIME < 4.0)))
    found = find_low_pressure(chamber, AMBIENT, 0.1)
    assert not isinstance(found, str)
    assert found[0] == pytest.approx(4.0, abs=chamber.step)
    assert found[1] < chamber.step


def test_t_end_is_where_the_pressure_falls_below_its_level() -> None:
    """p_c = p_a + 12 bar e^(-t/2) reaches 1.8 p_a at 2 ln(12 bar / 0.8 p_a)."""
    chamber = noisy("p_chamber", AMBIENT + 12e5 * np.exp(-since(0.0) / 2.0) * (TIME > 0.0))
    found = find_low_pressure(chamber, AMBIENT, 0.1)
    assert not isinstance(found, str)
    expected = 2.0 * np.log(12e5 / ((CRITICAL_RATIO - 1.0) * AMBIENT))
    assert found[0] == pytest.approx(expected, abs=3.0 * found[1])
    assert 0.005 < found[1] < 0.3


def test_a_pressure_that_never_rises_has_no_end() -> None:
    cold = noisy("p_chamber", AMBIENT + 0.5e5 * (TIME > 0.0), white=1e3)
    assert find_low_pressure(cold, AMBIENT, 0.1) == "the chamber pressure never is above 1.8 times ambient"


def test_a_log_that_ends_under_pressure_says_so() -> None:
    hot = noisy("p_chamber", AMBIENT + 12e5 * (TIME > 0.0))
    assert "13.0 bar in the chamber, above 1.8 times ambient" in str(find_low_pressure(hot, AMBIENT, 0.1))
    assert "the log ends before" in str(find_low_pressure(hot.between(-4.0, 0.1), AMBIENT, 0.1))


# --- what kind of run it was ------------------------------------------------------------------------------------------


def standing(chamber: float, run: float = 35e5) -> dict[str, Signal]:
    return {
        "p_chamber": noisy("p_chamber", np.full(TIME.size, AMBIENT + chamber), 1e3),
        "p_run": noisy("p_run", np.full(TIME.size, run), 1e3),
    }


@pytest.mark.parametrize("geometry", [(1.5, 1.7e-3), (None, None)], ids=["by c*", "by its share of the feed"])
@pytest.mark.parametrize(
    ("chamber", "stated", "kind", "misfire"),
    [
        (14e5, "hot_fire", "hot_fire", False),
        (14e5, "cold_flow", "hot_fire", False),
        (1.5e5, "cold_flow", "cold_flow", False),
        (1.5e5, "hot_fire", "cold_flow", True),
    ],
)
def test_a_fire_is_told_from_a_cold_flow(
    geometry: tuple[float | None, float | None], chamber: float, stated: str, kind: str, misfire: bool
) -> None:
    found = recognize(standing(chamber), stated, (0.1, 5.0), Known(AMBIENT, *geometry))
    assert (found.name, found.misfire) == (kind, misfire)
    assert found.why


def test_without_a_chamber_pressure_the_kind_is_as_stated() -> None:
    signals = {"p_run": standing(0.0)["p_run"]}
    assert recognize(signals, "cold_flow", (0.1, 5.0), Known(AMBIENT, None, None)).name == "cold_flow"
    assert "as stated" in recognize(signals, "hot_fire", (0.1, 5.0), Known(AMBIENT, None, None)).why


@pytest.mark.parametrize(("seconds", "kind"), [(0.5, "cold_flow"), (1.5, "hot_fire")])
def test_a_fire_that_is_out_early_in_the_liquid_phase_is_one_and_an_igniter_is_none(seconds: float, kind: str) -> None:
    time = np.arange(-1.0, 6.0, 1e-3)
    fire = (time > 0.1) & (time < 0.1 + seconds)
    pressure = AMBIENT + np.where(fire, 16e5, np.where(time > 0.0, 2e5, 0.0))
    signals = {"p_chamber": Signal("p_chamber", time, pressure, 1e3, 1e-3)}
    found = recognize(signals, "hot_fire", (0.1, 5.0), Known(AMBIENT, 1.2, 1.1e-3))
    assert (found.name, found.misfire) == (kind, kind == "cold_flow")
    assert (" s" in found.why.partition(", from ")[2]) == (kind == "hot_fire")
