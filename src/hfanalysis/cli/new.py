"""``hfa new``: what a log shows, at the terminal, and the draft made of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.table import Table
from rich.text import Text

from hfanalysis.cli.asking import edited
from hfanalysis.cli.paper import paper
from hfanalysis.drafting.document import plain
from hfanalysis.drafting.guesses import Judged
from hfanalysis.drafting.new import NewTest, new_test
from hfanalysis.drafting.picture import strips
from hfanalysis.drafting.survey import Surveyed

STRIP = 24
"""Letters of a column's curve at the terminal [letters]."""


def new(root: Path, test: str, logs: Sequence[Path], edit: bool) -> None:
    """Draft a test from its logs, and show what was seen."""
    made = new_test(root, test, logs, edited) if edit else new_test(root, test, logs)
    console = paper()
    console.print(columns(made.found))
    for line in summary(test, made):
        console.print(Text(line), soft_wrap=True)


def columns(found: Surveyed) -> Table:
    """Every column: its curve, what it does, what it is taken for."""
    table = Table(box=None, pad_edge=False, show_header=True, header_style="dim")
    for name in ("column", "rate", "begins at", "least", "largest", "over the log", "taken for"):
        table.add_column(name, justify="right" if name in ("rate", "begins at", "least", "largest") else "left",
                         no_wrap=name not in ("column", "taken for"))  # fmt: skip
    several = len(found.files) > 1
    for one in found.columns:
        table.add_row(*_row(found, one, several))
    return table


def _row(found: Surveyed, one: Judged, several: bool) -> Iterator[Text]:
    column, shape = one.column, one.shape
    where = f"{Path(column.file).stem}: " if several else ""
    yield Text(plain(where + column.shown))
    yield Text(f"{one.rate:g} Hz" if one.rate else "")
    for level in (shape.rest, column.least, column.largest):
        yield Text(f"{level:.4g}" if level == level else "")
    yield Text(strips(column.values, STRIP))
    yield Text(plain(taken_for(found, one)))


def taken_for(found: Surveyed, one: Judged) -> str:
    """The channel that a column is taken for; what it may be, with a question mark; or what it is not."""
    guess = found.guess(one)
    if guess is not None:
        return f"{guess.channel} [{guess.unit}]" if guess.unit else guess.channel
    if one.best is not None:
        return f"{one.best.channel}{f' in {one.best.unit}' if one.best.unit else ''}? {one.shape.words}"
    return one.remark or one.shape.words


def summary(test: str, made: NewTest) -> Iterator[str]:
    """What was made, what is open, and what to do next."""
    found = made.found
    for file in found.files:
        stamps = found.stamps[file.name]
        if stamps.column is not None:
            why = f" ({plain(stamps.reason)})" if stamps.reason else ""
            yield f"time of {plain(file.name)}: {plain(stamps.column.shown)} in {stamps.unit}{why}"
        elif not any(column.stamps for column in file.columns):
            known = f"none; {stamps.rate}, by a name" if stamps.rate else "none recognized"
            yield f"time of {plain(file.name)}: {known}"
    open_ones = [one for one in found.columns if found.guess(one) is None]
    guessed = sum(bool(one.guesses) for one in open_ones)
    yield (
        f"of {len(found.columns)} columns {len(found.chosen)} taken for channels, "
        f"{guessed} with a guess for you to confirm, {len(open_ones) - guessed} not recognized"
    )
    yield f"{made.picture}: every column drawn"
    yield f"{made.path}: drafted; complete what is marked there, then: hfa calibrate {test}"
