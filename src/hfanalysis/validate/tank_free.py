"""tank_free: the tank model alone from t_feed on, with only the chamber pressure measured in (report, 4.2.3)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hfanalysis.engine.effect import Active
from hfanalysis.engine.observe import read_as
from hfanalysis.inference.adopted.corrected_log import corrected
from hfanalysis.performance.tank_alone import run_tank_alone
from hfanalysis.products.calibration import TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.validate.residuals import Residual, compared


def run_tank_free(
    log: TestLog,
    segments: Segments,
    calibration: TankConstants,
    definition: TestDefinition,
    effects: Sequence[Active] = (),
) -> list[Residual]:
    """Measured and modeled tank and run-line pressure from t_feed on, as their sensors read them.

    Raises AbsentError where C_i cannot be had. Where m is not identified the run ends with the liquid.
    """
    true = corrected(log, segments.t_open.value or 0.0, effects)
    alone = run_tank_alone(true, segments, calibration, definition, definition.model.conventions == "report", effects)
    time = alone.measured.time
    keep = np.ones(time.size, dtype=bool)
    notes: tuple[str, ...] = ()
    if alone.exponent is None:
        keep = ~(time > alone.t_v)
        notes = ("m is not identified: the tank-alone run ends with the liquid",)
    models = {"p_tank": alone.pressure, "p_run": alone.run_pressure}
    models = read_as(models, time, effects, {"p_chamber": alone.chamber, "m_tank": alone.mass})
    return [
        compared(log, segments, name, time[keep], model[keep], notes) for name, model in models.items() if name in log
    ]
