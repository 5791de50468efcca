"""How long does the fire take to go out?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some
from scipy.integrate import quad
from tests.engine.stand import engine_on_stand
from tests.inference import logged, made

from hfanalysis.diagnose.answer.effect_source import acting
from hfanalysis.diagnose.answer.posterior import LEAST_EVIDENCE
from hfanalysis.effects import effect
from hfanalysis.engine.effect import Active
from hfanalysis.inference.fitting.fade import (
    FARTHEST_MISFIT,
    abrupt_end,
    bounded,
    fade_misfit,
    fade_slope,
    with_abrupt_end,
)
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.observations.burn_out import LAG, UNSURE, fade_of
from hfanalysis.inference.observations.observed import FADE
from hfanalysis.quantity import Quantity
from hfanalysis.record.signals import Signal

STEP, SPEED = 1e-3, 1.5e-3
SEGMENTS = logged.segments()
GONE = SEGMENTS.time("t_fuel_out") or 0.0


def falling(pressure: float, thrust: float, step: float = STEP) -> dict[str, Signal]:
    """Signals that fall within so many seconds as the fuel ends, on a slow decline and with noise."""
    rng, time = np.random.default_rng(3), np.arange(-1.0, GONE + 2.0, step)
    out = {}
    for name, level, seconds in (("p_chamber", 9e5, pressure), ("thrust", 1500.0, thrust)):
        value = level * (1.2 - 0.03 * time - 0.8 * np.clip((time - GONE) / seconds, 0.0, 1.0))
        value += 0.01 * level * rng.standard_normal(time.size)
        out[name] = Signal(name, time, value, 0.01 * level, step)
    return out


@settings(max_examples=10)
@given(some.floats(0.01, 0.2))
def test_a_fall_is_timed(seconds: float) -> None:
    found = fade_of(falling(seconds, seconds), SEGMENTS)
    assert found is not None
    assert found[0] == pytest.approx(seconds, rel=0.3)
    assert found[1] == pytest.approx(np.hypot(UNSURE, np.hypot(LAG, 2.0 * STEP) / found[0]))


def test_a_slow_line_to_the_chambers_sensor_is_no_slow_fall() -> None:
    found = fade_of(falling(0.15, 0.01), SEGMENTS)
    assert found is not None
    assert found[0] == pytest.approx(0.01, rel=0.3)


def test_what_does_not_tell() -> None:
    both = falling(0.06, 0.06)
    assert fade_of({"p_chamber": both["p_chamber"]}, SEGMENTS) is None
    assert fade_of(falling(0.06, 0.06, step=0.025), SEGMENTS) is None
    assert fade_of(both, logged.segments(t_fuel_out=Quantity(GONE, "s", 0.2))) is None
    assert fade_of(both, logged.segments(t_fuel_out=Quantity.absent("not seen"))) is None


def sliver(depth: float, width: float, tail: float = 0.5) -> Active:
    return effect("fuel_sliver").at(depth=depth, width=width, tail=tail)


@pytest.mark.parametrize("depth", [0.5, 0.8, 1.0])
def test_the_surface_fades_as_it_burns(depth: float) -> None:
    """dw/dt is the share A that burns, and A^2 = 1 - d (2 - d) exp(-2 w^(2 k)): from a share of 0.8 to the last, or a
    tenth, as a ramp. For k = 1/2 that is a difference of inverse hyperbolic tangents."""
    web = effect("fuel_sliver").fading_web
    assert web is not None
    shown, low = 1.0 - max(1.0 - depth, 0.005) ** 2, max(0.1, 1.0 - depth)
    seen = depth / (0.8 - low) * (1.0 - ((1.0 - depth) / 0.6) ** 2)
    even = 1e-3 * (np.arctanh(0.8) - np.arctanh(low)) * seen
    assert web(sliver(depth, 1e-3, 0.5).named) == pytest.approx(even, rel=0.01)
    first, last = ((0.5 * np.log(max(shown / (1.0 - a**2), 1.0))) ** (1.0 / 1.9) for a in (low, 0.8))
    seconds = quad(lambda w: (1.0 - shown * np.exp(-2.0 * w**1.9)) ** -0.5, first, last)[0]
    assert web(sliver(depth, 1e-3, 0.95).named) == pytest.approx(1e-3 * seconds * seen, rel=0.01)
    assert seconds > np.arctanh(0.8) - np.arctanh(low)


def test_a_fall_as_fast_as_a_chamber_empties_is_what_the_base_model_has() -> None:
    engine, abrupt = engine_on_stand(), 0.012
    assert fade_misfit(0.5 * abrupt, abrupt, engine, SPEED) == 0.0
    assert fade_misfit(4.0 * abrupt, abrupt, engine, SPEED) == pytest.approx(np.log(4.0))
    assert fade_misfit(4.0 * abrupt, abrupt, engine_on_stand(effects=(sliver(0.0, 1e-3),)), SPEED) > 1.0


def test_an_abrupt_end_takes_longer_in_a_roomier_chamber() -> None:
    """It is timed in a run, near what the chamber's volume says; where no fade was measured, not at all."""
    quick = made.replace(made.observed(), stated={FADE: (0.05, UNSURE)})
    found = with_abrupt_end(quick, made.hypothesis().engine).abrupt
    assert found is not None
    assert 0.2 * abrupt_end(made.hypothesis().engine) < found < 1.5 * abrupt_end(made.hypothesis().engine)
    roomy = made.replace(made.hypothesis().engine, dead_volume=made.hypothesis().engine.dead_volume + 5e-3)
    assert (with_abrupt_end(quick, roomy).abrupt or 0.0) > 1.5 * found
    assert with_abrupt_end(made.observed(), roomy).abrupt is None


@given(
    some.floats(0.45, 0.98).filter(lambda depth: abs(depth - 0.9) > 1e-3),  # a surface that goes to a tenth: a corner
    some.floats(5e-5, 5e-3),
    some.floats(0.51, 0.95),
    some.sampled_from(["depth", "width", "tail"]),
)
def test_slopes_of_a_fade_are_its_derivatives(depth: float, width: float, tail: float, moved: str) -> None:
    at = {"depth": depth, "width": width, "tail": tail}
    step = 1e-4 * at[moved]
    ahead, behind = (
        fade_misfit(0.5, 0.012, engine_on_stand(effects=(sliver(**(at | {moved: at[moved] + side * step})),)), SPEED)
        for side in (1.0, -1.0)
    )
    engine = engine_on_stand(effects=(sliver(**at),))
    slope = fade_slope(f"fuel_sliver.{moved}", 0.012, engine, SPEED)
    assert slope == pytest.approx((ahead - behind) / (2.0 * step), rel=1e-3)
    assert fade_slope("a", 0.012, engine, SPEED) == 0.0


@given(some.floats(-50.0, 50.0))
def test_a_slow_fall_says_only_so_much(misfit: float) -> None:
    held, slope = bounded(misfit)
    assert abs(held) <= min(abs(misfit), FARTHEST_MISFIT)
    step = 1e-4
    assert slope == pytest.approx((bounded(misfit + step)[0] - bounded(misfit - step)[0]) / (2.0 * step), abs=1e-6)
    assert bounded(0.1)[0] == pytest.approx(0.1, rel=1e-3)


def test_a_fire_that_dies_slowly_is_a_note_and_no_name() -> None:
    """Ten times as slowly as a chamber empties, or for a second: neither costs the base model what a name needs."""
    quick, engine = made.observed(), engine_on_stand()
    for seconds, most in ((10.0 * abrupt_end(engine), 2.0), (1.0, LEAST_EVIDENCE)):
        slow = replace(quick, stated={FADE: (seconds, UNSURE)})
        without, base = (fit(made.hypothesis(), test, made.truth()).log_evidence for test in (quick, slow))
        assert 0.3 < without - base < most


def test_slivers_are_a_source_where_the_fuel_ends() -> None:
    """As much fuel burns as in a fire that is out at once: less of it before, what is left after."""
    slow = made.replace(made.observed(), stated={FADE: (8.0 * abrupt_end(engine_on_stand()), UNSURE)})
    found = fit(made.hypothesis().with_effect(effect("fuel_sliver")), slow, np.append(made.truth(), [1.2, -1.5, 0.0]))
    source, gone = acting(found, "fuel_sliver", slow), slow.events["t_fuel_out"][0]
    there = source.mean != 0.0
    assert (source.equation, source.unit) == ("grain", "kg/s")
    assert np.abs(source.time[there] - gone).max() < 0.5
    assert (source.mean[there & (source.time < gone)] < 0.0).all()
    assert (source.mean[there & (source.time > gone)] > 0.0).all()
    burnt = np.abs(source.mean)
    assert abs(np.trapezoid(source.mean, source.time)) < 0.15 * np.trapezoid(burnt, source.time)
