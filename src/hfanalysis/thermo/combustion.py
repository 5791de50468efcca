"""Equilibrium combustion of nitrous oxide and a fuel, by NASA's CEA (report, section 2.1.2; PROPEP there).

The fuel is paraffin, n-eicosane, C20H42, liquid, where no other is asked for. The gas in the nozzle is taken frozen:
its heat capacity ratio is that of the chamber's composition with no further reaction (an equilibrium ratio gives 249 s
at O/F 7.0 where the report has 238 s at 6.34). Condensed carbon counts: it takes part in the mass and not in the gas
law.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import sqrt
from typing import Any

import numpy as np

from hfanalysis.thermo.constants import GAS_CONSTANT, OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.fuels import PARAFFIN, Fuel

PROPEP_OXIDIZER_ENTHALPY = 82.05e6 / OXIDIZER_MOLAR_MASS
"""Enthalpy of nitrous oxide as PROPEP, and with it the report, takes it [J/kg]. Source: heat of formation of the ideal
gas at 298.15 K, 82.05 MJ/kmol."""

FORMATION_OFFSET = 61.385e6 / OXIDIZER_MOLAR_MASS
"""Formation scale less that of the saturation properties [J/kg], which is 0 for the liquid at its boiling point.
Source: heat of formation of the ideal gas at 298.15 K, 82.05 MJ/kmol, less its enthalpy over that liquid (CoolProp:
20.665 MJ/kmol)."""

REFERENCE_TEMPERATURE = 298.15
"""Of the heats of formation [K]. Source: 25 degC, by convention."""


@dataclass(frozen=True)
class Gas:
    """Chamber gas: temperature [K], molar mass for the gas law [kg/kmol], frozen heat capacity ratio [-]."""

    temperature: float
    molar_mass: float
    gamma: float

    @property
    def gas_constant(self) -> float:
        """R_u / W [J/(kg K)]."""
        return GAS_CONSTANT / self.molar_mass

    @property
    def characteristic_velocity(self) -> float:
        """c* = sqrt(R T / gamma) ((gamma + 1)/2)^((gamma + 1)/(2 (gamma - 1))) [m/s]."""
        g = self.gamma
        return float(
            sqrt(self.gas_constant * self.temperature / g) * ((g + 1.0) / 2.0) ** ((g + 1.0) / (2.0 * (g - 1.0)))
        )


def equilibrium(
    pressure: float, of_ratio: float, oxidizer_enthalpy: float = PROPEP_OXIDIZER_ENTHALPY, nitrogen_share: float = 0.0,
    fuel: Fuel = PARAFFIN,
) -> Gas:  # fmt: skip
    """Equilibrium at constant enthalpy and ``pressure`` [Pa].

    ``of_ratio`` [-] counts all that comes through the injector, of which ``nitrogen_share`` by mass is nitrogen at
    298.15 K; ``oxidizer_enthalpy`` is that of the nitrous oxide entering, on the formation scale [J/kg]. Raises
    ArithmeticError where the equilibrium does not converge, ValueError for a pressure or ratio that is not positive.

    >>> round(equilibrium(27.579e5, 4.29).temperature)
    2666
    """
    if not (0.0 < pressure < np.inf and 0.0 < of_ratio < np.inf and 0.0 <= nitrogen_share < 1.0):
        raise ValueError(f"no mixture: {pressure=} Pa, {of_ratio=}, {nitrogen_share=}")
    try:
        return _solver(fuel).solve(pressure, of_ratio, oxidizer_enthalpy, nitrogen_share)
    except ArithmeticError:  # a start far off may be to blame
        restart()
        return _solver(fuel).solve(pressure, of_ratio, oxidizer_enthalpy, nitrogen_share)


def condensed_carbon(
    pressure: float, of_ratio: float, oxidizer_enthalpy: float, nitrogen_share: float, fuel: Fuel = PARAFFIN
) -> float:
    """Mass fraction of graphite [-] in :func:`equilibrium` at the same ``pressure`` [Pa], mixture and enthalpy
    [J/kg]."""
    equilibrium(pressure, of_ratio, oxidizer_enthalpy, nitrogen_share, fuel)
    return _solver(fuel).carbon


def restart() -> None:
    """Forget the last equilibrium, from which the next one starts: results no longer depend on what was asked before.

    Otherwise they differ in the twelfth digit; products are to be the same from run to run.
    """
    _solver.cache_clear()


class _Solver:
    """CEA's equilibrium solver with the reactants set up once."""

    def __init__(self, of: Fuel) -> None:
        import cea

        self._fuel = of
        fuel = cea.Reactant(
            name="fuel",
            formula=dict(of.atoms),
            molecular_weight=of.molar_mass,
            enthalpy=0.0,
            enthalpy_units="J/kg",
            temperature=REFERENCE_TEMPERATURE,
        )
        oxidizer = cea.Reactant(
            name="nitrous oxide",
            formula={"N": 2.0, "O": 1.0},
            molecular_weight=OXIDIZER_MOLAR_MASS,
            enthalpy=0.0,
            enthalpy_units="J/kg",
            temperature=REFERENCE_TEMPERATURE,
        )
        reactants = cea.Mixture([fuel, oxidizer, "N2"])
        products = cea.Mixture([fuel, oxidizer, "N2"], products_from_reactants=True)
        self._cea: Any = cea
        self._solver = cea.EqSolver(products, reactants=reactants)
        self._solution = cea.EqSolution(self._solver)

    @property
    def carbon(self) -> float:
        """Mass fraction of graphite in the last solution."""
        return float(self._solution.mass_fractions["C(gr)"])

    def solve(self, pressure: float, of_ratio: float, oxidizer_enthalpy: float, nitrogen_share: float) -> Gas:
        """One equilibrium; the nitrogen enters at 298.15 K, where its enthalpy is zero on the formation scale."""
        weights = np.array([1.0, of_ratio * (1.0 - nitrogen_share), of_ratio * nitrogen_share])
        weights /= weights.sum()
        self._weights = weights
        enthalpy = float(weights[0] * self._fuel.enthalpy + weights[1] * oxidizer_enthalpy)
        if not self._settled(self._cea.HP, enthalpy, pressure):
            raise ArithmeticError(f"no equilibrium at {pressure / 1e5:.3g} bar and O/F {of_ratio:.3g}")
        s = self._solution
        cp = 1e3 * float(s.cp_fr)
        molar_mass = float(s.M)
        return Gas(float(s.T), molar_mass, cp / (cp - GAS_CONSTANT / molar_mass))

    def _settled(self, kind: Any, given: float, pressure: float) -> bool:
        """Whether the last mixture has an equilibrium of ``given`` enthalpy [J/kg] or entropy [J/(kg K)]."""
        # CEA takes either over R, R in J/(kg K), on a kilogram of mixture, and the pressure in bar
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what does not converge is refused by who asks
            self._solver.solve(self._solution, kind, given / self._cea.R, pressure / 1e5, self._weights)
        return bool(self._solution.converged and self._solution.T > 0.0)

    @property
    def entropy(self) -> float:
        """Of the last solution [J/(kg K)]."""
        return 1e3 * float(self._solution.entropy)

    def at_entropy(self, entropy: float, pressure: float) -> State:
        """The last mixture at another pressure [Pa] and an ``entropy`` [J/(kg K)]."""
        if not self._settled(self._cea.SP, entropy, pressure):
            raise ArithmeticError(f"no equilibrium of this entropy at {pressure / 1e5:.3g} bar")
        return self.state(pressure)

    def state(self, pressure: float) -> State:
        """The last solution, at its ``pressure`` [Pa]."""
        s = self._solution
        return State(pressure, 1e3 * float(s.enthalpy), float(s.density), float(s.gamma_s))


@dataclass(frozen=True)
class State:
    """Gas in equilibrium: pressure [Pa], enthalpy [J/kg], density [kg/m^3], isentropic exponent [-]."""

    pressure: float
    enthalpy: float
    density: float
    exponent: float


def isentrope(
    pressure: float, of_ratio: float, oxidizer_enthalpy: float = PROPEP_OXIDIZER_ENTHALPY, fuel: Fuel = PARAFFIN
) -> tuple[Gas, State, Callable[[float], State]]:
    """The chamber's gas, its state, and the state at any other pressure [Pa] of the same entropy and elements.

    The composition shifts with the pressure. Arguments and errors are those of :func:`equilibrium`; the states' errors
    are, too. They hold until the next equilibrium is asked for elsewhere.
    """
    gas = equilibrium(pressure, of_ratio, oxidizer_enthalpy, fuel=fuel)
    solver = _solver(fuel)
    entropy = solver.entropy
    return gas, solver.state(pressure), lambda there: solver.at_entropy(entropy, there)


@lru_cache(maxsize=1)
def _solver(fuel: Fuel) -> _Solver:
    return _Solver(fuel)
