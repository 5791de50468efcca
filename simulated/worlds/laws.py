"""Laws of each equation, of which a world has one: small departures from what the diagnosis assumes, none an effect.

Each is an entry of an array that compiled code reads (its index), or a table that is bent.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import exp, log

import numpy as np
from benchmarks.other_tables import other_table
from numpy.typing import NDArray
from simulated.blind import combustion, nitrous

Array = NDArray[np.float64]

(ZONE_LAG, EXPONENT_SLOPE, REYNOLDS, RATIO_SLOPE, VAPOR_AREA, LOSS_POWER, TOTAL_FLUX, PORT_POWER, TAIL, MIXING,
 OPENING, THRUST_LOSS, SAG, DYER, ISENTROPIC, PRESSURE_POWER, UNIFORM_WEB) = range(17)  # fmt: skip
LAWS = 17
"""Indices. The last four are other closures of hidden effects: 1 where the world has them."""

SUDDEN = 1e-6
"""Seconds that are none."""

FADES = (0.006, 1.0)
"""Seconds in which what burns at the end of the fuel is gone, from and to; in logarithms."""


@dataclass(frozen=True)
class World:
    """What holds in a test: ``laws`` by index, the tank's ``properties`` (esdu or coolprop), and how the c* of the
    gas is bent: its slopes with the logarithms of O/F and of pressure [-]."""

    laws: Array
    properties: str
    bent: tuple[float, float]
    names: dict[str, str] = field(default_factory=dict)

    def tank_table(self) -> Array:
        """Of nitrous oxide, rows as :mod:`simulated.blind.nitrous` has them."""
        return other_table() if self.properties == "esdu" else nitrous.table()

    def gas_table(self) -> Array:
        """Of the chamber's gas, as :mod:`simulated.blind.combustion` has it; c* goes with the root of R T."""
        made = combustion.table().copy()
        mixture = np.linspace(combustion.R0, combustion.R1, made.shape[4]) - log(6.0)
        pressure = np.linspace(combustion.P0, combustion.P1, made.shape[3]) - log(15e5)
        made[0] += 2.0 * (self.bent[0] * mixture[None, :] + self.bent[1] * pressure[:, None])
        return made

    def fading(self, burning: float, cooling: float) -> World:
        """The same where what is left burns on for so long, and the chamber turns cold so slowly [s]."""
        laws = self.laws.copy()
        laws[[TAIL, MIXING]] = burning, cooling
        return replace(self, laws=laws)


def plain() -> World:
    """No law but those of the blind generator; the flame ends with the fuel."""
    laws = np.zeros(LAWS)
    laws[[TAIL, MIXING]] = SUDDEN
    return World(laws, "coolprop", (0.0, 0.0), {"all": "plain"})


def draw(rng: np.random.Generator) -> World:
    """A law for every equation."""
    laws, names = np.zeros(LAWS), {}

    def choose(equation: str, **among: dict[int, tuple[float, float]]) -> None:
        names[equation] = str(rng.choice(list(among)))
        for index, (low, high) in among[names[equation]].items():
            laws[index] = rng.uniform(low, high)

    choose("tank", equilibrium={}, two_zones={ZONE_LAG: (0.0005, 0.002)})
    choose("vapor", polytrope={}, exponent_moves={EXPONENT_SLOPE: (-0.04, 0.04)})
    choose("injector", orifice={}, reynolds={REYNOLDS: (0.005, 0.03)}, pressure_ratio={RATIO_SLOPE: (-0.06, 0.06)},
           own_of_vapor={VAPOR_AREA: (-0.03, 0.03)})  # fmt: skip
    choose("feed", quadratic={}, power={LOSS_POWER: (-0.2, 0.0)})
    choose("grain", oxidizer_flux={}, total_flux={TOTAL_FLUX: (0.5, 0.5)}, port={PORT_POWER: (-0.15, 0.05)})
    choose("nozzle", ideal={}, boundary_layer={THRUST_LOSS: (0.003, 0.012)})
    choose("valve", at_once={}, opens={OPENING: (0.01, 0.04)})
    choose("purge", follows={}, sags={SAG: (0.02, 0.3)})
    laws[TAIL], laws[MIXING] = (exp(rng.uniform(log(FADES[0]), log(FADES[1]))) for _ in range(2))
    laws[DYER:] = rng.integers(0, 2, LAWS - DYER)
    names["properties"] = str(rng.choice(["coolprop", "esdu"]))
    return World(laws, names["properties"], (rng.uniform(-0.006, 0.006), rng.uniform(-0.004, 0.004)), names)
