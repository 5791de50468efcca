"""What was found in the logs, written down as a test.toml that loads."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from importlib.resources import files

import numpy as np

from hfanalysis.drafting.clocks import Stamps
from hfanalysis.drafting.columns import Column, LogFile
from hfanalysis.drafting.guesses import Guess, Judged
from hfanalysis.drafting.labels import dimension
from hfanalysis.drafting.survey import Surveyed
from hfanalysis.record.channels import CANONICAL, LONG_NAMES
from hfanalysis.units import is_gauge

_DULL = ("constant", "state", "clock", "empty")
"""Shapes of columns that say nothing."""
SELDOM = 0.2
"""Share of the readings below which a reading may stand for none: what is there more often is the column's rest."""
MANY = 10
"""Different readings below which none is a code among them."""
CODE_APART = 0.15
"""Of the range of all other readings: how far from them a reading is that stands for none. Evidence: -10 beside 0 to
48 bar is; the level that a valve or a saturated sensor holds is not."""
_NAME, _RESERVED = re.compile(r"[A-Za-z][A-Za-z0-9_]*"), re.compile(r"time(_\d+)?|.*_(flags|raw)|name")
"""What a channel may be called, and what it may not."""
SHOWN = 3
"""Guesses of a column that are written down."""
_COLD = re.compile(r"cold|\bcf\d*\b|_cf\d*", re.IGNORECASE)
_WATER = re.compile(r"water|hydro", re.IGNORECASE)
_HEAD = """\
# What is known about test {id}. Drafted from {logs}: check what it says, complete it.
# Every physical value is a string with its unit, optionally with one standard deviation: "8.35 +/- 0.05 kg".
schema = 1

[test]
id = {id_text}
kind = "{kind}"               # hot_fire | cold_flow | water_flow: {why}
source = "measured"             # measured | replica | synthetic
# description = "what was tested, and how it went"
# date = 2022-04-03
# stand = "name of the test stand"
# engine = "name of the engine"   # stands on top of its page

[log]
{log}
# firing = 2                    # which of several in the log; without it the largest

# Channels whose column says what it is and in which unit. Optional for every one: accuracy = "2 psi", one standard
# deviation of its bias (else a class default is used and marked), scale and offset (applied before the unit),
# gauge = true, missing = [999.0] (readings that stand for none), trust = "why it is right, whatever its health seems".
"""

_OFTEN = {
    "p_run": ('# zero = "ambient"   # if it is open to the air before ignition',),
    "p_chamber": ('# zero = "ambient"   # if it is open to the air before ignition',),
    "thrust": ('tare = "auto"   # zero from the quiet time before ignition and after the burn; none if already done',),
}
"""What is often needed for a channel, beside column and unit."""


def document(test_id: str, found: Surveyed) -> str:
    """The text of a commented test.toml."""
    return _HEAD.format(
        id=plain(test_id),
        logs=" and ".join(plain(file.name) for file in found.files),
        id_text=quoted(test_id),
        log="\n".join(_log(found)),
        **_kind([test_id, *(file.name for file in found.files)]),
    ) + "\n".join([*_channels(found), "", (files("hfanalysis.drafting") / "sections.toml").read_text(encoding="utf-8")])


def _kind(names: Sequence[str]) -> dict[str, str]:
    for kind, words in (("water_flow", _WATER), ("cold_flow", _COLD)):
        said = next((name for name in names if words.search(name)), None)
        if said is not None:
            return {"kind": kind, "why": f"by the name {plain(said)}, check"}
    return {"kind": "hot_fire", "why": "check"}


def plain(text: str) -> str:
    """A text that may stand in a comment: on one line, nothing in it that cannot be seen."""
    return "".join(mark if mark.isprintable() else "?" for mark in " ".join(text.split()))


def quoted(text: str) -> str:
    """A TOML string: JSON's escapes are TOML's."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def key(column: Column) -> str:
    """A column as a channel's table names it."""
    return quoted(column.key) if isinstance(column.key, str) else str(column.key)


def _log(found: Surveyed) -> Iterator[str]:
    """The files, and where their time stamps are."""
    times = [_time(file, found.stamps[file.name]) for file in found.files]
    if len(found.files) == 1:
        yield f"files = [{quoted(found.files[0].name)}]"
        value, remark = times[0]
        yield (f"time = {value}" if value else "# time: ") + remark
        return
    yield "files = ["
    for file, (value, remark) in zip(found.files, times, strict=True):
        time = f", time = {value}" if value else ""
        yield f"    {{ file = {quoted(file.name)}{time} }},{remark if time else ''}"
    yield "]"
    yield '# Clocks of their own are brought together by offset = "1.2 s" in a file\'s time.'


def _time(file: LogFile, stamps: Stamps) -> tuple[str, str]:
    """The value of ``time`` ("" where nothing is to be said) and a remark."""
    if any(column.stamps for column in file.columns):
        return "", "the file gives every channel its own"
    if stamps.column is not None:
        remark = f"   # {plain(stamps.reason)}" if stamps.reason else ""
        spread = ", spread = true" if stamps.stands else ""
        return f"{{ column = {key(stamps.column)}, unit = {quoted(stamps.unit)}{spread} }}", remark
    if stamps.rate:
        return f'{{ rate = "{stamps.rate}" }}', "   # as a name in the log says: check"
    there = ", ".join(quoted(plain(column.shown)) for column in file.columns[:8])
    return "", f'time = {{ column = "…", unit = "s" }}, or {{ rate = "1 kHz" }}; none recognized among {there}'


def _channels(found: Surveyed) -> Iterator[str]:
    """Tables of what is sure, guesses of what is not, and the rest."""
    several = len(found.files) > 1
    taken = [one for one in found.columns if found.guess(one)]
    guessed = [one for one in found.columns if not found.guess(one) and one.guesses]
    rest = [one for one in found.columns if not found.guess(one) and not one.guesses]
    for one in taken:
        guess = found.guess(one)
        assert guess is not None
        yield from (*about(one), f"#   {plain('; '.join(guess.reasons))}", *table(one.column, guess, several), "")
    if not taken:
        yield from stand_in(found, several)
    if guessed:
        yield from ("# Not assigned: the log does not say enough. Each with what it may be, the likeliest first; take",
                    "# the marks off a table that is right, and complete its unit.", "")  # fmt: skip
    for one in guessed:
        marked = [f"# {line.removeprefix('# ')}" for line in table(one.column, one.guesses[0], several)]
        yield from (*about(one), *(_line(guess) for guess in one.guesses[:SHOWN]), *marked, "")
    if rest:
        yield "# Not recognized (a channel of your own name is carried through):"
        yield from (line for one in rest for line in about(one))


def about(one: Judged) -> Iterator[str]:
    """What a column is like, as a comment."""
    yield f"# {quoted(plain(one.column.shown))}: {'; '.join(facts(one))}"


def facts(one: Judged) -> list[str]:
    """A column's rate, where it begins, its extremes, its shape, and what else there is to say."""
    column, shape = one.column, one.shape
    unit = f" {plain(column.unit)}" if column.unit else ""
    rate = [f"{one.rate:g} samples a second"] if one.rate else []
    level = (
        []
        if shape.word == "empty"
        else [f"begins at {shape.rest:.4g}, {column.least:.4g} to {column.largest:.4g}{unit}"]
    )
    if shape.word == "constant":
        level = [f"{shape.rest:.6g}{unit} throughout"]
    words = [] if one.remark and shape.word == "empty" else [shape.words]
    return [*rate, *level, *words, *([plain(one.remark)] if one.remark else [])]


def _line(guess: Guess) -> str:
    others = f" (or {', '.join(guess.units)})" if guess.units else ""
    unit = f" in {plain(guess.unit + others)}" if guess.unit else ""
    return f"#   {guess.channel}{unit}? {plain('; '.join(guess.reasons))}"


def table(column: Column, guess: Guess, several: bool) -> list[str]:
    """A channel's table."""
    lines = [
        f"[channels.{guess.channel}]   # {LONG_NAMES[guess.channel]}: check",
        f"column = {key(column)}",
        *([f"file = {quoted(column.file)}"] if several else []),
        f"unit = {quoted(guess.unit)}{_remark(column, guess)}" if guess.unit or guess.channel != "valve" else "",
        *_gauge(guess),
        *(
            f"# missing = [{code!r}]   # {count} readings of exactly that, far from all others"
            for code, count in codes(column)
        ),
        *_OFTEN.get(guess.channel, ()),
    ]
    return [line for line in lines if line]


def _remark(column: Column, guess: Guess) -> str:
    if not column.unit:
        return "   # not stated in the log: check"
    if guess.unit != column.unit:
        return f"   # the log says {plain(quoted(column.unit))}, which is so meant for a {CANONICAL[guess.channel]}"
    if guess.channel.startswith("p_") and not guess.gauge and not re.search(r"[ag]\)?$", column.unit):
        return "   # absolute; add gauge = true where it is not"
    return ""


def _gauge(guess: Guess) -> list[str]:
    """The open air is no vacuum: what is open to it and rests at zero counts from there."""
    unit = guess.unit.replace("(a)", "a").casefold()
    if not guess.gauge or is_gauge(guess.unit):
        return []
    if unit.endswith("a") and unit != "pa" and unit not in ("kpa", "mpa"):
        return ["# It rests near zero, where an absolute pressure cannot be in the open air: is the unit right?"]
    return ["gauge = true   # it rests at zero, where the open air is"]


def codes(column: Column) -> Iterator[tuple[float, int]]:
    """Readings that may stand for none, and how many of those looked at are so: at an end of the column, there several
    times, and far from all others.
    """
    known, counts = np.unique(column.good, return_counts=True)
    if known.size < MANY:
        return
    for end, inner, others in ((0, 1, known[1:]), (-1, -2, known[:-1])):
        far = abs(known[end] - known[inner]) > CODE_APART * float(np.ptp(others))
        if far and 1 < counts[end] < SELDOM * column.good.size:
            yield float(known[end]), int(counts[end])


def stand_in(found: Surveyed, several: bool) -> Iterator[str]:
    """A test needs a channel: a lively column that nothing is guessed of, under its own name, until one is named."""
    with_numbers = [one for one in found.columns if one.column.good.size]
    order = [bool(one.guesses) + 2 * (one.shape.word in _DULL) for one in with_numbers]
    one = with_numbers[order.index(min(order))] if with_numbers else None
    column = one.column if one else next(c for file in found.files for c in file.columns if c.good.size)
    yield "# No column says both what it is and in which unit. This one stands here so that the file can be read;"
    yield "# remove it when you have named one as a known channel (p_tank, p_run, p_chamber, thrust, m_tank ...)."
    yield from (about(one) if one else ())
    yield f"[channels.{own_name(column)}]"
    yield f"column = {key(column)}"
    if several:
        yield f"file = {quoted(column.file)}"
    if dimension(column.unit):
        yield f"unit = {quoted(column.unit)}"
    yield ""


def own_name(column: Column) -> str:
    """The name under which a column that is no known channel is carried through.

    A letter first, then letters, digits and _; its number where it has no such name.
    """
    name = re.sub(r"[^A-Za-z0-9_]+", "_", column.name).strip("_")
    if not _NAME.fullmatch(name) or _RESERVED.fullmatch(name) or name in CANONICAL:
        return f"column_{column.number}"
    return name
