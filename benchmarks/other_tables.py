"""Tests that hide nothing, of nitrous oxide by another table: what a diagnosis claims in them is what tables differ by.

python -m benchmarks.other_tables DIR [--seed 15] [--limit 495]

Writes the tests without an effect among the first LIMIT of the blind generator's calibration split, its nitrous oxide
by the correlations of ESDU 91022 in place of CoolProp's equation of state. They are diagnosed by ``python -m
benchmarks.blind run --split calibration --n 1500 --seed SEED --kind none --limit LIMIT --out DIR``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CRITICAL_TEMPERATURE, CRITICAL_PRESSURE, CRITICAL_DENSITY = 309.57, 72.51e5, 452.0

REFERENCE = 273.15
"""Temperature [K] at which the liquid's enthalpy is that of the equation of state: their scales differ."""


def pressure(temperature: Array) -> Array:
    """Vapor pressure [Pa] by ESDU 91022, eq. 4.1, of temperatures [K] of any shape."""
    x = 1.0 - temperature / CRITICAL_TEMPERATURE
    terms = -6.71893 * x + 1.35966 * x**1.5 - 1.3779 * x**2.5 - 4.051 * x**5
    return np.asarray(CRITICAL_PRESSURE * np.exp(CRITICAL_TEMPERATURE / temperature * terms))


def liquid_density(temperature: Array) -> Array:
    """Density of the saturated liquid [kg/m^3] by ESDU 91022, eq. 4.2."""
    x = np.cbrt(1.0 - temperature / CRITICAL_TEMPERATURE)
    return np.asarray(CRITICAL_DENSITY * np.exp(1.72328 * x - 0.8395 * x**2 + 0.5106 * x**3 - 0.10412 * x**4))


def vapor_density(temperature: Array) -> Array:
    """Density of the saturated vapor [kg/m^3] by ESDU 91022, eq. 4.3."""
    x = np.cbrt(CRITICAL_TEMPERATURE / temperature - 1.0)
    terms = -1.009 * x - 6.28792 * x**2 + 7.50332 * x**3 - 7.90463 * x**4 + 0.629427 * x**5
    return np.asarray(CRITICAL_DENSITY * np.exp(terms))


def enthalpies(temperature: Array) -> tuple[Array, Array]:
    """Of the saturated liquid and vapor [J/kg] by ESDU 91022, eqs. 4.4 and 4.5."""
    x = np.cbrt(1.0 - temperature / CRITICAL_TEMPERATURE)
    liquid = -200.0 + 116.043 * x - 917.225 * x**2 + 794.779 * x**3 - 589.587 * x**4
    vapor = -200.0 + 440.055 * x - 459.701 * x**2 + 434.081 * x**3 - 485.338 * x**4
    return 1e3 * liquid, 1e3 * vapor


def other_table() -> Array:
    """The blind generator's table of nitrous oxide with all that ESDU 91022 has of it."""
    from simulated.blind import nitrous

    table = nitrous.table().copy()
    temperature = nitrous.LOWEST + nitrous.STEP * np.arange(table.shape[1])
    p, liquid, vapor = pressure(temperature), liquid_density(temperature), vapor_density(temperature)
    h_liquid, h_vapor = enthalpies(temperature)
    shift = np.interp(REFERENCE, temperature, table[nitrous.H_L] - h_liquid)
    table[nitrous.P], table[nitrous.RHO_L], table[nitrous.RHO_V] = p, liquid, vapor
    table[nitrous.H_L], table[nitrous.H_V] = h_liquid + shift, h_vapor + shift
    table[nitrous.U_L], table[nitrous.U_V] = h_liquid + shift - p / liquid, h_vapor + shift - p / vapor
    return table


def main() -> None:
    """Write the tests that are not there."""
    from simulated.blind import nitrous
    from simulated.blind.plan import plan
    from simulated.blind.write import answer_path, write_case

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, metavar="DIR")
    parser.add_argument("--seed", type=int, default=15)
    parser.add_argument("--limit", type=int, default=495)
    given = parser.parse_args()
    made = other_table()
    nitrous.table = lambda: made
    for case in plan(1500, "calibration", given.seed)[: given.limit]:
        if case.kind == "none" and not answer_path(case, given.out).is_file():
            write_case(case, given.out)


if __name__ == "__main__":
    main()
