"""A team's own limits: ``limits.toml`` at the root, beside ``raw_tests/``::

[[rule]]
quantity = "peak_chamber_pressure"
max = "40 bar"

[[rule]]
quantity = "C_i"
within = "5 %"          # of the stand's test before by date

[[stand.north.rule]]    # on this stand, in the place of the rules above on the same quantity
quantity = "peak_chamber_pressure"
max = "30 bar"
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

from pydantic import Field

from hfanalysis.errors import InputError
from hfanalysis.record.document import place, read_toml, validate
from hfanalysis.record.schema import Section, section
from hfanalysis.units import near

FILE = "limits.toml"


@section
class Rule(Section):
    """One rule: a quantity of the products by its name, and at least one limit, each with its unit."""

    quantity: str
    min: str | float | None = None
    max: str | float | None = None
    within: str | float | None = None


@section
class OfStand(Section):
    """The rules of one stand."""

    rule: tuple[Rule, ...] = ()


@section
class Limits(Section):
    """``limits.toml``."""

    rule: tuple[Rule, ...] = ()
    stand: Mapping[str, OfStand] = Field(default_factory=dict)


def read_limits(root: Path, stand: str | None, known: Collection[str]) -> tuple[Rule, ...]:
    """The rules for a stand, of the file at a root; none where there is no file.

    Raises InputError for what cannot be read, for a quantity that is not ``known``, and for a rule without a limit.
    """
    path = root / FILE
    if not path.is_file():
        return ()
    found = validate(Limits, read_toml(path)[1], path)
    for i, rule in enumerate(found.rule):
        _check(rule, known, place(str(path), "rule", i))
    for name, of_stand in found.stand.items():
        for i, rule in enumerate(of_stand.rule):
            _check(rule, known, place(str(path), "stand", name, "rule", i))
    own = found.stand.get(stand or "", OfStand()).rule
    replaced = {rule.quantity for rule in own}
    return (*(rule for rule in found.rule if rule.quantity not in replaced), *own)


def _check(rule: Rule, known: Collection[str], where: str) -> None:
    if rule.quantity not in known:
        offer = near(rule.quantity, known)
        raise InputError(f"{where}: found the quantity {rule.quantity!r}; expected one that products have{offer}")
    if rule.min is None and rule.max is None and rule.within is None:
        raise InputError(f"{where}: found a rule without a limit; expected min, max or within")
