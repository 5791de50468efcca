"""How a command ends: an exit status for each kind of end, and one plain message where the input is at fault."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import typer

from hfanalysis.errors import AnalysisError
from hfanalysis.interface.ending import plainly

LONGEST = 4000
"""Length of what is told in one line [characters]. Evidence: a screen holds as much."""


@contextmanager
def plain_exit() -> Iterator[None]:
    """Turn an :class:`AnalysisError` into its message and exit status; everything else passes, as a defect of ours."""
    try:
        yield
    except (AnalysisError, OSError, MemoryError) as error:
        known = plainly(error)
        if known is None:
            raise
        tell(known[1])
        raise typer.Exit(known[0]) from None
    except KeyboardInterrupt:
        tell("interrupted; products are as they were before, or complete")
        raise typer.Exit(130) from None


def tell(text: str) -> None:
    """One line for people, on standard error; of one that quotes a file at length, both ends."""
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} […] {text[-LONGEST // 2 :]}"
    print(f"hfa: {text}", file=sys.stderr)


def nobody_reads() -> None:
    """Whoever read standard output has gone (``hfa … | head``): what is still to be said goes nowhere, quietly."""
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), sys.stdout.fileno())


def put(text: str) -> None:
    """Write to standard output at once."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        nobody_reads()
