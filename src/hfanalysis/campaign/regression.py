"""Regression constants common to several tests, beside those of each alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hfanalysis.calibrate.fuel_law import evidence_for
from hfanalysis.calibrate.regression import Joint, fit, fit_together, result
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.errors import AbsentError
from hfanalysis.inference.adopted.corrected_log import corrected
from hfanalysis.inference.adopted.effects import read_adopted
from hfanalysis.progress import Progress, silent
from hfanalysis.record.log import read_log
from hfanalysis.segment.phases import Segments
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to


def regression_of(tests: Sequence[str], root: Path, out: Path | None, progress: Progress = silent) -> dict[str, Any]:
    """What the tests say of a and n alone and together. Raises AbsentError for a test that says nothing of them."""
    evidence = []
    for name in dict.fromkeys(tests):
        context = run_to("segment", open_test(root, name, out, progress=progress))
        segments = Segments.from_json(context.read_json("segments.json"))
        effects = read_adopted(root, context.definition).acting
        log = corrected(read_log(context.product("ingest.h5")), segments.t_open.value or 0.0, effects)
        try:
            tank = calibrate(log, segments, context.definition, 400, effects)
            evidence.append(evidence_for(log, segments, context.definition, tank, effects))
        except AbsentError as error:
            raise AbsentError(f"{name}: {error}") from None
    alone = [fit([e]) for e in evidence]
    return _product(
        fit_together(evidence, alone), {e.test: result(f).to_json() for e, f in zip(evidence, alone, strict=True)}
    )


def _product(joint: Joint, alone: dict[str, Any]) -> dict[str, Any]:
    words = "agree" if joint.agree else "disagree: common constants fit worse than chance allows"
    return {
        "tests": list(alone),
        **result(joint.fitted).to_json(),
        "agreement": {"verdict": words, "probability": joint.probability},
        "alone": alone,
    }
