"""The vapor's exponent, and its discharge coefficient, where the vapor expands and chokes in the injector.

The report's law (eq. 3.2) lets the vapor through as if it did not expand: at p_c/p_run of 0.15 that is twice what
chokes. Here the flow is C_d A sqrt(rho p_run) psi(p_c / p_run), with the pressure measured before the injector. As with
C_i, the density is that of the tank's vapor; that at p_run, throttled by the line (rho p_run/p_T of an ideal gas), is
the other end of what it may be. One course of the pressure tells one number: m where C_d is known, or C_d where m is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled, inner, law
from hfanalysis.effects.injector_choked_vapor import critical_ratio, expanding_flow
from hfanalysis.engine.injector import mass_flow
from hfanalysis.engine.tank import polytropic
from hfanalysis.roots import root_between, root_near

EXPONENTS = (0.05, 6.0)
"""Between which m [-] is looked for, as by the report's law (blowdown.py)."""

COEFFICIENTS = (0.005, 5.0)
"""Between which C_d [-] of the vapor is looked for. Source: a hole passes no more than 1 of the ideal; what is found
above says that the area is off."""

VAPOR_M = 1.15
"""In the middle of the exponents that expanding vapor has, 1.0 to 1.3 [-]. Source: PHYSICAL_M of verdicts.py."""

WITHIN = 1e-6
"""To what m and C_d are found [-]."""

NEAR = 0.1
"""Part of a guess by which m or C_d are looked for around it first. Source: by choice, for speed: some standard
deviations of a test's m; beyond it the whole range is looked through."""

Measured = tuple[Array, Array, Array, float, float, float, float, float, float, bool]
"""The fields of an :class:`Expansion`, in their order."""


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

    @property
    def measured(self) -> Measured:
        """As compiled code takes it."""
        return (
            self.time, self.loss, self.chamber, self.volume, self.area, self.pressure, self.mass, self.reached,
            self.gamma, self.throttled,
        )  # fmt: skip

    def exponent(self, coefficient: float) -> float:
        """m [-] with which the tank comes to the pressure ``reached``; NaN: with none."""
        return float(exponent_of(self.measured, coefficient, np.nan))

    def coefficient(self, exponent: float) -> float:
        """C_d [-] that an ``exponent`` m [-] needs; NaN: there is none."""
        return float(coefficient_of(self.measured, exponent, np.nan))


@inner
def _expand(
    time: Array, loss: Array, chamber: Array, start: float, mass: float, volume: float, area: float, exponent: float,
    gamma: float, throttled: bool,
) -> float:  # fmt: skip
    """Pressure [Pa] at the last of the times of p = p_v (M/M_v)^m, by the midpoint rule.

    The flow is C_d A sqrt(rho p_run) psi(p_c/p_run) [kg/s] of a gas that expands and chokes; 0 where nothing drives it.
    """
    left, choked = mass, critical_ratio(gamma)
    at_throat = expanding_flow(choked, gamma) * np.sqrt(1.0 - choked)
    for i in range(time.size - 1):
        h = time[i + 1] - time[i]
        trial = left
        for half in range(2):
            p = polytropic(start, mass, exponent, trial)
            share = 0.5 * half
            run = p - (loss[i] + share * (loss[i + 1] - loss[i]))
            behind = chamber[i] + share * (chamber[i + 1] - chamber[i])
            flow = 0.0
            if run > behind and run > 0.0:
                density, ratio = trial / volume * (run / p if throttled else 1.0), behind / run
                lasts = at_throat / np.sqrt(1.0 - ratio) if ratio <= choked else expanding_flow(ratio, gamma)
                flow = mass_flow(area, density, run - behind) * lasts
            step = 0.5 * h if half == 0 else h
            trial = max(left - step * flow, 1e-6 * mass)
        left = trial
    return float(polytropic(start, mass, exponent, left))


@inner
def _miss(measured: Measured, exponent: float, coefficient: float) -> float:
    """Pressure [Pa] at the end beyond that measured."""
    time, loss, chamber, volume, area, pressure, mass, reached, gamma, throttled = measured
    end = _expand(time, loss, chamber, pressure, mass, volume, coefficient * area, exponent, gamma, throttled)
    return float(end - reached)


@inner
def _by_exponent(exponent: float, given: tuple[Measured, float]) -> float:
    measured, coefficient = given
    return float(_miss(measured, exponent, coefficient))


@inner
def _by_coefficient(coefficient: float, given: tuple[Measured, float]) -> float:
    measured, exponent = given
    return float(_miss(measured, exponent, coefficient))


_exponent = law(root_near(law(root_between(_by_exponent))))
_coefficient = law(root_near(law(root_between(_by_coefficient))))


@compiled
def exponent_of(measured: Measured, coefficient: float, guess: float) -> float:
    """m [-] with which the tank comes to the pressure at the end with C_d = ``coefficient`` [-]; NaN: with none.

    ``guess`` [-]: about where it is (NaN: anywhere).
    """
    return float(_exponent((measured, coefficient), EXPONENTS[0], EXPONENTS[1], WITHIN, guess, NEAR * guess))


@compiled
def coefficient_of(measured: Measured, exponent: float, guess: float) -> float:
    """C_d [-] that an ``exponent`` m [-] needs; NaN: there is none. ``guess`` [-]: about where it is (or NaN)."""
    return float(_coefficient((measured, exponent), COEFFICIENTS[0], COEFFICIENTS[1], WITHIN, guess, NEAR * guess))
