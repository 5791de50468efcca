"""What can be said of a test whose engine cannot be run: what its sensors show by themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hfanalysis.diagnose.answer.plausible import judged
from hfanalysis.diagnose.answer.posterior import scale
from hfanalysis.diagnose.of_test import Subject
from hfanalysis.effects import effect
from hfanalysis.errors import AbsentError
from hfanalysis.quantity import Quantity
from hfanalysis.validate.performance import fire_of
from hfanalysis.validate.sensors import ZERO, Finding, findings

DRIFT = "load_cell_drift"


def sensors_alone(subject: Subject, why: str) -> dict[str, Any]:
    """The product of a diagnosis without a model. Raises AbsentError where the sensors show nothing wrong either.

    A thrust cell that does not come back to its zero has drifted, whatever the engine did. That thrust and chamber
    pressure disagree says that one of them, or the nozzle, is not what is stated, and not which.
    """
    fire = fire_of(subject.segments, subject.definition)
    found = findings(subject.log, subject.segments, subject.definition, fire)
    if not found:
        raise AbsentError(f"{why}; its sensors, by themselves, show nothing wrong")
    drift = next((f for f in found if f.verdict == ZERO), None)
    sure = 1.0 - scale().misled
    effects = [] if drift is None else [_drift(drift, sure)]
    label = "named" if effects else "unknown"
    name, else_ = (DRIFT, "unknown") if effects else ("unknown", "none")
    return {
        "verdict": label,
        "effects": effects,
        "set90": [name],
        "posterior": {name: sure, else_: 1.0 - sure},
        "localisation": [_place(f, subject) for f in found],
        "gap": {"before": {}, "after": {}, "noise": {}, "closed_fraction": dict.fromkeys(ARMS)},
        "upper_limits": {},
        "twins": [],
        "not_it": [],
        "decisive_measurements": [] if not effects else [f"{DRIFT}: {effect(DRIFT).decisive}"],
        "plausibility": {row["name"]: row["plausibility"] for row in effects},
        "compared": {"channels": sorted({c for f in found for c in f.channels})},
        "sentences": [*(f.text for f in found), f"No more can be said without a model to compare with: {why}."],
        "notes": [
            "only what the sensors show by themselves was judged; no probability of other effects was formed; "
            "what is stated is as sure as any evidence was on simulated tests"
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
    return {
        "equation": "sensor" if found.verdict == ZERO else "nozzle",
        "site": found.verdict,
        "phase": "liquid",
        "t_start": Quantity(0.0, "s"),
        "t_end": Quantity(end, "s"),
        "source": found.size,
        "channel": found.channels[0],
        "significance": 0.0,
    }
