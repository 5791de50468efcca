"""Where in the model something unknown can be, and what it is a factor of there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.equations import OUTPUTS
from hfanalysis.engine.sites import EQUATION_AND_UNIT
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


_TYPICAL: dict[str, tuple[float, str | None]] = {
    "tank_heat": (2000.0, None),
    "nitrogen_inflow": (0.02, None),
    "tank_leak": (0.05, None),
    "tank_pressure": (1e5, None),
    "injector_factor": (0.1, "oxidizer_flow"),
    "feed_loss": (1e5, None),
    "regression_factor": (0.2, "fuel_flow"),
    "temperature_factor": (0.1, "nozzle_flow"),
    "throat_factor": (0.05, "thrust"),
    "thrust_factor": (0.05, "thrust"),
}
PLACES = tuple(
    SourcePlace(name, *EQUATION_AND_UNIT[name], typical, factor_of=factor_of)
    for name, (typical, factor_of) in _TYPICAL.items()
)
"""Sites of the model at which an unknown of any shape is looked for."""
