"""What the calibration of a tank found, as calibration.json holds it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hfanalysis.calibrate.diagnostics import CoefficientHistory, TankHistory
from hfanalysis.calibrate.rest import Rest
from hfanalysis.calibrate.uncertainty import Draws
from hfanalysis.quantity import Quantity


@dataclass(frozen=True)
class Calibration:
    """Result of the tank calibration: quantities by their names in calibration.json."""

    quantities: dict[str, Quantity]
    rest: Rest | None
    history: CoefficientHistory | None
    tank_history: TankHistory | None
    warnings: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    draws: Draws | None = None

    def to_json(self) -> dict[str, Any]:
        """The content of calibration.json."""
        return {
            **{name: quantity.to_json() for name, quantity in self.quantities.items()},
            "rest": self.rest.to_json() if self.rest else None,
            "C_i_history": self.history.to_json() if self.history else None,
            "tank_history": self.tank_history.to_json() if self.tank_history else None,
            "notes": list(self.notes),
            "warnings": list(self.warnings),
        }
