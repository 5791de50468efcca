"""Small pieces of HTML: numbers that know both systems of units, tables, badges. Everything put in is escaped."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

from markupsafe import Markup, escape

from hfanalysis.health.reasons import Doubt, marked
from hfanalysis.quantity import DOUBTED, IDENTIFIED, UNPHYSICAL, Quantity
from hfanalysis.report.names import plain
from hfanalysis.sentences import Quoted, Text
from hfanalysis.wording.numbers import MINUS, Shown, decimals_for, fixed, in_words, shown, tidy
from hfanalysis.wording.scales import scale, superscript

_NEGATIVE, _POWER = re.compile(r"(?<![\w.)])-(?=\d)"), re.compile(r"(?<=[A-Za-z)])\^(-?\d)(?![\d.])")

_KEY = re.compile(r"\[[a-z]+(?:[._][a-z_]+)*\](?: [a-z]+(?:_[a-z]+)+)?")
"""A section of test.toml in a sentence, with a key of it."""


def both(si: str, team: str, style: str = "", value: float | None = None, unit: str = "") -> Markup:
    """Text in both systems of units: SI's shows, the page's script changes it. ``value`` is the number in ``unit``
    [SI].
    """
    if si == team and value is None and not style:
        return escape(si)
    known = "" if value is None else Markup(' data-value="{}" data-unit="{}"').format(repr(float(value)), unit)
    css = Markup(' class="{}"').format(style) if style else ""
    texts = Markup(' data-si="{}" data-team="{}"').format(si, team) if si != team else ""
    return Markup("<span{}{}{}>{}</span>").format(css, known, texts, si)


def amount(value: float | None, unit: str, digits: int = 4, difference: bool = False) -> Markup:
    """A ``value`` without uncertainty, in ``unit`` [SI]; ``difference`` for those that no zero point concerns."""
    if value is None:
        return Markup("–")
    texts = []
    for system in ("si", "team"):
        found = scale(unit, system)
        number = found.factor * value if difference else found(value)
        texts.append(f"{tidy(number, digits)} {found.unit}".strip())
    return both(texts[0], texts[1], "number", value, unit)


def switchable(words: str) -> Markup:
    """A sentence of a product as pages are set, the quantities that it knows ready for the other system of units."""
    return _with_keys(_switchable(plain(words)))


def _with_keys(words: Markup) -> Markup:
    """The text with keys of test.toml set as code; it is escaped already."""
    return Markup(_KEY.sub(r"<code>\g<0></code>", str(words)))


def _switchable(words: str) -> Markup:
    known = words.quoted if isinstance(words, Text) else {}
    pieces = {_set(piece): (piece, quantity) for piece, quantity in known.items() if _converts(piece, quantity)}
    if not pieces:
        return escape(_set(words))
    longest_first = sorted(map(re.escape, pieces), key=len, reverse=True)
    parts = re.split(rf"(?<![\w.−-])({'|'.join(longest_first)})(?!\w)", _set(words))
    return Markup("").join(_converted(part, *pieces[part]) if part in pieces else escape(part) for part in parts)


def _set(words: str) -> str:
    """With real minus signs and superscripts."""
    return _NEGATIVE.sub(MINUS, _POWER.sub(lambda found: superscript(int(found[1])), words))


def _converts(piece: str, quantity: Quoted) -> bool:
    """Whether it is said in a unit that the systems of units have two of."""
    si, team = (scale(quantity.unit, system) for system in ("si", "team"))
    return si != team and piece.endswith(f" {si.unit}")


def _converted(shown: str, piece: str, quantity: Quoted) -> Markup:
    """A quantity, and what it is uncertain by if that is there, in the other unit as well, no finer than it was."""
    si, team = (scale(quantity.unit, system) for system in ("si", "team"))
    if quantity.std:
        spread = team.factor * quantity.std
        decimals = decimals_for(team(quantity.value), spread)
        return both(shown, f"{fixed(team(quantity.value), decimals)} ± {fixed(spread, decimals)} {team.unit}")
    digits = sum(c.isdigit() for c in piece.removesuffix(si.unit))
    return both(shown, f"{tidy(team(quantity.value), max(3, digits))} {team.unit}")


def value(quantity: Quantity, name: str = "", std_last: bool = False) -> Markup:
    """A quantity [SI] with its standard deviation and unit; ``std_last`` puts the deviation behind the unit."""
    si, team = _shown(quantity, name)
    number = both(si.value, team.value, "number", quantity.value, quantity.unit)
    std = Markup(" ") + both(f"± {si.std}", f"± {team.std}", "std") if si.std else Markup()
    unit = Markup(" ") + both(si.unit, team.unit, "unit") if si.unit or team.unit else Markup()
    if std and si.unit.startswith("×") and not std_last:
        number, std = Markup("(") + number, std + Markup(")")
    rest = unit + std if std_last else std + unit
    return Markup('<span class="quantity">{}{}</span>').format(number, rest)


def interval(quantity: Quantity, name: str = "") -> Markup:
    """Its 95 % interval [SI], shown in both systems of units."""
    si, team = _shown(quantity, name)
    return both(si.interval, team.interval)


def _shown(quantity: Quantity, name: str) -> tuple[Shown, Shown]:
    return shown(quantity, "si", name), shown(quantity, "team", name)


def remark(quantity: Quantity, known: Sequence[Doubt]) -> Markup:
    """Why it is as it is, or why it is not there: what its channels are doubted for by the numbers of the ``known``
    reasons, which the page says once.
    """
    numbers, rest = marked(quantity, known)
    return Markup(" ").join(filter(None, (marks(numbers), switchable(rest))))


def judged(quantity: Quantity, known: Sequence[Doubt]) -> Markup:
    """The remark, after a badge where the number is doubted: for tables without a column of verdicts."""
    badge = verdict(DOUBTED) + Markup(" ") if quantity.verdict == DOUBTED else Markup()
    return badge + remark(quantity, known)


def marks(numbers: Iterable[int]) -> Markup:
    """The numbers of reasons, each a link to where the page says it."""
    link = Markup('<a class="mark" href="#{0}" aria-label="reason {1}">[{1}]</a>')
    return Markup(" ").join(link.format(reason_id(number), number) for number in numbers)


def reason_id(number: int) -> str:
    """Where on the page the reason of that number is said."""
    return f"reason-{number}"


def symbol(name: str) -> Markup:
    """A quantity's symbol, with its subscript where it has a short head."""
    head, _, tail = name.partition("_")
    if len(head) > 2:
        return Markup('<span class="name">{}</span>').format(name)
    sub = Markup("<sub>{}</sub>").format(tail.replace("_", " ")) if tail else ""
    return Markup('<span class="symbol">{}{}</span>').format(head, sub)


def symbol_and_words(name: str) -> Markup:
    """The symbol, where it is one, and the name in words."""
    words = in_words(name)
    if len(name.partition("_")[0]) > 2:
        return Markup('<span class="words">{}</span>').format(words)
    return Markup('{} <span class="words">{}</span>').format(symbol(name), words)


MARKS = {"good": "✓", "doubt": "?", "open": "?", "bad": "✕", "sensor": "!"}
"""Signs that say without color what a color says."""


def mark(verdict: str) -> str:
    """The class of a verdict for the style sheet."""
    return {IDENTIFIED: "good", UNPHYSICAL: "bad", DOUBTED: "doubt"}.get(verdict, "open")


def verdict(text: str) -> Markup:
    """A verdict as a badge: sign, word and color."""
    if not text:
        return Markup()
    kind = mark(text)
    badge = Markup('<span class="verdict {}"><span aria-hidden="true">{}</span> <span class="long">{}</span></span>')
    return badge.format(kind, MARKS[kind], text)


def table(
    name: str, caption: str | Markup, columns: Sequence[str], rows: Iterable[Sequence[Any]], sorts: bool = False
) -> Markup:
    """A table that scrolls by itself where it is too wide; a column whose head starts with ">" is aligned right.

    ``sorts``: the reader puts its rows in the order of any column, by :func:`sorted_by` where a cell has it.
    """
    right = [column.startswith(">") for column in columns]
    heads = Markup().join(
        Markup('<th scope="col"{}>{}</th>').format(_right(is_right), column.lstrip(">"))
        for column, is_right in zip(columns, right, strict=True)
    )
    body = Markup("\n").join(_row(row, right) for row in rows)
    frame = Markup(
        '<div class="scroll" tabindex="0" role="region" aria-label="{}: table"><table{}>'
        "<caption><span>{}</span></caption><thead><tr>{}</tr></thead><tbody>\n{}\n</tbody></table></div>"
    )
    return frame.format(name, Markup(' class="sorts"') if sorts else Markup(), caption, heads, body)


def sorted_by(number: float, shown: Markup) -> Markup:
    """What is ``shown`` in a cell, with the number by which its column is sorted."""
    return Markup('<span data-by="{}">{}</span>').format(f"{number:.8g}", shown)


def _row(cells: Sequence[Any], right: Sequence[bool]) -> Markup:
    first, *others = cells
    head = Markup('<tr><th scope="row"{}>{}</th>').format(_right(right[0]), first)
    rest = (Markup("<td{}>{}</td>").format(_right(r), cell) for cell, r in zip(others, right[1:], strict=True))
    return head + Markup().join(rest) + Markup("</tr>")


def _right(is_right: bool) -> Markup:
    return Markup(' class="r"') if is_right else Markup()


def paragraph(text: str | Markup, style: str = "note") -> Markup:
    """A paragraph."""
    return Markup('<p class="{}">{}</p>').format(style, text)


def bullets(texts: Iterable[str | Markup], style: str) -> Markup:
    """A list."""
    items = Markup().join(Markup("<li>{}</li>").format(text) for text in texts)
    return Markup('<ul class="{}">{}</ul>').format(style, items)


def seconds(time: float, decimals: int = 2) -> str:
    """An instant [s] of a chart."""
    return f"{fixed(time, decimals)} s"
