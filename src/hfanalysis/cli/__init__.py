"""The command line: ``hfa COMMAND TEST``."""

from __future__ import annotations

import errno
import gc
import io
import os
import sys

from hfanalysis.errors import InputError
from hfanalysis.processors import THREADS

INTERRUPTED = 130
"""Exit status after Ctrl-C. Source: shells' convention, 128 plus the number of the signal (2)."""

COLLECTED_AFTER = 100_000
"""Objects made and not yet freed after which Python looks for circles among them. Evidence: with its own 700, a tenth
of the time of ``hfa calibrate --force`` goes into looking through what imports leave."""


def main() -> None:
    """Run ``hfa``; the exit status tells how it ended (see the README)."""
    gc.set_threshold(COLLECTED_AFTER)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that lacks a sign must not stop an analysis
    for name in THREADS:
        os.environ.setdefault(name, "1")  # matrices are small here; it is fits that run side by side
    os.environ.pop("MPLBACKEND", None)  # of a notebook, whose packages need not be here; charts are drawn into files
    try:
        from hfanalysis.cli.app import app

        app()
    except KeyboardInterrupt:
        print("hfa: interrupted; products are as they were before, or complete", file=sys.stderr)
        sys.exit(INTERRUPTED)
    except OSError as error:
        if error.errno != errno.ENOSPC:
            raise
        print(f"hfa: {error.strerror}", file=sys.stderr)
        sys.exit(InputError.exit_status)
