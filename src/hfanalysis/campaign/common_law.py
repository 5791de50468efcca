"""One regression law of several tests, from the law of each.

A test tells two things that do not err together: the rate at its reference flux, ln r_i = ln r_0 + n ln(G_i / G_0), and
n itself. Of all tests these are a linear problem in ln r_0 and n; so tests whose fluxes differ tell n between them even
where none does alone, and a thousand tests are as soon told as two.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, hypot, log, sqrt

import numpy as np
from scipy.special import chdtrc, stdtrit

from hfanalysis.arrays import Array
from hfanalysis.calibrate.regression_verdict import judge_regression, rate_at
from hfanalysis.campaign.family import odd_one
from hfanalysis.campaign.pooling import DISAGREE
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import UNIT_OF_A, UNIT_OF_FLUX, FuelLaw, RegressionBasis
from hfanalysis.products.campaign import Agreement, CommonLaw
from hfanalysis.quantity import CONDITIONAL, IDENTIFIED, NORMAL_95, NOT_IDENTIFIABLE, Quantity

TOLD = (IDENTIFIED, CONDITIONAL, NOT_IDENTIFIABLE)
"""Verdicts on a and n of laws that count: one that does not tell a and n apart still tells the rate."""


@dataclass(frozen=True)
class _Line:
    """The least squares of ln r_0 and n: ``best`` (2,), their ``covariance`` (2, 2) with the tests' own deviations, and
    the weighted sum of squares [-] that is left, of ``freedom`` numbers more than constants."""

    best: Array
    covariance: Array
    misfit: float
    freedom: int

    @property
    def probability(self) -> float:
        """Of so large a scatter [-] by chance."""
        return float(chdtrc(self.freedom, self.misfit))

    @property
    def widening(self) -> float:
        """By how much a 95 % interval is wider than the tests' own deviations say: where they disagree by Student's,
        with the scatter that there is."""
        if self.probability >= DISAGREE:
            return 1.0
        return float(stdtrit(self.freedom, 0.975)) / NORMAL_95 * sqrt(self.misfit / self.freedom)

    def along(self, weights: tuple[float, float]) -> tuple[float, float]:
        """``weights`` times (ln r_0, n) [-], and its standard deviation."""
        w = np.array(weights)
        return float(w @ self.best), self.widening * sqrt(float(w @ self.covariance @ w))


@dataclass(frozen=True)
class _Known:
    """What a test tells: ln r [-] at a ``flux`` [kg/m^2/s] and n [-], with their standard deviations, which reach as
    far as their intervals."""

    flux: float
    ln_rate: float
    ln_rate_std: float
    n: float
    n_std: float

    def at(self, flux: float) -> Quantity:
        """The rate [m/s] at another flux: a and n of one test trade against each other, and the rate there does not."""
        away = log(flux / self.flux)
        rate = exp(self.ln_rate + self.n * away)
        return Quantity(rate, "m/s", rate * hypot(self.ln_rate_std, away * self.n_std))


def _known(law: FuelLaw) -> _Known | None:
    """None where it says nothing of the law of all: its rate is not identified, or the model of it is at fault."""
    rate, flux, n = law.regression_rate_reference, law.regression.reference_flux, law.n
    if rate.verdict != IDENTIFIED or n.verdict not in TOLD or flux is None:
        return None
    if not (rate.value and rate.std and n.std and flux.value) or n.value is None:
        return None
    return _Known(flux.value, log(rate.value), _reaching(rate) / rate.value, n.value, _reaching(n))


def _reaching(quantity: Quantity) -> float:
    """The standard deviation of a quantity, or of a normal one that is as wide as its interval."""
    low, high = quantity.interval or (0.0, 0.0)
    return max(quantity.std or 0.0, 0.5 * (high - low) / NORMAL_95)


def counts(law: FuelLaw) -> bool:
    """Whether a test's law says something of that of all."""
    return _known(law) is not None


def common_law(laws: Mapping[str, FuelLaw]) -> CommonLaw:
    """One law of the tests whose own law :func:`counts`, by name. Raises AbsentError for fewer than two."""
    known = {test: found for test, law in laws.items() if (found := _known(law)) is not None}
    if len(known) < 2:
        raise AbsentError(f"two tests are needed, and the rate is identified in {next(iter(known), 'none')}")
    told = {test: laws[test] for test in known}
    flux = exp(sum(log(one.flux) for one in known.values()) / len(known))
    line = _line(list(known.values()), flux)
    reference = flux * exp(-line.covariance[0, 1] / line.covariance[1, 1])
    agree = "agree" if line.probability >= DISAGREE else "disagree: common constants fit worse than chance allows"
    constants = _constants(line, flux, reference, _condition(told))
    return CommonLaw(
        tests=tuple(told),
        a=constants["a"],
        n=constants["n"],
        regression_rate_reference=constants["regression_rate_reference"],
        regression=RegressionBasis(reference_flux=Quantity(reference, UNIT_OF_FLUX), misfit=line.misfit),
        agreement=Agreement(verdict=agree, probability=line.probability),
        odd=odd_one({test: one.at(flux) for test, one in known.items()}),
        flux=flux,
        alone=told,
    )


def _line(tests: Sequence[_Known], flux: float) -> _Line:
    slopes = np.array([row for one in tests for row in ((1.0, log(one.flux / flux)), (0.0, 1.0))])
    values = np.array([value for one in tests for value in (one.ln_rate, one.n)])
    weights = np.array([1.0 / std for one in tests for std in (one.ln_rate_std, one.n_std)])
    slopes, values = slopes * weights[:, None], values * weights
    covariance = np.linalg.inv(slopes.T @ slopes)
    best = covariance @ slopes.T @ values
    left = values - slopes @ best
    return _Line(best, covariance, float(left @ left), values.size - 2)


def _constants(line: _Line, flux: float, reference: float, condition: str) -> dict[str, Quantity]:
    """a, n and the rate at the reference flux, judged as those of one test are."""
    (ln_rate, spread), (ln_a, std_a), (n, std_n) = map(
        line.along, ((1.0, log(reference / flux)), (1.0, -log(flux)), (0.0, 1.0))
    )
    low, high = n - NORMAL_95 * std_n, n + NORMAL_95 * std_n
    verdict, why = judge_regression("", (low, high), std_n, reference, spread)
    if condition and verdict == IDENTIFIED:
        verdict, why = CONDITIONAL, condition
    return {
        "a": Quantity(exp(ln_a), UNIT_OF_A, exp(ln_a) * std_a, _about(ln_a, std_a), verdict=verdict, why=why),
        "n": Quantity(n, "", std_n, (low, high), verdict=verdict, why=why),
        "regression_rate_reference": Quantity(
            exp(ln_rate), "m/s", exp(ln_rate) * spread, _about(ln_rate, spread), verdict=IDENTIFIED,
            why=rate_at(reference),
        ),
    }  # fmt: skip


def _about(logarithm: float, std: float) -> tuple[float, float]:
    return exp(logarithm - NORMAL_95 * std), exp(logarithm + NORMAL_95 * std)


def _condition(laws: Mapping[str, FuelLaw]) -> str:
    """On what the law holds, where those of tests do; empty where all of them hold as they are."""
    own = {test: law.n.why or "" for test, law in laws.items() if law.n.verdict == CONDITIONAL}
    if not own:
        return ""
    test, why = next(iter(own.items()))
    return f"as {len(own)} of {len(laws)} tests have it; {test}: {why}"
