"""hfa regression: a and n common to several tests, beside those of each alone."""

from __future__ import annotations

from pathlib import Path

from hfanalysis.campaign.regression import regression_of
from hfanalysis.cli.exit_status import put
from hfanalysis.errors import InputError
from hfanalysis.progress import Progress, silent


def regression(tests: list[str], root: Path, out: Path | None, as_json: bool, progress: Progress = silent) -> None:
    """Fit the tests alone and together, and show both. Raises InputError for fewer than two different tests."""
    if len(set(tests)) < 2:
        raise InputError(f"found {len(set(tests))} test; expected at least two: hfa regression TEST OTHER")
    product = regression_of(tests, root, out, progress)
    if as_json:
        from hfanalysis.products.disk import to_json

        put(to_json(product))
        return
    from hfanalysis.cli.tables import show_regression

    show_regression(product)
