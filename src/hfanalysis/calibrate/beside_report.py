"""Reductions that stand beside the report's: choked vapor, the two-phase inlet, and how the constants err together."""

from __future__ import annotations

from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.calibrate.blowdown import Inputs, Reduction, Tables, expansion
from hfanalysis.calibrate.inlet import Feed, inlet_of
from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.calibrate.uncertainty import Draws, InputSpread
from hfanalysis.calibrate.vapor_laws import VaporLaws, without_vapor
from hfanalysis.products.calibration import Joint
from hfanalysis.quantity import Quantity
from hfanalysis.thermo.saturation import Saturation

SENSORS = ("tank", "run", "chamber")
"""In the order of the biases of an InputSpread."""

JOINT = ("oxidizer_mass", "flow_area", "K_loss", "m")
"""What a model takes together: the load, C_i N_i A_i, and the constants of line and vapor."""

LEAST_DRAWS = 20
"""Repetitions with an answer below which no correlation is told."""


def beside_report(
    histories: MeasuredPressures, saturation: Saturation, inputs: Inputs, r: Reduction, draws: Draws,
    spread: InputSpread, found: dict[str, Quantity], no_vapor: str | None,
) -> dict[str, Any]:  # fmt: skip
    """m_choked, vapor_C_d, inlet, C_d and joint, and m with what they say of it.

    ``inputs`` and ``r`` without effects, ``draws`` with all errors; ``found``: the constants, the report's where ``r``
    is what they are told by; ``no_vapor``: why there is no vapor phase to tell of.
    """
    measured = expansion(Tables.of(histories, saturation), saturation, inputs) if no_vapor is None else None
    vapor = VaporLaws(measured, r, draws).told(found["m"]) if measured else without_vapor(no_vapor or "no vapor phase")
    if found["m"].value != r.m:  # effects act on it: it is by another law than the report's
        vapor.pop("m", None)
    feed = Feed.of(histories, inputs.t_feed, inputs.t_v)
    bias = dict(zip(SENSORS, spread.bias, strict=True))
    inlet, by_law = inlet_of(feed, saturation, bias, found["C_i"], r.C_i, draws)
    return {**vapor, "inlet": inlet, "C_d": by_law, "joint": joint(draws, found["m"].value is not None)}


def joint(draws: Draws, with_m: bool) -> Joint | None:
    """Standard deviations and correlations of JOINT; None where the repetitions have too few answers."""
    names = JOINT if with_m else JOINT[:-1]
    v, i = draws.values, draws.inputs
    columns = (i["mass"], v["C_i"] * i["area"], v["K_loss"], v["m"])[: len(names)]
    table = np.column_stack(columns)
    table = table[np.isfinite(table).all(axis=1)]
    if len(table) < LEAST_DRAWS:
        return None
    return joint_of(names, np.cov(table, rowvar=False))


def joint_of(names: tuple[str, ...], covariance: Array) -> Joint:
    """Errors of ``names`` by their ``covariance`` (n, n) [SI]."""
    std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale = np.where(std > 0.0, std, 1.0)
    correlation = np.clip(covariance / np.outer(scale, scale), -1.0, 1.0)
    np.fill_diagonal(correlation, 1.0)
    rows = tuple(tuple(round(float(x), 6) for x in row) for row in correlation)
    return Joint(names=names, std=tuple(float(x) for x in std), correlation=rows)
