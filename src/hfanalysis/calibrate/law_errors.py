"""What systematic errors do to a and n, and how these err together with the constants that they were fitted with.

The fit stays as it is, its weights too. To first order its answer follows what it was told of tank, grain and nozzle:
x = x_0 - H S dv, with H = C J' P of the fit and S the change of the observations by one deviation of each. So the
errors that the weights do not know add H S C_v S' H', and the correlation of a and n with the rest is -H S C_v.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, log

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.beside_report import joint_of
from hfanalysis.calibrate.drifting import by_drift
from hfanalysis.calibrate.evidence import NUISANCES
from hfanalysis.calibrate.likelihood import Weights
from hfanalysis.calibrate.regression import Fitted, law_at, weighed
from hfanalysis.calibrate.regression_verdict import WIDEST_N
from hfanalysis.products.calibration import FuelLaw, Joint
from hfanalysis.quantity import CONDITIONAL, IDENTIFIED, Quantity

STEP = 0.01
"""Of ln r and n [-], to either side, over which slopes are taken."""

NAMES = {"oxidizer_mass": "oxidizer_mass", "volume": "volume", "area": "flow_area", "loss_factor": "K_loss",
         "exponent": "m", "fuel_mass": "fuel_mass", "throat_area": "throat_area"}  # fmt: skip
"""What a model takes of NUISANCES, as a calibration names it; sensors are not among them."""


@dataclass(frozen=True)
class LawErrors:
    """A fit of one test, and the covariance of NUISANCES [SI] with all errors in, systematic ones too."""

    found: Fitted
    whole: Array

    @cached_property
    def _slopes(self) -> Array:
        return np.column_stack([self._slope(axis) for axis in STEP * np.eye(2)])

    @cached_property
    def _gain(self) -> Array:
        """Change of (ln r, n) [-] by what was observed [1/Pa, 1/s, 1/kg], (2, observations)."""
        return np.asarray(self.found.surface.covariance @ self._slopes.T @ self.found.weights.precision)

    def _gain_of(self, weights: Weights) -> Array:
        """The same with the weights that a fit takes which leaves more."""
        by_slopes = self._slopes.T @ weights.precision
        return np.asarray(np.linalg.solve(by_slopes @ self._slopes, by_slopes))

    @property
    def _response(self) -> Array:
        """Change of (ln r, n) [-] by one deviation of each nuisance, (2, nuisances)."""
        evidence = self.found.evidence
        return -self._gain @ replace(evidence, covariance=self.whole).sensitivities(self.found.law)

    def drifting(self, law: FuelLaw, std: float, lasts: float) -> FuelLaw:
        """The ``law`` with what a C_i that drifts by ``std`` [-] over ``lasts`` [s] does to it; on the condition that
        it does not, where n is not known to WIDEST_N otherwise."""
        best, evidence = self.found.law, self.found.evidence
        off = by_drift(evidence, best.a, best.n, std, lasts)
        moved = self._gain_of(weighed(evidence.moved(off), best)) @ off
        wider = self._wider(law, np.outer(moved, moved))
        if not (wider.n.verdict == IDENTIFIED and (wider.n.std or 0.0) > WIDEST_N):
            return wider
        why = f"a C_i that drifts by {100.0 * std:.0f} % while the liquid lasts moves n by {abs(float(moved[1])):.2f}"
        held = {name: replace(getattr(wider, name), verdict=CONDITIONAL, why=why) for name in ("a", "n")}
        return wider.but(**held)

    def _slope(self, axis: Array) -> Array:
        evidence, best, flux = self.found.evidence, self.found.best, self.found.flux
        after, before = (evidence.predict(law_at(best + s * axis, flux)) for s in (1.0, -1.0))
        if after is None or before is None:
            raise ArithmeticError("the engine's model cannot be run about the best a and n")
        return np.asarray((after - before) / (2.0 * STEP))

    def told(self, law: FuelLaw) -> FuelLaw:
        """The law with wider intervals, and with ``joint``, the errors of all constants together."""
        std = np.sqrt(np.diag(self.whole))
        scale = np.where(std > 0.0, std, 1.0)
        by_all, by_fit = (c / np.outer(scale, scale) for c in (self.whole, self.found.evidence.covariance))
        response = self._response
        more = response @ (by_all - by_fit) @ response.T
        return self._wider(law, more).but(joint=self._joint(by_all, response, more, std))

    def _wider(self, law: FuelLaw, more: Array) -> FuelLaw:
        flux, reference = self.found.flux, law.regression.reference_flux
        assert reference is not None
        assert reference.value is not None
        along = {"a": (1.0, -log(flux)), "n": (0.0, 1.0),
                 "regression_rate_reference": (1.0, log(reference.value / flux))}  # fmt: skip
        variances = {name: max(float(np.array(w) @ more @ np.array(w)), 0.0) for name, w in along.items()}
        known = law.regression.systematic
        systematic = {name: float(np.hypot(known.get(name, 0.0), np.sqrt(v))) for name, v in variances.items()}
        return law.but(
            **{name: _widened(getattr(law, name), v, name != "n") for name, v in variances.items()},
            regression=law.regression.but(systematic=systematic),
        )

    def _joint(self, by_all: Array, response: Array, more: Array, std: Array) -> Joint:
        """Of what a model takes: NAMES, then n and ln a."""
        to_a = np.array([[0.0, 1.0], [1.0, -log(self.found.flux)]])  # from (ln r, n) to (n, ln a)
        taken = [NUISANCES.index(name) for name in NAMES]
        law = to_a @ (self.found.surface.covariance + more) @ to_a.T
        across = (to_a @ response @ by_all)[:, taken]
        rest = by_all[np.ix_(taken, taken)]
        covariance = np.block([[rest, across.T], [across, law]])
        units = np.concatenate([std[taken], np.ones(2)])
        return joint_of((*NAMES.values(), "n", "ln_a"), covariance * np.outer(units, units))


def _widened(found: Quantity, variance: float, relative: bool) -> Quantity:
    """With a ``variance`` [-] more: of its logarithm, where it is a ``relative`` one."""
    if found.value is None or found.interval is None or not found.std or variance == 0.0:
        return found
    own = found.std / (found.value if relative else 1.0)
    wider = float(np.hypot(own, np.sqrt(variance))) / own
    if relative:
        ends = [found.value * exp(wider * log(end / found.value)) for end in found.interval]
    else:
        ends = [found.value + wider * (end - found.value) for end in found.interval]
    return replace(found, std=found.std * wider, ci95=(ends[0], ends[1]))
