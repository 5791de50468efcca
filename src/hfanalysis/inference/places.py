"""Where in the model something unknown can be, and what it is a factor of there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.equations import OUTPUTS
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.predict import aligned
from hfanalysis.inference.observations.observed import Observed


@dataclass(frozen=True)
class SourcePlace:
    """A site of the model or a ``sensor`` (its channel): its governing equation, and unit and typical size of what can
    be there. ``factor_of``: the output that a factor multiplies; for the chamber's temperature, the flow in whose
    enthalpy it is."""

    name: str
    equation: str
    unit: str
    typical: float
    sensor: str | None = None
    factor_of: str | None = None

    def whole(self, fitted: Fit, time: Array, observed: Observed) -> Array | None:
        """What a factor multiplies at ``time`` (n,) [s] in the run of a fit [SI]; None where there is no factor."""
        if self.factor_of is None:
            return None
        outputs = fitted.burnt.steps.at(aligned(observed, fitted.burnt, time))[1]
        return np.asarray(outputs[:, OUTPUTS.index(self.factor_of)])


PLACES = (
    SourcePlace("tank_heat", "tank_energy", "W", 2000.0),
    SourcePlace("nitrogen_inflow", "tank_volume", "kg/s", 0.02),
    SourcePlace("tank_leak", "tank_volume", "kg/s", 0.05),
    SourcePlace("tank_pressure", "tank_energy", "Pa", 1e5),
    SourcePlace("injector_factor", "injector", "1", 0.1, factor_of="oxidizer_flow"),
    SourcePlace("feed_loss", "feed", "Pa", 1e5),
    SourcePlace("regression_factor", "grain", "1", 0.2, factor_of="fuel_flow"),
    SourcePlace("temperature_factor", "chamber_energy", "1", 0.1, factor_of="nozzle_flow"),
    SourcePlace("throat_factor", "nozzle", "1", 0.05, factor_of="thrust"),
    SourcePlace("thrust_factor", "nozzle", "1", 0.05, factor_of="thrust"),
)
"""Sites of the model at which an unknown of any shape is looked for."""
