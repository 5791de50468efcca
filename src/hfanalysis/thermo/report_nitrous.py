"""Saturated nitrous oxide as the technical report has it (appendix A.1, after Green & Perry 2008).

Two slips of the printed appendix are corrected: the sign of d(nu_l)/dT (liquid expands on heating) never enters because
the derivative is that of the spline; c_v of the vapor at 250 K is 0.034798, not 0.043798 kJ/(mol K), as its neighbors
and every finite difference of them show. The pressure correlation and the table come from different sources: the
correlation lies 1.4 % above the equation of state behind the table at 298 K.
"""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.thermo.cache import cached
from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.saturation import NODES, Property, Saturation, splines

CRITICAL_TEMPERATURE = 309.57
"""T_c of the liquid volume correlation [K]; the table ends at 309.52 K, where both phases meet. Source: report,
appendix A.1."""

PRESSURE = (96.512, -4045.0, -12.277, 2.886e-5, 2.0)
"""c1 to c5 of the saturation pressure, in Pa and K. Source: report, appendix A.1 (Green and Perry 2008)."""

LIQUID_VOLUME = (2.781, 0.27244, 309.57, 0.2882)
"""c1 to c4 of the liquid's molar volume, in kmol/m^3 and K. Source: report, appendix A.1 (Green and Perry 2008)."""

# T [K], nu_v [m^3/kmol], u_l, h_l, u_v, h_v [kJ/mol], c_v, c_p of the vapor [kJ/(mol K)]
_TABLE = """
    182.33 16.823 -0.18142 -0.17830 14.931 16.411 0.025545 0.034993
    185 14.503 0.020258 0.023954 14.984 16.481 0.025844 0.035439
    190 11.089 0.39840 0.40340 15.082 16.610 0.026427 0.036334
    195 8.6098 0.77745 0.78408 15.176 16.733 0.027038 0.037309
    200 6.7780 1.1577 1.1664 15.268 16.852 0.027674 0.038365
    205 5.4030 1.5396 1.5508 15.356 16.965 0.028331 0.039506
    210 4.3558 1.9234 1.9377 15.440 17.071 0.029006 0.040736
    215 3.5474 2.3094 2.3274 15.521 17.170 0.029694 0.042062
    220 2.9156 2.6982 2.7206 15.596 17.262 0.030395 0.043494
    225 2.4162 3.0899 3.1177 15.666 17.346 0.031105 0.045048
    230 2.0171 3.4852 3.5192 15.730 17.421 0.031824 0.046741
    235 1.6951 3.8844 3.9257 15.789 17.487 0.032552 0.048600
    240 1.4329 4.2881 4.3379 15.840 17.541 0.033289 0.050660
    245 1.2174 4.6969 4.7566 15.883 17.584 0.034037 0.052967
    250 1.0388 5.1115 5.1826 15.917 17.614 0.034798 0.055585
    255 0.88979 5.5326 5.6170 15.941 17.630 0.035577 0.058600
    260 0.76438 5.9614 6.0609 15.953 17.629 0.036377 0.062136
    265 0.65808 6.3990 6.5161 15.952 17.609 0.037205 0.066370
    270 0.56730 6.8471 6.9843 15.935 17.567 0.038072 0.071572
    275 0.48917 7.3078 7.4682 15.899 17.500 0.038988 0.078164
    280 0.42135 7.7841 7.9715 15.839 17.401 0.039971 0.086856
    285 0.36189 8.2804 8.4993 15.749 17.262 0.041046 0.098934
    290 0.30912 8.8039 9.0600 15.618 17.071 0.042252 0.11700
    295 0.26142 9.3670 9.6680 15.429 16.806 0.043653 0.14723
    300 0.21691 9.9960 10.354 15.145 16.422 0.045376 0.20883
    305 0.17210 10.768 11.205 14.661 15.791 0.047733 0.40691
    309.52 0.097371 12.745 13.450 12.745 13.450 nan nan
"""
TABLE = np.array(_TABLE.split(), dtype=np.float64).reshape(-1, 8)
"""T [K], nu_v [m^3/kmol], energies and enthalpies [kJ/mol], heat capacities [kJ/(mol K)]. Source: report, appendix A.1,
with c_v at 250 K corrected."""


def saturation_pressure(temperature: Array | float) -> Array:
    """Saturation pressure [Pa] at a temperature [K]: exp(c1 + c2/T + c3 ln T + c4 T^c5) (report, appendix A.1).

    A number, or an array of any shape, which the result has too.

    >>> round(float(saturation_pressure(298.15)) / 1e5, 2)
    57.29
    """
    c1, c2, c3, c4, c5 = PRESSURE
    t = np.asarray(temperature, dtype=np.float64)
    return np.asarray(np.exp(c1 + c2 / t + c3 * np.log(t) + c4 * t**c5))


def saturation_pressure_slope(temperature: Array | float) -> Array:
    """dp_sat/dT [Pa/K] at a temperature [K], analytic; of the shape of ``temperature``."""
    _, c2, c3, c4, c5 = PRESSURE
    t = np.asarray(temperature, dtype=np.float64)
    return np.asarray(saturation_pressure(t) * (-c2 / t**2 + c3 / t + c4 * c5 * t ** (c5 - 1.0)))


def liquid_molar_volume(temperature: Array | float) -> Array:
    """Molar volume of the saturated liquid [m^3/kmol] at a temperature [K]: c2^(1 + (1 - T/c3)^c4) / c1 (report,
    appendix A.1).

    A number, or an array of any shape, which the result has too.

    >>> round(float(liquid_molar_volume(298.15)) * 1e3, 1)
    59.3
    """
    c1, c2, c3, c4 = LIQUID_VOLUME
    t = np.asarray(temperature, dtype=np.float64)
    return np.asarray(c2 ** (1.0 + (1.0 - t / c3) ** c4) / c1)


def liquid_molar_volume_slope(temperature: Array | float) -> Array:
    """d(nu_l)/dT [m^3/(kmol K)] at a temperature [K], of its shape: -(c4/c3) ln(c2) nu_l (1 - T/c3)^(c4 - 1), with the
    sign that the report lost."""
    _, c2, c3, c4 = LIQUID_VOLUME
    t = np.asarray(temperature, dtype=np.float64)
    return np.asarray(-(c4 / c3) * np.log(c2) * liquid_molar_volume(t) * (1.0 - t / c3) ** (c4 - 1.0))


def build() -> Saturation:
    """The report's correlations and table as one smooth set in specific SI units."""
    theta = np.linspace(_theta(TABLE[-1, 0]), _theta(TABLE[0, 0]), NODES)
    shape = (len(Property), NODES - 1, 4)
    coefficients = cached(f"nitrous-report-{NODES}", shape, lambda: splines(theta, sample(theta)))
    return Saturation.from_splines("report", theta, coefficients, CRITICAL_TEMPERATURE)


def sample(theta: Array) -> Array:
    """All properties at the given theta (n,): shape (properties, n), specific SI units, as
    :func:`hfanalysis.thermo.coolprop_nitrous.sample`."""
    t = np.clip(CRITICAL_TEMPERATURE * (1.0 - theta**3), TABLE[0, 0], TABLE[-1, 0])
    per_kg = 1.0 / OXIDIZER_MOLAR_MASS
    joule_per_kg = 1e6 * per_kg
    samples = {
        Property.LN_PRESSURE: np.log(saturation_pressure(t)),
        Property.LIQUID_VOLUME: liquid_molar_volume(t) * per_kg,
        Property.LN_VAPOR_VOLUME: _spline(np.log(TABLE[:, 1] * per_kg), theta),
        Property.LIQUID_ENERGY: _spline(TABLE[:, 2] * joule_per_kg, theta),
        Property.LIQUID_ENTHALPY: _spline(TABLE[:, 3] * joule_per_kg, theta),
        Property.VAPOR_ENERGY: _spline(TABLE[:, 4] * joule_per_kg, theta),
        Property.VAPOR_ENTHALPY: _spline(TABLE[:, 5] * joule_per_kg, theta),
        Property.LN_VAPOR_CV: _spline_to_last(np.log(TABLE[:-1, 6] * joule_per_kg), theta),
        Property.LN_VAPOR_CP: _spline_to_last(np.log(TABLE[:-1, 7] * joule_per_kg), theta),
    }
    samples[Property.VAPOR_GRUENEISEN] = _grueneisen(theta, t, samples)
    return np.array([samples[p] for p in Property])


def _grueneisen(theta: Array, t: Array, samples: dict[Property, Array]) -> Array:
    """G = (dp/dT)_v v / c_v of the vapor, from its energy along saturation: du = c_v dT + (T (dp/dT)_v - p) dv.

    With p v = h - u, which is the table's own.
    """
    from scipy.interpolate import CubicSpline

    cv = np.exp(samples[Property.LN_VAPOR_CV])
    energy, volume = (
        CubicSpline(theta, samples[p])(theta, 1) for p in (Property.VAPOR_ENERGY, Property.LN_VAPOR_VOLUME)
    )
    by_theta = -3.0 * CRITICAL_TEMPERATURE * theta**2
    work = samples[Property.VAPOR_ENTHALPY] - samples[Property.VAPOR_ENERGY]
    return np.asarray(((energy - cv * by_theta) / volume + work) / (t * cv))


def _theta(temperature: Array | float) -> Array:
    return np.asarray((1.0 - np.asarray(temperature) / CRITICAL_TEMPERATURE) ** (1.0 / 3.0))


def _spline(values: Array, theta: Array) -> Array:
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(_theta(TABLE[::-1, 0]), values[::-1])(theta))


def _spline_to_last(values: Array, theta: Array) -> Array:
    """Heat capacities have no entry at the critical point: beyond the last (305 K) ln c goes on straight in theta."""
    from scipy.interpolate import CubicSpline

    known = _theta(TABLE[-2::-1, 0])
    spline = CubicSpline(known, values[::-1])
    beyond = np.minimum(theta - known[0], 0.0)
    return np.asarray(spline(np.maximum(theta, known[0])) + beyond * spline(known[0], 1))
