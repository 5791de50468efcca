"""a and n: a burn's own constants are found from burn time and chamber pressure, and what is not told apart is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.calibrate.engine_sample import TRUTH, engine, evidence, rate

from hfanalysis.assembly.calibrated import Regression, pressure_at, starting_for
from hfanalysis.calibrate.evidence import Evidence, Ports, Scalar, burn_time_of
from hfanalysis.calibrate.likelihood import effective_samples, surface, weights_from
from hfanalysis.calibrate.regression import RANGE_N, RANGE_RATE, Fitted, _likeliest, _minimum, fit, law_at
from hfanalysis.calibrate.regression_verdict import result
from hfanalysis.engine.unsteady import burn
from hfanalysis.errors import AbsentError


@pytest.fixture(scope="module")
def clear() -> Fitted:
    """Little noise, a burn time to 50 ms."""
    return fit(evidence())


@pytest.fixture(scope="module")
def blurred() -> Fitted:
    """Noise of a bar, no burn time."""
    return fit(replace(evidence(noise=1e5, stop=2.0), burn_time=None))


@pytest.mark.parametrize("truth", [TRUTH, Regression(3.2e-4, 0.3), Regression(4e-5, 0.65)])
def test_the_constants_of_a_burn_are_found(truth: Regression) -> None:
    """From the rough scan of starts, none of which is the answer."""
    found = fit(evidence(truth))
    assert found.law.n == pytest.approx(truth.n, abs=0.02)
    assert rate(found.law, 200.0) == pytest.approx(rate(truth, 200.0), rel=0.01)


def test_two_observations_tell_a_and_n_apart(clear: Fitted) -> None:
    quantities = result(clear).quantities
    for name, true in (("a", TRUTH.a), ("n", TRUTH.n)):
        assert quantities[name].verdict == "identified"
        assert quantities[name].interval[0] < true < quantities[name].interval[1]


def test_the_rate_at_the_reference_flux_is_known_better_than_at_any_other(clear: Fitted) -> None:
    flux = clear.reference_flux
    widths = [
        np.ptp(clear.surface.interval(np.array([1.0, np.log(g / clear.flux)]))) for g in (flux / 3, flux, 3 * flux)
    ]
    assert widths[1] < min(widths[0], widths[2])


def test_what_is_not_told_apart_is_said_and_the_combination_given(blurred: Fitted) -> None:
    quantities = result(blurred).quantities
    assert quantities["n"].verdict == quantities["a"].verdict == "not identifiable"
    assert "combination" in (quantities["n"].why or "")
    found = quantities["regression_rate_reference"]
    assert found.verdict == "identified"
    flux = result(blurred).regression.reference_flux.value
    assert found.interval[0] < rate(TRUTH, flux) < found.interval[1]


def test_a_and_n_multiply_to_the_reference_rate(clear: Fitted) -> None:
    found = result(clear)
    q, flux = found.quantities, found.regression.reference_flux.value
    assert q["a"].value * flux ** q["n"].value == pytest.approx(q["regression_rate_reference"].value)


def test_more_noise_widens_the_intervals() -> None:
    widths = [np.ptp(fit(evidence(noise=n)).surface.interval(np.array([0.0, 1.0]))) for n in (0.02e5, 0.2e5)]
    assert widths[1] > 3.0 * widths[0]


def test_what_the_tank_leaves_open_widens_the_rate() -> None:
    sure, unsure = fit(evidence()), fit(evidence(nuisance={"area": 0.03 * engine().feed.area}))
    width = [float(np.ptp(f.surface.interval(np.array([1.0, 0.0])))) for f in (sure, unsure)]
    assert width[1] > 1.5 * width[0]


def test_fuel_left_takes_the_place_of_a_burn_time() -> None:
    whole = evidence(fuel_mass=2.5, outer_radius=45e-3)
    true = burn(replace(whole.engine, a=TRUTH.a, n=TRUTH.n))
    left = 2.5 - float(np.trapezoid(true.output("fuel_flow") * (true.time < 6.0), true.time))
    seen = replace(whole, burn_time=None, fuel_left=Scalar(left, 0.02, "scales"), end=6.0)
    found = fit(seen)
    assert rate(found.law, 200.0) == pytest.approx(rate(TRUTH, 200.0), rel=0.02)


def test_an_engine_that_cannot_run_says_so() -> None:
    broken = evidence()
    broken = replace(broken, engine=replace(broken.engine, exit_area=0.5 * broken.engine.throat_area))
    with pytest.raises(AbsentError, match="cannot be run"):
        fit(broken)


@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.9])
def test_correlated_residuals_count_as_fewer(correlation: float) -> None:
    """Of a first-order process n (1 - rho)/(1 + rho) values are independent."""
    noise = np.random.default_rng(0).standard_normal(20_000)
    x = np.empty_like(noise)
    x[0] = noise[0]
    for i in range(1, x.size):
        x[i] = correlation * x[i - 1] + noise[i]
    expected = x.size * (1.0 - correlation) / (1.0 + correlation)
    assert effective_samples(x) == pytest.approx(expected, rel=0.15)


def test_a_constant_misfit_is_one_value_and_not_many() -> None:
    assert effective_samples(np.full(100, 3.0)) == 3.0


def test_the_region_of_a_quadratic_misfit_is_its_ellipse() -> None:
    """x^2/4 + y^2 <= 4 reaches to 4 in x, to 2 in y, to sqrt(20) in x + y."""
    found = surface(lambda p: p[0] ** 2 / 4.0 + p[1] ** 2, np.zeros(2), np.diag([4.0, 1.0]), 4.0)
    assert found.bounded
    for weights, half in (((1.0, 0.0), 4.0), ((0.0, 1.0), 2.0), ((1.0, 1.0), np.sqrt(20.0))):
        assert found.interval(np.array(weights)) == pytest.approx((-half, half), rel=0.03)


def test_a_valley_without_an_end_is_not_bounded() -> None:
    found = surface(lambda p: p[1] ** 2, np.zeros(2), np.diag([1.0, 1.0]), 4.0)
    assert not found.bounded


def test_the_start_is_extrapolated_from_the_pressure_at_the_full_line() -> None:
    warm = replace(engine(), temperature=289.0)
    started = starting_for(engine(), 0.8, pressure_at(warm, 0.8))
    assert started.temperature == pytest.approx(289.0, abs=0.01)


def test_a_pressure_that_no_saturated_tank_comes_down_to_is_refused() -> None:
    with pytest.raises(AbsentError, match=r"no saturated tank of 14\.00 kg in 16\.5 L comes down to"):
        starting_for(replace(engine(), oxidizer_mass=14.0), 0.8, 60e5)


def test_a_burn_given_up_early_is_carried_on_at_its_last_rate() -> None:
    whole, part = burn(engine()), burn(engine(), longest=6.0)
    assert not part.fuel_out
    assert burn_time_of(engine(), part) == pytest.approx(whole.burn_time, rel=0.15)
    assert burn_time_of(engine(), whole) == whole.burn_time


def test_a_fit_that_leaves_more_is_less_likely_though_its_own_weights_are_wider() -> None:
    left, nothing = np.sin(np.arange(40.0)), np.zeros((41, 41))
    residuals = [np.append(size * left, 0.0) for size in (1e4, 2e4)]
    weights = [weights_from(r, 40, np.array([0.1]), nothing, nothing, 1.0) for r in residuals]
    assert weights[0].misfit(residuals[0]) == pytest.approx(weights[1].misfit(residuals[1]))
    deviances = [w.deviance(r, 10.0) for w, r in zip(weights, residuals, strict=True)]
    assert deviances[1] - deviances[0] == pytest.approx(20.0 * np.log(2.0))


def test_of_minima_that_a_test_does_not_tell_apart_the_usual_is_told_and_the_other_said(blurred: Fitted) -> None:
    region = blurred.surface.points[blurred.surface.rise < 0.5 * blurred.surface.threshold]
    ends = [region[int(np.argmin(region[:, 1]))], region[int(np.argmax(region[:, 1]))]]
    minima = _likeliest(blurred.evidence, ends, blurred.flux)
    distances = [abs(m[1] - 0.45) for m in minima]
    assert len(minima) == 2
    assert distances[0] < distances[1]
    told = result(replace(blurred, rivals=(minima[1],)))
    assert told.n.verdict == "not identifiable"
    assert f"{minima[1][1]:.2f}" in (told.n.why or "")
    assert told.n.ci95 is not None
    assert told.n.ci95[0] <= minima[1][1] <= told.n.ci95[1]


def test_a_minimum_that_is_less_likely_is_no_rival(clear: Fitted) -> None:
    off = clear.best + np.array([0.3, 0.0])
    assert [m is clear.best for m in _likeliest(clear.evidence, [off, clear.best], clear.flux)] == [True]


def test_the_law_passes_through_its_point() -> None:
    assert rate(law_at(np.array([np.log(1e-3), 0.4]), 150.0), 150.0) == pytest.approx(1e-3)


def test_evidence_lists_its_observations() -> None:
    e: Evidence = evidence()
    assert e.observed.size == e.time.size + 1
    assert e.observed[-1] == e.burn_time.value  # type: ignore[union-attr]


def test_a_start_beyond_the_range_of_n_is_moved_to_its_border(clear: Fitted) -> None:
    found = _minimum(clear.evidence, clear.weights, clear.flux, np.array([clear.best[0], RANGE_N[1] + 0.4]))
    assert RANGE_N[0] <= found[1] <= RANGE_N[1]


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, 0.0), (-2.0, 0.4), (0.0, -0.5)])
def test_a_value_lies_within_its_interval_wherever_the_fit_has_come_to(
    clear: Fitted, shift: tuple[float, float]
) -> None:
    """Where that is not the least of the surface, a and n are not identified."""
    found = result(replace(clear, best=clear.best + np.array(shift)))
    for name in ("a", "n", "regression_rate_reference"):
        quantity = found.quantities[name]
        assert quantity.interval is not None
        assert quantity.interval[0] <= quantity.value <= quantity.interval[1]
        assert (quantity.verdict == "identified") == (shift == (0.0, 0.0)) or name == "regression_rate_reference"


def test_a_rate_that_no_fuel_has_is_not_looked_for() -> None:
    """The fit of a chamber pressure that no engine of this kind has stays among the rates of fuels."""
    sound = evidence()
    found = result(fit(replace(sound, chamber=0.2 * sound.chamber, burn_time=None)))
    low, high = (1e3 * rate for rate in RANGE_RATE)
    rate_found = found.regression_rate_reference
    assert rate_found.value is not None
    assert 0.9e-3 * low < rate_found.value < 1.1e-3 * high
    assert found.a.verdict == found.n.verdict == "not identifiable"


def test_a_valley_that_hardly_shows_n_points_at_a_flux_of_the_burn(clear: Fitted) -> None:
    """And at no number beyond a float's range."""
    steep = replace(clear.surface, points=clear.surface.points * np.array([1e6, 1e-9]) + np.array([0.0, 0.5]))
    assert 0.0 < replace(clear, surface=steep).reference_flux < 1e4


def with_ports(test: Evidence, noise: float = 0.0, bias: float = 0.0) -> Evidence:
    """The same with the port's radius as it was, at twelve times; a bias of half a millimeter is possible."""
    true = burn(replace(test.engine, a=TRUTH.a, n=TRUTH.n))
    time = np.linspace(0.6, 0.9 * test.end, 12)
    scatter = noise * np.random.default_rng(5).standard_normal(time.size)
    radius = np.interp(time, true.time, true.state("port_radius")) + bias + scatter
    covariance = test.covariance.copy()
    covariance[-1, -1] = 5e-4**2
    return replace(test, ports=Ports(time, radius, max(noise, 1e-5)), covariance=covariance)


def test_a_port_measured_while_it_burns_tells_the_law_without_a_burn_time() -> None:
    blind = replace(evidence(noise=0.1e5), burn_time=None)
    wide, told = fit(blind), fit(with_ports(blind, 2e-5))
    across = np.array([0.0, 1.0])
    assert np.ptp(told.surface.interval(across)) < 0.5 * np.ptp(wide.surface.interval(across))
    assert told.law.n == pytest.approx(TRUTH.n, abs=0.03)
    assert rate(told.law, 200.0) == pytest.approx(rate(TRUTH, 200.0), rel=0.02)


def test_a_bias_of_the_port_s_sensor_is_none_of_the_law() -> None:
    blind = replace(evidence(noise=0.1e5), burn_time=None)
    found = fit(with_ports(blind, 2e-5, bias=4e-4))
    low, high = found.surface.interval(np.array([0.0, 1.0]))
    assert low < TRUTH.n < high
    assert rate(found.law, 200.0) == pytest.approx(rate(TRUTH, 200.0), rel=0.03)
