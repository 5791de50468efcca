"""The model's column of the performance table: sums of its own burn, and what uncertain constants make of them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi
from typing import Any

import numpy as np
import pytest
from tests.engine.stand import engine_on_stand
from tests.products.filled import filled

from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.inference.full_run import FullRun
from hfanalysis.products.calibration import Calibration, Joint
from hfanalysis.quantity import Quantity
from hfanalysis.validate.modeled import modeled

FLUX = 130.0
GRAVITY = 9.80665


@cache
def run() -> FullRun:
    engine = engine_on_stand()
    return FullRun(engine, burn(engine, longest=60.0))


def calibration(**std: float) -> Calibration:
    """What calibration.json has of the engine's constants, exact but for those that are named."""
    engine = run().engine
    values = {
        "C_i": 0.3, "m": engine.polytropic_exponent, "K_loss": engine.feed.loss_factor, "n": engine.n,
        "regression_rate_reference": engine.a * FLUX**engine.n, "oxidizer_mass": engine.oxidizer_mass,
    }  # fmt: skip
    found = {n: Quantity(v, std=std.get(n, 0.0)) for n, v in values.items()}
    return filled(Calibration, {**found, "regression": {"reference_flux": Quantity(FLUX)}})


def impulse_by_hand(found: Burn) -> float:
    return float(np.trapezoid(found.output("thrust"), found.time))


def fuel() -> float:
    """The grain's mass by its size [kg]."""
    engine, port = run().engine, float(run().burnt.state("port_radius")[0])
    return pi * engine.fuel_density * engine.grain_length * (engine.outer_radius**2 - port**2)


def test_the_table_is_the_sum_of_the_burn() -> None:
    found, burnt = modeled(run(), calibration()), run().burnt
    values = {name: quantity.value for name, quantity in found.items()}
    assert values["total_impulse"] == pytest.approx(impulse_by_hand(burnt), rel=2e-3)
    loaded = float(burnt.state("tank_mass")[0]) + fuel()
    assert values["specific_impulse_loaded"] == pytest.approx(impulse_by_hand(burnt) / (GRAVITY * loaded), rel=3e-3)
    expended = loaded - float(burnt.state("tank_mass")[-1])
    assert values["specific_impulse"] == pytest.approx(impulse_by_hand(burnt) / (GRAVITY * expended), rel=3e-3)
    assert values["specific_impulse_to_purge"] == values["specific_impulse"]
    assert values["average_thrust"] == pytest.approx(impulse_by_hand(burnt) / burnt.time[-1], rel=3e-3)
    assert values["peak_thrust"] == pytest.approx(float(burnt.output("thrust").max()))
    assert values["peak_chamber_pressure"] == pytest.approx(float(burnt.output("chamber_pressure").max()))


def with_area(engine: Engine, std: float) -> Engine:
    return replace(engine, feed=replace(engine.feed, area=engine.feed.area * (1.0 + std / 0.3)))


def with_loss(engine: Engine, std: float) -> Engine:
    return replace(engine, feed=replace(engine.feed, loss_factor=engine.feed.loss_factor + std))


def with_mass(engine: Engine, std: float) -> Engine:
    return replace(engine, oxidizer_mass=engine.oxidizer_mass + std)


def with_exponent(engine: Engine, std: float) -> Engine:
    assert engine.polytropic_exponent is not None
    return replace(engine, polytropic_exponent=engine.polytropic_exponent + std)


def with_rate(engine: Engine, std: float) -> Engine:
    return replace(engine, a=engine.a + std / FLUX**engine.n)


def with_n(engine: Engine, std: float) -> Engine:
    """About the flux at which the rate is known."""
    return replace(engine, n=engine.n + std, a=engine.a * FLUX**-std)


@pytest.mark.parametrize(
    ("name", "share", "moved"),
    [
        ("C_i", 0.02, with_area),
        ("K_loss", 0.1, with_loss),
        ("oxidizer_mass", 0.01, with_mass),
        ("m", 0.02, with_exponent),
        ("regression_rate_reference", 0.02, with_rate),
        ("n", 0.01, with_n),
    ],
)
def test_its_deviations_are_those_of_the_constants_carried_through_the_engine(
    name: str, share: float, moved: Any
) -> None:
    """Against burns drawn with them, as Gauss and Hermite would draw three."""
    std = share * getattr(calibration(), name).value
    found = modeled(run(), calibration(**{name: std}))
    burns = [burn(moved(run().engine, z * std), longest=60.0) for z in np.sqrt(3.0) * np.array([-1.0, 0.0, 1.0])]
    for told, of, least in (
        ("peak_thrust", lambda b: b.output("thrust").max(), 0.3),
        ("peak_chamber_pressure", lambda b: b.output("chamber_pressure").max(), 100.0),
        ("total_impulse", impulse_by_hand, 2.0),
        (
            "specific_impulse_loaded",
            lambda b: impulse_by_hand(b) / (GRAVITY * (b.state("tank_mass")[0] + fuel())),
            0.03,
        ),
        ("burn_time", lambda b: b.time[-1], 0.01),
    ):
        assert found[told].std == pytest.approx(drawn([float(of(b)) for b in burns]), rel=0.15, abs=least), told


def drawn(values: list[float]) -> float:
    """Standard deviation of what has these values at -sqrt(3), 0 and sqrt(3) of a normal constant's deviations."""
    weights = np.array([1.0, 4.0, 1.0]) / 6.0
    return float(np.sqrt(weights @ (np.array(values) - weights @ values) ** 2))


def test_constants_that_err_together_are_moved_together() -> None:
    """More flow and more loss at once, as the balance has them: less is left open than by each alone."""
    engine = run().engine
    std = (0.02 * engine.feed.area, 0.1 * engine.feed.loss_factor)

    def told(correlation: float) -> float:
        rows = ((1.0, correlation), (correlation, 1.0))
        joint = Joint(names=("flow_area", "K_loss"), std=std, correlation=rows)
        return modeled(run(), calibration().but(joint=joint))["peak_thrust"].std or 0.0

    moved = [
        float(burn(one, longest=60.0).output("thrust").max() - run().burnt.output("thrust").max())
        for one in (with_area(engine, 0.3 * 0.02), with_loss(engine, std[1]))
    ]
    for correlation in (0.0, 0.8, -1.0):
        variance = moved[0] ** 2 + moved[1] ** 2 + 2.0 * correlation * moved[0] * moved[1]
        assert told(correlation) == pytest.approx(np.sqrt(variance), rel=0.05)
