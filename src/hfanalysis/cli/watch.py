"""What people see of a command while it works."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

from hfanalysis.progress import Progress, silent, watching_compiler


@contextmanager
def watch(name: str, quiet: bool) -> Iterator[Progress]:
    """A spinner on standard error for what takes over two seconds, at a terminal only."""
    if quiet or not sys.stderr.isatty():
        yield silent
        return
    from hfanalysis.cli.progress import spinner

    with spinner(name) as progress, watching_compiler(partial(_compiles, progress)):
        yield progress


def _compiles(progress: Progress, count: int) -> None:
    progress(f"compiling the numerical code, once ({count} functions)", None)
