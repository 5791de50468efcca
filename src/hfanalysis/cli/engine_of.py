"""hfa engine: an engine file from a calibrated test."""

from __future__ import annotations

from pathlib import Path

from hfanalysis.cli.exit_status import tell
from hfanalysis.cli.perform import bring
from hfanalysis.cli.request import Request
from hfanalysis.errors import InputError

FOLDER = "engines"
"""Where in a root engine files are."""


def engine(request: Request, stand: str | None, flight: bool, out: Path | None) -> None:
    """Bring the test up to validate and write its engine file; what is left out is told."""
    context = bring("validate", request)
    from hfanalysis.interface.of_test import engine_of_test
    from hfanalysis.simulation import commented, of_test

    path = out or request.root / FOLDER / f"{request.test}{'.flight' if flight else ''}.toml"
    written = of_test.text_of(engine_of_test(context, stand), path.absolute(), flight)
    try:
        commented.write(path, written.text)
    except OSError as error:
        raise InputError(f"--out {path}: cannot be written ({error.strerror}); expected a file's name") from None
    for text in written.left_out:
        tell(f"left out: {text}")
    if not request.quiet:
        tell(f"{path}: written; next: hfa simulate {path}")
