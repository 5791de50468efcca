"""ingest: the raw log, as the logger wrote it, on canonical channels in SI with quality flags per sample.

Reads the raw files; writes ``ingest.h5`` and, for who wants to know what it holds without opening it, ``ingest.json``.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Ingest the raw files of the test."""
    from hfanalysis.record.ingest import ingest
    from hfanalysis.record.log import read_log
    from hfanalysis.record.summary import summary

    ingest(context.definition, context.scratch("ingest.h5"), context.progress)
    context.write(summary(read_log(context.scratch("ingest.h5"))))


STAGE = Stage(name="ingest", needs=(), products=("ingest.h5", "ingest.json"), run=run, adopts=False)
