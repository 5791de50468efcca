"""Saturated nitrous oxide as smooth tables that compiled code can read.

Every property is a C2 cubic spline over theta = (1 - T/T_c)^(1/3). Along the saturation line the densities behave near
the critical point like T_c - T to a power close to 1/3, so that in theta they stay smooth where in T they end in an
infinite slope; away from it T itself is a smooth function of theta and nothing is lost.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled

NODES = 512
"""Table nodes. Evidence: at this number the spline errors are below 1e-7 relative (tests/thermo)."""


class Property(IntEnum):
    """Row of a property in the table."""

    LN_PRESSURE = 0
    LIQUID_VOLUME = 1
    LN_VAPOR_VOLUME = 2
    LIQUID_ENERGY = 3
    VAPOR_ENERGY = 4
    LIQUID_ENTHALPY = 5
    VAPOR_ENTHALPY = 6
    LN_VAPOR_CV = 7
    LN_VAPOR_CP = 8
    VAPOR_GRUENEISEN = 9


LN_PRESSURE, LIQUID_VOLUME, LN_VAPOR_VOLUME = 0, 1, 2
"""Rows of the table, as in :class:`Property`."""

LIQUID_ENERGY, VAPOR_ENERGY, LIQUID_ENTHALPY, VAPOR_ENTHALPY = 3, 4, 5, 6
"""Rows of the table, as in :class:`Property`."""

LN_VAPOR_CV, LN_VAPOR_CP, VAPOR_GRUENEISEN = 7, 8, 9
"""Rows of the table, as in :class:`Property`."""


def splines(theta: Array, values: Array) -> Array:
    """Cubics (properties, n - 1, 4) through samples (properties, n) [SI] over theta (n,) [-], in ascending power of
    theta - node."""
    from scipy.interpolate import CubicSpline

    return np.ascontiguousarray(np.stack([CubicSpline(theta, row).c[::-1].T for row in values]))


@dataclass(frozen=True)
class Saturation:
    """Saturated nitrous oxide from one source, in specific SI units.

    ``coefficients`` has the shape (properties, intervals, 4): cubics in theta - node, ascending power. ``theta_start``
    and ``theta_step`` give the uniform grid, ``critical_temperature`` the T_c in theta [K], ``t_min`` and ``t_max`` the
    range of validity [K]. The methods take temperatures of any shape and return arrays of that shape (NaN outside the
    range).
    """

    source: str
    critical_temperature: float
    theta_start: float
    theta_step: float
    coefficients: Array
    t_min: float
    t_max: float

    @classmethod
    def from_samples(
        cls, source: str, theta: Array, properties: Mapping[Property, Array], critical_temperature: float
    ) -> Saturation:
        """Splines through samples (n,) of all properties [SI] on a uniform theta grid (n,) (falling temperature).

        ``critical_temperature`` [K].
        """
        coefficients = splines(theta, np.array([properties[p] for p in Property]))
        return cls.from_splines(source, theta, coefficients, critical_temperature)

    @classmethod
    def from_splines(cls, source: str, theta: Array, coefficients: Array, critical_temperature: float) -> Saturation:
        """The same from ``coefficients`` as :func:`splines` gives them."""
        t = critical_temperature * (1.0 - theta**3)
        return cls(
            source,
            critical_temperature,
            float(theta[0]),
            float(theta[1] - theta[0]),
            coefficients,
            float(t.min()),
            float(t.max()),
        )

    def samples(self) -> tuple[Array, dict[Property, Array]]:
        """The nodes in theta [-], (n,), and all properties there [SI], (n,), of which :meth:`from_samples` makes the
        same table again."""
        step, last = self.theta_step, self.coefficients[:, -1]
        end = last[:, 0] + step * (last[:, 1] + step * (last[:, 2] + step * last[:, 3]))
        values = np.column_stack([self.coefficients[:, :, 0], end])
        theta = np.asarray(self.theta_start + step * np.arange(values.shape[1]), dtype=np.float64)
        return theta, {p: values[p] for p in Property}

    @property
    def kernel_table(self) -> tuple[Array, float, float, float]:
        """What the compiled functions of this module read: coefficients (properties, intervals, 4), start and step of
        theta, T_c [K]."""
        return (self.coefficients, self.theta_start, self.theta_step, self.critical_temperature)

    def _evaluate(self, prop: Property, temperature: ArrayLike) -> tuple[Array, Array]:
        if isinstance(temperature, float):  # of which there are thousands, each on its own
            held = self.t_min - 1e-9 <= temperature <= self.t_max + 1e-9
            one = evaluate(*self.kernel_table, int(prop), temperature) if held else (np.nan, np.nan)
            return np.asarray(one[0]), np.asarray(one[1])
        t = np.asarray(temperature, dtype=np.float64)
        value, slope = _evaluate_many(*self.kernel_table, int(prop), t.ravel())
        inside = (t >= self.t_min - 1e-9) & (t <= self.t_max + 1e-9)
        return np.where(inside, value.reshape(t.shape), np.nan), np.where(inside, slope.reshape(t.shape), np.nan)

    def pressure(self, temperature: ArrayLike) -> Array:
        """Saturation pressure [Pa] at a ``temperature`` [K], of its shape."""
        return np.asarray(np.exp(self._evaluate(Property.LN_PRESSURE, temperature)[0]))

    def pressure_slope(self, temperature: ArrayLike) -> Array:
        """dp_sat/dT [Pa/K] at a ``temperature`` [K], of its shape."""
        value, slope = self._evaluate(Property.LN_PRESSURE, temperature)
        return np.asarray(np.exp(value) * slope)

    def liquid_density(self, temperature: ArrayLike) -> Array:
        """Density of the saturated liquid [kg/m^3] at a ``temperature`` [K], of its shape."""
        return 1.0 / self._evaluate(Property.LIQUID_VOLUME, temperature)[0]

    def liquid_volume(self, temperature: ArrayLike) -> tuple[Array, Array]:
        """Specific volume of the saturated liquid [m^3/kg] and its slope [m^3/(kg K)] (positive: liquid expands).

        At a ``temperature`` [K], of its shape.
        """
        return self._evaluate(Property.LIQUID_VOLUME, temperature)

    def vapor_density(self, temperature: ArrayLike) -> Array:
        """Density of the saturated vapor [kg/m^3] at a ``temperature`` [K], of its shape."""
        return np.asarray(np.exp(-self._evaluate(Property.LN_VAPOR_VOLUME, temperature)[0]))

    def vapor_volume(self, temperature: ArrayLike) -> tuple[Array, Array]:
        """Specific volume of the saturated vapor [m^3/kg] and its slope [m^3/(kg K)] at a ``temperature`` [K], of its
        shape."""
        value, slope = self._evaluate(Property.LN_VAPOR_VOLUME, temperature)
        return np.exp(value), np.exp(value) * slope

    def energy(self, prop: Property, temperature: ArrayLike) -> tuple[Array, Array]:
        """Specific internal energy or enthalpy [J/kg] of a phase and its slope along saturation [J/(kg K)].

        At a ``temperature`` [K], of its shape; ``prop`` says which (heat capacities and volumes have properties of
        their own).
        """
        return self._evaluate(prop, temperature)

    def heat_capacities(self, temperature: ArrayLike) -> tuple[Array, Array]:
        """c_v and c_p of the saturated vapor [J/(kg K)] at a ``temperature`` [K], of its shape."""
        cv = self._evaluate(Property.LN_VAPOR_CV, temperature)[0]
        cp = self._evaluate(Property.LN_VAPOR_CP, temperature)[0]
        return np.exp(cv), np.exp(cp)

    def grueneisen(self, temperature: ArrayLike) -> Array:
        """Grueneisen's parameter V (dp/dU)_V [-] of the saturated vapor: heat Q raises its pressure by this Q/V.

        At a ``temperature`` [K], of its shape.
        """
        return self._evaluate(Property.VAPOR_GRUENEISEN, temperature)[0]

    def isentropic_exponent(self, temperature: ArrayLike) -> Array:
        """(d ln p/d ln rho)_s of the saturated vapor [-] at a ``temperature`` [K], of its shape.

        c_p/c_v times (d ln p/d ln rho)_T, which follows from c_p - c_v = -T (dp/dT)_v^2 / (dp/dv)_T with (dp/dT)_v = G
        c_v / v.
        """
        cv, cp = self.heat_capacities(temperature)
        by_heat = self.grueneisen(temperature) ** 2 * cv * np.asarray(temperature, dtype=np.float64)
        return np.asarray(cp / (cp - cv) * by_heat / (self.pressure(temperature) * self.vapor_volume(temperature)[0]))

    def temperature(self, pressure: ArrayLike) -> Array:
        """Saturation temperature [K] at a ``pressure`` [Pa], of its shape: the inverse of :meth:`pressure`; NaN outside
        the range."""
        p = np.asarray(pressure, dtype=np.float64)
        low, high = self.pressure_range
        inside = (p >= low) & (p <= high)
        t = _temperatures(*self.kernel_table, np.clip(p, low, high).ravel(), self.t_min, self.t_max)
        return np.where(inside, t.reshape(p.shape), np.nan)

    @cached_property
    def pressure_range(self) -> tuple[float, float]:
        """Lowest and highest saturation pressure of the source [Pa]."""
        return float(self.pressure(self.t_min)), float(self.pressure(self.t_max))


@compiled
def evaluate(
    table: Array, theta_start: float, theta_step: float, critical: float, row: int, temperature: float
) -> tuple[float, float]:
    """Value [SI] of one table row and its derivative by temperature [SI/K] at a ``temperature`` [K].

    The first four arguments are :attr:`Saturation.kernel_table`: coefficients (properties, intervals, 4), theta's start
    and step, T_c [K]. The ends are held by their last cubic.
    """
    k, x, by_temperature = place(table, theta_start, theta_step, critical, temperature)
    return row_at(table, row, k, x, by_temperature)


@compiled
def place(
    table: Array, theta_start: float, theta_step: float, critical: float, temperature: float
) -> tuple[int, float, float]:
    """Where a ``temperature`` [K] lies in the table (properties, intervals, 4): interval, distance from its node in
    theta, and d theta/dT [1/K], for :func:`row_at`."""
    theta = max(1.0 - temperature / critical, 1e-9) ** (1.0 / 3.0)
    k = min(max(int((theta - theta_start) / theta_step), 0), table.shape[1] - 1)
    return k, theta - (theta_start + k * theta_step), -1.0 / (3.0 * critical * theta * theta)


@compiled
def row_at(table: Array, row: int, k: int, x: float, by_temperature: float) -> tuple[float, float]:
    """Value [SI] and derivative by temperature [SI/K] of one row of the table (properties, intervals, 4) at a
    :func:`place`; many rows share one place."""
    c = table[row, k]
    value = c[0] + x * (c[1] + x * (c[2] + x * c[3]))
    return value, (c[1] + x * (2.0 * c[2] + x * 3.0 * c[3])) * by_temperature


@compiled
def saturation_temperature(
    table: Array,
    theta_start: float,
    theta_step: float,
    critical: float,
    pressure: float,
    guess: float,
    t_min: float,
    t_max: float,
) -> float:
    """T [K] at which p_sat(T) = ``pressure`` [Pa], by Newton's method on ln p (which is nearly linear in 1/T).

    It is kept inside ``t_min`` to ``t_max`` [K]; ``guess`` [K]; the first four arguments are
    :attr:`Saturation.kernel_table`: coefficients (properties, intervals, 4), theta's start and step, T_c [K].
    """
    target = np.log(pressure)
    t = guess
    for _ in range(30):
        value, slope = evaluate(table, theta_start, theta_step, critical, 0, t)
        step = (target - value) / (slope * t * t)
        new = float(min(max(1.0 / (1.0 / t - step), t_min), t_max))
        if abs(new - t) < 1e-10 * t:
            return new
        t = new
    return t


@compiled
def _evaluate_many(
    table: Array, theta_start: float, theta_step: float, critical: float, row: int, t: Array
) -> tuple[Array, Array]:
    value = np.empty_like(t)
    slope = np.empty_like(t)
    for i in range(t.size):
        value[i], slope[i] = evaluate(table, theta_start, theta_step, critical, row, t[i])
    return value, slope


@compiled
def _temperatures(
    table: Array, theta_start: float, theta_step: float, critical: float, p: Array, t_min: float, t_max: float
) -> Array:
    out = np.empty_like(p)
    guess = 280.0
    for i in range(p.size):
        out[i] = np.nan
        if np.isfinite(p[i]):
            guess = saturation_temperature(table, theta_start, theta_step, critical, p[i], guess, t_min, t_max)
            out[i] = guess
    return out
