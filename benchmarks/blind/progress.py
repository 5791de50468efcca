"""How far a run is, and how much time is left: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Protocol

from .folder import DONE, Note


class Display(Protocol):
    """Told of every case that ends."""

    def done(self, note: Note) -> None:
        """One more."""


def clock(seconds: float) -> str:
    """A duration for people.

    >>> clock(59.6), clock(3725)
    ('1 min', '1 h 2 min')
    """
    minutes = round(seconds / 60.0)
    if minutes < 1:
        return f"{seconds:.0f} s"
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


class Lines:
    """Plain lines on standard error: one every ``every`` cases, and one for each that fails."""

    def __init__(self, total: int, every: int) -> None:
        self.total, self.every, self.started = total, every, monotonic()
        self.counts: Counter[str] = Counter()

    def done(self, note: Note) -> None:
        """Say so now and then."""
        self.counts[note.status] += 1
        if note.status != DONE:
            self._say(f"{note.id}: {note.status}: {note.message}")
        number = self.counts.total()
        if number % self.every == 0 or number == self.total:
            left = (monotonic() - self.started) / number * (self.total - number)
            failed = number - self.counts[DONE]
            self._say(f"{number}/{self.total} diagnosed, {failed} without success, {clock(left)} to go")

    @staticmethod
    def _say(text: str) -> None:
        print(text, file=sys.stderr, flush=True)


class Bar:
    """A bar with the time left."""

    def __init__(self, bar: object, task: object) -> None:
        self._bar, self._task = bar, task

    def done(self, note: Note) -> None:
        """Move on; what fails stays on the screen."""
        if note.status != DONE:
            self._bar.console.print(f"{note.id}: {note.status}: {note.message}", markup=False)  # type: ignore[attr-defined]
        self._bar.update(self._task, advance=1, description=note.id)  # type: ignore[attr-defined]


@contextmanager
def display(total: int, every: int) -> Iterator[Display]:
    """A bar where there is a terminal, else lines."""
    if not sys.stderr.isatty():
        yield Lines(total, every)
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(),
               TextColumn("left"), TimeRemainingColumn())  # fmt: skip
    # a case takes seconds: the speed is that of the last ten minutes, not of half a minute
    with Progress(*columns, console=Console(stderr=True), speed_estimate_period=600.0) as bar:
        yield Bar(bar, bar.add_task("diagnosing", total=total))
