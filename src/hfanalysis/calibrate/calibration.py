"""What the calibration of a tank found, beside what its product holds."""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.calibrate.uncertainty import Draws
from hfanalysis.products.calibration import Calibration, FuelLaw, TankConstants


@dataclass(frozen=True)
class TankCalibration:
    """The constants of a tank, and the repetitions that gave their deviations; None where there are no constants.

    ``draws`` have what the log and stated deviations leave open, ``whole`` the systematic errors beside it (of the
    sensors' spans, too): the first weigh a fit, the second are what its answer may be off by.
    """

    constants: TankConstants
    draws: Draws | None = None
    whole: Draws | None = None

    def with_law(self, law: FuelLaw) -> Calibration:
        """Together with the fuel's regression."""
        return Calibration(**{**self.constants.content, **law.content})
