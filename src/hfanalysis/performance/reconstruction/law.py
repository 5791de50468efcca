"""n and a of r = a G^n along the path of one firing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.performance.reconstruction.posterior import CHANGE
from hfanalysis.quantity import Quantity

SPREAD = 1.25
"""Largest over smallest flux from which a and n are told. Source: over less, n is the slope of a point."""

NO_MORE = 0.7
"""Part of the standard deviation taken beforehand from which on a firing says nothing of n. Source: by choice: half of
the variance is then the firing's."""

POINTS = 5
"""Moments at which O/F has to be told. Source: by choice."""


def exponent_and_factor(
    flux: Array, rate: Array, told: NDArray[np.bool_], group: NDArray[np.int64]
) -> tuple[Quantity, Quantity]:
    """a and n, from courses of flux [kg/m^2/s] and rate [m/s] (n, draws) where O/F is ``told`` (n,); those of the
    likeliest ``group`` are in the middle. Errors that a whole course has in common are in each course's slope."""
    usual = np.median(flux[told], axis=1) if told.any() else np.zeros(0)
    if usual.size < POINTS or usual.max() < SPREAD * usual.min():
        reason = "the flux hardly moves where O/F is told: one point has no slope"
        return Quantity.absent(reason), Quantity.absent(reason)
    x, y = np.log(flux[told]), np.log(rate[told])
    from_middle = x - x.mean(axis=0)
    slope = np.sum(from_middle * y, axis=0) / np.sum(from_middle**2, axis=0)
    offset = y.mean(axis=0) - slope * x.mean(axis=0)
    beforehand = CHANGE / float(np.log(usual.max() / usual.min()))
    if float(np.std(slope)) > NO_MORE * beforehand:
        reason = f"the firing tells n no better than what is taken of it beforehand, +/- {beforehand:.2f}"
        return Quantity.absent(reason), Quantity.absent(reason)
    why = "along the path of one firing, its errors in common"
    factors = np.exp(offset)
    ends = tuple(float(x) for x in np.quantile(factors, (0.025, 0.975)))
    a = Quantity(
        float(np.median(factors[group])), "m/s (kg/m^2/s)^-n", float(np.std(factors)), (ends[0], ends[1]), why=why
    )
    low, high = (float(x) for x in np.quantile(slope, (0.025, 0.975)))
    return a, Quantity(float(np.median(slope[group])), "", float(np.std(slope)), (low, high), why=why)
