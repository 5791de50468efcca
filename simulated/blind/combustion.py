"""Chamber gas from NASA's CEA: R T and frozen heat capacity ratio over entering enthalpy, nitrogen share, p and O/F.

Nodes are few; monotone cubics refine them along pressure and O/F, and compiled code interpolates linearly in all
four. The fuel is n-eicosane, liquid, -554 MJ/kmol. Nitrogen enters with zero enthalpy on the formation scale.
"""

from __future__ import annotations

import warnings
from functools import lru_cache

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .cache import kept

Array = NDArray[np.float64]

ENTHALPIES = (1.5e6, 1.85e6)
"""Oxidizer enthalpy on the formation scale [J/kg], linear between."""
NITROGEN = (0.0, 0.2, 0.5)
"""Mass share of nitrogen in what comes through the injector."""
PRESSURES = (0.5e5, 80e5, 12, 56)
RATIOS = (0.35, 250.0, 170, 680)
"""From, to, nodes, points after refining; both in logarithms."""
RICHER = (36, 144)
"""Nodes and points below the least O/F, as far apart: late in a blowdown fuel goes on with hardly any oxidizer."""

FUEL_MOLAR_MASS = 282.5475
FUEL_ENTHALPY = -554e6 / FUEL_MOLAR_MASS


def _grids(refined: bool) -> tuple[Array, Array]:
    k = 3 if refined else 2
    pressures, ratios = (np.linspace(np.log(g[0]), np.log(g[1]), int(g[k])) for g in (PRESSURES, RATIOS))
    richer = ratios[0] - (ratios[1] - ratios[0]) * np.arange(RICHER[k - 2], 0, -1)
    return pressures, np.concatenate([richer, ratios])


def _nodes() -> Array:
    import cea

    made = {"enthalpy": 0.0, "enthalpy_units": "J/kg", "temperature": 298.15}
    fuel = cea.Reactant(name="wax", formula={"C": 20.0, "H": 42.0}, molecular_weight=FUEL_MOLAR_MASS, **made)
    nitrous = cea.Reactant(name="nitrous", formula={"N": 2.0, "O": 1.0}, molecular_weight=44.0128, **made)
    gases = cea.Mixture([fuel, nitrous, "N2"], products_from_reactants=True)
    solver = cea.EqSolver(gases, reactants=cea.Mixture([fuel, nitrous, "N2"]))
    found = cea.EqSolution(solver)
    ln_p, ln_r = _grids(False)
    out = np.empty((2, len(ENTHALPIES), len(NITROGEN), len(ln_p), len(ln_r)))
    for index in np.ndindex(out.shape[1:]):
        h, z = ENTHALPIES[index[0]], NITROGEN[index[1]]
        p, ratio = float(np.exp(ln_p[index[2]])), float(np.exp(ln_r[index[3]]))
        w = np.array([1.0, ratio * (1.0 - z), ratio * z]) / (1.0 + ratio)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what does not converge is refused below
            solver.solve(found, cea.HP, (w[0] * FUEL_ENTHALPY + w[1] * h) / cea.R, p / 1e5, w)
        if not found.converged:
            raise ArithmeticError(f"no equilibrium at {p} Pa, O/F {ratio}")
        gas, heat = 8314.462618 / found.M, 1e3 * found.cp_fr
        out[(0, *index)], out[(1, *index)] = np.log(gas * found.T), heat / (heat - gas)
    return out


def _make() -> Array:
    from scipy.interpolate import PchipInterpolator

    (p, r), (fine_p, fine_r) = _grids(False), _grids(True)
    return np.ascontiguousarray(PchipInterpolator(p, PchipInterpolator(r, _nodes(), axis=4)(fine_r), axis=3)(fine_p))


@lru_cache(maxsize=1)
def table() -> Array:
    """(ln RT, gamma) x enthalpy x nitrogen share x ln p x ln O/F."""
    return kept("combustion-2", _make)


P0, P1 = (float(np.log(v)) for v in PRESSURES[:2])
R0, R1 = (float(v) for v in _grids(True)[1][[0, -1]])


@njit(cache=True)
def gas(values: Array, enthalpy: float, share: float, pressure: float, ratio: float) -> tuple[float, float]:
    """R T [J/kg] and gamma."""
    w = (enthalpy - 1.5e6) / 0.35e6
    x = (np.log(pressure) - P0) / (P1 - P0) * (values.shape[3] - 1)
    y = (np.log(ratio) - R0) / (R1 - R0) * (values.shape[4] - 1)
    x = min(max(x, 0.0), values.shape[3] - 1.000001)
    y = min(max(y, 0.0), values.shape[4] - 1.000001)
    i, j = int(x), int(y)
    x, y = x - i, y - j
    k, v = 0, min(max(share, 0.0), 0.5) / 0.2
    if v > 1.0:
        k, v = 1, (v - 1.0) / 1.5
    a, b = 0.0, 0.0
    for e in range(2):
        we = w if e else 1.0 - w
        for s in range(2):
            if s == 1 and v == 0.0:
                continue
            f = we * (v if s else 1.0 - v)
            c00, c01 = f * (1.0 - x) * (1.0 - y), f * (1.0 - x) * y
            c10, c11 = f * x * (1.0 - y), f * x * y
            t = values[0, e, k + s]
            a += c00 * t[i, j] + c01 * t[i, j + 1] + c10 * t[i + 1, j] + c11 * t[i + 1, j + 1]
            t = values[1, e, k + s]
            b += c00 * t[i, j] + c01 * t[i, j + 1] + c10 * t[i + 1, j] + c11 * t[i + 1, j + 1]
    return float(np.exp(a)), b
