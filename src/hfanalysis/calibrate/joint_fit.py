"""The constants of a test with adopted effects in its model, fitted together to all channels.

One after the other, as without effects, C_i takes the load as it was stated, m a tank that expands by itself, and a and
n a chamber behind both. What an effect was found with is another set: its size and the constants were fitted at once.
With constants found one by one beside it the engine misses the end of the liquid by tenths of a second, and m takes
what is left over. Here the constants are found as the diagnosis finds them on another test: the effects are held, and
everything else is free, but for the table of nitrous oxide and the laws: the engine that these constants are for runs
by those that it has. What they may be off by counts them, and the effects
(:mod:`hfanalysis.calibrate.joint_errors`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, log
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import Regression
from hfanalysis.calibrate.beside_report import joint_of
from hfanalysis.calibrate.conditions import conditioned, conditions
from hfanalysis.calibrate.evidence import burn_time_of
from hfanalysis.calibrate.joint_errors import errors_about
from hfanalysis.calibrate.joint_refused import reasons
from hfanalysis.calibrate.regression_verdict import judge_regression, rate_at
from hfanalysis.calibrate.tank import PEAK_OVER
from hfanalysis.calibrate.verdicts import PHYSICAL_M
from hfanalysis.engine.effect import Active
from hfanalysis.engine.grain import oxidizer_flux
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.errors import AbsentError
from hfanalysis.inference.candidate import Bench, Candidate
from hfanalysis.inference.fitting.hypothesis import Free
from hfanalysis.inference.full_run import LONGEST_BURN
from hfanalysis.inference.gap import flowing, residuals_of
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.subject import Subject
from hfanalysis.products.calibration import (
    UNIT_OF_A,
    UNIT_OF_FLUX,
    Calibration,
    Joint,
    RegressionBasis,
    RegressionTest,
)
from hfanalysis.quantity import IDENTIFIED, NORMAL_95, NOT_IDENTIFIABLE, STATED, UNPHYSICAL, Quantity

M_NOT_TOLD = 0.8
"""Standard deviation of m, over what is known of it before, from which on the channels do not tell it."""

PROBE_STEP = 0.1
"""Of its standard deviation, by which a constant is moved to see what follows from it."""

DERIVED = {"vapor_mass_at_t_v": "kg", "mass_at_t_feed": "kg", "oxidizer_mass_liquid_phase": "kg",
           "oxidizer_flow_peak": "kg/s"}  # fmt: skip


TOGETHER = {"oxidizer_mass": "oxidizer_mass", "area": "flow_area", "loss_factor": "K_loss",
            "polytropic_exponent": "m", "n": "n", "a": "ln_a"}  # fmt: skip
"""What is free, as ``joint`` names it."""


def fitted_together(subject: Subject, effects: Sequence[Active], one_by_one: Calibration) -> Calibration:
    """The content of calibration.json, its constants fitted together with ``effects`` in the model.

    ``subject``: the test with its base calibration, from which the fit starts; ``one_by_one``: the calibration with the
    effects acting, whose other entries stay. Raises AbsentError where the test has no engine that runs, no chamber
    pressure to compare, or the fit is none to go by (:func:`hfanalysis.calibrate.joint_refused.reasons`).
    """
    hypothesis, observed = subject.compared(as_run=True)
    if "p_chamber" not in observed.names:
        raise AbsentError("nothing of p_chamber is left to fit a and n to")
    engine = replace(hypothesis.engine, effects=(*hypothesis.engine.effects, *effects))
    found = Bench(observed).settled(replace(hypothesis, engine=engine))
    if found is None:
        raise AbsentError("the engine's model with the adopted effects cannot be run")
    if why := reasons(found, observed, one_by_one, subject.definition):
        raise AbsentError("; ".join(why) + ". With these effects alone the model is far from this test: diagnose it")
    try:
        errors = errors_about(found, observed, effects, subject.definition)
        return _Constants(subject, observed, found, one_by_one, errors).product()
    except ArithmeticError as error:
        raise AbsentError(f"the engine's model with the adopted effects cannot be run to its end: {error}") from error


@dataclass(frozen=True)
class _Constants:
    """A fit of all constants, as quantities of a calibration; ``errors``: second moments about it, in standard
    deviations of the priors."""

    subject: Subject
    observed: Observed
    found: Candidate
    one_by_one: Calibration
    errors: Array

    def product(self) -> Calibration:
        """The content of calibration.json."""
        fitted, before = {**self._of_tank(), **self._derived(), **self._law()}, self.one_by_one.quantities
        held = {name for name, quantity in before.items() if quantity.verdict == STATED}
        mine = {name: quantity for name, quantity in fitted.items() if name not in held}
        about = "C_i, K_loss, m, the load and its temperature, a and n: fitted together to all channels, with the "
        note = about + "adopted effects held; one by one they are under one_by_one"
        return self.one_by_one.but(
            **mine,
            notes=(*self.one_by_one.notes, note),
            regression=self._about(),
            joint=self._joint(),
            one_by_one={name: before[name] for name in mine if name in before},
        )

    @cached_property
    def engine(self) -> Engine:
        """With the fitted constants."""
        return self.found.fit.hypothesis.at(self.found.fit.x)

    @cached_property
    def burnt(self) -> Burn:
        """Its burn, to the end."""
        return burn(self.engine, longest=LONGEST_BURN)

    def _free(self, name: str) -> tuple[Free, float, float]:
        """What may move, where it is, and its standard deviation, both in those of its prior."""
        place = self._place(name)
        fit = self.found.fit
        return fit.hypothesis.free[place], float(fit.x[place]), float(np.sqrt(self.errors[place, place]))

    def _place(self, name: str) -> int:
        return [free.name for free in self.found.fit.hypothesis.free].index(name)

    def _quantity(self, name: str, unit: str, per: float = 1.0, **judged: Any) -> Quantity:
        """A fitted constant over ``per``; its interval ends where the constant may go no further."""
        free, x, std = self._free(name)
        ends = np.clip([x - NORMAL_95 * std, x + NORMAL_95 * std], free.least, free.most)
        low, high = (free.value(float(end)) / per for end in ends)
        return Quantity(free.value(x) / per, unit, abs(free.slope(x)) * std / per, (low, high), **judged)

    def _joint(self) -> Joint:
        """Errors of the fitted constants together, as a model takes them."""
        fit = self.found.fit
        places = [i for i, free in enumerate(fit.hypothesis.free) if free.name in TOGETHER]
        free = [fit.hypothesis.free[i] for i in places]
        slopes = [
            f.slope(float(fit.x[i])) / (f.value(float(fit.x[i])) if f.name == "a" else 1.0)
            for f, i in zip(free, places, strict=True)
        ]
        covariance = self.errors[np.ix_(places, places)] * np.outer(slopes, slopes)
        return joint_of(tuple(TOGETHER[f.name] for f in free), covariance)

    def _of_tank(self) -> dict[str, Quantity]:
        definition = self.subject.definition
        area = definition.injector_area
        assert area is not None
        discharge = self._quantity("area", "", area.value, verdict=IDENTIFIED)
        assert discharge.value is not None
        assert discharge.std is not None
        spread = float(np.hypot(discharge.std, discharge.value * (area.std or 0.0) / area.value))
        out = {"C_i": Quantity(discharge.value, "", spread, verdict=IDENTIFIED)}
        if any(free.name == "loss_factor" for free in self.found.fit.hypothesis.free):
            out["K_loss"] = self._quantity("loss_factor", "1/m^4", verdict=IDENTIFIED)
        out["m"] = self._exponent()
        before = self._free("oxidizer_mass")[0].center
        said = f"fitted with all else, from {before:.3f} kg, which is believed to 1 % at best"
        out["oxidizer_mass_fitted"] = self._quantity("oxidizer_mass", "kg", verdict=IDENTIFIED, why=said)
        out["tank_temperature"] = self._quantity("temperature", "K", verdict=IDENTIFIED)
        return out

    def _exponent(self) -> Quantity:
        """m with its verdict: it may move between bounds within which a fit has to stay."""
        free, place = self._free("polytropic_exponent")[0], self._place("polytropic_exponent")
        std = float(np.sqrt(self.found.fit.covariance[place, place]))  # what may be off beside tells no less of it
        found = self._quantity("polytropic_exponent", "")
        assert found.ci95 is not None
        before = f"what is known of nitrous oxide, {free.center:.2f} ± {free.std:.2f}"
        if std > M_NOT_TOLD:
            why = f"the channels hardly say more than {before}"
            return replace(found, verdict=NOT_IDENTIFIABLE, why=why)
        low, high = found.ci95
        if high < PHYSICAL_M[0] or low > PHYSICAL_M[1]:
            outside = f"outside {PHYSICAL_M[0]} to {PHYSICAL_M[1]}, no property of nitrous oxide"
            return replace(found, verdict=UNPHYSICAL, why=f"{outside}, though drawn to {before}")
        return replace(found, verdict=IDENTIFIED, why="told by all channels together")

    def _derived(self) -> dict[str, Quantity]:
        """What follows from the constants, with the deviation that theirs make."""
        values = self._followed(self.engine)
        std = self._spread(values)
        return {
            name: Quantity(float(value), unit, float(s) if np.isfinite(s) else None, verdict=IDENTIFIED)
            for (name, unit), value, s in zip(DERIVED.items(), values, std, strict=True)
            if np.isfinite(value)
        }

    def _followed(self, engine: Engine) -> Array:
        """DERIVED of an engine's burn [SI]; NaN where it cannot be run, or its liquid does not end."""
        try:
            burnt = burn(engine, longest=LONGEST_BURN)
        except (ValueError, ArithmeticError):
            return np.full(len(DERIVED), np.nan)
        if burnt.liquid_out is None:
            return np.full(len(DERIVED), np.nan)
        time, mass, flow = burnt.time, burnt.state("tank_mass"), burnt.output("oxidizer_flow")
        left = float(np.interp(burnt.liquid_out, time, mass))
        at_feed = float(np.interp(self.subject.segments.time("t_feed") or 0.0, time, mass))
        passed = np.concatenate([[0.0], np.cumsum(0.5 * (flow[1:] + flow[:-1]) * np.diff(time))])
        starts = np.arange(0.0, max(burnt.liquid_out - PEAK_OVER, 0.0) + 1e-9, 0.2 * PEAK_OVER)
        over = np.interp(starts + PEAK_OVER, time, passed) - np.interp(starts, time, passed)
        return np.array([left, at_feed, engine.oxidizer_mass - left, float(over.max()) / PEAK_OVER])

    def _spread(self, values: Array) -> Array:
        fit = self.found.fit
        steps = PROBE_STEP * np.sqrt(np.maximum(np.diag(self.errors), 0.0))
        slopes = np.zeros((values.size, steps.size))
        for i, step in enumerate(steps.tolist()):
            if step > 0.0:
                x = fit.x.copy()
                x[i] += step
                slopes[:, i] = (self._followed(fit.hypothesis.at(x)) - values) / step
        return np.asarray(np.sqrt(np.einsum("ij,jk,ik->i", slopes, self.errors, slopes)))

    @cached_property
    def _covariance_of_law(self) -> Array:
        """Of ln a and n."""
        free_a, x_a, _ = self._free("a")
        free_n, x_n, _ = self._free("n")
        places = [self._place("a"), self._place("n")]
        scale = np.array([free_a.slope(x_a) / free_a.value(x_a), free_n.slope(x_n)])
        return np.asarray(self.errors[np.ix_(places, places)] * np.outer(scale, scale))

    @cached_property
    def _reference_flux(self) -> float:
        """Oxidizer flux of the burn [kg/m^2/s] at which ln a + n ln G is known best."""
        low, high = self._fluxes
        covariance = self._covariance_of_law
        best = -covariance[0, 1] / max(float(covariance[1, 1]), 1e-300)
        return exp(float(np.clip(best, log(low), log(high))))

    @cached_property
    def _fluxes(self) -> tuple[float, float]:
        """Least and largest oxidizer flux over what is compared [kg/m^2/s]."""
        burnt, (start, end) = self.burnt, self._window
        flux = oxidizer_flux(burnt.output("oxidizer_flow"), burnt.state("port_radius"))
        seen = flux[(burnt.time >= start) & (burnt.time <= end) & (flux > 0.0)]
        return float(seen.min()), float(seen.max())

    @property
    def _window(self) -> tuple[float, float]:
        """From when to when the chamber is compared [s]."""
        return self.observed.phases["liquid"], self.observed.end

    def _law(self) -> dict[str, Quantity]:
        """a, n, and the rate at the flux where it is known best."""
        a, n, flux = self._quantity("a", UNIT_OF_A), self._quantity("n", ""), self._reference_flux
        assert a.value is not None
        assert n.value is not None
        assert n.ci95 is not None
        along = np.array([1.0, log(flux)])
        spread = float(np.sqrt(along @ self._covariance_of_law @ along))
        on = conditions(Regression(a.value, n.value), flux, self._fluxes)
        verdict, why = conditioned(judge_regression("", n.ci95, n.std or 0.0, flux, spread), n.ci95, on)
        rate, around = a.value * flux**n.value, exp(NORMAL_95 * spread)
        return {
            "a": replace(a, verdict=verdict, why=why),
            "n": replace(n, verdict=verdict, why=why),
            "regression_rate_reference": Quantity(
                rate, "m/s", rate * spread, (rate / around, rate * around), verdict=IDENTIFIED,
                why=rate_at(flux),
            ),
        }  # fmt: skip

    def _about(self) -> RegressionBasis:
        """What a and n rest on, as :func:`hfanalysis.calibrate.regression.result` has it."""
        stated = next((test.content for test in self.one_by_one.regression.tests), {})
        names = ", ".join(sorted(active.effect.name for active in self.engine.effects))
        told = f"all channels from the opening to {self._window[1]:.2f} s, together with C_i, K_loss, m and the load"
        mine = {
            "test": self.subject.definition.test.id,
            "fitted_with": (told, f"adopted effects, held: {names}"),
            "window": self._window,
            "burn_time_measured": stated.get("burn_time_measured"),
            "burn_time_model": burn_time_of(self.engine, self.burnt),
            "initial_temperature": self.engine.temperature,
            "flux_range": self._fluxes,
        }
        test = RegressionTest.model_validate({**stated, **mine, **self._of_chamber()})
        flux = Quantity(self._reference_flux, UNIT_OF_FLUX)
        return RegressionBasis(reference_flux=flux, misfit=self.found.chi2, tests=(test,))

    def _of_chamber(self) -> dict[str, float]:
        """How well the chamber's pressure is met, and by how many independent values."""
        chamber = next(c for c in self.observed.channels if c.name == "p_chamber")
        left = residuals_of(self.found.fit, self.observed)["p_chamber"][flowing(chamber, self.observed)]
        return {
            "p_chamber_rms": float(np.sqrt(np.mean(left**2))),
            "p_chamber_bias": float(left.mean()),
            "independent_samples": left.size / chamber.coherence,
        }
