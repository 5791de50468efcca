"""The diagnosis of one test: where, when and by how much the report's model departs from what was measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.fit import Fit, model_of
from hfanalysis.diagnose.hypothesis import base_hypothesis
from hfanalysis.diagnose.localise import Localisation, Source, localise
from hfanalysis.diagnose.observed import Observed, observe_test
from hfanalysis.quantity import Quantity
from hfanalysis.segment.phases import Segments
from hfanalysis.stages.base import Progress, silent
from hfanalysis.testdata.definition import TestDefinition
from hfanalysis.testdata.log import TestLog
from hfanalysis.validate.full import run_full

Array = NDArray[np.float64]

Z90 = 1.6449
"""Half-width of the 90 % interval of a normal distribution."""

SEEN = 2.0
"""Standard deviations from which on a source counts as there."""


@dataclass(frozen=True)
class Diagnosis:
    """What was found, and the product."""

    localisation: Localisation
    product: dict[str, Any]


def diagnose(
    log: TestLog,
    segments: Segments,
    calibration: Mapping[str, Any],
    definition: TestDefinition,
    progress: Progress = silent,
) -> Diagnosis:
    """Localise. Raises AbsentError where the test does not state an engine or too little was recorded."""
    observed = observe_test(log, segments, definition)
    full = run_full(log, segments, calibration, definition)
    found = localise(base_hypothesis(full.engine, calibration), observed, progress)
    places = [place(source, observed) for source in found.sources]
    product = {
        "verdict": "unknown" if places else "none",
        "effects": [],
        "set90": ["unknown"] if places else ["none"],
        "localisation": places,
        "ranking": [
            {"site": s.site.name, "equation": s.site.equation, "log_evidence": s.log_evidence} for s in found.ranking
        ],
        "gap": gap(found),
        "nuisances": {name: value for name, value in found.final.values.items() if "." not in name},
        "compared": {
            "channels": list(observed.names),
            "start": float(observed.channels[0].time[0]),
            "end": observed.end,
        },
        "warnings": _warnings(found),
    }
    return Diagnosis(found, product)


def place(source: Source, observed: Observed) -> dict[str, Any]:
    """Where and when a source acts, and how large it is on average there."""
    seen = np.abs(source.mean) > SEEN * source.std
    if not seen.any():
        seen = np.abs(source.mean) >= np.abs(source.mean).max()
    first, last = source.time[seen][0], source.time[seen][-1]
    inside = (source.time >= first) & (source.time <= last)
    mean = float(source.mean[inside].mean())
    return {
        "equation": source.site.equation,
        "site": source.site.name,
        "phase": _phase(source, observed),
        "t_start": Quantity(float(first), "s", source.splines.spacing / 2.0),
        "t_end": Quantity(float(last), "s", source.splines.spacing / 2.0),
        "source": Quantity(mean, source.site.unit, float(source.std[inside].mean())),
        "significance": source.log_evidence,
        "history": {
            "unit": source.site.unit,
            "time": source.time.tolist(),
            "low90": (source.mean - Z90 * source.std).tolist(),
            "high90": (source.mean + Z90 * source.std).tolist(),
        },
    }


def _phase(source: Source, observed: Observed) -> str:
    """The phase in which the source is seen best."""
    names = [name for name in observed.phases if name != "end"]
    starts = [observed.phases[name] for name in names]
    weight = (source.mean / np.maximum(source.std, 1e-300)) ** 2
    number = np.searchsorted(starts, source.time, side="right") - 1
    return names[int(np.argmax([weight[number == i].sum() for i in range(len(names))]))]


def gap(found: Localisation) -> dict[str, Any]:
    """Root mean square of measured less model, by channel [SI]: without sources, with them, and the noise alone."""
    out: dict[str, dict[str, float]] = {"before": {}, "after": {}, "noise": {}}
    for stage, fitted in (("before", found.base), ("after", found.final)):
        for name, residual in raw_residuals(fitted, found.observed).items():
            out[stage][name] = float(np.sqrt(np.mean(residual**2)))
    for channel in found.observed.channels:
        out["noise"][channel.name] = float(np.sqrt(np.mean(channel.noise_std**2)))
    return out


def raw_residuals(fitted: Fit, observed: Observed) -> dict[str, Array]:
    """Measured less model of every channel, in its unit."""
    return {c.name: c.value - model_of(fitted, c) for c in observed.channels}


def _warnings(found: Localisation) -> list[str]:
    if found.final.converged:
        return []
    return ["the last fit did not converge: sizes and intervals are rough"]
