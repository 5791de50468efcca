"""A fuel as its chemistry knows it: atoms, and the enthalpy with which it comes."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from hashlib import sha256

from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS

ATOMS = {"C": 12.011, "H": 1.008, "N": 14.007, "O": 15.999}
"""Standard atomic weights [kg/kmol] of what a fuel may be made of. Source: IUPAC, abridged values of 2021; others leave
products that condense, which the gas law of the engine does not know."""

SOLID = 16.0
"""Carbon atoms in a chain from which on an alkane is solid in a room. Source: n-hexadecane melts at 18 degC."""

_ATOM = re.compile(r"\s*([A-Z][a-z]?)\s*([0-9]*\.?[0-9]*)")


@dataclass(frozen=True)
class Fuel:
    """``atoms``: how many of each element are in a mole of the formula; ``molar_mass`` [kg/kmol] of the formula;
    ``enthalpy``: heat of formation at 298.15 K [J/kg]."""

    name: str
    atoms: tuple[tuple[str, float], ...]
    molar_mass: float
    enthalpy: float

    @property
    def stoichiometric(self) -> float:
        """Nitrous oxide over fuel by mass [-] that burns it to carbon dioxide, water and nitrogen."""
        count = dict(self.atoms)
        oxygen = 2.0 * count.get("C", 0.0) + 0.5 * count.get("H", 0.0) - count.get("O", 0.0)
        return oxygen * OXIDIZER_MOLAR_MASS / self.molar_mass

    @property
    def wax(self) -> bool:
        """Whether it is a paraffin: an alkane of a chain so long that it is solid.

        >>> PARAFFIN.wax, Fuel("polyethylene", (("C", 2.0), ("H", 4.0)), 28.05, 0.0).wax
        (True, False)
        """
        count = dict(self.atoms)
        carbon, hydrogen = count.get("C", 0.0), count.get("H", 0.0)
        return set(count) == {"C", "H"} and carbon >= SOLID and abs(hydrogen - 2.0 * carbon - 2.0) < 1.0

    @property
    def key(self) -> str:
        """What tells it from other fuels in the name of a file, whatever it is called."""
        return sha256(repr((self.atoms, self.molar_mass, self.enthalpy)).encode()).hexdigest()[:12]


PARAFFIN_MOLAR_MASS = 282.5475
"""n-eicosane [kg/kmol]. Source: C20H42 by standard atomic weights."""

PARAFFIN = Fuel("paraffin", (("C", 20.0), ("H", 42.0)), PARAFFIN_MOLAR_MASS, -554e6 / PARAFFIN_MOLAR_MASS)
"""Liquid n-eicosane. Source: its heat of formation at 298.15 K, -554 MJ/kmol; the report prints +557 MJ/kmol, a slip of
the sign."""


def atoms_of(formula: str) -> tuple[tuple[str, float], ...]:
    """The atoms of a formula, in the order of ATOMS.

    Raises ValueError for what is none, for other elements, and where carbon cannot be left over: richer than every
    mixture there is no soot, which the table of the burnt gas counts from.

    >>> atoms_of("C20H42"), atoms_of("C 7.3 H 10.9 O 0.06")
    ((('C', 20.0), ('H', 42.0)), (('C', 7.3), ('H', 10.9), ('O', 0.06)))
    """
    found = dict.fromkeys(ATOMS, 0.0)
    at = 0
    text = formula.strip()
    while at < len(text):
        match = _ATOM.match(text, at)
        if match is None:
            raise ValueError(f"{formula!r}; expected a formula such as C20H42")
        element, count = match.groups()
        if element not in ATOMS:
            raise ValueError(f"{element} in {formula!r}; expected {', '.join(ATOMS)}")
        try:
            found[element] += float(count) if count else 1.0
        except ValueError:
            raise ValueError(f"{formula!r}; expected a formula such as C20H42") from None
        at = match.end()
    if not found["C"] > found["O"]:
        raise ValueError(f"{formula!r}; expected more carbon than oxygen, as in every fuel of a hybrid")
    return tuple((element, count) for element, count in found.items() if count)


def molar_mass(atoms: Iterable[tuple[str, float]]) -> float:
    """Of a formula [kg/kmol]."""
    return sum(ATOMS[element] * count for element, count in atoms)


def blend(name: str, parts: Iterable[tuple[float, Fuel]]) -> Fuel:
    """The fuel of parts by mass, a kilogram as its formula: ``parts`` are shares [-], one together, and fuels."""
    mixed = dict.fromkeys(ATOMS, 0.0)
    enthalpy = 0.0
    for share, fuel in parts:
        enthalpy += share * fuel.enthalpy
        for element, count in fuel.atoms:
            mixed[element] += 1e3 * share * count / fuel.molar_mass
    atoms = tuple((element, count) for element, count in mixed.items() if count)
    return Fuel(name, atoms, molar_mass(atoms), enthalpy)
