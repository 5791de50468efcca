"""Flow from the tank through feed line and injector into the chamber (report, eq. 3.2 and chapter 4)."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import ArrayLike

from hfanalysis.arrays import Array
from hfanalysis.compiled import Real, compiled, law

SMALL_DROP = 1000.0
"""Pressure drop [Pa] below which the square root is bent to a finite slope, at which no solver stalls."""


@compiled
def bent_root(value: float, small: float) -> float:
    """sqrt(x), in the root of its unit, zero for x <= 0.

    Below ``small`` it is the parabola that joins it smoothly and ends with a finite slope.

    >>> bent_root(4.0, 1.0), bent_root(-1.0, 1.0)
    (2.0, 0.0)
    """
    if value >= small:
        return sqrt(value)
    x = max(value, 0.0) / small
    return sqrt(small) * 0.5 * x * (3.0 - x)


@compiled
def mass_flow(area: float, density: float, pressure_drop: float) -> float:
    """mdot = C_i N_i A_i sqrt(2 rho dp) [kg/s], zero for dp <= 0: flow reverses for nobody.

    ``area`` is the effective area C_i N_i A_i [m^2], ``density`` [kg/m^3] upstream, ``pressure_drop`` p_run - p_c [Pa].

    >>> round(mass_flow(3.786e-5, 742.5, 57.29e5 - 0.345e5 - 27.579e5), 3)
    2.5
    """
    return area * sqrt(2.0 * density) * bent_root(pressure_drop, SMALL_DROP)


def mass_flows(area: ArrayLike, density: ArrayLike, pressure_drop: ArrayLike) -> Array:
    """:func:`mass_flow` [kg/s] of arrays of one shape (n,), or of numbers and arrays [m^2, kg/m^3, Pa]."""
    given = (np.asarray(x, dtype=np.float64) for x in np.broadcast_arrays(area, density, pressure_drop))
    return _mass_flows(*(np.ascontiguousarray(x) for x in given))


@compiled
def _mass_flows(area: Array, density: Array, pressure_drop: Array) -> Array:
    out = np.empty_like(pressure_drop)
    for i in range(out.size):
        out[i] = mass_flow(area[i], density[i], pressure_drop[i])
    return out


@compiled
def mass_flow_with_feed(area: float, feed_loss_factor: float, density: float, pressure_drop: float) -> float:
    """mdot [kg/s] through a feed line that loses K_loss mdot^2 / rho and the injector behind it.

    ``area`` C_i N_i A_i [m^2], ``feed_loss_factor`` K_loss [1/m^4], ``density`` [kg/m^3], ``pressure_drop`` p_T - p_c
    [Pa]. Both losses are quadratic in mdot, so that the two resistances add: mdot^2 = rho dp / (K_loss + 1 / (2 (C_i
    N_i A_i)^2)).
    """
    return sqrt(density / flow_resistance(area, feed_loss_factor)) * bent_root(pressure_drop, SMALL_DROP)


@law
def flow_resistance(area: Real, feed_loss_factor: Real) -> Real:
    """rho dp / mdot^2 [1/m^4] of line and injector in a row: K_loss [1/m^4] and an effective ``area`` [m^2]."""
    return feed_loss_factor + 0.5 / (area * area)
