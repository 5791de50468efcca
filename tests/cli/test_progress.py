"""The spinner shows only what takes its time."""

from __future__ import annotations

import io
import time

from rich.console import Console

from hfanalysis.cli.progress import spinner


def said(patience: float, lasting: float) -> str:
    console = Console(file=io.StringIO(), force_terminal=True, width=80)
    with spinner("HF5", console, patience) as progress:
        progress("reading log.csv", 0.5)
        time.sleep(lasting)
    return console.file.getvalue()  # type: ignore[attr-defined, no-any-return]


def test_nothing_shows_for_what_is_quick() -> None:
    assert "reading" not in said(patience=5.0, lasting=0.0)


def test_what_takes_long_says_what_it_is_doing() -> None:
    assert "HF5: reading log.csv" in said(patience=0.01, lasting=0.4)
