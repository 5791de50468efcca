"""The report's appendix, with its two slips corrected and nothing else changed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.thermo import report_nitrous
from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.report_nitrous import CRITICAL_TEMPERATURE, LIQUID_VOLUME, TABLE
from hfanalysis.thermo.saturation import Property

TEMPERATURE, NU_V, U_L, H_L, U_V, H_V, C_V, C_P = TABLE.T
KILOJOULE_PER_MOL = 1e6 / OXIDIZER_MOLAR_MASS
"""J/kg in a kJ/mol."""

# d/dT as Table 2 prints it: T, nu_v [m^3/(kmol K)], u_l, h_l, u_v, h_v [J/(kmol K)], c_v, c_p [J/(kmol K^2)];
# central differences of Table 1 over 2 x 5 K; the two entries that inherit the slip in c_v stand as they should
TABLE_2 = """
    190 -0.58932 75719 76013  19200  25200 119.4 187.0
    220 -0.11312 78050 79030  14500  17600 141.1 298.6
    240 -0.04777 81250 83090   9400   9700 148.5 436.7
    245 -0.03941 82340 84470   7700   7300 150.9 492.5
    250 -0.032761 83570 86040  5800   4600 154.0 563.3
    255 -0.027442 84990 87830  3600   1500 157.9 655.1
    260 -0.023171 86640 89910  1100  -2100 162.8 777.0
    295 -0.009221 119210 129400 -47300 -64900 312.4 9183.0
"""


def test_at_25_degrees_pressure_and_liquid_volume_are_the_certified_ones() -> None:
    assert report_nitrous.saturation_pressure(298.15) == pytest.approx(57.3e5, abs=0.05e5)
    assert report_nitrous.liquid_molar_volume(298.15) == pytest.approx(59.3e-3, abs=0.05e-3)


@given(t=st.floats(182.4, 309.4))
def test_the_liquid_expands_on_heating_and_the_printed_sign_would_have_it_shrink(t: float) -> None:
    h = 1e-4 * (CRITICAL_TEMPERATURE - t)
    volume, slope = report_nitrous.liquid_molar_volume, report_nitrous.liquid_molar_volume_slope(t)
    difference = (volume(t + h) - volume(t - h)) / (2.0 * h)
    assert slope > 0.0
    assert slope == pytest.approx(difference, rel=1e-6)
    _, c2, c3, c4 = LIQUID_VOLUME
    as_printed = (c4 / c3) * np.log(c2) * volume(t) * (1.0 - t / c3) ** (c4 - 1.0)
    assert as_printed == pytest.approx(-difference, rel=1e-6)


@given(t=st.floats(182.4, 309.4))
def test_the_slope_of_the_pressure_correlation_is_its_finite_difference(t: float) -> None:
    p = report_nitrous.saturation_pressure
    assert report_nitrous.saturation_pressure_slope(t) == pytest.approx((p(t + 1e-3) - p(t - 1e-3)) / 2e-3, rel=1e-7)


def test_the_correlations_are_what_the_smooth_set_holds() -> None:
    t = np.linspace(183.0, 309.0, 200)
    nitrous = saturation("report")
    np.testing.assert_allclose(nitrous.pressure(t), report_nitrous.saturation_pressure(t), rtol=1e-8)
    np.testing.assert_allclose(nitrous.pressure_slope(t), report_nitrous.saturation_pressure_slope(t), rtol=1e-5)
    per_kmol = OXIDIZER_MOLAR_MASS * np.array(nitrous.liquid_volume(t))
    np.testing.assert_allclose(per_kmol[0], report_nitrous.liquid_molar_volume(t), rtol=1e-8)
    np.testing.assert_allclose(per_kmol[1], report_nitrous.liquid_molar_volume_slope(t), rtol=1e-5)


def test_every_node_of_the_reports_table_is_reproduced() -> None:
    nitrous = saturation("report")
    np.testing.assert_allclose(nitrous.vapor_volume(TEMPERATURE)[0] * OXIDIZER_MOLAR_MASS, NU_V, rtol=1e-6)
    columns = {
        Property.LIQUID_ENERGY: U_L,
        Property.LIQUID_ENTHALPY: H_L,
        Property.VAPOR_ENERGY: U_V,
        Property.VAPOR_ENTHALPY: H_V,
    }
    for p, column in columns.items():
        found = nitrous.energy(p, TEMPERATURE)[0] / KILOJOULE_PER_MOL
        np.testing.assert_allclose(found, column, atol=1e-6, err_msg=p.name)
    c_v, c_p = (c / KILOJOULE_PER_MOL for c in nitrous.heat_capacities(TEMPERATURE[:-1]))
    np.testing.assert_allclose(c_v, C_V[:-1], rtol=1e-5)
    np.testing.assert_allclose(c_p, C_P[:-1], rtol=1e-5)


def test_the_tables_phases_meet_at_its_last_node_but_the_liquids_correlation_does_not() -> None:
    """Its critical temperature is 0.05 K higher, so that at the table's end the liquid is still 10 % denser."""
    nitrous, last = saturation("report"), 309.52
    for liquid, vapor in (
        (Property.LIQUID_ENERGY, Property.VAPOR_ENERGY),
        (Property.LIQUID_ENTHALPY, Property.VAPOR_ENTHALPY),
    ):
        assert nitrous.energy(liquid, last)[0] == pytest.approx(nitrous.energy(vapor, last)[0], rel=1e-9)
    assert nitrous.liquid_density(last) / nitrous.vapor_density(last) == pytest.approx(1.104, abs=0.001)


def test_heat_capacities_rise_on_beyond_their_last_entry() -> None:
    t = np.linspace(300.0, 309.52, 200)
    for capacity in saturation("report").heat_capacities(t):
        assert (np.diff(capacity) > 0.0).all()


def test_the_heat_capacity_at_250_K_lies_between_its_neighbors() -> None:
    at = dict(zip(TEMPERATURE, C_V, strict=True))
    assert at[250.0] == 0.034798
    assert at[245.0] < at[250.0] < at[255.0]
    smooth = C_V[1 : list(TEMPERATURE).index(280.0)]
    assert np.abs(np.diff(smooth, 2)).max() < 7e-5  # as printed, 0.043798, it would be a spike of 0.018


@pytest.mark.parametrize("row", TABLE_2.strip().splitlines(), ids=lambda row: row.split()[0] + " K")
def test_the_reports_second_table_holds_the_differences_of_the_first(row: str) -> None:
    t, *printed = map(float, row.split())
    i = int(np.flatnonzero(t == TEMPERATURE)[0])
    difference = (TABLE[i + 1, 1:] - TABLE[i - 1, 1:]) / (TABLE[i + 1, 0] - TABLE[i - 1, 0])
    scale = np.array([1.0, 1e6, 1e6, 1e6, 1e6, 1e6, 1e6])  # kJ/mol to J/kmol
    rounding = np.array([1e-5, 1.0, 1.0, 1.0, 1.0, 0.06, 0.6])
    assert (np.abs(difference * scale - printed) < rounding).all()


def test_the_printed_slips_of_the_second_table_come_from_the_printed_heat_capacity() -> None:
    """With 0.043798 at 250 K the differences are 1050.9 and -742.1: the corrected column is not the printed one."""
    at = dict(zip(TEMPERATURE, C_V, strict=True))
    assert (0.043798 - at[240.0]) / 10.0 * 1e6 == pytest.approx(1050.9, abs=0.06)
    assert (at[260.0] - 0.043798) / 10.0 * 1e6 == pytest.approx(-742.1, abs=0.06)
