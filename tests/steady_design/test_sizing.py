"""Tank sizes by both methods of the report."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.steady_design.sizing import DipTube, TankSize, size_for_length, size_for_ullage
from hfanalysis.thermo.nitrous import saturation

TUBE = DipTube(6.35e-3, 4.572e-3)
DIAMETER = 5.047 * 0.0254
REPORT = saturation("report")


def design_tank() -> TankSize:
    return size_for_ullage(REPORT, 7.035, 298.15, DIAMETER, TUBE, 0.2)


def test_the_design_tank_is_the_certified_one() -> None:
    tank = design_tank()
    assert tank.volume == pytest.approx(10.82e-3, rel=0.005)
    assert tank.length == pytest.approx(0.8385, rel=0.005)
    assert tank.dip_tube_length == pytest.approx(0.1399, rel=0.005)


@given(st.floats(1.0, 20.0), st.floats(260.0, 305.0), st.floats(0.01, 3.0))
def test_both_methods_agree(mass: float, temperature: float, ullage: float) -> None:
    first = size_for_ullage(REPORT, mass, temperature, DIAMETER, TUBE, ullage)
    second = size_for_length(REPORT, mass, temperature, DIAMETER, TUBE, first.length)
    assert second.dip_tube_length == pytest.approx(first.dip_tube_length, rel=1e-7)
    assert second.volume == pytest.approx(first.volume, rel=1e-9)
    assert second.liquid_mass == pytest.approx(first.liquid_mass, rel=1e-7)


@given(st.floats(1.0, 20.0), st.floats(260.0, 305.0), st.floats(0.01, 3.0))
def test_the_tank_holds_its_mass_at_its_ullage(mass: float, temperature: float, ullage: float) -> None:
    tank = size_for_ullage(REPORT, mass, temperature, DIAMETER, TUBE, ullage)
    assert tank.liquid_mass + tank.vapor_mass == pytest.approx(mass, rel=1e-12)
    liquid = tank.liquid_mass / float(REPORT.liquid_density(temperature))
    vapor = tank.vapor_mass / float(REPORT.vapor_density(temperature))
    assert vapor / liquid == pytest.approx(ullage, rel=1e-9)
    assert liquid + vapor == pytest.approx(tank.volume, rel=1e-9)


def test_the_dip_tube_only_takes_its_wall_from_the_ullage() -> None:
    bare = size_for_ullage(REPORT, 7.035, 298.15, DIAMETER, DipTube(0.0, 0.0), 0.2)
    assert design_tank().dip_tube_length == pytest.approx(
        bare.dip_tube_length / (1.0 - (6.35e-3**2 - 4.572e-3**2) / DIAMETER**2), rel=1e-12
    )
    assert design_tank().volume == pytest.approx(bare.volume, rel=1e-12)


@pytest.mark.parametrize("ullage", [0.0, -0.1, float("nan")])
def test_a_tank_without_ullage_is_refused(ullage: float) -> None:
    with pytest.raises(ValueError, match="ullage has to be positive"):
        size_for_ullage(REPORT, 7.035, 298.15, DIAMETER, TUBE, ullage)


@pytest.mark.parametrize("length", [0.1, 0.6, 10.0])
def test_a_tank_too_short_or_too_long_is_refused(length: float) -> None:
    with pytest.raises(ValueError, match="no saturated tank"):
        size_for_length(REPORT, 7.035, 298.15, DIAMETER, TUBE, length)
