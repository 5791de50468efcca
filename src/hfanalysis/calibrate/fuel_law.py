"""a and n of a test that has been calibrated, or of several together; a test that tells nothing says why."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hfanalysis.calibrate.calibration import TankCalibration
from hfanalysis.calibrate.evidence import Evidence
from hfanalysis.calibrate.evidence_from_log import evidence_of
from hfanalysis.calibrate.facts import nothing_to_regress
from hfanalysis.calibrate.regression import Joint, fit, fit_together, result
from hfanalysis.engine.effect import Active
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import FuelLaw
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog


def evidence_for(
    log: TestLog,
    segments: Segments,
    definition: TestDefinition,
    calibration: TankCalibration,
    effects: Sequence[Active] = (),
) -> Evidence:
    """What a test says about a and n. Raises AbsentError where it says nothing, with the reason."""
    if segments.kind != "hot_fire" or segments.misfire:
        raise AbsentError("nothing burns in this test")
    if calibration.draws is None:
        reason = calibration.constants.C_i.reason
        raise AbsentError(f"no oxidizer flow to regress with: C_i is missing ({reason})")
    if reason := nothing_to_regress(log, segments, definition, calibration.constants):
        raise AbsentError(reason)
    return evidence_of(log, segments, definition, calibration.constants, calibration.draws, effects)


def regress(
    log: TestLog,
    segments: Segments,
    definition: TestDefinition,
    calibration: TankCalibration,
    effects: Sequence[Active] = (),
) -> FuelLaw:
    """a, n and the rate at the reference flux of one test, with their verdicts, ``effects`` acting."""
    try:
        found = fit([evidence_for(log, segments, definition, calibration, effects)])
    except AbsentError as error:
        return FuelLaw.absent(str(error))
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        return FuelLaw.absent(f"the engine's model cannot be fitted with what test.toml states: {error}")
    return result(found)


def regress_together(tests: Sequence[Evidence]) -> Joint:
    """Common a and n of several tests."""
    return fit_together(tests, [fit([e]) for e in tests])
