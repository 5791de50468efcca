"""What can be said of a test whose engine cannot be run: what its channels show by themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hfanalysis.diagnose.answer.plausible import judged
from hfanalysis.diagnose.answer.posterior import scale
from hfanalysis.diagnose.of_test import Subject
from hfanalysis.diagnose.signs import Sign, sentences, signs
from hfanalysis.effects import effect
from hfanalysis.errors import AbsentError
from hfanalysis.quantity import Quantity
from hfanalysis.validate.performance import fire_of
from hfanalysis.validate.sensors import ZERO, Finding, findings

DRIFT = "load_cell_drift"


def sensors_alone(subject: Subject, why: str) -> dict[str, Any]:
    """The product of a diagnosis without a model. Raises AbsentError where the channels show nothing wrong either.

    A thrust cell that does not come back to its zero has drifted, whatever the engine did. That thrust and chamber
    pressure disagree says that one of them, or the nozzle, is not what is stated, and not which. What tank and purge
    line show is in ``diagnose.signs``. Nothing tells which of several explains most: a drift comes first, for its size
    is known, and nothing else is added to the model.
    """
    fire = fire_of(subject.segments, subject.definition)
    wrong = findings(subject.log, subject.segments, subject.definition, fire)
    seen = signs(subject.log, subject.segments)
    if not wrong and not seen:
        raise AbsentError(f"{why}; its channels, by themselves, show nothing wrong")
    drift = next((f for f in wrong if f.verdict == ZERO), None)
    sure = 1.0 - scale().misled
    effects = [] if drift is None else [_drift(drift, sure)]
    labels = ([(DRIFT,)] if drift else []) + [sign.names for sign in seen]
    first = {name: sure / len(labels[0]) for name in labels[0]} if labels else {"unknown": sure}
    partners = {name: sure / len(group) for group in labels[1:] for name in group}
    partners |= {name: 0.5 * sure for sign in seen for name in sign.besides}
    return {
        "verdict": "unknown" if not labels else "named" if all(len(group) == 1 for group in labels) else "ambiguous",
        "effects": effects,
        "set90": list(first),
        "posterior": {**first, "unknown" if labels else "none": 1.0 - sure},
        "partners": partners,
        "localisation": [*(_place(f, subject) for f in wrong), *(_place_of(sign) for sign in seen)],
        "gap": {"before": {}, "after": {}, "noise": {}, "closed_fraction": dict.fromkeys(ARMS)},
        "upper_limits": {},
        "twins": [],
        "not_it": [],
        "decisive_measurements": [
            f"{name}: {effect(name).decisive}" for name in dict.fromkeys((*first, *partners)) if name != "unknown"
        ],
        "plausibility": {row["name"]: row["plausibility"] for row in effects},
        "compared": {"channels": sorted({c for f in wrong for c in f.channels} | {s.channel for s in seen})},
        "sentences": [
            *sentences(subject.log, subject.segments, subject.definition),
            f"No more can be said without a model to compare with: {why}.",
        ],
        "notes": [
            "only what the channels show by themselves was judged; no probability of other effects was formed; "
            "what is stated is as sure as any evidence was on simulated tests; of two names, or of one that may have a "
            "part in it, the odds are even"
        ],
        "warnings": [],
        "runtime_s": {"value": None, "reason": "times stand in run.log, so that products are the same from run to run"},
        "seed": 0,
    }


ARMS: Sequence[str] = ("same", "held_out", "other_test", "placebo")


def _drift(found: Finding, sure: float) -> dict[str, Any]:
    size: Quantity = found.size
    value = size.value or 0.0
    parameters: Mapping[str, Quantity] = {"drift": size}
    return {
        "name": DRIFT,
        "probability": sure,
        "equation": "sensor",
        "meaning": effect(DRIFT).meaning,
        "parameters": parameters,
        "plausibility": judged(DRIFT, {"drift": value}),
    }


def _place(found: Finding, subject: Subject) -> dict[str, Any]:
    end = subject.segments.time("t_end") or subject.segments.time("t_fuel_out") or 0.0
    equation = "sensor" if found.verdict == ZERO else "nozzle"
    return _row(equation, found.verdict, "liquid", (0.0, end), found.size, found.channels[0])


def _place_of(sign: Sign) -> dict[str, Any]:
    equation, phase = effect(sign.names[0]).equation, "purge" if sign.channel == "p_purge" else "liquid"
    return _row(equation, " or ".join(sign.names), phase, (sign.start, sign.end), sign.size, sign.channel)


def _row(
    equation: str, site: str, phase: str, span: tuple[float, float], size: Quantity, channel: str
) -> dict[str, Any]:
    return {
        "equation": equation,
        "site": site,
        "phase": phase,
        "t_start": Quantity(span[0], "s"),
        "t_end": Quantity(span[1], "s"),
        "source": size,
        "channel": channel,
        "significance": 0.0,
    }
