"""calibrate: the injector coefficient, the feed loss, the vapour's polytropic exponent and the fuel's regression.

Reads ``ingest.h5`` and ``segments.json``; writes ``calibration.json``.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Calibrate the tank of the test, then the regression with that tank's flow."""
    from hfanalysis.calibrate.of_test import regress
    from hfanalysis.calibrate.tank import calibrate
    from hfanalysis.segment.phases import Segments
    from hfanalysis.testdata.log import read_log

    log = read_log(context.product("ingest.h5"))
    segments = Segments.from_json(context.read_json("segments.json"))
    context.progress("repeating the calibration with drawn inputs", None)
    result = calibrate(log, segments, context.definition, int(context.parameter("samples")))
    context.progress("fitting the regression", None)
    regression = regress(log, segments, context.definition, result)
    context.write_json(
        "calibration.json", {**regression.quantities, **result.to_json(), "regression": regression.about}
    )


STAGE = Stage(
    name="calibrate",
    needs=("ingest", "segment"),
    products=("calibration.json",),
    run=run,
    parameters={"samples": 400},
)
