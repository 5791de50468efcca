"""Injectors that flash and choke: what knows of it finds the truth within its interval, the report's laws do not."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from simulated.feed import CASES, Emptied, Feed, definition_of, emptied, log_of, segments_of

from hfanalysis.calibrate.tank import calibrate
from hfanalysis.effects import effect
from hfanalysis.engine.effect import Active
from hfanalysis.products.calibration import TankConstants
from hfanalysis.quantity import Quantity

FIRST, OWN, DYER, MIXTURE, HOT = CASES


@cache
def run(feed: Feed) -> Emptied:
    return emptied(feed)


@cache
def found(feed: Feed, properties: str = "coolprop", area: float | None = 0.0) -> TankConstants:
    true = run(feed)
    return calibrate(log_of(feed, true), segments_of(true), definition_of(feed, properties, area), 60).constants


def holds(told: Quantity, truth: float) -> bool:
    assert told.interval is not None, told.reason
    return told.interval[0] <= truth <= told.interval[1]


@pytest.mark.parametrize("feed", [FIRST, DYER, MIXTURE, HOT], ids=lambda f: f.name)
def test_the_discharge_coefficient_is_told_by_the_law_that_the_injector_has(feed: Feed) -> None:
    told = found(feed)
    assert holds(told.C_d[feed.liquid], feed.C_d)
    assert not holds(told.C_i, feed.C_d)
    for law in {"spi", "hem", "dyer"} - {feed.liquid}:
        assert not holds(told.C_d[law], feed.C_d), law


def test_the_report_table_of_properties_finds_it_too() -> None:
    assert holds(found(OWN, "report").C_d["hem"], OWN.C_d)


def test_holes_that_are_not_measured_leave_every_coefficient_open_by_5_per_cent() -> None:
    for told, sure in ((found(OWN, area=None), found(OWN)),):
        for unknown, known in ((told.C_i, sure.C_i), (told.C_d["hem"], sure.C_d["hem"])):
            assert unknown.value == pytest.approx(known.value)
            assert unknown.std is not None
            assert unknown.value is not None
            assert unknown.std / unknown.value == pytest.approx(0.05, rel=0.3)
        assert told.oxidizer_flow_peak.std == pytest.approx(sure.oxidizer_flow_peak.std, rel=0.1)  # it knows no area


@pytest.mark.parametrize("feed", [FIRST, MIXTURE], ids=lambda f: f.name)
def test_m_of_choked_vapor_is_told_where_its_coefficient_is_that_of_the_liquid(feed: Feed) -> None:
    told = found(feed)
    assert told.C_i.value == pytest.approx(feed.vapor_C_d, rel=0.02)
    assert holds(told.m_choked, feed.m)
    assert not holds(told.m, feed.m)


@pytest.mark.parametrize("feed", [OWN, HOT], ids=lambda f: f.name)
def test_else_its_coefficient_is_within_what_an_m_of_vapor_needs(feed: Feed) -> None:
    told = found(feed)
    assert holds(told.vapor_C_d, feed.vapor_C_d)
    assert not holds(told.m_choked, feed.m)
    assert not holds(told.m, feed.m)


def test_the_verdict_names_all_three_and_what_would_decide() -> None:
    told = found(OWN)
    assert told.m.value is not None
    assert told.m_choked.value is not None
    why = str(told.m.why)
    assert f"{told.m.value:.2f} by the report's law" in why
    assert f"{told.m_choked.value:.2f} where the vapor chokes with C_d = C_i" in why
    assert "an m of 1.0 to 1.3 needs a C_d of" in why
    assert "cold flow of vapor" in why
    assert (told.m_choked.verdict, told.vapor_C_d.verdict) == ("conditional", "conditional")


def test_what_reaches_the_injector_is_the_tanks_liquid_with_its_enthalpy_kept() -> None:
    """By CoolProp, at nine instants of the liquid phase."""
    from CoolProp.CoolProp import PropsSI

    true, told = run(FIRST), found(FIRST)
    at = (np.arange(9) + 0.5) / 9.0 * true.t_v
    tank, line = (np.interp(at, true.time, true.values[n]) for n in ("p_tank", "p_run"))
    enthalpy = PropsSI("H", "P", tank, "Q", np.zeros(9), "NitrousOxide")
    assert told.inlet is not None
    for name, key in (("quality", "Q"), ("density", "D")):
        expected = PropsSI(key, "P", line, "H", enthalpy, "NitrousOxide").mean()
        assert getattr(told.inlet, name).value == pytest.approx(expected, rel=0.03), name  # with the sensors' errors
    saturated = [PropsSI("T", "P", p, "Q", np.zeros(9), "NitrousOxide").mean() for p in (line, tank)]
    assert told.inlet.subcooling.value == pytest.approx(saturated[0] - saturated[1], abs=0.3)


def test_values_hang_on_no_default() -> None:
    """What is not stated widens intervals, and moves nothing."""
    sure, open_ = found(OWN), found(OWN, area=None)
    for name, told in sure.quantities.items():
        assert told.value == open_.quantities[name].value, name


def test_an_adopted_effect_that_chokes_acts_on_m_alone() -> None:
    """Nothing chokes twice: m is that of the choked vapor then, and what stands beside it is as it was."""
    true, plain = run(FIRST), found(FIRST)
    choked = Active(effect("injector_choked_vapor"), (1.0, 1.2))
    told = calibrate(log_of(FIRST, true), segments_of(true), definition_of(FIRST), 60, [choked]).constants
    assert told.m.value == pytest.approx(FIRST.m, abs=0.15)  # line and injector are one restriction to the effect
    for beside, alone in ((told.m_choked, plain.m_choked), (told.vapor_C_d, plain.vapor_C_d)):
        assert beside.value == pytest.approx(alone.value)
        assert beside.ci95 == pytest.approx(alone.ci95)  # draws in another order sum to another last digit
    assert "report's law" not in str(told.m.why)
