"""Sentences that know which of their words are quantities.

A sentence of a product is text, and stays text in JSON. The numbers in it with a unit are put there as quantities, so
that who shows it can show them in other units::

    text("the tank is supercharged: {rest} before the opening", rest=said(72.4e5, "bar", ".1f"))
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

UNITS = {
    "bar": ("Pa", 1e5),
    "kW": ("W", 1e3),
    "g/s": ("kg/s", 1e-3),
    "%": ("1", 1e-2),
    "ms": ("s", 1e-3),
    "kJ/K": ("J/K", 1e3),
    "mm^2": ("m^2", 1e-6),
    "mm/s": ("m/s", 1e-3),
    "L": ("m^3", 1e-3),
    "g": ("kg", 1e-3),
}
"""Units of sentences that are none of SI: the SI unit, and how many of it they are. Source: definitions."""

MOST_WHOLE = 1e5
"""From which on a rounded number has a power of ten. Source: definition."""


@dataclass(frozen=True)
class Quoted:
    """A quantity in a sentence: its value in the SI ``unit``, and its standard deviation where the sentence has it."""

    value: float
    unit: str
    std: float | None = None


class Text(str):
    """A sentence, with the quantities in it by their words (``"72.4 bar"``)."""

    __slots__ = ("quoted",)
    quoted: Mapping[str, Quoted]

    def __new__(cls, words: str, quoted: Mapping[str, Quoted] | None = None) -> Text:
        made = super().__new__(cls, words)
        made.quoted = quoted or {}
        return made

    def __str__(self) -> str:
        """Itself, so that an error's message still knows its quantities."""
        return self

    def __getnewargs__(self) -> tuple[str, Mapping[str, Quoted]]:  # type: ignore[override]
        return str.__str__(self), self.quoted


def rounded(number: float, form: str) -> str:
    """A number [any unit] by its format, whole numbers of some digits without a power of ten.

    >>> rounded(2941.2, ".3g"), rounded(0.29412, ".3g")
    ('2940', '0.294')
    """
    words = f"{number:{form}}"
    return f"{float(words):.0f}" if "e+" in words and abs(number) < MOST_WHOLE else words


def said(
    value: float,
    unit: str,
    form: str = ".3g",
    std: float | None = None,
    std_form: str = ".2g",
    size: float | None = None,
) -> Text:
    """A quantity in words: ``value`` [SI], shown in ``unit`` by a format; with ± ``std`` [SI] where that is given.

    ``size``: of a unit that UNITS does not have, in SI. A number without a unit is only a word.

    >>> said(1.25e6, "bar", ".1f", 5e4, ".1f")
    '12.5 ± 0.5 bar'
    >>> said(2941.2, "N", ".3g", 130.0)
    '2940 ± 130 N'
    """
    si, factor = UNITS.get(unit, (unit, 1.0))
    factor = factor if size is None else size
    spread = "" if std is None else f" ± {rounded(std / factor, std_form)}"
    words = f"{rounded(value / factor, form)}{spread} {unit}".strip()
    quoted = {words: Quoted(float(value), si, None if std is None else float(std))}
    return Text(words, quoted if unit else {})


def text(template: str, **parts: Any) -> Text:
    """A sentence from its template, as ``str.format`` makes it; it knows the quantities of its parts."""
    return Text(template.format(**parts), quoted_in(parts.values()))


def joined(separator: str, parts: Iterable[str]) -> Text:
    """Sentences one after the other."""
    kept = list(parts)
    return Text(separator.join(kept), quoted_in(kept))


def capitalised(words: str) -> Text:
    """With a capital at its beginning."""
    return Text(words[:1].upper() + words[1:], quoted_in([words]))


def quoted_in(data: Any) -> dict[str, Quoted]:
    """All quantities in the sentences of a nested structure, by their words."""
    if isinstance(data, Text):
        return dict(data.quoted)
    if isinstance(data, str) or not isinstance(data, Iterable):
        return {}
    parts = data.values() if isinstance(data, Mapping) else () if _history(data) else data
    return {words: quantity for part in parts for words, quantity in quoted_in(part).items()}


def _history(data: Any) -> bool:
    """Whether it is a list of numbers, which may be long."""
    return isinstance(data, (list, tuple)) and bool(data) and isinstance(data[0], float)


def to_json(quoted: Mapping[str, Quoted]) -> dict[str, dict[str, Any]]:
    """As products have it."""
    return {words: asdict(quantity) for words, quantity in quoted.items()}


def from_json(data: Mapping[str, Mapping[str, Any]]) -> dict[str, Quoted]:
    """The inverse of :func:`to_json`."""
    return {words: Quoted(**quantity) for words, quantity in data.items()}


def revived(data: Any, quoted: Mapping[str, Quoted]) -> Any:
    """A nested structure whose texts know their quantities again."""
    if isinstance(data, str):
        own = {words: quantity for words, quantity in quoted.items() if words in data}
        return Text(data, own) if own else data
    if isinstance(data, Mapping):
        return {name: revived(part, quoted) for name, part in data.items()}
    if isinstance(data, list) and not _history(data):
        return [revived(part, quoted) for part in data]
    return data
