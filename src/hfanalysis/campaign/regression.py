"""Regression constants common to several tests, beside those of each alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hfanalysis.calibrate.evidence import Evidence
from hfanalysis.calibrate.fuel_law import evidence_for
from hfanalysis.calibrate.regression import Fitted, fit, fit_together
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
    evidence = [evidence_of_test(name, root, out, progress) for name in dict.fromkeys(tests)]
    return together(evidence, [fit([e]) for e in evidence])


def evidence_of_test(name: str, root: Path, out: Path | None, progress: Progress = silent) -> Evidence:
    """What a test says of a and n. Raises AbsentError where it says nothing."""
    context = run_to("segment", open_test(root, name, out, progress=progress))
    segments, effects = context.read(Segments).fired, read_adopted(root, context.definition).acting
    log, definition = context.believed()
    if segments.taken is not None:
        log = log.between(segments.taken.start, segments.taken.end)
    log = corrected(log, segments.t_open.value or 0.0, effects)
    try:
        return evidence_for(log, segments, definition, calibrate(log, segments, definition, 400, effects), effects)
    except AbsentError as error:
        raise AbsentError(f"{name}: {error}") from None


def together(evidence: Sequence[Evidence], alone: Sequence[Fitted]) -> CommonLaw:
    """One law of several tests beside that of each ``alone``."""
    laws = {e.test: result(f) for e, f in zip(evidence, alone, strict=True)}
    joint = fit_together(evidence, alone)
    words = "agree" if joint.agree else "disagree: common constants fit worse than chance allows"
    flux, by_test = rates(laws)
    return CommonLaw(
        tests=tuple(laws),
        **result(joint.fitted).content,
        agreement=Agreement(verdict=words, probability=joint.probability),
        odd=odd_one(by_test),
        flux=flux if by_test else None,
        alone=laws,
    )
