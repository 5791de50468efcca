"""Reading and writing files of adopted effects.

A file has a table per effect, its parameters as in test.toml: values with their units, and +/- one standard deviation::

    [tank_heat]
    power = "0.9 +/- 0.15 kW"
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hfanalysis.effects import FOLDER, library
from hfanalysis.effects.learnt import with_learnt
from hfanalysis.engine.effect import Active, Effect, Parameter
from hfanalysis.errors import InputError
from hfanalysis.inference.adopted import adopted_file
from hfanalysis.products.disk import atomic
from hfanalysis.products.model import AdoptedEffect
from hfanalysis.quantity import Quantity
from hfanalysis.record.document import place, read_toml
from hfanalysis.units import DIMENSIONS, Value, near, parse

if TYPE_CHECKING:
    from hfanalysis.products.diagnosis import NamedEffect

ABSOLUTE_TEMPERATURE = 100.0
"""[K] A parameter that is never below this is a temperature; others in kelvin are differences."""


@dataclass(frozen=True)
class Adopted:
    """Adopted effects, the standard deviations of their parameters [SI] where stated, and the ``file`` that has them.

    ``stated``: by effect, its parameters as the file has them; the others have their prior's center.
    """

    effects: tuple[Active, ...] = ()
    stated: Mapping[str, Mapping[str, Value]] | None = None
    file: str = ""

    @property
    def acting(self) -> tuple[Active, ...]:
        """The effects that are not of strength 0, with which a model is the base model."""
        return tuple(active for active in self.effects if not active.idle)

    def drawn(self, acting: Sequence[Active], rng: np.random.Generator) -> tuple[Active, ...]:
        """Effects that act, their parameters off by what is stated of them, within their bounds."""
        return tuple(_moved(active, (self.stated or {}).get(active.effect.name, {}), rng) for active in acting)

    def product(self) -> tuple[AdoptedEffect, ...]:
        """As products have it: name, file, and every parameter as a quantity in its own unit, with its standard
        deviation where stated."""
        named = ((active, active.effect.name) for active in self.effects)
        return tuple(AdoptedEffect(name=name, file=self.file, parameters=self._quantities(a)) for a, name in named)

    def _quantities(self, active: Active) -> dict[str, Quantity]:
        stated = (self.stated or {}).get(active.effect.name, {})
        return {
            p.name: Quantity(value, p.unit, stated[p.name].std if p.name in stated else None)
            for p, value in zip(active.effect.parameters, active.values, strict=True)
            if not p.inner
        }


def _moved(active: Active, stated: Mapping[str, Value], rng: np.random.Generator) -> Active:
    off = {name: value.std or 0.0 for name, value in stated.items()}
    values = [
        float(np.clip(value + off.get(p.name, 0.0) * rng.standard_normal(), p.low, p.high))
        for p, value in zip(active.effect.parameters, active.values, strict=True)
    ]
    return Active(active.effect, tuple(values))


def read_adopted(root: Path, definition: Any) -> Adopted:
    """The effects adopted for a test; none where there is no file.

    Raises InputError, with the file, the key, what was found and what was expected, for an effect or parameter that is
    not known, a strength that is missing, and a value that cannot be read or is out of bounds.
    """
    path = adopted_file(root, definition)
    return Adopted() if path is None else read_effects(path, library(root / FOLDER))


def read_effects(path: Path, known: Mapping[str, Effect]) -> Adopted:
    """The effects of one file; those there can be are ``known``. Raises InputError as :func:`read_adopted`. Values come
    out in SI."""
    return effects_in(read_toml(path)[1], path, known)


def effects_in(content: Mapping[str, Any], path: Path, known: Mapping[str, Effect]) -> Adopted:
    """The effects that tables of the file at ``path`` state, by name. Raises InputError as :func:`read_adopted`. Values
    come out in SI."""
    known = with_learnt(known, content)
    stated = {name: _values(path, name, table, known) for name, table in sorted(content.items())}
    return _adopted(stated, known, path.name)


def tables(adopted: Adopted) -> dict[str, dict[str, str]]:
    """The same the other way: of every effect, all its parameters [SI] in full, with +/- where stated."""
    return {active.effect.name: _table(active, adopted) for active in adopted.effects}


def _table(active: Active, adopted: Adopted) -> dict[str, str]:
    stated = (adopted.stated or {}).get(active.effect.name, {})
    values = {name: stated.get(name, Value(value)) for name, value in active.named.items()}
    return {p.name: _text(values[p.name], p.unit) for p in active.effect.parameters if not p.inner}


def _values(path: Path, name: str, table: Any, known: Mapping[str, Effect]) -> dict[str, Value]:
    """The parameters that one table states."""
    if name not in known:
        raise InputError(f"{path}: found {name!r}; expected an effect{near(name, known)} (hfa effects lists them)")
    if not isinstance(table, dict):
        raise InputError(f"{place(str(path), name)}: found {table!r}; expected a table of parameters, [{name}]")
    parameters = {p.name: p for p in known[name].parameters if not p.inner}
    for key in table:
        if key not in parameters:
            expected = f"one of {', '.join(parameters)}{near(key, parameters)}"
            raise InputError(f"{place(str(path), name)}: found {key!r}; expected {expected}")
    strengths = list(parameters)[: known[name].strengths]
    if not set(strengths) & set(table):
        missing = " or ".join(strengths)
        raise InputError(f"{place(str(path), name)}: {missing} is missing; expected the effect's strength in its table")
    return {key: _value(text, parameters[key], place(str(path), name, key)) for key, text in table.items()}


def _value(text: Any, parameter: Parameter, where: str) -> Value:
    found = _parsed(text, parameter, where)
    if not parameter.low <= found.value <= parameter.high:
        raise InputError(
            f"{where}: found {text!r} = {found.value:.6g} {parameter.unit}; expected {parameter.low:g} to "
            f"{parameter.high:g} {parameter.unit} ({parameter.meaning})"
        )
    return found


def _parsed(text: Any, parameter: Parameter, where: str) -> Value:
    dimension = _dimension(parameter)
    if dimension is not None:
        return parse(text, dimension, where)
    # a unit that only a team's own effect has is read as it is written there
    bare = str(text).strip()
    if not bare.endswith(parameter.unit):
        raise InputError(f"{where}: found {text!r}; expected a value in {parameter.unit}")
    return parse(bare.removesuffix(parameter.unit).strip(), "dimensionless", where)


def _dimension(parameter: Parameter) -> str | None:
    """The dimension of a parameter's unit; None for one that no table has."""
    if parameter.unit in ("", "-", "1"):
        return "dimensionless"
    if parameter.unit == "K":
        return "temperature" if parameter.low >= ABSOLUTE_TEMPERATURE else "temperature_difference"
    return next((name for name, found in DIMENSIONS.items() if found.si == parameter.unit), None)


def of_diagnosis(effects: Sequence[NamedEffect], known: Mapping[str, Effect]) -> Adopted:
    """The effects that a diagnosis.json names, as :func:`of_tables`."""
    return of_tables({found.name: found.parameters for found in effects}, known)


def of_tables(effects: Mapping[str, Mapping[str, Quantity]], known: Mapping[str, Effect]) -> Adopted:
    """Effects by name, with their parameters as a diagnosis.json has them. Raises InputError for what a file of them
    could not hold. Values in and out are in the units of the effects (SI)."""
    stated, known = {}, with_learnt(known, effects)
    for name, parameters in sorted(effects.items()):
        units = {p.name: p.unit for p in known[name].parameters} if name in known else {}
        values = {key: Value(q.value, q.std) for key, q in parameters.items() if q.value is not None}
        table = {key: _text(value, units.get(key, "")) for key, value in values.items()}
        stated[name] = _values(Path("diagnosis.json"), name, table, known)
    return _adopted(stated, known)


def _adopted(stated: Mapping[str, Mapping[str, Value]], known: Mapping[str, Effect], file: str = "") -> Adopted:
    active = [known[name].at(**{key: v.value for key, v in values.items()}) for name, values in stated.items()]
    return Adopted(tuple(active), stated, file)


def write_adopted(path: Path, adopted: Adopted, header: Sequence[str]) -> None:
    """Write a file that :func:`read_effects` reads as it is; ``header`` is put first, as comments.

    The file appears whole or not at all.
    """
    lines = [f"# {line}".rstrip() for line in header]
    for active in adopted.effects:
        lines += ["", f"[{active.effect.name}]"]
        stated = (adopted.stated or {}).get(active.effect.name, {})
        parameters = [p for p in active.effect.parameters if p.name in stated]
        lines += [f'{p.name} = "{_text(stated[p.name], p.unit)}"' for p in parameters]
    with atomic(path) as scratch:
        scratch.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _text(value: Value, unit: str) -> str:
    """A value in full, so that what is read is what was written."""
    spread = "" if value.std is None else f" +/- {value.std!r}"
    return f"{value.value!r}{spread} {'' if unit == '-' else unit}".strip()
