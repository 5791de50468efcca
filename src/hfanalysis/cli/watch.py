"""What people see of a command while it works."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from hfanalysis.progress import Progress, silent


@contextmanager
def watch(name: str, quiet: bool) -> Iterator[Progress]:
    """A spinner on standard error for what takes over two seconds, at a terminal only."""
    if quiet or not sys.stderr.isatty():
        yield silent
        return
    from hfanalysis.cli.progress import spinner

    with spinner(name) as progress:
        yield progress
