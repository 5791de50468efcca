"""A thrust cell whose zero wanders as it warms."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hfanalysis.engine.effect import Array, Channels, Effect, Parameter


def _distort(times: Array, channels: Channels, values: Mapping[str, float]) -> dict[str, Array]:
    warmed = -np.expm1(-np.maximum(times, 0.0) / values["time"])
    return {**channels, "thrust": channels["thrust"] + values["drift"] * warmed}


EFFECT = Effect(
    name="load_cell_drift",
    equation="sensor",
    meaning="the thrust cell's zero drifts from ignition on, as heat reaches it",
    reference="Doebelin, Measurement Systems, chapters 3 and 5: zero drift of strain-gauge cells with temperature; a "
    "cell that warms as one body approaches its end exponentially",
    formula="F_read = F + d (1 - exp(-t / tau))",
    sites=("thrust",),
    parameters=(
        Parameter("drift", "N", "where the zero ends", typical=100.0, low=-2000.0, high=2000.0),
        Parameter("time", "s", "in which the cell warms", 5.0, center=10.0, low=1.0, high=100.0),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    distort=_distort,
    twins=(),
    decisive="the thrust cell's zero for a minute after the burn, or a thermocouple on the cell",
)
