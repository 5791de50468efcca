"""segment: when what happens - the phases of the test, from the physics of its signals.

Reads ``ingest.h5``; writes ``segments.json``.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Find the phases of the test."""
    from hfanalysis.record.log import read_log
    from hfanalysis.segment.phases import find_phases

    log = read_log(context.product("ingest.h5"))
    context.write(find_phases(log, context.definition, int(context.parameter("firing")) or None))


STAGE = Stage(name="segment", needs=("ingest",), products=("segments.json",), run=run, adopts=False,
    parameters={"firing": 0}, least={"firing": 0},
)  # fmt: skip
