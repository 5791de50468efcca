"""The vapor's exponent, and its discharge coefficient, where the vapor expands and chokes in the injector.

The report's law (eq. 3.2) lets the vapor through as if it did not expand: at p_c/p_run of 0.15 that is twice what
chokes. Here the flow is C_d A sqrt(rho p_run) psi(p_c / p_run), with the pressure measured before the injector. As with
C_i, the density is that of the tank's vapor; that at p_run, throttled by the line (rho p_run/p_T of an ideal gas), is
the other end of what it may be. One course of the pressure tells one number: m where C_d is known, or C_d where m is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from scipy.optimize import brentq

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.effects.injector_choked_vapor import expanding_flow
from hfanalysis.engine.injector import mass_flow
from hfanalysis.engine.tank import polytropic

EXPONENTS = (0.05, 6.0)
"""Between which m [-] is looked for, as by the report's law (blowdown.py)."""

COEFFICIENTS = (0.005, 5.0)
"""Between which C_d [-] of the vapor is looked for. Source: a hole passes no more than 1 of the ideal; what is found
above says that the area is off."""

VAPOR_M = 1.15
"""In the middle of the exponents that expanding vapor has, 1.0 to 1.3 [-]. Source: PHYSICAL_M of verdicts.py."""

WITHIN = 1e-6
"""To what m and C_d are found [-]."""


@dataclass(frozen=True)
class Expansion:
    """A vapor phase as it was measured: the feed loss [Pa] and p_c [Pa] at ``time`` [s], each (n,).

    ``volume`` [m^3], ``area`` of the holes [m^2]; ``pressure`` [Pa] and ``mass`` [kg] at its start, pressure
    ``reached`` [Pa] at its end; ``gamma``: isentropic exponent [-]. ``throttled``: the density is that at p_run.
    """

    time: Array
    loss: Array
    chamber: Array
    volume: float
    area: float
    pressure: float
    mass: float
    reached: float
    gamma: float
    throttled: bool = False

    def exponent(self, coefficient: float) -> float:
        """m [-] with which the tank comes to the pressure ``reached``; NaN: with none."""
        return _root(lambda m: self._end(m, coefficient) - self.reached, EXPONENTS)

    def coefficient(self, exponent: float) -> float:
        """C_d [-] that an ``exponent`` m [-] needs; NaN: there is none."""
        return _root(lambda c: self._end(exponent, c) - self.reached, COEFFICIENTS)

    def _end(self, exponent: float, coefficient: float) -> float:
        area = coefficient * self.area
        return _expand(
            self.time, self.loss, self.chamber, self.pressure, self.mass, self.volume, area, exponent, self.gamma,
            self.throttled,
        )  # fmt: skip


def _root(miss: Callable[[float], float], between: tuple[float, float]) -> float:
    try:
        return float(brentq(miss, *between, xtol=WITHIN))
    except ValueError:
        return float("nan")


@compiled
def choked_flow(
    area: float, density: float, tank: float, run: float, chamber: float, gamma: float, throttled: bool
) -> float:
    """C_d A sqrt(rho p_run) psi(p_c/p_run) [kg/s] of a gas that expands and chokes; 0 where nothing drives it.

    ``area`` C_d A [m^2]; ``density`` [kg/m^3] and pressure ``tank`` [Pa] in the tank; ``run`` and ``chamber`` [Pa];
    ``gamma`` [-].
    """
    if run <= chamber or run <= 0.0:
        return 0.0
    at = density * run / tank if throttled else density
    return mass_flow(area, at, run - chamber) * expanding_flow(chamber / run, gamma)


@compiled
def _expand(
    time: Array, loss: Array, chamber: Array, start: float, mass: float, volume: float, area: float, exponent: float,
    gamma: float, throttled: bool,
) -> float:  # fmt: skip
    """Pressure [Pa] at the last of the times of p = p_v (M/M_v)^m, by the midpoint rule."""
    left = mass
    for i in range(time.size - 1):
        h = time[i + 1] - time[i]
        trial = left
        for half in range(2):
            p = polytropic(start, mass, exponent, trial)
            share = 0.5 * half
            lost = loss[i] + share * (loss[i + 1] - loss[i])
            behind = chamber[i] + share * (chamber[i + 1] - chamber[i])
            flow = choked_flow(area, trial / volume, p, p - lost, behind, gamma, throttled)
            step = 0.5 * h if half == 0 else h
            trial = max(left - step * flow, 1e-6 * mass)
        left = trial
    return float(polytropic(start, mass, exponent, left))
