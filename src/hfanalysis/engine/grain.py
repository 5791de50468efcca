"""The fuel grain: a port that opens as the oxidizer flux has it (report, section 3.1.3)."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

from hfanalysis.arrays import Array
from hfanalysis.compiled import Real, compiled, inlined, law
from hfanalysis.engine.equations import FUEL_DENSITY, GRAIN_LENGTH, RADIUS, REGRESSION_A, REGRESSION_N, Equations
from hfanalysis.engine.sites import FUEL_FLOW, OXIDIZER_FLOW

SMALL_FLUX = 0.01
"""Oxidizer flux [kg/(m^2 s)] below which regression is bent to a finite slope."""

USUAL_N = (0.45, 0.2)
"""Flux exponent of hybrid fuels and its spread [-]. Source: Karabeyoglu et al., J. Propulsion and Power 20(6), 2004,
find 0.62 for paraffin with oxygen; small engines show as little as 0.2."""


@compiled
def flux_power(flux: float, n: float) -> float:
    """G^n, ``flux`` G [kg/(m^2 s)]; below SMALL_FLUX the parabola that joins it smoothly and ends in 0 with a finite
    slope.

    >>> flux_power(400.0, 0.5)
    20.0
    """
    if flux >= SMALL_FLUX:
        return float(flux**n)
    x = max(flux, 0.0) / SMALL_FLUX
    return float(SMALL_FLUX**n * x * (2.0 - n - (1.0 - n) * x))


@law
def oxidizer_flux(flow: Real, radius: Real) -> Real:
    """G = mdot / (pi r^2) [kg/(m^2 s)] of a ``flow`` [kg/s] in a port of ``radius`` [m] (report, eq. 3.17).

    >>> round(oxidizer_flux(2.5, 0.03))
    884
    """
    return flow / (pi * radius * radius)


@law
def ring(radius: Real, length: Real, density: Real) -> Real:
    """Fuel 2 pi r L rho that a port frees as it opens [kg per meter of radius] (report, eq. 3.21).

    ``radius`` and ``length`` [m], ``density`` [kg/m^3].
    """
    return 2.0 * pi * radius * length * density


@law
def fuel_around(radius: Real, outer_radius: Real, length: Real, density: Real) -> Real:
    """Fuel between a port and its casing [kg] (report, eq. 3.59); radii and ``length`` [m], ``density`` [kg/m^3]."""
    return density * pi * length * (outer_radius * outer_radius - radius * radius)


@law
def opened(start: Real, a: Real, n: Real, pace: Real) -> Real:
    """Port radius [m], from ``start`` [m] on, behind a ``pace`` int (mdot/pi)^n dt: with r = a G^n the equation
    separates.

    r^N = r_0^N + N a int (mdot/pi)^n dt, N = 2 n + 1 (report, eq. 2.2 for a constant flow).
    """
    power = 2.0 * n + 1.0
    return (start**power + power * a * pace) ** (1.0 / power)


@law
def pace_between(start: Real, end: Real, a: Real, n: Real) -> Real:
    """int (mdot/pi)^n dt in which a port opens from one radius [m] to the other: the inverse of :func:`opened`.

    >>> round(opened(0.03, 1e-4, 0.5, pace_between(0.03, 0.05, 1e-4, 0.5)), 6)
    0.05
    """
    power = 2.0 * n + 1.0
    return (end**power - start**power) / (a * power)


@dataclass(frozen=True)
class Grain:
    """Cylindrical port: length, outer radius [m], density [kg/m^3], regression a [m/s (kg/m^2/s)^-n] and n."""

    length: float
    outer_radius: float
    density: float
    a: float
    n: float

    def port_radius(self, mass: float) -> float:
        """Initial port radius [m] of a grain of that mass [kg] (report, eq. 3.59); raises ValueError where it does not
        fit."""
        square = self.outer_radius**2 - mass / (pi * self.density * self.length)
        if square <= 0.0:
            raise ValueError(f"a grain of {mass:.3f} kg does not fit {self.length} m by {self.outer_radius} m radius")
        return sqrt(square)

    def fuel(self, radius: Real) -> Real:
        """Mass [kg] of the grain with a port of ``radius`` [m], a number or an array."""
        return fuel_around(radius, self.outer_radius, self.length, self.density)

    def ring(self, radius: Real) -> Real:
        """Fuel that the port frees as it opens [kg/m], at a ``radius`` [m]."""
        return ring(radius, self.length, self.density)

    def burn_time(self, oxidizer_flow: float, mass: float) -> float:
        """t = (R^N - r_0^N) / (a N) (pi / mdot_o)^n [s] (report, eq. 2.3) of ``oxidizer_flow`` [kg/s] and a fuel
        ``mass`` [kg]."""
        pace = pace_between(self.port_radius(mass), self.outer_radius, self.a, self.n)
        return float(pace * (pi / oxidizer_flow) ** self.n)


@inlined
def grain(y: Array, burning: bool, m: Equations) -> tuple[float, float]:
    """Regression rate [m/s] and fuel that it frees per meter [kg/m] (report, eq. 3.17 and 3.21), of ``y`` (states,)
    [SI]."""
    port = y[RADIUS]
    flux = oxidizer_flux(m.env[OXIDIZER_FLOW], port)
    regression = m.c[REGRESSION_A] * flux_power(flux, m.c[REGRESSION_N]) if burning else 0.0
    surface = ring(port, m.c[GRAIN_LENGTH], m.c[FUEL_DENSITY])
    m.env[FUEL_FLOW] = surface * regression
    return regression, surface
