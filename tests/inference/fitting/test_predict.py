"""A hypothesis, what it says the sensors read, and its fit, on made-up observations whose truth is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from tests.engine.stand import engine_on_stand
from tests.inference import made

from hfanalysis.effects import effect, library
from hfanalysis.effects.load_cell_drift import heat_clock
from hfanalysis.engine.unsteady import burn
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.hypothesis import FARTHEST_PARAMETER, M_RANGE, Free, Hypothesis, free_parameters
from hfanalysis.inference.fitting.predict import last_regression, predict, readings, signatures
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.places import PLACES
from hfanalysis.inference.splines import Splines, probe
from hfanalysis.inference.unknowns import in_slopes
from hfanalysis.inference.unknowns.pulse import Pulse
from hfanalysis.inference.unknowns.smooth_source import SmoothSource


def plain() -> Hypothesis:
    return made.hypothesis()


def eroding() -> Hypothesis:
    return made.hypothesis().with_effect(effect("nozzle_throat_erosion")).with_effect(effect("tank_heat"))


def with_bad_sensors() -> Hypothesis:
    return made.hypothesis().with_effect(effect("load_cell_drift")).with_effect(effect("chamber_tap_lag"))


def with_unknown_heat() -> Hypothesis:
    return _smooth("tank_heat")


def with_unknown_offset() -> Hypothesis:
    return _smooth("offset of thrust")


def with_unknown_pulse() -> Hypothesis:
    place = next(place for place in PLACES if place.name == "regression_factor")
    pulse = Pulse(place, 0.0, np.zeros(plain().size), size=0.05, start=2.03, duration=1.4, scale=0.1, end=8.0)
    return pulse.added_to(fit(plain(), made.observed(), made.truth(), 0))[0]


def _smooth(place: str) -> Hypothesis:
    test = made.observed()
    fitted = fit(plain(), test, made.truth())
    found = in_slopes(fitted, test)
    return next(s for s in found if s.place.name == place and isinstance(s, SmoothSource)).added_to(fitted)[0]


def blocks(test: Observed) -> int:
    return sum(c.time.size for c in test.channels)


@pytest.mark.parametrize(
    "of", [plain, eroding, with_bad_sensors, with_unknown_heat, with_unknown_offset, with_unknown_pulse]
)
def test_slopes_are_differences_of_predictions(of) -> None:  # type: ignore[no-untyped-def]
    hypothesis, test = of(), made.observed(common=True)
    x = np.concatenate([made.truth(), np.full(hypothesis.size - made.truth().size, 0.4)])
    x = np.clip(x, *hypothesis.bounds)
    here = predict(hypothesis, test, x, tangents=True)
    assert here.slopes is not None
    assert here.slopes.shape == (here.residual.size, hypothesis.size)
    for k, name in enumerate(hypothesis.names):
        step = 1e-2 * np.eye(x.size)[k]
        up, down = (predict(hypothesis, test, x + s * step, tangents=False).residual for s in (1, -1))
        quotient = (up - down) / 2e-2
        error = np.linalg.norm(here.slopes[:, k] - quotient)
        # runs are exact to 3e-5 of their values, that is to some hundredths of the noise
        assert error < 0.01 * np.linalg.norm(quotient) + 0.5, name


@pytest.mark.parametrize("common", [False, True])
def test_the_residual_of_the_truth_is_white(common: bool) -> None:
    means, neighbors = [], []
    for seed in range(6):
        test = made.observed(seed=seed, common=common)
        residual = predict(made.hypothesis(), test, made.truth(), tangents=False).residual
        means.append(np.mean(residual**2))
        neighbors.append(np.mean(residual[1:] * residual[:-1]))
    count = 6 * residual.size
    assert np.mean(means) == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / count))
    assert np.mean(neighbors) == pytest.approx(0.0, abs=4.0 / np.sqrt(count))


def test_the_constants_come_back_from_a_wrong_start() -> None:
    test, truth = made.observed(), made.truth()
    least, most = made.hypothesis().bounds
    start = np.clip(truth + np.array([0.3, -0.4, 1.0, -1.0, 0.5, 1.0, -1.0]), least, most)
    found = fit(made.hypothesis(), test, start)
    spread = np.sqrt(np.diag(found.covariance))
    assert found.converged
    assert (np.abs(found.x - truth) < 4.0 * spread).all()
    assert (np.abs(start - truth) > 4.0 * spread).all()
    feed = engine_on_stand().feed
    assert abs(found.values["area"] - feed.area) < 4.0 * found.stds["area"]
    assert found.stds["area"] < 0.01 * feed.area


def test_a_fit_ends_where_no_direction_is_better() -> None:
    found = fit(made.hypothesis(), made.observed())
    gradient = found.slopes.T @ found.residual + found.x
    # what a last step would still gain: half of g C g
    assert 0.5 * gradient @ found.covariance @ gradient < 0.05


def test_bounds_are_kept() -> None:
    """A tank that cools as no nitrous oxide can would need an exponent beyond its range."""
    test = made.observed(engine=engine_on_stand(polytropic_exponent=0.75))
    at = made.hypothesis().names.index("polytropic_exponent")
    found = fit(made.hypothesis(), test, -1.3 * np.eye(made.hypothesis().size)[at])
    least, most = made.hypothesis().bounds
    assert ((found.x >= least) & (found.x <= most)).all()
    assert found.x[at] == pytest.approx(-M_RANGE)


def test_what_the_model_says_after_the_flow_is_ambient_pressure_and_no_thrust() -> None:
    test = made.observed()
    for name, rest in (("p_chamber", test.ambient), ("thrust", 0.0)):
        channel = next(c for c in test.channels if c.name == name)
        assert channel.resting.sum() == len(made.RESTING)
        assert channel.value[channel.resting] == pytest.approx(rest, abs=5.0 * made.NOISE[name])


def test_a_throat_measured_after_the_test_tells_of_erosion() -> None:
    radius = float(np.sqrt(engine_on_stand().throat_area / np.pi))
    worn = replace(made.observed(), stated={"throat_radius_after": (radius + 2e-4, 2e-5)})
    without = predict(made.hypothesis(), worn, made.truth(), tangents=False)
    assert without.residual[-1] == pytest.approx(10.0, rel=1e-6)
    x = np.zeros(eroding().size)
    x[: made.truth().size + 1] = *made.truth(), 0.3
    here = predict(eroding(), worn, x, tangents=True)
    assert here.slopes is not None
    assert here.residual[-1] < 10.0
    assert here.slopes[-1, made.truth().size] < -1.0


def test_a_signature_is_what_an_effect_adds() -> None:
    test = made.observed()
    hypothesis = made.hypothesis().with_effect(effect("load_cell_drift"))
    x = np.concatenate([made.truth(), [0.7, 0.0, 0.0]])
    signature = signatures(hypothesis, test, x)[:, 0]
    values = hypothesis.values(x)
    thrust = test.channels[-1]
    burning = ~thrust.resting
    pressure = readings(test, predict(hypothesis, test, x, tangents=False).burnt)["p_chamber"]
    warmed = -np.expm1(
        -heat_clock(test.grid, pressure, values["load_cell_drift.exponent"]) / values["load_cell_drift.time"]
    )
    expected = values["load_cell_drift.drift"] * thrust.averaged(warmed)[burning]
    assert signature[-thrust.time.size :][burning] == pytest.approx(expected, rel=1e-6)
    assert not signature[: -thrust.time.size].any()


@given(
    shape=some.sampled_from(("normal", "positive", "wide")),
    center=some.floats(1e-6, 1e6),
    relative=some.floats(0.01, 3.0),
    x=some.floats(-FARTHEST_PARAMETER, FARTHEST_PARAMETER),
)
def test_a_place_is_where_the_parameter_has_its_value(shape, center: float, relative: float, x: float) -> None:  # type: ignore[no-untyped-def]
    free = Free("p", center, relative if shape == "positive" else relative * center, shape)
    assert free.place(free.value(x)) == pytest.approx(x, abs=1e-6)
    step = 1e-5
    assert free.slope(x) == pytest.approx((free.value(x + step) - free.value(x - step)) / (2 * step), rel=1e-4)


def test_bounds_of_effects_are_those_of_their_parameters() -> None:
    for name, known in library().items():
        for free, parameter in zip(free_parameters(known), known.parameters, strict=True):
            assert free.least < free.most, name
            margin = 1e-9 * max(abs(parameter.low), abs(parameter.high), abs(free.center))
            if np.isfinite(parameter.low) or np.isfinite(parameter.high):
                assert free.value(free.least) >= parameter.low - margin, f"{name}.{parameter.name}"
                assert free.value(free.most) <= parameter.high + margin, f"{name}.{parameter.name}"


def test_without_an_effect_a_hypothesis_is_what_it_was() -> None:
    again = eroding().without("tank_heat").without("nozzle_throat_erosion")
    assert again.names == made.hypothesis().names
    assert again.engine == made.hypothesis().engine
    assert eroding().named == ("nozzle_throat_erosion", "tank_heat")
    assert eroding().nuisances == made.hypothesis().size


def test_splines_sum_to_one_where_they_reach() -> None:
    splines = Splines.over(0.0, 5.0, 0.6)
    assert splines.at(np.linspace(0.0, 5.0, 50)).sum(axis=1) == pytest.approx(1.0)


def test_a_probe_adds_its_splines_to_its_site() -> None:
    """Splines every quarter of a second follow a heat that comes with a lag and fades, to some milliwatts."""
    splines, dense = Splines.over(0.0, 4.0, 0.25), np.linspace(0.0, 4.0, 401)
    heat = 700.0 * (1.0 - np.exp(-dense)) * np.exp(-dense / 8.0)
    fitted = np.linalg.lstsq(splines.at(dense), heat, rcond=None)[0]
    assert splines.at(dense) @ fitted == pytest.approx(heat, abs=0.02)
    coefficients = {f"c{i}": float(c) for i, c in enumerate(fitted)}
    probed = engine_on_stand(effects=(probe("tank_heat", splines, 1000.0).at(on=1.0, **coefficients),))
    heated = engine_on_stand(effects=(effect("tank_heat").at(power=700.0, lag=1.0, fade=8.0, begun=0.0),))
    times = np.linspace(0.1, 3.9, 20)
    theirs, ours = (burn(e, 4.0, 1e-7, times=times).output("tank_pressure") for e in (heated, probed))
    assert ours == pytest.approx(theirs, rel=1e-6)


def test_the_last_regression_is_that_of_the_run_where_the_fuel_ended_later() -> None:
    """A run that ends before the measured end of the fuel has no regression there, and a fire would fade for ever."""
    done = burn(engine_on_stand(), 20.0)
    end = float(done.steps.times[-1, 1])
    speed = last_regression(done, end - 0.5)
    assert speed > 1e-4
    assert 0.5 * speed < last_regression(done, end + 3.0) < 1.5 * speed
    assert last_regression(done, 2.0) > speed  # early in a firing it is faster
