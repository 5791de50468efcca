"""A base calibration where the pressure ahead of the injector was not recorded: injector and feed line as one orifice.

Both lose pressure with the square of the flow over the density, so that together they pass what one smaller orifice at
the tank's pressure does. Such an area is no C_i, and is reported as none; a diagnosis can start from it.
"""

from __future__ import annotations

from dataclasses import replace

from hfanalysis.calibrate.fuel_law import regress
from hfanalysis.calibrate.tank import calibrate
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog

SAMPLES = 50
"""Repetitions of the calibration with drawn inputs: a diagnosis takes the load's deviation from them, and no more."""

NOTE = (
    "p_run was not recorded: injector and feed line were taken for one orifice, and what happens in one of them "
    "cannot be told from the other"
)


def lumped_calibration(log: TestLog, segments: Segments, definition: TestDefinition) -> Calibration:
    """What calibration.json would hold if the feed line lost nothing. Raises AbsentError as a calibration does."""
    channels = {**log.channels, "p_run": replace(log["p_tank"], name="p_run")}
    lossless = replace(log, channels=channels)
    tank = calibrate(lossless, segments, definition, SAMPLES)
    regression = regress(lossless, segments, definition, tank)
    return tank.with_law(regression)
