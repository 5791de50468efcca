"""A column's label, taken apart: the name, and the unit where the label states one."""

from __future__ import annotations

import re
from typing import NamedTuple

from hfanalysis.errors import InputError
from hfanalysis.units import DIMENSIONS, dimension_of, unit_factor

_BRACKETED = re.compile(r"^(?P<name>.*?)\s*[\[({](?P<unit>[^\])}]*)[\])}]\s*$", re.DOTALL)
_LAST_WORD = re.compile(r"^(?P<name>.*[^\s_])[\s_]+(?P<unit>[^\s_\d][^\s_]*)$", re.DOTALL)
_IN_NAMES = ("pressure", "force", "mass", "temperature", "time")
"""Dimensions of units that a name may end in without brackets."""
_LETTERS = ("N", "s", "K")
"""Units of one letter that are taken for one at the end of a name."""

MEANT = {
    ("force", "lb"): "lbf", ("force", "lbs"): "lbf", ("force", "lbm"): "lbf", ("force", "pounds"): "lbf",
    ("force", "kg"): "kgf", ("force", "kgs"): "kgf", ("mass", "lbf"): "lb", ("mass", "kgf"): "kg",
}  # fmt: skip
"""(dimension of the quantity, unit in the log) -> the unit that is meant: a force in pounds is one in pounds-force, and
a cell calibrated in pounds-force hangs pounds of mass."""


class Label(NamedTuple):
    """A label's name without its unit, and the unit ("" where it states none)."""

    name: str
    unit: str


def taken_apart(label: str, unit: str = "") -> Label:
    """Name and unit of a label; ``unit`` is what the log says elsewhere, which wins.

    >>> taken_apart("PT-TANK (psia)"), taken_apart("thrust_lbf"), taken_apart("p_c")
    (Label(name='PT-TANK', unit='psia'), Label(name='thrust', unit='lbf'), Label(name='p_c', unit=''))
    """
    bracketed = _BRACKETED.match(label)
    if bracketed and bracketed["name"]:
        return Label(bracketed["name"], spelled(unit or bracketed["unit"].strip()))
    last = None if unit else _LAST_WORD.match(label.strip())
    if last and (len(last["unit"]) > 1 or last["unit"] in _LETTERS) and any(fits(last["unit"], d) for d in _IN_NAMES):
        return Label(last["name"], last["unit"])
    return Label(label, spelled(unit.strip()))


def spelled(unit: str) -> str:
    """A unit as this package writes it, where that is plain from another way of writing it.

    >>> spelled("Deg F"), spelled("PSIG"), spelled("furlongs per fortnight")
    ('deg F', 'PSIG', 'furlongs per fortnight')
    """
    return unit if is_unit(unit) or not is_unit(unit.replace("Deg", "deg")) else unit.replace("Deg", "deg")


def fits(unit: str, dimension: str) -> bool:
    """Whether a text is a unit of a dimension."""
    if not unit or dimension not in DIMENSIONS:
        return False
    try:
        unit_factor(unit, dimension, "")
    except InputError:
        return False
    return True


def is_unit(unit: str) -> bool:
    """Whether a text is a unit of any dimension met here."""
    return bool(dimension(unit))


def dimension(unit: str) -> str:
    """The dimension of a unit; "" where it is none that is known here, or is not stated."""
    if not unit:
        return ""
    try:
        return dimension_of(unit, "")
    except InputError:
        return ""


def as_meant(unit: str, quantity: str) -> str:
    """The unit as a quantity of this dimension has it, "" where it cannot have it.

    >>> as_meant("lbs", "force"), as_meant("psi", "pressure"), as_meant("psi", "force")
    ('lbf', 'psi', '')
    """
    if fits(unit, quantity):
        return unit
    return MEANT.get((quantity, unit.strip().casefold()), "")
