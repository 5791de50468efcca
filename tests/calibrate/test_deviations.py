"""What calibrated constants are stated to be known to, against references of the tests' own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.calibrate.engine_sample import TRUTH, evidence
from tests.segment.stand import Stand, Trial, definition, fire, log_of, segments_of, signal

from hfanalysis.calibrate.evidence import Evidence
from hfanalysis.calibrate.measured_pressures import read_at
from hfanalysis.calibrate.regression import fit, law_at
from hfanalysis.calibrate.regression_verdict import result
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.products.calibration import TankConstants
from hfanalysis.record.log import TestLog
from hfanalysis.record.noise import Noise
from hfanalysis.units import Value

NOISE, BURN_TIME = 0.05e5, 0.1


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def information(found: Evidence, flux: float) -> np.ndarray:
    """Of (ln r, n) at the truth, where every sample has white NOISE and the burn time its own: Fisher's matrix."""
    point = np.array([np.log(TRUTH.a * flux**TRUTH.n), TRUTH.n])
    columns = []
    for step in 0.02 * np.eye(2):
        after, before = (found.predict(law_at(point + sign * step, flux)) for sign in (1.0, -1.0))
        assert after is not None
        assert before is not None
        columns.append((after - before) / 0.04)
    slopes = np.column_stack(columns)
    weight = np.append(np.full(found.time.size, NOISE**-2), BURN_TIME**-2)
    return np.asarray(slopes.T @ (weight[:, None] * slopes))


def test_n_and_the_rate_are_known_as_well_as_noise_and_burn_time_let_them() -> None:
    """The bound of Cramer and Rao, by differences of burns about the truth."""
    seen = evidence(noise=NOISE, burn_time_std=BURN_TIME)
    told = result(fit(seen))
    flux = told.regression.reference_flux.value
    least = np.linalg.inv(information(seen, flux))
    quantities = told.quantities
    assert quantities["n"].std == pytest.approx(np.sqrt(least[1, 1]), rel=0.3)
    rate = quantities["regression_rate_reference"]
    assert rate.std / rate.value == pytest.approx(np.sqrt(least[0, 0]), rel=0.3)
    a = quantities["a"]
    direction = np.array([1.0, -np.log(flux)])
    assert a.std / a.value == pytest.approx(np.sqrt(direction @ least @ direction), rel=0.3)


def calibrated(log: TestLog, test: Trial, samples: int = 150) -> TankConstants:
    stated = definition(test.stand, mass=Value(test.stand.mass, 0.0))
    return calibrate(log, segments_of(test), stated, samples).constants


def with_sensors(log: TestLog, accuracy: float, zeroed: bool) -> TestLog:
    """Pressures of an accuracy [Pa], with or without a zero that was taken without any error."""
    change = {"accuracy": accuracy, "zero_std": 0.0 if zeroed else None}
    return replace(log, channels={n: replace(c, **change) for n, c in log.channels.items()})


def test_a_zero_at_ambient_takes_away_half_of_a_sensors_variance(burn: Trial) -> None:
    """The rest is its error of span: sensors without a zero that are the root of 2 better are as good."""
    log = log_of(burn, white=100.0)
    zeroed, better = (calibrated(with_sensors(log, a, z), burn) for a, z in ((8e4, True), (8e4 / np.sqrt(2.0), False)))
    for name in ("C_i", "m", "K_loss", "p_loss_liquid", "vapor_mass_at_t_v"):
        assert zeroed.quantities[name].std == pytest.approx(better.quantities[name].std, rel=0.03), name


def test_the_mean_loss_is_known_as_well_as_both_its_sensors(burn: Trial) -> None:
    """p_tank - p_run over the liquid phase, each off by a constant of 0.3 bar."""
    found = calibrated(with_sensors(log_of(burn), 0.3e5, False), burn)
    assert found.quantities["p_loss_liquid"].std == pytest.approx(np.sqrt(2.0) * 0.3e5, rel=0.2)


@pytest.mark.parametrize(("falls_to", "known"), [(0.66, False), (0.55, True)])
def test_without_nitrogen_a_tank_that_lost_two_fifths_of_its_pressure_tells_m(falls_to: float, known: bool) -> None:
    """Before, a bar of the pressure at t_v would be worth too much of m."""
    test = fire(Stand(vapor_time=2.5), rate=200.0)
    gone = test.time[(test.time > test.t_v) & (test.values["p_tank"] < falls_to * test.p_v)]
    assert gone.size
    end = float(gone[0])
    assert end < test.t_purge
    kept = test.time <= end
    short = replace(test, time=test.time[kept], values={n: v[kept] for n, v in test.values.items()})
    absent = replace(segments_of(test).events["t_purge"], value=None, std=None, reason="no nitrogen is seen")
    stated = definition(test.stand, mass=Value(test.stand.mass, 0.0))
    m = calibrate(log_of(short), segments_of(short, t_purge=absent), stated, 20).constants.m
    assert (m.value is not None) is known
    if known:
        assert m.value == pytest.approx(test.stand.m, rel=0.02)


@pytest.mark.parametrize("white", [1e3, 2e4, 6e4])
def test_a_pressure_at_a_corner_is_read_the_same_way_whatever_the_noise(white: float) -> None:
    """A curve laid smoothly through a corner that the noise hides reads it low."""
    time = np.arange(-0.4, 0.4, 0.02)
    corner = 33e5 - 2e5 * time - 5e5 * np.maximum(time, 0.0)
    drawn = np.random.default_rng(3).standard_normal((60, time.size))
    noise = Noise(white, 0.0, 0.02)
    read = [read_at(signal("p_tank", time, corner + white * z), 0.0, 0.4, 0.4, breaks=True) for z in drawn]
    errors = np.array([one.value - 33e5 for one in read])
    std = noise.std_of(read[0].weights, read[0].time)
    assert abs(errors.mean()) < 3.0 * std / np.sqrt(60)
    assert errors.std() == pytest.approx(std, rel=0.3)
    assert read_at(signal("p_tank", time, corner), 0.0, 0.4, 0.4, breaks=False).value < 33e5 - 1e4
