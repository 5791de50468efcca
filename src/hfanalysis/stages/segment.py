"""segment: when what happens - the phases of the test, from the physics of its signals.

Reads ``ingest.h5`` and ``health.json``; writes ``segments.json``.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Find the phases of the test."""
    from hfanalysis.segment.phases import find_phases

    log, definition = context.believed()
    context.write(find_phases(log, definition, int(context.parameter("firing")) or None))


STAGE = Stage(
    name="segment",
    needs=("ingest", "health"),
    products=("segments.json",),
    run=run,
    adopts=False,
    parameters={"firing": 0},
    least={"firing": 0},
)
