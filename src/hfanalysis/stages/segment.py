"""segment: when what happens - the phases of the test, from the physics of its signals.

Reads ``ingest.h5`` and ``health.json``; writes ``segments.json``.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Find the phases of the test."""
    from hfanalysis.health.usable import of_firing, zeros_of_firing
    from hfanalysis.segment.phases import find_phases

    log, definition = context.believed()
    found = find_phases(log, definition, int(context.parameter("firing")) or None)
    if (taken := found.taken) is not None:
        part = of_firing(log, taken.start, taken.end, definition)
        found = found.but(notes=(*found.notes, *zeros_of_firing(log, part)))
    context.write(found)


STAGE = Stage(
    name="segment",
    needs=("ingest", "health"),
    products=("segments.json",),
    run=run,
    adopts=False,
    parameters={"firing": 0},
    least={"firing": 0},
)
