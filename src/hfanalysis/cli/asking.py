"""``hfa new --edit``: the columns of a log, one after the other, asked for at the terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace

from hfanalysis.drafting.document import facts, plain
from hfanalysis.drafting.guesses import Guess, Judged
from hfanalysis.drafting.labels import as_meant
from hfanalysis.drafting.picture import strips
from hfanalysis.drafting.survey import Surveyed
from hfanalysis.errors import InputError
from hfanalysis.record.channels import CANONICAL, LONG_NAMES
from hfanalysis.units import near

NONE, HELP, DONE = "-", "?", "."
"""Answers: no channel; the list of channels; leave the rest as drafted."""


def edited(found: Surveyed) -> Surveyed:
    """What was found, with every column asked for; raises :class:`InputError` where nobody answers."""
    _tell(f"Enter takes what stands in brackets, {NONE} leaves a column out, {HELP} lists the channels, {DONE} ends.")
    chosen = dict(found.chosen)
    for one in found.columns:
        if not one.column.good.size:
            continue
        at = one.column.file, one.column.number
        answer = _channel(one, chosen.get(at))
        if answer == DONE:
            break
        if answer == NONE:
            chosen.pop(at, None)
            continue
        for other in [key for key, guess in chosen.items() if guess.channel == answer and key != at]:
            chosen.pop(other)
            _tell(f"  {answer} was another column, which is left out now")
        chosen[at] = _answered(one, answer)
    return replace(found, chosen=chosen)


def _channel(one: Judged, taken: Guess | None) -> str:
    """A channel's name, or NONE or DONE."""
    offered = taken.channel if taken else NONE
    _tell(f"\n{plain(one.column.shown)}: {'; '.join(facts(one))}")
    _tell(f"  {strips(one.column.values, 60)}")
    for guess in one.guesses[:3]:
        _tell(f"  {guess.channel}? {plain('; '.join(guess.reasons))}")
    while True:
        answer = _ask(f"  channel [{offered}]: ") or offered
        if answer in (*CANONICAL, NONE, DONE):
            return answer
        for line in (
            _channels() if answer == HELP else [f"  {answer!r} is no channel{near(answer, CANONICAL)}; {HELP} lists"]
        ):
            _tell(line)


def _answered(one: Judged, channel: str) -> Guess:
    """The column as this channel, in the unit that was answered."""
    known = next((guess for guess in one.guesses if guess.channel == channel), None)
    offered = as_meant(one.column.unit, CANONICAL[channel]) or (known.unit if known else "")
    unit = "" if CANONICAL[channel] == "dimensionless" else _unit(offered, CANONICAL[channel])
    gauge = known is not None and known.gauge and unit == known.unit
    return Guess(channel, 0.0, ("as answered",), unit, certain=True, gauge=gauge)


def _unit(offered: str, dimension: str) -> str:
    while True:
        answer = _ask(f"  unit [{offered}]: ") or offered
        if meant := as_meant(answer, dimension):
            return meant
        _tell(f"  {answer!r} is no unit of {dimension}")


def _channels() -> Iterator[str]:
    yield from (f"  {name}: {LONG_NAMES[name]}" for name in CANONICAL)


def _ask(question: str) -> str:
    """A line from whoever is asked."""
    print(question, end="", file=sys.stderr, flush=True)
    line = sys.stdin.readline()
    if not line:
        raise InputError("--edit: nobody answers (the input ended); nothing was written; leave --edit out for a draft")
    return line.strip()


def _tell(text: str) -> None:
    print(text, file=sys.stderr)
