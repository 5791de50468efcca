"""hfa table: every quantity of some tests as one tidy table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hfanalysis.cli.exit_status import put, tell
from hfanalysis.errors import AbsentError
from hfanalysis.products import tidy
from hfanalysis.products.tidy import Row
from hfanalysis.stages.open_test import PROCESSED


def table(tests: Sequence[str], root: Path, out: Path | None, write: Path | None, archive: Path | None = None) -> None:
    """Of these tests (none named: all that have products, and what the campaign says; or all of an ``archive``) to
    ``write``, else as CSV to standard output. Nothing is run for it."""
    rows = _made(tests, root, out) if archive is None else _archived(archive, tests)
    if write is None:
        put(tidy.csv_text(rows))
    else:
        tidy.write(write, rows)
        tell(f"{write}: {len(rows)} quantities of {len({row['test'] for row in rows if row['test']})} tests")


def _made(tests: Sequence[str], root: Path, out: Path | None) -> list[Row]:
    folder = out if out is not None else root / PROCESSED
    named = list(tests) or sorted(path.parent.name for path in folder.glob("*/segments.json"))
    rows = tidy.rows_of_campaign(folder, named) if not tests else [
        row for test in named for row in tidy.rows_of_test(folder / test)
    ]  # fmt: skip
    if not rows:
        raise AbsentError(f"{folder}: no products of {', '.join(named) or 'any test'}; hfa run TEST makes them")
    return rows


def _archived(path: Path, tests: Sequence[str]) -> list[Row]:
    from hfanalysis.archive.reading import Archive

    with Archive(path) as kept:
        return [row for test in tests or kept.tests for row in kept.rows(test)]
