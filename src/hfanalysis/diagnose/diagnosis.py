"""The diagnosis of one test: where model and measurement disagree, what it is, and the proof."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.diagnose.answer.at_limit import at_limit
from hfanalysis.diagnose.answer.effect_source import acting_in
from hfanalysis.diagnose.answer.learnt import Learning, learn
from hfanalysis.diagnose.answer.plausible import judged, sized
from hfanalysis.diagnose.answer.posterior import poor_fit, scale
from hfanalysis.diagnose.answer.proof import OtherTest, Proof, prove
from hfanalysis.diagnose.answer.source_places import likeliest_place, places
from hfanalysis.diagnose.answer.too_small import with_parts, without_small_sources, without_the_small
from hfanalysis.diagnose.answer.tried_on import conditions_of, tried_on
from hfanalysis.diagnose.answer.tried_on import rows as rows_tried
from hfanalysis.diagnose.answer.verdict import Verdict, effects_in, effects_product, upper_limits, verdict_of
from hfanalysis.diagnose.answer.where import by_equation
from hfanalysis.diagnose.answer.words import story
from hfanalysis.diagnose.model_free import shown
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.naming import Naming, name_effects
from hfanalysis.diagnose.naming.polish import not_converged
from hfanalysis.diagnose.naming.slack import course_error
from hfanalysis.diagnose.naming.valleys import told_otherwise
from hfanalysis.diagnose.naming.variants import Settings
from hfanalysis.diagnose.weak_form.spread import Spread
from hfanalysis.diagnose.weak_form.weak import weak_residuals
from hfanalysis.diagnose.weak_form.weak_product import weak_product
from hfanalysis.engine.effect import Effect
from hfanalysis.inference import gap
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.fitting.fade import abrupt
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import DEPARTURE, Hypothesis
from hfanalysis.inference.observations.burning import ended
from hfanalysis.inference.observations.observed import FADE, Observed
from hfanalysis.inference.subject import Subject
from hfanalysis.products.diagnosis import (
    NO_TIME,
    ClosedFraction,
    Compared,
    Constants,
    Diagnosis,
    FormError,
    Gap,
    GapByPhase,
    Place,
    Plausibility,
    Tried,
    TriedOn,
)
from hfanalysis.progress import Progress, silent
from hfanalysis.quantity import Quantity


@dataclass(frozen=True)
class Diagnosed:
    """What was found, the verdict, the proof, and the product."""

    naming: Naming
    verdict: Verdict
    product: Diagnosis


def diagnose(
    subject: Subject,
    effects: Mapping[str, Effect],
    other: Callable[[], OtherTest | None] = lambda: None,
    progress: Progress = silent,
    settings: Settings | None = None,
) -> Diagnosed:
    """Localise, name and prove; ``other`` finds another test to prove it on, if there is something to prove.

    Raises AbsentError where no engine is stated or too little was recorded.
    """
    one = _judged(subject, effects, progress, settings)
    if (fade := _fade(one, effects)) is not None:
        progress("leaving out how the fire fades", 0.0)
        at_once = replace(subject, segments=ended(subject.segments, fade.t_start.value or 0.0, fade.t_start.std or 0.0))
        rest = _judged(at_once, effects, progress, settings)
        one = replace(rest, small={**one.small, **rest.small}, notes=(FADE_LEFT_OUT,))
    hypothesis, catalogue, found, verdict, small = one.hypothesis, one.catalogue, one.found, one.verdict, one.small
    progress("proving it", 0.93)
    unknown = learn(found, verdict.chosen) if verdict.label == "unknown" else Learning()
    proof = Proof({}, None, ())
    if verdict.label != "none":
        proof = prove(found, verdict.chosen, other(), unknown.active)
    product = _product(found, verdict, proof, catalogue)
    if unknown.product is not None:
        product = product.but(learnt=unknown.product.but(beside=effects_in(verdict, found.bench.observed)))
    product = product.but(
        called=plain_names(effects),
        gap=_with_calibrated(product.gap, found, hypothesis, subject),
        constants=None if product.constants is None else product.constants.but(calibrated=_calibrated(subject)),
        too_small=small,
        tried_on=one.tried,
        not_learnt=unknown.reason,
    )
    sentences = story(product)
    if poor_fit(found.named.leftover):
        sentences += shown(subject).sentences
    notes = (*subject.notes, *until_when(found.bench.observed), *one.notes, *product.notes)
    return Diagnosed(found, verdict, product.but(notes=notes, sentences=tuple(sentences)))


def until_when(observed: Observed) -> tuple[str, ...]:
    """What is said where nothing tells whether the chamber burns to the end."""
    shown = observed.flame_shown
    if shown is None:
        return ()
    return (
        f"whether the chamber burns after {shown:.2f} s is unknown, for its pressure falls faster than the flow up to "
        "the end: it is compared until then",
    )


@dataclass(frozen=True)
class _Judged:
    """What was tried, the verdict, and what is too small to matter, with the part that it is."""

    hypothesis: Hypothesis
    catalogue: Catalogue
    found: Naming
    verdict: Verdict
    rows: tuple[Place, ...]
    small: Mapping[str, float]
    tried: TriedOn | None = None
    notes: tuple[str, ...] = ()


FADE_LEFT_OUT = "how a fire fades within a second of its end is in no model: names are judged by what comes before"
"""What is said where a fade was taken for something else."""


def _judged(subject: Subject, effects: Mapping[str, Effect], progress: Progress, settings: Settings | None) -> _Judged:
    hypothesis, observed = subject.compared()
    catalogue = Catalogue(_visible(effects, observed), subject.stated())
    found = without_small_sources(name_effects(hypothesis, observed, catalogue, progress, settings))
    tried = tried_on(conditions_of(subject, observed), rows_tried())
    twins = {name: effect.twins for name, effect in catalogue.effects.items()}
    verdict = verdict_of(found, twins, tried.misled if tried else 0.0)
    rows = sized_places(verdict, found)
    verdict, small = without_the_small(verdict, rows, found)
    return _Judged(hypothesis, catalogue, found, verdict, rows, small, tried)


def _fade(one: _Judged, effects: Mapping[str, Effect]) -> Place | None:
    """What was taken for fuel that burns later and is no more than how the fire fades; None where nothing was.

    Other names may have been bent to it: they are judged by what comes before.
    """
    fading = {name for name, effect in effects.items() if effect.fading_web is not None}
    return next((row for row in one.rows if row.site in fading & set(one.small)), None)


def sized_places(verdict: Verdict, found: Naming) -> tuple[Place, ...]:
    """Where and when the model lacks what, and which part that is of what goes through its equation."""
    return with_parts(places(verdict, found), verdict.chosen.fit.burnt, found.base.fit.burnt, found.bench.observed)


def _with_calibrated(found: Gap, naming: Naming, hypothesis: Hypothesis, subject: Subject) -> Gap:
    """The gap with that of the model as it is calibrated, m among its constants, and what refitting the base closes of
    it."""
    m, observed = None if subject.calibration is None else subject.calibration.m.value, naming.bench.observed
    free = tuple(
        replace(f, center=m, least=-np.inf, most=np.inf) if f.name == "polytropic_exponent" and m is not None else f
        for f in hypothesis.free
    )
    try:
        ran = gap.as_calibrated(replace(hypothesis, free=free), observed)
        gaps = [gap.total_gap(one, observed) for one in (ran, naming.base.fit)]
        calibrated = gap.root_mean_square(ran, observed)
    except (ValueError, ArithmeticError):
        return found
    return found.but(calibrated=calibrated, closed_by_refitting=gap.closed(gaps[0], gaps[1]))


def _calibrated(subject: Subject) -> dict[str, Quantity]:
    """The constants that the base model has in calibration, by the names that its fits have."""
    product, definition = subject.calibration, subject.definition
    if product is None:
        return {}
    known = {"loss_factor": product.K_loss, "m": product.m, "a": product.a, "n": product.n}
    known["oxidizer_mass"] = product.oxidizer_mass
    if definition.injector_area is not None and product.C_i.value is not None:
        holes = definition.injector_area.value
        known["area"] = Quantity(product.C_i.value * holes, "m^2", (product.C_i.std or 0.0) * holes)
    return {name: q for name, q in known.items() if q.value is not None}


def plain_names(effects: Mapping[str, Effect]) -> dict[str, str]:
    """What people call each effect, where it says so."""
    return {name: effect.plain_name for name, effect in effects.items() if effect.plain_name}


def _visible(effects: Mapping[str, Effect], observed: Observed) -> dict[str, Effect]:
    """Effects that the channels of a test can show at all: a sensor's need the sensor."""
    return {n: e for n, e in effects.items() if not e.of_sensor or set(e.sites) & set(observed.names)}


def _product(found: Naming, verdict: Verdict, proof: Proof, catalogue: Catalogue) -> Diagnosis:
    observed, chosen = found.bench.observed, verdict.chosen
    equations = by_equation(verdict.posterior, found)
    left = {*verdict.set90, *verdict.added}
    residuals = weak_residuals(observed, found.base.fit.burnt.steps.engine, Spread.of_fit(found.base.fit))
    unsure = () if chosen.fit.converged else ("the last fit did not converge: sizes and intervals are rough",)
    if (why := not_converged(found.risen)) is not None:
        unsure = (*unsure, f"the search did not converge: {why}; take names with care")
    return Diagnosis(
        verdict=verdict.label,
        effects=effects_product(verdict, observed),
        set90=tuple(verdict.set90),
        posterior=verdict.posterior,
        partners=verdict.partners,
        by_equation=equations,
        evidences=verdict.evidences,
        unknown_elsewhere=verdict.elsewhere,
        tried=tuple(_tried(c, found, verdict.held_out) for c in (*found.singles, *found.sets, *found.unknown)),
        leftover=found.named.leftover,
        localisation=sized_places(verdict, found),
        likeliest_place=likeliest_place(verdict, found, equations),
        gap=_gap(found.base, chosen, proof, observed),
        upper_limits=upper_limits(verdict, found, catalogue),
        doubts=verdict.doubts,
        unknown_beside=verdict.added if verdict.doubts else (),
        at_limit=at_limit(verdict),
        not_converged=why,
        twins=_twins(verdict, catalogue),
        not_it=() if poor_fit(found.named.leftover) else _not_it(verdict),
        decisive_measurements=_decisive(verdict, catalogue),
        plausibility={name: row for name, row in _plausibility(found, chosen).items() if name in left},
        constants=_constants(found, verdict),
        weak_form=weak_product(residuals),
        compared=_compared(found, chosen, observed),
        probabilities_from="probabilities.json" if scale().temperature != 1.0 else "raw evidences",
        notes=(*proof.notes, *_course(verdict, found), *_two_tops(verdict.chosen)),
        warnings=unsure,
        runtime_s=NO_TIME,
        seed=0,
    )


def _compared(found: Naming, chosen: Candidate, observed: Observed) -> Compared:
    """With the time in which the fire went out, where it shows, and that in which the chamber empties without fuel."""
    times = np.concatenate([channel.time for channel in observed.channels])
    out = Compared(
        channels=tuple(observed.names),
        start=float(times[times > 0.0].min()),
        end=float(times.max()),
        model_form_error=_errors(chosen),
        chi_square=chosen.leftover,
        chi_square_without=found.base.leftover,
    )
    if FADE not in observed.stated:
        return out
    seconds, log_std = observed.stated[FADE]
    at_once = abrupt(observed, found.base.fit.burnt.steps.engine)
    return out.but(fuel_fade=Quantity(seconds, "s", seconds * log_std), abrupt_end=Quantity(at_once, "s"))


def _gap(base: Candidate, chosen: Candidate, proof: Proof, observed: Observed) -> Gap:
    """The gap without and with what was found, by channel and phase [SI], and how much of it each arm closes."""
    arms = proof.fractions
    return Gap(
        before=gap.root_mean_square(base.fit, observed),
        after=gap.root_mean_square(chosen.fit, observed),
        noise=gap.noise_of(observed),
        by_phase=GapByPhase(before=gap.by_phase(base.fit, observed), after=gap.by_phase(chosen.fit, observed)),
        closed_fraction=ClosedFraction(**{arm: arms.get(arm) for arm in ClosedFraction.model_fields}),
        closed_by_free_form=arms.get("placebo_free_form"),
        other_test=proof.other,
    )


def _tried(candidate: Candidate, found: Naming, held_out: Mapping[tuple[str, ...], float | None]) -> Tried:
    """A row of what was tried: its names, the log evidence beyond the base model's, and the form it was judged at."""
    return Tried(
        names=tuple(candidate.names),
        unknown=candidate.unknown,
        log_evidence=candidate.log_evidence - found.base.log_evidence,
        model_form_error=_errors(candidate),
        held_out=held_out.get(candidate.key),
    )


def _errors(candidate: Candidate) -> FormError:
    """The model-form error that a candidate asks for, as parts of the channels' ranges."""
    tank, chamber = candidate.form.errors
    return FormError(tank=tank, chamber=chamber)


CALLED = {"polytropic_exponent": "m"}
"""What people call a constant that has another name in the model."""

UNITS = {
    "a": "m/s (kg/m^2/s)^-n", "area": "m^2", "loss_factor": "1/m^4", "oxidizer_mass": "kg", "temperature": "K",
    "volume": "m^3", "fuel_mass": "kg", "grain_length": "m", "outer_radius": "m", "fuel_density": "kg/m^3",
    "dead_volume": "m^3", "throat_area": "m^2", "exit_area": "m^2",
}  # fmt: skip
"""Of constants, where they have one."""


def _constants(found: Naming, verdict: Verdict) -> Constants:
    """The base model's constants as fitted without and with the effects; m above all."""
    out: dict[str, dict[str, Quantity]] = {}
    for arm, fitted in (("without", found.base.fit), ("with", verdict.chosen.fit)):
        values, stds = fitted.values, fitted.stds
        out[arm] = {
            CALLED.get(n, n): Quantity(values[n], UNITS.get(n, ""), stds[n])
            for n in values
            if "." not in n and not n.startswith(DEPARTURE)
        }
    return Constants.from_json(out)


def _plausibility(found: Naming, chosen: Candidate) -> dict[str, Plausibility]:
    def of(fitted: Fit, name: str) -> Plausibility:
        return judged(sized(fitted, name, found.bench.observed))

    out: dict[str, Plausibility] = {}
    for candidate in found.singles:
        out.setdefault(candidate.names[0], of(candidate.fit, candidate.names[0]))
    return out | {name: of(chosen.fit, name) for name in acting_in(chosen.fit)}


def _two_tops(chosen: Candidate) -> list[str]:
    """That constants may as well be elsewhere, where another set of them explains the test nearly as well."""
    weight, far = told_otherwise(chosen)
    if not far:
        return []
    here, there = (", ".join(f"{CALLED.get(n, n)} {both[k]:.3g}" for n, both in far.items()) for k in (0, 1))
    return [TWO_TOPS.format(here, weight, there)]


TWO_TOPS = (
    "two sets of constants explain the test: {}, which is told, or with probability {:.1g} {}; "
    "the intervals reach over both"
)


def _course(verdict: Verdict, found: Naming) -> list[str]:
    """That the course of what is named differs from the library's, where it does."""
    if verdict.label not in ("named", "ambiguous") or verdict.chosen.unknown:
        return []
    off = course_error(verdict.chosen, found.bench)
    return [COURSE.format(" and ".join(verdict.chosen.names), 100.0 * off)] if off > 0.0 else []


COURSE = "{}: the course differs from the library's by about {:.0f} % of itself"

LIKELY = 0.02
"""Probability below which a listed effect is said not to be it."""


def _not_it(verdict: Verdict) -> tuple[str, ...]:
    """Listed effects that were tried and are not it, nor beside it."""
    named = (
        n
        for n, p in verdict.posterior.items()
        if n not in ("none", "unknown", *verdict.added) and max(p, verdict.partners.get(n, 0.0)) < LIKELY
    )
    return tuple(sorted(named))


def _twins(verdict: Verdict, catalogue: Catalogue) -> tuple[tuple[str, ...], ...]:
    """Groups of names in the answer that these channels hardly tell apart, as the effects declare."""
    groups = []
    for name in (*verdict.set90, *verdict.added):
        if name in catalogue.effects and catalogue.effects[name].twins:
            group = tuple(sorted({name, *catalogue.effects[name].twins}))
            if group not in groups:
                groups.append(group)
    return tuple(groups)


def _decisive(verdict: Verdict, catalogue: Catalogue) -> tuple[str, ...]:
    """What would decide between the names that are left; nothing where none is claimed."""
    left = () if verdict.label == "none" else dict.fromkeys((*verdict.added, *verdict.set90))
    names = [n for n in left if n in catalogue.effects]
    told = {n: catalogue.effects[n] for n in names if catalogue.effects[n].decisive}
    return tuple(dict.fromkeys(f"{effect.plain_name or name}: {effect.decisive}" for name, effect in told.items()))
