"""Saturated nitrous oxide from both sources: every slope is that of its curve, and every curve is where it belongs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hfanalysis.arrays import Array
from hfanalysis.thermo import coolprop_nitrous
from hfanalysis.thermo.nitrous import SOURCES, saturation
from hfanalysis.thermo.saturation import Property, Saturation

Curve = Callable[[Saturation, float], tuple[Array, Array]]

CURVES: dict[str, Curve] = {
    "saturation pressure": lambda s, t: (s.pressure(t), s.pressure_slope(t)),
    "liquid volume": lambda s, t: s.liquid_volume(t),
    "vapor volume": lambda s, t: s.vapor_volume(t),
    "liquid energy": lambda s, t: s.energy(Property.LIQUID_ENERGY, t),
    "vapor energy": lambda s, t: s.energy(Property.VAPOR_ENERGY, t),
    "liquid enthalpy": lambda s, t: s.energy(Property.LIQUID_ENTHALPY, t),
    "vapor enthalpy": lambda s, t: s.energy(Property.VAPOR_ENTHALPY, t),
}

both_sources = pytest.mark.parametrize("source", SOURCES)


@both_sources
@pytest.mark.parametrize("name", CURVES)
@given(place=st.floats(0.0, 1.0))
def test_a_slope_is_the_finite_difference_of_its_curve(source: str, name: str, place: float) -> None:
    nitrous, curve = saturation(source), CURVES[name]
    t = nitrous.t_min + 0.02 + place * (nitrous.t_max - 0.002 - nitrous.t_min - 0.02)
    h = 1e-4 * (nitrous.critical_temperature - t)  # towards the critical point every curve bends within ever less
    (above, _), (below, _) = curve(nitrous, t + h), curve(nitrous, t - h)
    value, slope = curve(nitrous, t)
    turning = 1e-7 * abs(value) / (nitrous.critical_temperature - t)  # u_v and h_v have a maximum, where the slope is 0
    assert slope == pytest.approx((above - below) / (2.0 * h), rel=1e-6, abs=turning)


@both_sources
def test_warming_expands_the_liquid_and_compresses_the_vapor(source: str) -> None:
    nitrous = saturation(source)
    t = np.linspace(nitrous.t_min, nitrous.t_max, 500)
    assert (nitrous.liquid_volume(t)[1] > 0.0).all()
    assert (nitrous.vapor_volume(t)[1] < 0.0).all()
    assert (nitrous.pressure_slope(t) > 0.0).all()
    assert (nitrous.liquid_density(t) >= nitrous.vapor_density(t)).all()


@both_sources
@given(place=st.floats(0.0, 1.0))
def test_the_temperature_of_a_saturation_pressure_is_the_one_it_came_from(source: str, place: float) -> None:
    nitrous = saturation(source)
    t = nitrous.t_min + place * (nitrous.t_max - nitrous.t_min)
    assert nitrous.temperature(nitrous.pressure(t)) == pytest.approx(t, abs=1e-8)


@both_sources
def test_the_temperature_keeps_the_shape_of_the_pressures(source: str) -> None:
    nitrous = saturation(source)
    t = np.array([[200.0, 280.0, 300.0], [305.0, 190.0, 250.0]])
    np.testing.assert_allclose(nitrous.temperature(nitrous.pressure(t)), t, rtol=1e-10)


@both_sources
def test_outside_its_range_a_source_says_nothing(source: str) -> None:
    nitrous = saturation(source)
    outside = np.array([nitrous.t_min - 0.1, nitrous.t_max + 0.1, np.nan])
    for curve in CURVES.values():
        value, slope = curve(nitrous, outside)  # type: ignore[arg-type]
        assert np.isnan(value).all()
        assert np.isnan(slope).all()
    low, high = nitrous.pressure_range
    assert np.isnan(nitrous.temperature([0.99 * low, 1.01 * high, -1.0, np.nan])).all()
    assert np.isfinite(nitrous.temperature([low, high])).all()


@both_sources
def test_enthalpy_exceeds_energy_by_the_work_of_displacement(source: str) -> None:
    """h - u = p v: exact in one equation of state, a few per cent where a correlation and a table meet."""
    nitrous = saturation(source)
    t = np.linspace(190.0, 305.0, 60)
    work = nitrous.pressure(t) * nitrous.vapor_volume(t)[0]
    gap = nitrous.energy(Property.VAPOR_ENTHALPY, t)[0] - nitrous.energy(Property.VAPOR_ENERGY, t)[0]
    worst = np.abs(gap / work - 1.0).max()
    assert worst < 1e-7 if source == "coolprop" else 0.005 < worst < 0.06


def test_an_unknown_source_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"'refprop'; known: coolprop, report"):
        saturation("refprop")


def test_the_table_is_the_equation_of_state_between_its_nodes_too() -> None:
    nitrous = saturation("coolprop")
    intervals = nitrous.coefficients.shape[1]
    theta = nitrous.theta_start + nitrous.theta_step * (np.arange(0, intervals, 6) + 0.5)
    exact = dict(zip(Property, coolprop_nitrous.sample(theta), strict=True))
    t = nitrous.critical_temperature * (1.0 - theta**3)
    capacities = nitrous.heat_capacities(t)
    found = {
        Property.LN_PRESSURE: nitrous.pressure(t),
        Property.LIQUID_VOLUME: nitrous.liquid_volume(t)[0],
        Property.LN_VAPOR_VOLUME: nitrous.vapor_volume(t)[0],
        Property.LN_VAPOR_CV: capacities[0],
        Property.LN_VAPOR_CP: capacities[1],
        Property.VAPOR_GRUENEISEN: nitrous.grueneisen(t),
    }
    for p in Property:
        value = found[p] if p in found else nitrous.energy(p, t)[0]
        truth = np.exp(exact[p]) if p.name.startswith("LN_") else exact[p]
        close = t < 309.0 if p is Property.LN_VAPOR_CP else t < nitrous.t_max  # c_p is infinite at 309.52 K
        np.testing.assert_allclose(value[close], truth[close], rtol=1e-7, err_msg=p.name)


def test_the_reports_pressure_lies_above_the_equation_of_state_by_1_4_per_cent_at_25_degrees() -> None:
    ratio = saturation("report").pressure(298.15) / saturation("coolprop").pressure(298.15)
    assert ratio == pytest.approx(1.0137, abs=0.0005)


def test_both_sources_agree_on_the_volumes_and_on_heat_of_vaporisation() -> None:
    a, b = saturation("coolprop"), saturation("report")
    t = np.linspace(200.0, 300.0, 21)
    np.testing.assert_allclose(a.liquid_density(t), b.liquid_density(t), rtol=0.01)
    np.testing.assert_allclose(a.vapor_density(t), b.vapor_density(t), rtol=0.01)
    heat = [s.energy(Property.VAPOR_ENTHALPY, t)[0] - s.energy(Property.LIQUID_ENTHALPY, t)[0] for s in (a, b)]
    np.testing.assert_allclose(*heat, rtol=0.01)


@both_sources
def test_the_isentropic_exponent_is_that_of_the_speed_of_sound(source: str) -> None:
    """rho c^2 / p of CoolProp's saturated vapor; the report's pressure lies 1 to 5 % above that of its table."""
    from CoolProp.CoolProp import PropsSI

    nitrous = saturation(source)
    for t in (240.0, 270.0, 290.0):
        sound = PropsSI("A", "T", t, "Q", 1, "NitrousOxide")
        exact = sound**2 * PropsSI("D", "T", t, "Q", 1, "NitrousOxide") / PropsSI("P", "T", t, "Q", 1, "NitrousOxide")
        assert nitrous.isentropic_exponent(t) == pytest.approx(exact, rel=1e-4 if source == "coolprop" else 0.05)


def test_both_sources_agree_on_grueneisens_parameter() -> None:
    """One from the equation of state's slope, one from what the table's energy does along saturation."""
    t = np.linspace(200.0, 300.0, 21)
    np.testing.assert_allclose(saturation("report").grueneisen(t), saturation("coolprop").grueneisen(t), rtol=2e-3)
