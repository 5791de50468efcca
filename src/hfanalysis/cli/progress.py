"""A spinner that appears only when something takes its time."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from hfanalysis.progress import Progress as Callback

PATIENCE = 2.0
"""[s] before anything shows."""


@contextmanager
def spinner(test: str, console: Console | None = None, patience: float = PATIENCE) -> Iterator[Callback]:
    """A callback for progress; what it is told shows on standard error after ``patience`` [s]."""
    bar = Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(bar_width=24),
        TimeElapsedColumn(),
        console=console or Console(stderr=True),
        transient=True,
    )
    task = bar.add_task(test, total=None)

    def progress(text: str, fraction: float | None = None) -> None:
        bar.update(
            task, description=f"{test}: {text}", total=None if fraction is None else 1.0, completed=fraction or 0.0
        )

    timer = threading.Timer(patience, bar.start)
    timer.daemon = True
    timer.start()
    try:
        yield progress
    finally:
        timer.cancel()
        bar.stop()
