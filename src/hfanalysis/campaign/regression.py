"""Regression constants common to several tests, beside those of each alone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hfanalysis.campaign.common_law import common_law
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import Calibration, FuelLaw
from hfanalysis.products.campaign import CommonLaw
from hfanalysis.progress import Progress, silent
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to


def regression_of(tests: Sequence[str], root: Path, out: Path | None, progress: Progress = silent) -> CommonLaw:
    """What the tests say of a and n alone and together; they are calibrated where they are not yet.

    Raises AbsentError for a test that says nothing of them.
    """
    laws = {}
    for test in dict.fromkeys(tests):
        law = law_in(run_to("calibrate", open_test(root, test, out, progress=progress)).read(Calibration))
        if law.a.value is None:
            raise AbsentError(f"{test}: {law.a.reason}")
        laws[test] = law
    return common_law(laws)


def law_in(calibration: Calibration) -> FuelLaw:
    """The regression law of a calibration, without what it has to do with its other constants."""
    return FuelLaw(**{name: getattr(calibration, name) for name in FuelLaw.model_fields}).but(joint=None)
