"""ingest: the raw log, as the logger wrote it, on canonical channels in SI with quality flags per sample.

Reads the raw files; writes ``ingest.h5``.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Ingest the raw files of the test."""
    from hfanalysis.testdata.ingest import ingest

    ingest(context.definition, context.scratch("ingest.h5"))


STAGE = Stage(name="ingest", needs=(), products=("ingest.h5",), run=run)
