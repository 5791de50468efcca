"""a and n of an engine whose gauge sits at the head of a port hardly wider than its throat."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.calibrate.engine_sample import TRUTH, engine, evidence

from hfanalysis.assembly.calibrated import Regression
from hfanalysis.calibrate.evidence import Evidence, chamber_at
from hfanalysis.calibrate.narrow_port import reaching_the_head, with_stated_tap
from hfanalysis.calibrate.regression import Fitted, fit
from hfanalysis.calibrate.regression_verdict import result
from hfanalysis.effects import effect
from hfanalysis.engine.unsteady import burn
from hfanalysis.products.calibration import FuelLaw

HEAD = effect("head_end_pressure")


def stated(tap: str | None) -> Any:
    """What of a test.toml says where the gauge sits."""
    return SimpleNamespace(channels={"p_chamber": SimpleNamespace(tap=tap)})


def narrow() -> Any:
    """The engine with a throat of 0.6 of its port's area at ignition."""
    return replace(engine(), throat_area=pi * engine().port_radius ** 2 / 1.6, exit_area=pi * 40e-3**2)


@cache
def seen() -> Evidence:
    """What a gauge at its head reads of its burn."""
    of_nozzle = evidence(throat_area=narrow().throat_area, exit_area=narrow().exit_area)
    lit = replace(narrow(), a=TRUTH.a, n=TRUTH.n, effects=(HEAD.at(weight=1.0, recovery=0.4),))
    burnt = burn(lit)
    noise = 0.02e5 * np.random.default_rng(3).standard_normal(of_nozzle.time.size)
    gone = replace(of_nozzle.burn_time, value=burnt.burn_time) if of_nozzle.burn_time is not None else None
    anchor = (of_nozzle.anchor[0], float(np.interp(of_nozzle.anchor[0], burnt.time, burnt.output("tank_pressure"))))
    return replace(of_nozzle, chamber=chamber_at(lit, burnt, of_nozzle.time) + noise, burn_time=gone, anchor=anchor)


@cache
def fitted(at_head: bool) -> Fitted:
    """a and n by the engine whose gauge reads the head, or the nozzle."""
    acting = with_stated_tap(stated("head"), ()) if at_head else ()
    return fit(replace(seen(), engine=replace(seen().engine, effects=acting)))


def law_of(tap: str | None) -> tuple[FuelLaw, FuelLaw]:
    """The law as the fit leaves it, and with what the place of the gauge may mean."""
    found = fitted(tap == "head")
    law = result(found)
    return law, reaching_the_head(law, found, stated(tap))


def rate(law: FuelLaw, of: Regression) -> tuple[tuple[float, float], float]:
    """The interval of the rate at the reference flux, and the true one there [m/s]."""
    flux = law.regression.reference_flux
    assert flux is not None
    assert flux.value is not None
    interval = law.regression_rate_reference.interval
    assert interval is not None
    return interval, of.a * flux.value**of.n


@pytest.mark.parametrize("tap", ["head", None])
def test_with_the_gauge_at_the_head_a_and_n_hold_the_truth_if_that_is_stated_or_left_open(tap: str | None) -> None:
    alone, law = law_of(tap)
    for name in ("a", "n"):
        low, high = getattr(law, name).interval
        assert low <= getattr(TRUTH, name) <= high, name
    (low, high), true = rate(law, TRUTH)
    assert low <= true <= high
    assert (alone.a.value, alone.n.value) == (law.a.value, law.n.value)


def test_taken_for_the_nozzles_pressure_n_is_far_off_and_not_identified() -> None:
    blind, as_it_is = law_of("aft")
    told, _ = law_of("head")
    assert blind == as_it_is
    assert blind.n.verdict == "not identifiable"
    assert told.n.verdict == "identified"
    assert abs((blind.n.value or 0.0) - TRUTH.n) > 10.0 * abs((told.n.value or 0.0) - TRUTH.n)


def test_the_head_is_in_the_model_only_where_it_is_stated() -> None:
    assert with_stated_tap(stated(None), ()) == with_stated_tap(stated("aft"), ()) == ()
    (acting,) = with_stated_tap(stated("head"), ())
    assert acting.named["weight"] == 1.0
    assert with_stated_tap(stated("head"), (acting,)) == (acting,)
