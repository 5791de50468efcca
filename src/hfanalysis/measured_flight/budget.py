"""What the deviation of an apogee is made of, from the drawn flights."""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.flight.ascent import (
    ANGLE,
    APOGEE,
    CROSSWIND,
    DRAG,
    MASS,
    PROPELLANT,
    THRUST_BIAS,
    THRUST_DRIFT,
    THRUST_SCALE,
    WIND,
)
from hfanalysis.inference.budget import by_draws
from hfanalysis.performance.load_cell import ROWS
from hfanalysis.products.budget import Budget

WIND_AND_ANGLE, CURVE = "wind and launch angle", "purge gas and nozzle's law"


def apogee_budget(drawn: Array, results: Array, curves: int = 1, shots: bool = False) -> Budget | None:
    """The budget of the apogee [m]; None where too few flights have one.

    Args:
        drawn: the flights' inputs (flights, 9), as they were flown.
        results: what came of them (flights, 8).
        curves: of the thrust, to which the flights were dealt in turn.
        shots: the thrust's scale holds how it differs from one firing to the next, too.
    """
    scale = f"{ROWS['gain']} and one firing to the next" if shots else ROWS["gain"]
    rows = {
        scale: drawn[:, THRUST_SCALE],
        f"{ROWS['zero']} and drift": drawn[:, [THRUST_BIAS, THRUST_DRIFT]],
        "dry mass": drawn[:, MASS],
        "propellant loaded": drawn[:, PROPELLANT],
        "drag": np.column_stack([drawn[:, DRAG], drawn[:, DRAG] ** 2]),
        WIND_AND_ANGLE: _wind(drawn),
        CURVE: _dealt(len(drawn), curves),
    }
    apogee = np.where(results[:, APOGEE] > 0.0, results[:, APOGEE], np.nan)
    return by_draws(apogee, rows, {WIND_AND_ANGLE, *([scale] if shots else [])})


def _dealt(flights: int, curves: int) -> Array:
    """A column for every curve but the first, 1 where it was flown."""
    return np.asarray(np.arange(flights)[:, np.newaxis] % curves == np.arange(1, curves), dtype=np.float64)


def _wind(drawn: Array) -> Array:
    """Columns of wind and angle, with their squares and product: still air is a maximum in some of them."""
    wind, cross, angle = drawn[:, WIND], drawn[:, CROSSWIND], drawn[:, ANGLE]
    return np.column_stack([wind, angle, wind**2, cross**2, angle**2, wind * angle])
