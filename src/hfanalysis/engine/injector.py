"""Flow from the tank through feed line and injector into the chamber (report, eq. 3.2 and chapter 4)."""

from __future__ import annotations

from math import sqrt

from hfanalysis.compiled import compiled

SMALL_DROP = 1000.0
"""Pressure drop [Pa] below which the square root is bent to a finite slope, at which no solver stalls."""


@compiled
def root(pressure_drop: float) -> float:
    """sqrt(dp) [Pa^0.5], zero for dp <= 0; below SMALL_DROP the parabola that joins it smoothly."""
    if pressure_drop >= SMALL_DROP:
        return sqrt(pressure_drop)
    x = max(pressure_drop, 0.0) / SMALL_DROP
    return sqrt(SMALL_DROP) * 0.5 * x * (3.0 - x)


@compiled
def mass_flow(area: float, density: float, pressure_drop: float) -> float:
    """mdot = C_i N_i A_i sqrt(2 rho dp) [kg/s], zero for dp <= 0: flow reverses for nobody.

    ``area`` is the effective area C_i N_i A_i [m^2], ``density`` [kg/m^3] upstream, ``pressure_drop`` p_run - p_c [Pa].

    >>> round(mass_flow(3.786e-5, 742.5, 57.29e5 - 0.345e5 - 27.579e5), 3)
    2.5
    """
    return area * sqrt(2.0 * density) * root(pressure_drop)


@compiled
def mass_flow_with_feed(area: float, feed_loss_factor: float, density: float, pressure_drop: float) -> float:
    """mdot [kg/s] through a feed line that loses K_loss mdot^2 / rho and the injector behind it.

    ``pressure_drop`` is p_T - p_c [Pa], ``feed_loss_factor`` K_loss [1/m^4]. Both losses are quadratic in mdot, so that
    the two resistances add: mdot^2 = rho dp / (K_loss + 1 / (2 (C_i N_i A_i)^2)).
    """
    return sqrt(density / (feed_loss_factor + 0.5 / (area * area))) * root(pressure_drop)
