"""report: one self-contained page per test, for the people at the stand.

Reads whatever the stages before it have made; a stage that found nothing to do is named with its reason. Writes
``report.html``. The team's own limits, notes and photos redo it alone.
"""

from __future__ import annotations

from pathlib import Path

from hfanalysis.record import limits, team_notes
from hfanalysis.stages import ORDER
from hfanalysis.stages.base import Context, Stage
from hfanalysis.stages.stand import of_before


def run(context: Context) -> None:
    """Write the page of the test."""
    from hfanalysis.report.page import page
    from hfanalysis.stages.material import load

    context.scratch("report.html").write_text(page(load(context)), encoding="utf-8")


def _beside(context: Context) -> list[Path]:
    """What the page has from elsewhere than the stages: the test before, and what the team itself has laid there."""
    rules = context.root / limits.FILE
    own = [rules] if rules.is_file() else []
    return [*of_before(context), *own, *team_notes.files_of(context.definition.folder)]


STAGE = Stage(
    name="report",
    needs=("ingest", "health"),
    wants=tuple(name for name in ORDER if name not in ("ingest", "health", "report")),
    products=("report.html",),
    run=run,
    beside=_beside,
)
