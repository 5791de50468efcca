"""The performance table, the histories and the sensors' verdicts, on logs whose truth is written down here."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from simulated.engines import hf5_like
from tests.products.cf import check
from tests.segment.stand import AMBIENT, THROAT, Trial, definition, fire, log_of, segments_of

from hfanalysis.performance.efficiency import efficiencies, ideal
from hfanalysis.performance.flows import Flows
from hfanalysis.performance.histories import ABOUT, Histories, clock, measured_histories, write_histories
from hfanalysis.performance.measured import HOLES, Fire, fire_of, impulse_inputs, impulse_to, measured
from hfanalysis.performance.thrust import Thrust
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.sections import GrainSection, ObservedSection
from hfanalysis.record.signals import Signal
from hfanalysis.units import Value

BURN = ObservedSection(burn_time=Value(9.0, 0.1))
GRAIN = GrainSection(mass=Value(1.6, 0.01))
AREA = np.pi * THROAT**2


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=500.0)


def with_thrust(log: TestLog, thrust: Channel) -> TestLog:
    return replace(log, channels={**log.channels, "thrust": thrust})


def table(log: TestLog, test: Trial, **change: Any) -> dict[str, Quantity]:
    stated = {"observed": BURN, "grain": GRAIN} | change
    return measured(log, segments_of(test), definition(test.stand, **stated), None)


def test_the_impulse_is_that_of_the_burn(burn: Trial) -> None:
    found = table(log_of(burn), burn)
    inside = (burn.time >= 0.0) & (burn.time <= 9.0)
    true = float(np.trapezoid(burn.values["thrust"][inside], burn.time[inside]))
    assert found["total_impulse"].value == pytest.approx(true, rel=1e-3)
    assert found["average_thrust"].value == pytest.approx(true / 9.0, rel=1e-3)
    assert found["specific_impulse_loaded"].value == pytest.approx(true / 9.80665 / (burn.stand.mass + 1.6), rel=1e-3)


def test_the_raw_files_integral_stands_beside_it(burn: Trial) -> None:
    log = log_of(burn)
    raw = log["thrust"].values + 200.0
    found = table(with_thrust(log, replace(log["thrust"], raw=raw)), burn)
    length = float(np.ptp(burn.time))
    whole = float(np.trapezoid(burn.values["thrust"], burn.time)) + 200.0 * length
    assert found["total_impulse_of_file"].value == pytest.approx(whole, rel=1e-3)
    assert found["total_impulse"].value < 0.9 * whole


def test_a_peak_is_that_of_the_mean_curve_and_not_of_its_oscillation(burn: Trial) -> None:
    log = log_of(burn)
    p = log["p_chamber"]
    ringing = replace(p, values=p.values + 3e5 * np.sin(2.0 * np.pi * 40.0 * p.time) * (p.time > 100.0))
    found = table(replace(log, channels={**log.channels, "p_chamber": ringing}), burn)
    assert ringing.values.max() > 1.15 * burn.values["p_chamber"].max()
    assert found["peak_chamber_pressure"].value == pytest.approx(burn.values["p_chamber"].max(), rel=0.02)


def test_a_flagged_spike_is_no_peak(burn: Trial) -> None:
    log = log_of(burn)
    p = log["p_chamber"]
    values, flags = p.values.copy(), p.flags.copy()
    hit = int(np.searchsorted(p.time, 102.0))
    values[hit], flags[hit] = 500e5, 8
    spiked = replace(log, channels={**log.channels, "p_chamber": replace(p, values=values, flags=flags)})
    found = table(spiked, burn)["peak_chamber_pressure"].value
    assert found == pytest.approx(table(log, burn)["peak_chamber_pressure"].value, rel=1e-4)


def test_what_is_left_is_no_propellant_burned(burn: Trial) -> None:
    left = ObservedSection(burn_time=Value(9.0), fuel_mass_after=Value(0.4, 0.01), oxidizer_mass_after=Value(1.0, 0.1))
    found = table(log_of(burn), burn, observed=left)
    assert found["fuel_mass"].value == pytest.approx(1.2)
    assert found["oxidizer_mass"].value == pytest.approx(burn.stand.mass - 1.0)


@pytest.mark.parametrize(("without", "name"), [("thrust", "total_impulse"), ("p_chamber", "peak_chamber_pressure")])
def test_a_missing_channel_takes_its_numbers_with_it(burn: Trial, without: str, name: str) -> None:
    found = table(log_of(burn, without=(without,)), burn)
    assert found[name].value is None
    assert found[name].reason == f"the log has no {without}"
    assert found["burn_time"].value == 9.0


def test_a_grain_that_is_not_stated_takes_the_specific_impulse(burn: Trial) -> None:
    found = table(log_of(burn), burn, grain=None)
    assert found["specific_impulse_loaded"].reason == "test.toml does not state [grain] mass"
    assert found["total_impulse"].value is not None


def test_the_end_of_the_fuel_ends_the_burn_where_nobody_saw_it(burn: Trial) -> None:
    gone = segments_of(burn, t_fuel_out=Quantity(7.0, "s", 0.02))
    found = fire_of(gone, definition(burn.stand))
    assert isinstance(found, Fire)
    assert (found.end, found.std) == (7.0, 0.02)
    assert fire_of(segments_of(burn), definition(burn.stand)).startswith("the end of the burn is not known")  # type: ignore[union-attr]


def test_histories_are_read_with_their_units(burn: Trial, tmp_path: Path) -> None:
    log, segments = log_of(burn), segments_of(burn)
    time = clock(log, segments, 6.0)
    found = Histories(
        time, measured_histories(log, segments, definition(burn.stand), time), {"of_ratio": "a and n are missing"}
    )
    write_histories(tmp_path / "performance.h5", found, {"version": "1"})
    check(tmp_path / "performance.h5")
    with h5py.File(tmp_path / "performance.h5") as file:
        assert set(file) == {"time", "thrust_raw", "thrust_corrected", "p_chamber"}
        for name in file:
            assert file[name].attrs["units"] == ABOUT[name][0]
        at = float(np.interp(2.0, file["time"], file["p_chamber"]))
    true = float(np.interp(2.0, burn.time, burn.values["p_chamber"]))
    assert at == pytest.approx(true, rel=1e-3)
    assert true > 5.0 * AMBIENT


def test_c_star_ends_where_nitrogen_enters_and_the_thrust_coefficient_does_not() -> None:
    """The chamber pressure is kept up by a gas that is in none of the flows."""
    engine, time = hf5_like(), np.arange(0.0, 10.0, 0.02)
    fed = np.where(time < 6.0, 1.0, np.exp(-(time - 6.0)))
    flows = Flows(time, fed, 0.12 * fed, np.full(time.size, 1e-3), np.full(time.size, 0.03))
    held = {"p_chamber": np.full(time.size, 10e5), "thrust_corrected": np.full(time.size, 2300.0)}
    fire = Fire(9.5, 0.1, "video")
    blind, told = (
        efficiencies(held, flows, engine, ideal(held, flows, engine, AMBIENT, fire, purge)) for purge in (None, 6.0)
    )
    before, after = (time > 0.5) & (time < 5.8), (time > 6.5) & (time < 9.0)
    np.testing.assert_array_equal(told["c_star"][before], blind["c_star"][before])
    assert np.nanmax(blind["c_star"][after]) > 5.0 * blind["c_star"][before].mean()
    assert np.isnan(told["c_star"][after]).all()
    assert np.isnan(told["c_star_efficiency"][after]).all()
    assert np.isfinite(told["thrust_coefficient_efficiency"][after]).all()


def test_an_impulse_whose_burn_ends_in_a_hole_has_a_deviation() -> None:
    time = np.arange(-1.0, 8.0, 1e-2)
    kept = (time < 4.5) | (time > 5.5)
    channel = Channel(
        "thrust", "N", time[kept], 5000.0 * (time[kept] < 5.0), np.zeros(kept.sum(), np.uint8), 5.0, True, ""
    )
    found = impulse_to(
        TestLog({"thrust": channel}), Thrust(Signal.of(channel), 0.0, np.nan), Fire(5.0, 0.1, ""), definition()
    )
    assert found.std is not None
    assert abs((found.value or 0.0) - 25000.0) < 3.0 * found.std


def test_an_impulse_across_a_hole_hangs_on_means_and_is_less_sure() -> None:
    time = np.arange(-1.0, 8.0, 1e-3)
    clean = np.where((time > 0.0) & (time < 5.0), 5000.0 - 600.0 * time, 0.0)
    rng = np.random.default_rng(3)

    def impulse(hole: tuple[float, float] | None) -> tuple[float, float]:
        kept = np.ones(time.size, dtype=bool) if hole is None else (time <= hole[0]) | (time >= hole[1])
        read = clean + 300.0 * rng.standard_normal(time.size)
        channel = Channel("thrust", "N", time[kept], read[kept], np.zeros(kept.sum(), np.uint8), 5.0, True, "")
        found = impulse_to(
            TestLog({"thrust": channel}), Thrust(Signal.of(channel), 0.0, np.nan), Fire(5.0, 1e-3, ""), definition()
        )
        assert found.value is not None
        assert found.std is not None
        assert ("bridged" in (found.why or "")) == (hole is not None)
        return found.value, found.std

    true = float(np.trapezoid(clean, time))
    _, sure = impulse(None)
    off = [impulse((2.0, 3.0)) for _ in range(20)]
    # a line between single samples would be off by 300 N / sqrt(2) over the second
    assert np.std([value - true for value, _ in off]) < 60.0
    # the means lie 1.1 s apart; each of a hundred samples
    expected = np.hypot(sure, 660.0 / np.sqrt(12.0))
    assert np.mean([std for _, std in off]) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("rate", [100.0, 10.0, 4.0, 2.0])
def test_an_impulse_is_no_surer_than_its_samples_are_close(rate: float) -> None:
    """The fire comes and goes at once, and burns roughly: the instants between the samples are any."""
    rng = np.random.default_rng(1)
    found = []
    for _ in range(60):
        time, out = np.arange(-2.0 - rng.random() / rate, 9.0, 1.0 / rate), 5.0 + rng.random() / rate
        read = np.where((time > 0.0) & (time < out), 4000.0 + 200.0 * rng.standard_normal(time.size), 0.0)
        channel = Channel("thrust", "N", time, read, np.zeros(time.size, np.uint8), 1.0, True, "")
        thrust = Thrust(Signal.of(channel), 0.0, np.nan)
        log, fire_ = TestLog({"thrust": channel}), Fire(6.0, 1e-3, "")
        one = impulse_to(log, thrust, fire_, definition())
        assert one.value is not None
        (between,) = (i.effect for i in impulse_inputs(log, thrust, fire_, definition(), one.value) if i.name == HOLES)
        found.append((one.value - 4000.0 * out, between))
    off, std = np.array(found, dtype=float).T
    assert np.std(off) == pytest.approx(std.mean(), rel=0.35)
