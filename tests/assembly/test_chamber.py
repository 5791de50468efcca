"""The chamber of an engine that is put together is as large as its parts."""

from __future__ import annotations

from math import pi
from pathlib import Path

import pytest
from tests.products.filled import filled
from tests.segment.stand import definition

from hfanalysis.assembly.calibrated import Regression, engine_of_test
from hfanalysis.assembly.engine import engine, tank
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import Needs, load_engine
from hfanalysis.record.sections import Chamber, GrainSection
from hfanalysis.units import Value

PRE, POST = 0.218e-3, 0.885e-3
GRAIN = GrainSection(mass=Value(1.6), length=Value(0.61), density=Value(900.0), outer_radius=Value(39.5e-3))


def test_of_a_test() -> None:
    """What its chamber holds at rest is ambient air in both volumes and the port."""
    stated = definition(grain=GRAIN, chamber=Chamber(pre_volume=Value(PRE), post_volume=Value(POST)))
    constants = {"C_i": 0.3, "m": 1.1, "K_loss": 2e8, "oxidizer_mass": 9.0}
    calibration = filled(Calibration, {name: Quantity(value) for name, value in constants.items()})
    built = engine_of_test(stated, calibration, 293.15, Regression(1e-4, 0.5))
    fuel = pi * 900.0 * 0.61 * (39.5e-3**2 - built.port_radius**2)
    assert fuel == pytest.approx(1.6)
    assert built.dead_volume == pytest.approx(PRE + POST)


def test_of_an_engine_file() -> None:
    """The report's design point has 0.218 L before its grain and 0.885 L behind it."""
    path = Path(__file__).parents[2] / "engines" / "maelstrom.toml"
    needs = Needs(load_engine(path), "simulate")
    assert engine(needs, tank(needs)).dead_volume == pytest.approx(1.103e-3)
