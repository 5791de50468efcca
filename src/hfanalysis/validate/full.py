"""full: the calibrated engine with nothing measured in, against every channel (report, 4.3.3)."""

from __future__ import annotations

import numpy as np

from hfanalysis.engine.observe import read_as
from hfanalysis.inference.full_run import FullRun
from hfanalysis.products.segments import Segments
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.validate.residuals import Residual, compared

TANK_CELL = 0.05
"""Part of the loaded mass by which the tank's cell may be off at rest and still be compared. Evidence:
test_sensor_bounds.py."""


def compare_full(log: TestLog, segments: Segments, full: FullRun) -> list[Residual]:
    """Every channel that the model has, over the burn, as its sensors read it."""
    burnt = full.burnt
    models = {
        "p_tank": burnt.output("tank_pressure"),
        "p_run": full.run_pressure,
        "p_chamber": burnt.output("chamber_pressure"),
        "thrust": burnt.output("thrust"),
        "m_tank": burnt.state("tank_mass"),
    }
    models = read_as(models, burnt.time, full.engine.effects)
    usable = {name: model for name, model in models.items() if name in log and log[name].good.sum() > 8}
    if "m_tank" in usable and not _cell_reads(log, segments, full.engine.oxidizer_mass):
        del usable["m_tank"]
    return [compared(log, segments, name, burnt.time, model) for name, model in usable.items()]


def _cell_reads(log: TestLog, segments: Segments, loaded: float) -> bool:
    """Whether the tank's cell at rest reads what is loaded."""
    still = Signal.of(log["m_tank"]).shifted(segments.t_open.value or 0.0).between(-5.0, -0.1).value
    return bool(still.size > 3 and abs(float(np.median(still)) - loaded) < TANK_CELL * loaded)
