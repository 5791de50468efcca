"""calibrate: the injector coefficient, the feed loss and the vapour's polytropic exponent, with their intervals.

Reads ``ingest.h5`` and ``segments.json``; writes ``calibration.json``.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Calibrate the tank of the test."""
    from hfanalysis.calibrate.tank import calibrate
    from hfanalysis.segment.phases import Segments
    from hfanalysis.testdata.log import read_log

    log = read_log(context.product("ingest.h5"))
    segments = Segments.from_json(context.read_json("segments.json"))
    context.progress("repeating the calibration with drawn inputs", None)
    result = calibrate(log, segments, context.definition, int(context.parameter("samples")))
    context.write_json("calibration.json", result.to_json())


STAGE = Stage(
    name="calibrate",
    needs=("ingest", "segment"),
    products=("calibration.json",),
    run=run,
    parameters={"samples": 400},
)
