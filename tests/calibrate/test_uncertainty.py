"""Intervals: they hold the value, they grow with what is uncertain, and they are the same each time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.segment.stand import Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.tank import calibrate
from hfanalysis.products.calibration import TankConstants
from hfanalysis.quantity import Quantity
from hfanalysis.record.sections import Injector
from hfanalysis.units import Value

SAMPLES = 120
NAMES = ("C_i", "m", "K_loss", "Z", "vapor_mass_at_t_v")


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def calibrated(burn: Trial, accuracy: float = 1e3, std: float = 1e-4, **change: Any) -> TankConstants:
    log = log_of(burn, white=1e3, accuracy=accuracy)
    stated = definition(burn.stand, **({"mass": Value(burn.stand.mass, 0.0)} | change))
    return calibrate(log, segments_of(burn, std=std), stated, SAMPLES).constants


def test_the_same_test_gives_the_same_numbers(burn: Trial) -> None:
    one, other = calibrated(burn), calibrated(burn)
    assert one.quantities == other.quantities


def test_an_interval_holds_its_value(burn: Trial) -> None:
    for name, quantity in calibrated(burn, 1e4, 0.01, mass=Value(10.0, 0.02)).quantities.items():
        assert quantity.value is not None
        assert quantity.interval is not None
        low, high = quantity.interval
        assert low < quantity.value < high, name
        assert quantity.std is not None
        assert high - low == pytest.approx(2.0 * 1.96 * quantity.std, rel=0.35), name


@pytest.mark.parametrize(
    ("more", "grows"),
    [
        pytest.param({"accuracy": 2e4}, NAMES, id="sensors off by 0.2 bar"),
        pytest.param({"std": 0.02}, ("m", "vapor_mass_at_t_v"), id="phases known to 20 ms"),
        pytest.param({"mass": Value(10.0, 0.3)}, ("C_i", "K_loss"), id="mass known to 0.3 kg"),
        pytest.param({"volume": Value(16.5e-3, 0.2e-3)}, ("C_i", "vapor_mass_at_t_v"), id="volume known to 0.2 L"),
        pytest.param({"injector": Injector(22, Value(3.142e-6, 0.1e-6))}, ("C_i",), id="holes known to 3 %"),
    ],
)
def test_what_is_less_well_known_widens_what_depends_on_it(
    burn: Trial, more: dict[str, Any], grows: tuple[str, ...]
) -> None:
    sure, unsure = calibrated(burn), calibrated(burn, **more)
    for name in grows:
        a, b = sure.quantities[name].std, unsure.quantities[name].std
        assert a is not None
        assert b is not None
        assert b > 1.5 * a, name


def test_the_deviation_of_C_i_is_that_of_the_mass_where_only_the_mass_is_uncertain(burn: Trial) -> None:
    """C_i goes with the liquid's mass: 0.3 kg of it."""
    found = calibrated(burn, mass=Value(10.0, 0.3))
    c, liquid = found.quantities["C_i"], found.quantities["oxidizer_mass_liquid_phase"]
    assert c.std is not None
    assert c.value is not None
    assert liquid.value is not None
    assert c.std / c.value == pytest.approx(0.3 / liquid.value, rel=0.15)  # 120 draws give a deviation to 6 %


def test_stated_deviations_are_honest() -> None:
    """Over 25 logs with their own noise and biases the errors scatter as the deviations say."""
    accuracy = 1e4
    burn = fire(rate=200.0)
    generator = np.random.default_rng(21)
    z: dict[str, list[float]] = {"C_i": [], "m": [], "K_loss": []}
    for seed in range(25):
        biased = {n: v + accuracy * generator.standard_normal() for n, v in burn.values.items()}
        test = Trial(burn.stand, burn.time, biased, burn.t_v, burn.t_purge, burn.p_v, burn.flow, burn.mass)
        log = log_of(test, white=5e3, flicker=1e5, seed=seed, accuracy=accuracy)
        std = 0.005
        times = {
            n: Quantity(t + std * generator.standard_normal(), "s", std)
            for n, t in (("t_v", burn.t_v), ("t_purge", burn.t_purge))
        }
        mass = burn.stand.mass + 0.05 * generator.standard_normal()
        stated = definition(burn.stand, mass=Value(mass, 0.05))
        found = calibrate(log, segments_of(test, **times), stated, SAMPLES).constants
        for name, scores in z.items():
            quantity, truth = found.quantities[name], getattr(burn.stand, name)
            assert quantity.value is not None
            assert quantity.std is not None
            scores.append((quantity.value - truth) / quantity.std)
    for name, scores in z.items():
        assert abs(np.mean(scores)) < 0.65, name  # 3.2 standard errors of a mean of 25
        assert 0.6 < np.std(scores) < 1.45, name
