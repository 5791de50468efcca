"""Saturated nitrous oxide from CoolProp's reference equation of state (Lemmon & Span 2006), tabulated once and cached.

One source for pressure, volumes and energies: a saturated tank closes in energy to round-off, which a mix of
correlations cannot. Importing CoolProp takes longer than a whole calibration, so the table is kept in the user's cache.
"""

from __future__ import annotations

from importlib.metadata import version

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.thermo.cache import cached
from hfanalysis.thermo.saturation import NODES, Property, Saturation, splines

CRITICAL_TEMPERATURE = 309.5207
"""T_c in theta [K]. Source: Lemmon and Span 2006, as CoolProp has it."""

T_MIN = 182.34
"""Lower end of the table [K]. Source: the triple point, 182.33 K (CoolProp)."""

T_MAX = 309.50
"""Upper end of the table [K]. Source: just below the critical point, 309.52 K, where both phases meet."""


def build() -> Saturation:
    """The table, from the cache where it is there, else from CoolProp (about 3 s, once)."""
    theta = np.linspace(_theta(T_MAX), _theta(T_MIN), NODES)
    name = f"nitrous-coolprop-{version('CoolProp')}-{NODES}"
    coefficients = cached(name, (len(Property), NODES - 1, 4), lambda: splines(theta, sample(theta)))
    return Saturation.from_splines("coolprop", theta, coefficients, CRITICAL_TEMPERATURE)


def sample(theta: Array) -> Array:
    """All properties at the given theta (n,), straight from CoolProp: shape (properties, n), specific SI units ([Pa],
    [m^3/kg], [J/kg], [J/(kg K)]; logarithms where Property says so)."""
    from CoolProp import CoolProp

    state = CoolProp.AbstractState("HEOS", "NitrousOxide")
    rows = np.empty((len(Property), theta.size))
    for i, t in enumerate(CRITICAL_TEMPERATURE * (1.0 - theta**3)):
        state.update(CoolProp.QT_INPUTS, 0.0, t)
        liquid = (1.0 / state.rhomass(), state.umass(), state.hmass())
        state.update(CoolProp.QT_INPUTS, 1.0, t)
        vapor = (np.log(1.0 / state.rhomass()), state.umass(), state.hmass())
        by_temperature = state.first_partial_deriv(CoolProp.iP, CoolProp.iT, CoolProp.iDmass)
        heat = (np.log(state.cvmass()), np.log(state.cpmass()), by_temperature / state.rhomass() / state.cvmass())
        rows[:, i] = (np.log(state.p()), liquid[0], vapor[0], liquid[1], vapor[1], liquid[2], vapor[2], *heat)
    return rows


def _theta(temperature: float) -> float:
    return float((1.0 - temperature / CRITICAL_TEMPERATURE) ** (1.0 / 3.0))
