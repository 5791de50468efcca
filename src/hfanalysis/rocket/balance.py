"""Center of gravity and pitch inertia of the rocket over the burn: CG_total(t) of the report (section 3.2.4).

Liquid and vapor lie over each other in the tank; grain, chamber gas, empty engine and structure stay where they are.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array


@dataclass(frozen=True)
class MassPart:
    """Mass [kg], center of gravity [m from the nose tip] and length [m] of a part, each over time or constant."""

    mass: Array | float
    center: Array | float
    length: Array | float = 0.0


@dataclass(frozen=True)
class Balance:
    """Mass [kg], center of gravity [m from the nose tip], pitch inertia about it [kg m^2] over time."""

    mass: Array
    center: Array
    inertia: Array


def balance(parts: Iterable[MassPart]) -> Balance:
    """Mass [kg], CG [m] and pitch inertia [kg m^2], (n,), of parts taken as slender rods (report, eq. 3.60).

    CG = sum m x / sum m, I = sum m (L^2/12 + (x - CG)^2).
    """
    known = list(parts)
    mass = sum((np.asarray(p.mass, dtype=np.float64) for p in known), np.zeros(1))
    center = sum((np.asarray(p.mass) * p.center for p in known), np.zeros(1)) / mass
    rods = (np.asarray(p.mass) * (np.square(p.length) / 12.0 + np.square(center - p.center)) for p in known)
    return Balance(np.asarray(mass), np.asarray(center), np.asarray(sum(rods, np.zeros(1))))


@dataclass(frozen=True)
class TankPlace:
    """Where the tank is: its top [m from the nose tip], length [m] and volume [m^3]."""

    top: float
    length: float
    volume: float


def oxidizer(place: TankPlace, liquid: Array, vapor: Array, liquid_volume: Array) -> list[MassPart]:
    """The tank's content: ``liquid`` and ``vapor`` [kg] over time, the liquid's specific volume [m^3/kg], (n,) each.

    The liquid fills the tank from below; each phase has its center in the middle of the length it takes.
    """
    height = np.clip(liquid * liquid_volume / place.volume, 0.0, 1.0) * place.length
    bottom = place.top + place.length
    return [
        MassPart(liquid, bottom - 0.5 * height, height),
        MassPart(vapor, place.top + 0.5 * (place.length - height), place.length - height),
    ]


@dataclass(frozen=True)
class Places:
    """Where the tank is, and the middles of grain and chamber [m from the nose tip].

    ``front``: the engine's front, from which engine files count; ``length``: of the engine [m].
    """

    tank: TankPlace
    grain_center: float
    grain_length: float
    gas_center: float
    front: float
    length: float


@dataclass(frozen=True)
class Masses:
    """Parts that stay as they are, and where the propellant is.

    ``dry``: mass [kg] and center of gravity of the empty engine, None where the structure holds it.
    """

    fixed: tuple[MassPart, ...]
    where: Places
    dry: MassPart | None
    remark: str


@dataclass(frozen=True)
class Held:
    """What tank, grain and chamber hold on one clock [kg], (n,) each, and the liquid's specific volume [m^3/kg].

    ``oxidizer``: in the tank, of which ``liquid``; ``gas``: in the chamber, None where it is not known. ``remark``:
    what is not known of it.
    """

    oxidizer: Array
    liquid: Array
    liquid_volume: Array
    fuel: Array
    gas: Array | None
    remark: str = ""

    def parts(self, place: Places) -> list[MassPart]:
        """Where it is."""
        tank = oxidizer(place.tank, self.liquid, self.oxidizer - self.liquid, self.liquid_volume)
        gas = [] if self.gas is None else [MassPart(self.gas, place.gas_center)]
        return [*tank, MassPart(self.fuel, place.grain_center, place.grain_length), *gas]


def engine_center(held: Held, place: Places, empty: MassPart | None) -> Array:
    """Of an engine with what it holds [m from its front], (n,); once nothing is left, the last that it had.

    ``empty``: the engine by itself, None where it is not weighed apart.
    """
    parts = [*([] if empty is None else [empty]), *held.parts(place)]
    weight = np.asarray(sum((np.asarray(part.mass) for part in parts), np.zeros(1)))
    with np.errstate(invalid="ignore", divide="ignore"):
        center = np.asarray(balance(parts).center - place.front)
    there = weight > 0.0
    return center if there.all() else np.interp(np.arange(weight.size), np.flatnonzero(there), center[there])
