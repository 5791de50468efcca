"""What a fit of a and n tells: values and intervals, whether the test tells a and n apart, and what they rest on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import exp, log

import numpy as np

from hfanalysis.assembly.calibrated import Regression
from hfanalysis.calibrate.conditions import conditioned, conditions, set_by_trickle
from hfanalysis.calibrate.evidence import Evidence, burn_time_of
from hfanalysis.calibrate.likelihood import Weights
from hfanalysis.calibrate.regression import NEAR, RANGE_N, RANGE_RATE, Fitted, residual_of, slopes
from hfanalysis.engine.grain import oxidizer_flux
from hfanalysis.engine.unsteady import Burn
from hfanalysis.products.calibration import UNIT_OF_A, UNIT_OF_FLUX, FuelLaw, RegressionBasis, RegressionTest
from hfanalysis.quantity import IDENTIFIED, NORMAL_95, NOT_IDENTIFIABLE, UNPHYSICAL, Quantity

WIDEST_N = 0.1
"""Standard deviation of n from which on a test does not tell a and n apart. Evidence: of 400 whole engines
(docs/recovery.md) 66 are not told apart; there n is off by 0.09 in the median."""

WIDEST_RATE = 0.25
"""Standard deviation of the logarithm of the rate from which on it is not known either."""

PHYSICAL_N = (0.0, 1.0)
"""A flux that slows the regression, or acts more than in proportion, is no regression law [-]. Source: Marxman's
turbulent boundary layer has 0.8, paraffin 0.5 and more (docs/calibration.md)."""

AT_LIMIT = 0.05
"""Of the logarithm of the rate [-], within which of the end of its range it counts as cut off by it."""


@dataclass(frozen=True)
class _Told:
    """What a fit tells of one combination of ln r and n [-]: its value, and 95 % of what it may be."""

    value: float
    low: float
    high: float
    outside: bool

    @classmethod
    def of(cls, found: Fitted, along: tuple[float, float]) -> _Told:
        """``along``: the weights of ln r and n."""
        weights = np.array(along)
        value, (low, high) = float(found.best @ weights), found.interval(weights)
        return cls(value, min(low, value), max(high, value), not low <= value <= high)

    @property
    def std(self) -> float:
        return 0.5 * (self.high - self.low) / NORMAL_95


def _not_told(found: Fitted, *told: _Told) -> str:
    """Why the region of the likelihood is none that tells a and n; empty where it is one."""
    if _at_limit(found):
        low, high = (1e3 * rate for rate in RANGE_RATE)
        return f"the rate comes to the end of what any fuel has, {low:g} to {high:g} mm/s"
    if not RANGE_N[0] + NEAR < found.best[1] < RANGE_N[1] - NEAR:
        return f"n comes to the end of where it is looked for, {RANGE_N[0]:g} to {RANGE_N[1]:g}"
    if any(t.outside for t in told):
        return "the least misfit is not where the fit has come to: it has several valleys, or none"
    return "" if found.surface.bounded else "the likelihood has no end where it was followed"


def _at_limit(found: Fitted) -> bool:
    rate = found.surface.points[found.surface.rise <= found.surface.threshold][:, 0]
    return not (log(RANGE_RATE[0]) + AT_LIMIT < rate.min() and rate.max() < log(RANGE_RATE[1]) - AT_LIMIT)


def result(found: Fitted) -> FuelLaw:
    """Judge a fit and say what it rests on."""
    flux, law = found.reference_flux, found.law
    ln_rate, ln_a, n = (_Told.of(found, along) for along in ((1.0, log(flux / found.flux)), (1.0, -log(found.flux)),
                                                             (0.0, 1.0)))  # fmt: skip
    rivals = [float(r[1]) for r in found.rivals]
    not_told = _not_told(found, ln_rate, ln_a, n)
    judged = judge_regression(not_told, (n.low, n.high), n.std, flux, ln_rate.std, rivals)
    verdict, why = conditioned(judged, (n.low, n.high), _conditions(found, flux))
    known = ln_rate.std <= WIDEST_RATE and not _at_limit(found)
    return FuelLaw(
        a=Quantity(
            exp(ln_a.value), UNIT_OF_A, law.a * ln_a.std, (exp(ln_a.low), exp(ln_a.high)), verdict=verdict, why=why
        ),
        n=Quantity(n.value, "", n.std, (n.low, n.high), verdict=verdict, why=why),
        regression_rate_reference=Quantity(
            exp(ln_rate.value), "m/s", exp(ln_rate.value) * ln_rate.std, (exp(ln_rate.low), exp(ln_rate.high)),
            verdict=IDENTIFIED if known else NOT_IDENTIFIABLE,
            why=rate_at(flux),
        ),
        regression=_about(found, flux),
    )  # fmt: skip


def _conditions(found: Fitted, flux: float) -> Iterator[str]:
    """What a and n hold on, in words."""
    evidence = found.evidence
    burnt, along = evidence.burnt(found.law), slopes(evidence, found.flux, found.best)
    window = flux_range(evidence, burnt)
    trickle = set_by_trickle(evidence, found.weights, burnt, along, window)
    return conditions(found.law, flux, window, trickle, evidence.engine.combustion.fuel.wax)


def rate_at(flux: float) -> str:
    """What the rate [m/s] at the reference flux [kg/m^2/s] is."""
    return f"rate at an oxidizer flux of {flux:.0f} kg/(m^2 s), where the test tells it best: ln a + n ln G_ref"


def judge_regression(
    not_told: str, interval: tuple[float, float], std: float, flux: float, spread: float, rivals: Sequence[float] = ()
) -> tuple[str, str]:
    """Verdict on a and n, and why.

    Args:
        not_told: why the interval is none, as where it is the end of where it was looked; empty where it is one.
        interval: 95 % interval of n [-].
        std: standard deviation of n [-].
        flux: the reference flux [kg/m^2/s].
        spread: relative standard deviation [-] of the rate at it.
        rivals: other n [-] that explain the test as well.
    """
    if rivals:
        others = " or ".join(f"{n:.2f}" for n in rivals)
        return NOT_IDENTIFIABLE, f"a and n are not told apart: the test is explained as well with n = {others}"
    if spread > WIDEST_RATE:
        because = not_told or f"the rate at {flux:.0f} kg/(m^2 s) is known to {100.0 * spread:.0f} % only"
        return NOT_IDENTIFIABLE, f"neither a nor n is told: {because}"
    if not_told or std > WIDEST_N:
        because = f"; {not_told}" if not_told else ""
        return NOT_IDENTIFIABLE, (
            f"a and n are not told apart (n to +/- {std:.2f} or worse{because}); what is identified is their "
            f"combination, the rate at {flux:.0f} kg/(m^2 s), to {100.0 * spread:.1f} %"
        )
    if interval[1] < PHYSICAL_N[0] or interval[0] > PHYSICAL_N[1]:
        return (
            UNPHYSICAL,
            f"n outside {PHYSICAL_N[0]:.0f} to {PHYSICAL_N[1]:.0f}: the model lacks something that acts on p_c",
        )
    return (
        IDENTIFIED,
        f"with the oxidizer flow and effects listed under regression; the rate at {flux:.0f} kg/(m^2 s) is known best",
    )


def _about(found: Fitted, flux: float) -> RegressionBasis:
    tests = (_about_test(found.evidence, found.weights, found.law),)
    return RegressionBasis(reference_flux=Quantity(flux, UNIT_OF_FLUX), misfit=found.misfit, tests=tests)


def _about_test(evidence: Evidence, weights: Weights, law: Regression) -> RegressionTest:
    burnt = evidence.burnt(law)
    residual = residual_of(evidence, law)[: evidence.time.size]
    burn_time = evidence.burn_time
    return RegressionTest(
        test=evidence.test,
        fitted_with=(*evidence.remarks, *([f"burn time: {burn_time.source}"] if burn_time else [])),
        window=(float(evidence.time[0]), float(evidence.time[-1])),
        burn_time_measured=burn_time.value if burn_time else None,
        burn_time_std=burn_time.std if burn_time else None,
        burn_time_model=burn_time_of(evidence.engine, burnt),
        fuel_left_measured=evidence.fuel_left.value if evidence.fuel_left else None,
        initial_temperature=evidence.engine.temperature,
        flux_range=flux_range(evidence, burnt),
        p_chamber_rms=float(np.sqrt(np.mean(residual**2))),
        p_chamber_bias=float(residual.mean()),
        independent_samples=weights.effective,
    )


def flux_range(evidence: Evidence, burnt: Burn) -> tuple[float, float]:
    """Least and largest oxidizer flux [kg/m^2/s] over the compared window."""
    part = (burnt.time >= evidence.time[0]) & (burnt.time <= evidence.time[-1])
    flux = oxidizer_flux(burnt.output("oxidizer_flow")[part], burnt.state("port_radius")[part])
    return float(flux.min()), float(flux.max())
