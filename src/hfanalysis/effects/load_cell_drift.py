"""A thrust cell whose zero wanders as it warms."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Believable, Channels, Effect, Parameter

REFERENCE = 10e5
"""Pressure [Pa] of a chamber at which the warming time is stated. Source: by definition of that time."""


LEAST_OVERPRESSURE = 1e-3
"""Least pressure over the surroundings' that counts, in REFERENCE [-]: noise goes below, and has no power there."""


def heat_clock(times: Array, pressure: Array, power: float) -> Array:
    """Time [s] at REFERENCE that brings as much heat as a chamber has brought since the opening (time 0), (n,).

    ``times`` [s] and ``pressure`` [Pa], (n,) each. Heat goes with a ``power`` [-] of its pressure over the
    surroundings': from 0 (a cell that goes on warming by what soaks into it) to 1. It is the time itself where the
    pressure was not recorded.
    """
    if not np.ptp(pressure) > 0.0:
        return np.maximum(times, 0.0)
    over = np.maximum((pressure - pressure.min()) / REFERENCE, LEAST_OVERPRESSURE)
    rate = np.where(times >= 0.0, over**power, 0.0)
    return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(times))])


def _distort(times: Array, channels: Channels, values: Mapping[str, float]) -> dict[str, Array]:
    warmed = -np.expm1(-heat_clock(times, channels["p_chamber"], values["exponent"]) / values["time"])
    return {**channels, "thrust": channels["thrust"] + values["drift"] * warmed}


EFFECT = Effect(
    name="load_cell_drift",
    plain_name="thrust cell that drifts",
    equation="sensor",
    meaning="the thrust cell's zero drifts from ignition on, as heat reaches it",
    reference="Doebelin, Measurement Systems, chapters 3 and 5: zero drift of strain-gauge cells with temperature; a "
    "cell that warms as one body approaches its end exponentially; the hot gas brings heat with the chamber's pressure "
    "to the power of 0.8 (Bartz, 1957), and what has soaked into the stand goes on without it",
    formula="F_read = F + d (1 - exp(-h / tau)),  dh/dt = ((p_c - p_a) / 10 bar)^k",
    sites=("thrust",),
    parameters=(
        Parameter("drift", "N", "where the zero ends", typical=100.0, low=-2000.0, high=2000.0),
        Parameter(
            "time", "s", "in which the cell warms, at 10 bar in the chamber", 15.0, center=10.0, low=1.0, high=100.0
        ),
        Parameter(
            "exponent", "-", "power of the chamber pressure with which it warms", 0.35, center=0.5, low=0.0, high=1.0
        ),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    distort=_distort,
    twins=(),
    decisive="the thrust cell's zero for a minute after the burn, or a thermocouple on the cell",
    believable=Believable("drift", 500.0, "cells drift by some per cent of their range", unit="N"),
)
