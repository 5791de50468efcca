"""Whether an effect of the size that was found can be on a stand, and how large that is in words.

The limits are not those of the priors: they are what a careful engineer would believe of a small stand before asking
what else it could be. A size beyond its limit lowers the probability of the name.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import log

from hfanalysis.products.diagnosis import Plausibility


@dataclass(frozen=True)
class Limit:
    """The largest believable size of a parameter [SI], how it is shown (factor, unit), and why no larger."""

    parameter: str
    most: float
    factor: float
    unit: str
    why: str


LIMITS = {
    "tank_heat": Limit("power", 3000.0, 1e-3, "kW", "a stand's heating blankets draw some hundred watts each"),
    "tank_wall_heat_capacity": Limit("capacity", 2e4, 1e-3, "kJ/K", "20 kJ/K are 22 kg of aluminium"),
    "tank_nonequilibrium": Limit("depth", 8e5, 1e-5, "bar", "cold-flow tests see dips of a few bar"),
    "tank_stratification": Limit("excess", 10.0, 1.0, "K", "a tank in the shade is layered by some kelvins"),
    "n2_purge": Limit("area", 3e-5, 1e6, "mm^2", "30 mm^2 are a bore of 6 mm, more than purge lines have"),
    "feed_line_fill": Limit("volume", 1e-3, 1e3, "L", "a litre is ten metres of a line of 11 mm"),
    "injector_two_phase": Limit("weight", 1.0, 1.0, "", "1 is equilibrium all the way"),
    "injector_choked_vapor": Limit("weight", 1.0, 1.0, "", "1 is compressible flow, choked where it must be"),
    "combustion_efficiency": Limit("deficit", 0.25, 100.0, "%", "an engine that burns at all gives three quarters"),
    "chamber_heat_loss": Limit("loss", 4e5, 1e-3, "kW", "walls of some kilogrammes take no more for seconds"),
    "grain_pressure_regression": Limit("exponent", 0.6, 1.0, "", "paraffin's regression hardly knows the pressure"),
    "ignition_transient": Limit("mass", 0.15, 1e3, "g", "igniter charges weigh some ten grammes"),
    "fuel_sliver": Limit("depth", 0.95, 100.0, "%", "beyond that the end would not be seen at all"),
    "nozzle_throat_erosion": Limit("rate", 4e-4, 1e3, "mm/s", "graphite loses some tenths of a millimetre a second"),
    "nozzle_divergence": Limit("loss", 0.12, 100.0, "%", "a cone of 40 degrees half-angle loses 12 %"),
    "load_cell_drift": Limit("drift", 500.0, 1.0, "N", "cells drift by some per cent of their range"),
    "pressure_transducer_offset": Limit("p_tank", 3e5, 1e-5, "bar", "that much would show before the test"),
    "chamber_tap_lag": Limit("lag", 0.5, 1e3, "ms", "a tap and a tube of a metre lag some hundredths of a second"),
}

STEEPNESS = 3.0
"""Log of the odds lost per squared e-fold beyond the limit."""

MOST_LOST = 15.0


def excess(name: str, values: Mapping[str, float]) -> float:
    """The size of an effect over the largest believable one; 0 where nothing is known of it."""
    limit = LIMITS.get(name)
    if limit is None:
        return 0.0
    if name == "pressure_transducer_offset":
        return max(abs(v) for v in values.values()) / limit.most
    return abs(values[limit.parameter]) / limit.most


def lost(name: str, values: Mapping[str, float]) -> float:
    """Log of the odds that an effect loses by its size."""
    beyond = excess(name, values)
    return 0.0 if beyond <= 1.0 else min(STEEPNESS * log(beyond) ** 2 + 1.0, MOST_LOST)


def judged(name: str, values: Mapping[str, float]) -> Plausibility:
    """How large the effect is, whether that is possible, and why."""
    limit = LIMITS.get(name)
    if limit is None:
        return Plausibility(size=None, plausible=None, why="nothing is known of how large this effect can be")
    chosen = limit.parameter
    if name == "pressure_transducer_offset":
        chosen = max(values, key=lambda k: abs(values[k]))
    text = f"{values[chosen] * limit.factor:.3g} {limit.unit}".strip()
    most = f"{limit.most * limit.factor:.3g} {limit.unit}".strip()
    possible = excess(name, values) <= 1.0
    why = f"{chosen} of {text}" + (f" is below {most}" if possible else f" is beyond {most}: {limit.why}")
    return Plausibility(size=text, plausible=possible, why=why)
