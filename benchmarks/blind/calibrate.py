"""Fit the constants of the stated probabilities on the calibration split, and on no other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from math import inf, sqrt
from pathlib import Path
from typing import Any

import numpy as np
from simulated.blind.judged import Case, of_kind
from simulated.blind.outcomes import LEAST
from simulated.blind.plan import OUTSIDE_TARGETS, SHARES, TARGETS
from simulated.blind.score import reliability

from hfanalysis.diagnose.answer.posterior import LEAST_EVIDENCE

from .fit import OFFSETS, REST, Constants, Fitted, Sample, constants_of, fit, out_of_fold, sample
from .folder import PROBABILITIES, write_json
from .results import Results

ALONE = (*OFFSETS, "unexplained")
"""Constants that can be fitted alone."""

FEWEST = 50
"""Cases below which the constants would be arbitrary."""


class Unfit(Exception):
    """The results cannot be calibrated on; the message says why."""


def log_scores(samples: Sequence[Sample], constants: Sequence[Constants]) -> np.ndarray:
    """Logarithm of the probability of the right label."""
    right = (
        c.probabilities(s.evidences, s.leftover, s.elsewhere)[s.truth] for s, c in zip(samples, constants, strict=True)
    )
    return np.log(np.maximum(list(right), LEAST))


def weights_of(samples: Sequence[Sample]) -> np.ndarray:
    """For how many each case counts, one on the average."""
    own = np.array([s.weight for s in samples])
    return np.asarray(own / own.mean())


def stated(cases: Sequence[Case], samples: Sequence[Sample], constants: Sequence[Constants]) -> list[Case]:
    """The cases with the probabilities that the constants make of their evidences."""
    return [
        Case(c.answer, {"posterior": k.probabilities(s.evidences, s.leftover, s.elsewhere)})
        for c, s, k in zip(cases, samples, constants, strict=True)
    ]


def usable(found: Results) -> tuple[list[Case], list[Sample], int]:
    """Cases with one right label and its evidence, and the number of those that have no evidence for it."""
    asked = of_kind(list(found.cases.values()), "single", "none", "outside")
    both = [(c, sample(c.product, c.truth, str(c.answer["stand"] or c.answer["id"]))) for c in asked]
    kept = [(c, s) for c, s in both if s is not None]
    cases = [c for c, _ in kept]
    samples = [replace(s, weight=w) for (_, s), w in zip(kept, weights(cases), strict=True)]
    return cases, samples, len(both) - len(kept)


def weights(cases: Sequence[Case]) -> list[float]:
    """For how many each case counts, so that every kind and d' has its share of the whole plan.

    Parts of the plan that were sampled more or less densely may so be taken together. All cases count for as many as
    they are worth: (sum w)^2 / sum w^2 (Kish: Survey Sampling, 1965, section 11.7).
    """
    cells = [(c.kind, c.answer["target_d_prime"]) for c in cases]
    number = Counter(cells)
    targets = {"single": len(TARGETS), "outside": len(OUTSIDE_TARGETS)}
    raw = np.array([SHARES[kind] / targets.get(kind, 1) / number[kind, target] for kind, target in cells])
    return list((raw * raw.sum() / np.sum(raw**2)).tolist()) if cells else []


def calibrate(
    found: Results, split: str, mixed: bool = False, fewest: int = FEWEST
) -> tuple[list[str], dict[str, Any]]:
    """Fit; what there is to say, and what is to be written.

    Raises Unfit where cases are of several versions of the code (unless ``mixed``), or too few.
    """
    codes = sorted({note.code for i, note in found.notes.items() if i in found.cases})
    if len(codes) > 1 and not mixed:
        raise Unfit(f"the cases were diagnosed by {len(codes)} versions of the code; run them anew, or pass --mixed")
    cases, samples, without = usable(found)
    if len(samples) < fewest:
        raise Unfit(f"only {len(samples)} cases state evidences for their right label; {fewest} are needed")
    fits = {with_leftover: fit(samples, with_leftover) for with_leftover in (False, True)}
    held_out = {key: out_of_fold(samples, key) for key in fits}
    scores = {key: log_scores(samples, constants) for key, constants in held_out.items()}
    # t1 is kept where it pays beyond its own noise on cases that it was not fitted to
    gain = (scores[True] - scores[False]) * weights_of(samples)
    grows = bool(gain.mean() > gain.std(ddof=1) / sqrt(len(gain)))
    lines = [
        *_report(cases, samples, fits, held_out, grows, without),
        "",
        *forms(cases),
        "",
        *alarms(cases),
        "",
        *leads(cases),
    ]
    return lines, to_json(fits[grows], len(samples), split, codes)


def calibrate_only(found: Results, which: str, present: dict[str, Any]) -> tuple[list[str], dict[str, Any]]:
    """Fit one constant with all others ``present`` held: what there is to say, and what is to be written.

    For cases that are no fair sample of the plan but hold many of the kind that the constant is for.
    """
    if which not in ALONE:
        raise Unfit(f"there is no constant {which!r}; there are {', '.join(ALONE)}")
    cases, samples, without = usable(found)
    if len(samples) < FEWEST:
        raise Unfit(f"only {len(samples)} cases state evidences for their right label; {FEWEST} are needed")
    before = constants_of(present)
    one = fit(samples, present["temperature_per_leftover"] > 0.0, before, which)
    lines = [f"{len(samples)} cases; {without} more state no evidence for the right label and are left out",
             f"{which}: {value_of(one.constants, which):.4g} +- {_pm(one, which)}", ""]  # fmt: skip
    for text, constants in (("before", before), ("with it", one.constants)):
        all_of = [constants] * len(samples)
        said, scores = stated(cases, samples, all_of), log_scores(samples, all_of)
        for kind, name in (("single", "names"), ("outside", "outsiders")):
            own = of_kind(said, kind)
            lines.append(f"{text:8s} {name}: {sum(c.stated == c.truth for c in own)} of {len(own)} right")
        lines.append(f"{text:8s} log score {(scores * weights_of(samples)).mean():+.4f}")
    data = {**present, "offsets": dict(one.constants.scale.offsets), "unexplained": one.constants.unexplained}
    codes = sorted({note.code for i, note in found.notes.items() if i in found.cases})
    data["standard_errors"] = {**present["standard_errors"], which: one.errors[which]}
    data["fitted_alone"] = {which: {"cases": len(samples), "code": codes}}
    return lines, data


def _report(
    cases: Sequence[Case], samples: Sequence[Sample], fits: dict[bool, Fitted],
    held_out: dict[bool, list[Constants]], grows: bool, without: int,
) -> list[str]:  # fmt: skip
    raw = [Constants()] * len(samples)
    lines = [f"{len(samples)} cases; {without} more state no evidence for the right label and are left out",
             f"T {'grows with the misfit left' if grows else 'does not depend on the misfit left'}", ""]  # fmt: skip
    lines += [f"{'*' if key == grows else ' '} {_constants(one)}" for key, one in fits.items()]
    lines += ["", "                        log score            calibration error (debiased)"]
    rows = {"evidences as they are": raw, "fitted, same cases": [fits[grows].constants] * len(samples),
            "fitted, 5-fold": held_out[grows], "5-fold, other form": held_out[not grows]}  # fmt: skip
    for name, constants in rows.items():
        s = log_scores(samples, constants) * weights_of(samples)
        error = reliability(stated(cases, samples, constants))[0]
        spread = s.std(ddof=1) / sqrt(len(s))
        lines.append(f"{name:22s}  {s.mean():+.4f} +- {spread:.4f}   {error.value:.4f} "
                     f"({error.low:.3f} to {error.high:.3f})")  # fmt: skip
    return lines


def forms(cases: Sequence[Case]) -> list[str]:
    """Model-form errors that right explanations ask for: the price of a coarser one goes by it."""
    right = [c for c in cases if c.stated == c.truth and c.truth != "unknown"]
    errors = [e for c in right if (e := c.product.get("compared", {}).get("model_form_error")) is not None]
    lines = [f"model-form error of the {len(errors)} cases that are right (none, or the name)"]
    for side in ("tank", "chamber"):
        asked = Counter(e[side] for e in errors)
        each = ", ".join(f"{100.0 * error:.2g} %: {number}" for error, number in sorted(asked.items()))
        lines.append(f"  {side}: {each}")
    return lines


def alarms(cases: Sequence[Case], most: int = 4) -> list[str]:
    """The largest log evidences where there is nothing to find: the least that a claim needs goes by them."""
    nothing = [c.product.get("evidences", {}) for c in cases if c.truth == "none"]
    named = sorted(max((v for k, v in e.items() if k not in ("none", "unknown")), default=0.0) for e in nothing)
    unknown = sorted(e.get("unknown", 0.0) for e in nothing)
    lines = [f"largest log evidences of the {len(nothing)} cases without an effect"]
    for name, found in (("names", named), ("unknown", unknown)):
        lines.append(f"  {name}: " + ", ".join(f"{v:.1f}" for v in found[::-1][:most]))
    return lines


def leads(cases: Sequence[Case], most: int = 8) -> list[str]:
    """What an unknown source explains more than the best name, where that has what a claim needs and both act in one
    equation: the most where the name is right, and all where something else is hidden. What closures leave goes by it.
    """
    found: dict[bool, list[tuple[float, float, str]]] = {True: [], False: []}
    for c in cases:
        evidences = c.product.get("evidences", {})
        name, best = max(((k, e) for k, e in evidences.items() if k not in ("none", "unknown")), key=lambda x: x[1])
        lead, apart = evidences.get("unknown", -inf) - best, c.product.get("unknown_elsewhere")
        same_place = apart is None or apart < evidences["unknown"]
        if best >= LEAST_EVIDENCE and lead > 0.0 and same_place and c.truth in (name, "unknown"):
            found[c.truth == name].append((lead, best, c.answer["id"]))
    lines = ["lead of an unknown source over the best name (its log evidence) in the same equation"]
    for right, text in ((True, "names that are right"), (False, "outsiders")):
        rows = sorted(found[right], reverse=True)[: most if right else None]
        lines.append(f"  {text}: " + ", ".join(f"{lead:.1f} ({best:.0f}, {i})" for lead, best, i in rows))
    return lines


def value_of(constants: Constants, which: str) -> float:
    """One of ALONE."""
    return constants.unexplained if which == "unexplained" else constants.scale.offsets[which]


def _constants(one: Fitted) -> str:
    k = one.constants
    return (
        f"T0 = {k.temperature:.4g} (ln T0 +- {_pm(one, 'ln_temperature')}), "
        f"t1 = {k.per_leftover:.4g} +- {_pm(one, 'per_leftover')}, "
        f"named = {k.named:.4g} +- {_pm(one, 'named')}, unknown = {k.unknown:.4g} +- {_pm(one, 'unknown')}, "
        f"unseen: named = {k.unseen_named:.4g} +- {_pm(one, 'unseen named')}, "
        f"unknown = {k.unseen_unknown:.4g} +- {_pm(one, 'unseen unknown')}, "
        f"unexplained = {k.unexplained:.3g} +- {_pm(one, 'unexplained')}, "
        f"misled = {k.misled:.3g} +- {_pm(one, 'misled')}, "
        f"where all is faint {k.misled_faint:.3g} +- {_pm(one, 'misled_faint')}"
    )


def _pm(one: Fitted, name: str) -> str:
    error = one.errors[name]
    return "-" if error is None else f"{error:.2g}"


def to_json(one: Fitted, number: int, split: str, codes: Sequence[str]) -> dict[str, Any]:
    """The data file that the diagnosis reads."""
    k = one.constants
    return {
        "temperature": k.temperature,
        "temperature_per_leftover": k.per_leftover,
        "offsets": dict(k.scale.offsets),
        "misled": k.misled,
        "misled_faint": k.misled_faint,
        "unexplained": k.unexplained,
        "standard_errors": one.errors,
        "cases": number,
        "split": split,
        "code": list(codes),
    }


def pooled(one: dict[str, Any], other: dict[str, Any]) -> dict[str, Any]:
    """Two fits to different cases as one, each constant by the inverse squares of its standard errors.

    The temperature counts by its logarithm; that of the misfit left has to be none in both.
    """
    if one["temperature_per_leftover"] or other["temperature_per_leftover"]:
        raise Unfit("constants of which the temperature goes with the misfit left are not pooled")
    values, errors = {}, {}
    for name in (*one["offsets"], "ln_temperature", *REST):
        if name == "none":
            continue
        both = [(_constant(data, name), data["standard_errors"][name]) for data in (one, other)]
        if any(error is None for _, error in both):
            raise Unfit(f"{name} has no standard error in one of the fits")
        weight = np.array([error**-2 for _, error in both])
        values[name] = float(weight @ [value for value, _ in both] / weight.sum())
        errors[name] = float(weight.sum() ** -0.5)
    return {
        **one,
        "temperature": float(np.exp(values.pop("ln_temperature"))),
        **{name: values.pop(name) for name in REST},
        "offsets": {"none": 0.0, **values},
        "standard_errors": {**one["standard_errors"], **errors},
        "cases": one["cases"] + other["cases"],
        "code": sorted({*one["code"], *other["code"]}),
    }


def _constant(data: dict[str, Any], name: str) -> float:
    if name == "ln_temperature":
        return float(np.log(data["temperature"]))
    return float(data["offsets"].get(name, data.get(name)))


def save(data: dict[str, Any], path: Path = PROBABILITIES) -> None:
    """Write the constants, whole; only those of the calibration split may go where the diagnosis reads them."""
    if path.resolve() == PROBABILITIES.resolve() and data["split"] != "calibration":
        raise Unfit("only constants of the calibration split may be written for the diagnosis; pass --write PATH")
    write_json(path, data)
