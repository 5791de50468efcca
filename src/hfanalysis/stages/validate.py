"""validate: the calibrated model against the measurement; so far the tank alone, with the measured chamber pressure in.

Reads ``ingest.h5``, ``segments.json`` and ``calibration.json``; writes ``residuals.h5`` and ``validation.json``.
"""

from __future__ import annotations

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Run the tank alone and store its residuals."""
    from hfanalysis.segment.phases import Segments
    from hfanalysis.testdata.log import read_log
    from hfanalysis.validate.residuals import gaps, write_residuals
    from hfanalysis.validate.tank_free import run_tank_free

    log = read_log(context.product("ingest.h5"))
    segments = Segments.from_json(context.read_json("segments.json"))
    residual = run_tank_free(log, segments, context.read_json("calibration.json"), context.definition)
    write_residuals(context.scratch("residuals.h5"), {"tank_free": [residual]}, context.provenance())
    context.write_json(
        "validation.json",
        {"gap": {"tank_free": gaps([residual])}, "notes": list(residual.notes), "warnings": []},
    )


STAGE = Stage(
    name="validate",
    needs=("ingest", "segment", "calibrate"),
    products=("residuals.h5", "validation.json"),
    run=run,
)
