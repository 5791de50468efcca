"""The one way to bring a test up to date: from Python and from the command line."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hfanalysis.errors import AbsentError
from hfanalysis.progress import Progress, silent
from hfanalysis.stages import ORDER, RUN
from hfanalysis.stages.base import Context
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

PAGES = ("report", RUN)
"""What has a page, of which the index tells."""

SPINE = ("segment", "calibrate")
"""The stages without which a run of all of them found nothing; what else is absent is told."""


def check_spine(context: Context) -> None:
    """Raises :class:`AbsentError` where a run of all stages found nothing to calibrate; its page is written still."""
    missing = [stage for stage in SPINE if stage in context.absent]
    if missing:
        raise AbsentError(context.absent[missing[0]])


def bring(
    to: str,
    root: Path,
    test: str,
    out: Path | None = None,
    *,
    force: bool = False,
    settings: Mapping[str, Any] | None = None,
    progress: Progress = silent,
) -> Context:
    """Bring a stage (or, for "run", all of them) of a test up to date, and what it needs first.

    ``out``: where products go instead of ``root/processed``; ``settings``: parameters by ``"stage.name"``. Raises
    :class:`InputError` where the input is at fault, :class:`AbsentError` where the log does not hold what was asked.
    """
    context = open_test(root, test, out, progress=progress, settings=settings)
    context = run_to(ORDER[-1] if to == RUN else to, context, force=force, whole=to == RUN)
    if to in PAGES:
        from hfanalysis.report.index import write_index

        write_index(context.out.parent)
    return context
