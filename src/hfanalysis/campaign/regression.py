"""Regression constants common to several tests, beside those of each alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hfanalysis.calibrate.fuel_law import evidence_for
from hfanalysis.calibrate.regression import fit, fit_together
from hfanalysis.calibrate.regression_verdict import result
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.campaign.family import odd_one, rates
from hfanalysis.errors import AbsentError
from hfanalysis.inference.adopted.corrected_log import corrected
from hfanalysis.inference.adopted.effects import read_adopted
from hfanalysis.products.campaign import Agreement, CommonLaw
from hfanalysis.products.segments import Segments
from hfanalysis.progress import Progress, silent
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to


def regression_of(tests: Sequence[str], root: Path, out: Path | None, progress: Progress = silent) -> CommonLaw:
    """What the tests say of a and n alone and together. Raises AbsentError for a test that says nothing of them."""
    evidence = []
    for name in dict.fromkeys(tests):
        context = run_to("segment", open_test(root, name, out, progress=progress))
        segments, effects = context.read(Segments).fired, read_adopted(root, context.definition).acting
        log, definition = context.believed()
        if segments.taken is not None:
            log = log.between(segments.taken.start, segments.taken.end)
        log = corrected(log, segments.t_open.value or 0.0, effects)
        try:
            tank = calibrate(log, segments, definition, 400, effects)
            evidence.append(evidence_for(log, segments, definition, tank, effects))
        except AbsentError as error:
            raise AbsentError(f"{name}: {error}") from None
    alone = [fit([e]) for e in evidence]
    laws = {e.test: result(f) for e, f in zip(evidence, alone, strict=True)}
    joint = fit_together(evidence, alone)
    words = "agree" if joint.agree else "disagree: common constants fit worse than chance allows"
    agreement = Agreement(verdict=words, probability=joint.probability)
    flux, by_test = rates(laws)
    return CommonLaw(
        tests=tuple(laws),
        **result(joint.fitted).content,
        agreement=agreement,
        odd=odd_one(by_test),
        flux=flux if by_test else None,
        alone=laws,
    )
