"""One regression law of several tests, from the law of each.

A test tells two things that do not err together: the rate at its reference flux, ln r_i = ln r_0 + n ln(G_i / G_0), and
n itself. Of all tests these are a linear problem in ln r_0 and n; so tests whose fluxes differ tell n between them even
where none does alone, and a thousand tests are as soon told as two.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import exp, log, sqrt

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
from hfanalysis.simulation.scatter import PRIOR_SCATTER, RATE

TOLD = (IDENTIFIED, CONDITIONAL, NOT_IDENTIFIABLE)
"""Verdicts on a and n of laws that count: one that does not tell a and n apart still tells the rate."""


@dataclass(frozen=True)
class _Known:
    """What a test tells: ln r [-] at a ``flux`` [kg/m^2/s] and n [-], with their standard deviations (``rate_std``,
    ``n_std``), which reach as far as their intervals, and of these the parts that would be the same in a repeated
    test (``rate_same``, ``n_same``)."""

    flux: float
    ln_rate: float
    rate_std: float
    rate_same: float
    n: float
    n_std: float
    n_same: float

    def at(self, flux: float, n: float) -> Quantity:
        """The rate [m/s] at another flux by the ``n`` of all tests: its own n errs against a, and the rate at its own
        flux does not."""
        rate = exp(self.ln_rate + n * log(flux / self.flux))
        return Quantity(rate, "m/s", rate * self.rate_std)


@dataclass(frozen=True)
class _Shared:
    """The errors of ln r and n [-] that all tests have alike: the least that any of them has of that kind."""

    rate: float
    n: float

    @classmethod
    def of(cls, tests: Collection[_Known]) -> _Shared:
        return cls(min(one.rate_same for one in tests), min(one.n_same for one in tests))


def _rest(std: float, shared: float) -> float:
    """What of a deviation is not shared; never nothing."""
    return sqrt(max(std**2 - shared**2, 1e-6 * std**2))


def _known(law: FuelLaw) -> _Known | None:
    """None where it says nothing of the law of all: its rate is not identified, or the model of it is at fault."""
    rate, flux, n = law.regression_rate_reference, law.regression.reference_flux, law.n
    if rate.verdict != IDENTIFIED or n.verdict not in TOLD or flux is None:
        return None
    if not (rate.value and rate.std and n.std and flux.value) or n.value is None:
        return None
    systematic = law.regression.systematic
    of_rate = _reaching(rate, systematic.get("regression_rate_reference", 0.0), rate.value)
    return _Known(flux.value, log(rate.value), *of_rate, n.value, *_reaching(n, systematic.get("n", 0.0)))


def _reaching(quantity: Quantity, systematic: float, scale: float = 1.0) -> tuple[float, float]:
    """The standard deviation of a quantity, or of a normal one that is as wide as its interval, over ``scale``; and the
    part of it that is ``systematic`` [-] or that the interval has beyond its deviation."""
    low, high = quantity.interval or (0.0, 0.0)
    std = (quantity.std or 0.0) / scale
    whole = max(std, 0.5 * (high - low) / NORMAL_95 / scale)
    own = _rest(std, systematic)
    return whole, sqrt(max(whole**2 - own**2, 0.0))


def counts(law: FuelLaw) -> bool:
    """Whether a test's law says something of that of all."""
    return _known(law) is not None


@dataclass(frozen=True)
class _Line:
    """ln r_0 and n of all tests: ``best`` (2,), their ``covariance`` (2, 2), and the probability [-] of so large a
    scatter of the tests by chance."""

    best: Array
    covariance: Array
    probability: float

    def along(self, weights: tuple[float, float]) -> tuple[float, float]:
        """``weights`` times (ln r_0, n) [-], and its standard deviation."""
        w = np.array(weights)
        return float(w @ self.best), sqrt(float(w @ self.covariance @ w))


def _line(tests: Sequence[_Known], flux: float, shared: _Shared) -> _Line:
    """The least squares by the errors that are not shared; those that are do not become less with the number of tests.
    Where tests disagree, the others are as large as the scatter asks for (Student)."""
    slopes = np.array([row for one in tests for row in ((1.0, log(one.flux / flux)), (0.0, 1.0))])
    values = np.array([value for one in tests for value in (one.ln_rate, one.n)])
    own = np.array([std for one in tests for std in (_rest(one.rate_std, shared.rate), _rest(one.n_std, shared.n))])
    by_own = slopes / own[:, None]
    covariance = np.linalg.inv(by_own.T @ by_own)
    best = covariance @ by_own.T @ (values / own)
    left = (values - slopes @ best) / own
    freedom, misfit = values.size - 2, float(left @ left)
    probability = float(chdtrc(freedom, misfit))
    if probability < DISAGREE:
        covariance = covariance * (float(stdtrit(freedom, 0.975)) / NORMAL_95) ** 2 * misfit / freedom
    return _Line(best, covariance + np.diag([shared.rate**2, shared.n**2]), probability)


def common_law(laws: Mapping[str, FuelLaw]) -> CommonLaw:
    """One law of the tests whose own law :func:`counts`, by name. Raises AbsentError for fewer than two."""
    known = {test: found for test, law in laws.items() if (found := _known(law)) is not None}
    if len(known) < 2:
        raise AbsentError(f"two tests are needed, and the rate is identified in {next(iter(known), 'none')}")
    told = {test: laws[test] for test in known}
    flux = exp(sum(log(one.flux) for one in known.values()) / len(known))
    shared = _Shared.of(known.values())
    line = _line(list(known.values()), flux, shared)
    reference = flux * exp(-line.covariance[0, 1] / line.covariance[1, 1])
    constants = _constants(line, flux, reference, _condition(told))
    agree = "agree" if line.probability >= DISAGREE else "disagree: common constants fit worse than chance allows"
    return CommonLaw(
        tests=tuple(told),
        a=constants["a"],
        n=constants["n"],
        regression_rate_reference=constants["regression_rate_reference"],
        regression=RegressionBasis(reference_flux=Quantity(reference, UNIT_OF_FLUX)),
        agreement=Agreement(verdict=agree, probability=line.probability),
        odd=odd_one({test: one.at(flux, float(line.best[1])) for test, one in known.items()}, PRIOR_SCATTER[RATE]),
        flux=flux,
        alone=told,
    )


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
