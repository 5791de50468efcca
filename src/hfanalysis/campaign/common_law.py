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
from hfanalysis.simulation.scatter import PRIOR_SCATTER, RATE

TOLD = (IDENTIFIED, CONDITIONAL, NOT_IDENTIFIABLE)
"""Verdicts on a and n of laws that count: one that does not tell a and n apart still tells the rate."""


@dataclass(frozen=True)
class _Error:
    """Of a number [-]: the standard deviation that is its ``own``, and the one ``shared`` by all tests of a stand, as
    that of a hole's area."""

    own: float
    shared: float

    @classmethod
    def of(cls, quantity: Quantity, systematic: float, scale: float = 1.0) -> _Error:
        """Of a quantity, by ``scale``, of whose deviation a part is ``systematic`` [-]; both together reach as far as
        its interval."""
        low, high = quantity.interval or (0.0, 0.0)
        std = (quantity.std or 0.0) / scale
        whole = max(std, 0.5 * (high - low) / NORMAL_95 / scale)
        own = sqrt(std**2 - min(systematic, 0.999 * std) ** 2)
        return cls(own, sqrt(max(whole**2 - own**2, 0.0)))

    @property
    def whole(self) -> float:
        """Both."""
        return hypot(self.own, self.shared)


@dataclass(frozen=True)
class _Known:
    """What a test tells: ln r [-] at a ``flux`` [kg/m^2/s] and n [-], with their errors."""

    flux: float
    ln_rate: float
    of_rate: _Error
    n: float
    of_n: _Error

    def at(self, flux: float) -> Quantity:
        """The rate [m/s] at another flux: a and n of one test trade against each other, and the rate there does not."""
        away = log(flux / self.flux)
        rate = exp(self.ln_rate + self.n * away)
        return Quantity(rate, "m/s", rate * hypot(self.of_rate.own, away * self.of_n.own))


def _known(law: FuelLaw) -> _Known | None:
    """None where it says nothing of the law of all: its rate is not identified, or the model of it is at fault."""
    rate, flux, n = law.regression_rate_reference, law.regression.reference_flux, law.n
    if rate.verdict != IDENTIFIED or n.verdict not in TOLD or flux is None:
        return None
    if not (rate.value and rate.std and n.std and flux.value) or n.value is None:
        return None
    systematic = law.regression.systematic
    of_rate = _Error.of(rate, systematic.get("regression_rate_reference", 0.0), rate.value)
    return _Known(flux.value, log(rate.value), of_rate, n.value, _Error.of(n, systematic.get("n", 0.0)))


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


def _line(tests: Sequence[_Known], flux: float) -> _Line:
    """Weighted by all of their errors, of which the shared ones do not become less with the number of tests, and are
    as large as if all were off to the same side. Whether tests agree is asked by their own errors; where they do not,
    these are as large as the scatter asks for (Student)."""
    slopes = np.array([row for one in tests for row in ((1.0, log(one.flux / flux)), (0.0, 1.0))])
    values = np.array([value for one in tests for value in (one.ln_rate, one.n)])
    errors = [error for one in tests for error in (one.of_rate, one.of_n)]
    own, shared, whole = (np.array([getattr(e, name) for e in errors]) for name in ("own", "shared", "whole"))
    left = (values - slopes @ _weighted(slopes, own) @ values) / own
    freedom = values.size - 2
    probability = float(chdtrc(freedom, left @ left))
    if probability < DISAGREE:
        own = own * float(stdtrit(freedom, 0.975)) / NORMAL_95 * sqrt(left @ left / freedom)
    taken = _weighted(slopes, whole)
    of_rates = np.arange(values.size) % 2 == 0
    together = np.column_stack([taken @ np.where(of_rates, shared, 0.0), taken @ np.where(of_rates, 0.0, shared)])
    covariance = (taken * own**2) @ taken.T + together @ together.T
    return _Line(taken @ values, covariance, probability)


def _weighted(slopes: Array, std: Array) -> Array:
    """What takes observations with deviations ``std`` (m,) to the constants of their ``slopes`` (m, 2): (2, m)."""
    by_std = slopes / std[:, None]
    return np.asarray(np.linalg.solve(by_std.T @ by_std, by_std.T) / std)


def common_law(laws: Mapping[str, FuelLaw]) -> CommonLaw:
    """One law of the tests whose own law :func:`counts`, by name. Raises AbsentError for fewer than two."""
    known = {test: found for test, law in laws.items() if (found := _known(law)) is not None}
    if len(known) < 2:
        raise AbsentError(f"two tests are needed, and the rate is identified in {next(iter(known), 'none')}")
    told = {test: laws[test] for test in known}
    flux = exp(sum(log(one.flux) for one in known.values()) / len(known))
    line = _line(list(known.values()), flux)
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
        odd=odd_one({test: one.at(flux) for test, one in known.items()}, PRIOR_SCATTER[RATE]),
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
