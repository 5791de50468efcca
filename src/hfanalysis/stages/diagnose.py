"""diagnose: where, when and by how much the report's model departs from the measurement, before any name.

Reads ``ingest.h5``, ``segments.json`` and ``base_calibration.json`` (the base model
is what is diagnosed, whatever has been adopted); writes ``diagnosis.json`` and ``diagnosis.h5``.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Localise what the model lacks."""
    from hfanalysis.diagnose.histories import write_histories
    from hfanalysis.diagnose.of_test import diagnose
    from hfanalysis.segment.phases import Segments
    from hfanalysis.testdata.log import read_log

    log = read_log(context.product("ingest.h5"))
    segments = Segments.from_json(context.read_json("segments.json"))
    found = diagnose(log, segments, context.read_json("base_calibration.json"), context.definition, context.progress)
    write_histories(context.scratch("diagnosis.h5"), found.localisation, context.provenance())
    context.write_json("diagnosis.json", found.product)


STAGE = Stage(
    name="diagnose",
    needs=("ingest", "segment", "calibrate"),
    products=("diagnosis.json", "diagnosis.h5"),
    run=run,
    adopts=False,
)
