"""hfa engine: an engine file from a calibrated test."""

from __future__ import annotations

from pathlib import Path

from hfanalysis.cli.exit_status import tell
from hfanalysis.cli.request import Request
from hfanalysis.cli.watch import watch


def engine(request: Request, stand: str | None, flight: bool, out: Path | None) -> None:
    """Bring the test up to validate and write its engine file; what is left out is told."""
    with watch(request.test, request.quiet) as progress:
        from hfanalysis.interface.of_test import engine_file

        path, left_out = engine_file(request.test, request.root, stand=stand, flight=flight, out=out, progress=progress)
    for text in left_out:
        tell(f"left out: {text}")
    if not request.quiet:
        tell(f"{path}: written; next: hfa simulate {path}")
