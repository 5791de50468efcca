"""validate: the performance of the test, and the calibrated model against the measurement in three modes.

Reads ``ingest.h5``, ``health.json``, ``segments.json`` and, where there is one, ``calibration.json``; writes
``residuals.h5``, ``performance.h5`` and ``validation.json``.
"""

from __future__ import annotations

from functools import partial

from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Compare what can be compared; what cannot says why."""
    from hfanalysis.inference.adopted.effects import read_adopted
    from hfanalysis.performance.histories import write_histories
    from hfanalysis.performance.reconstruction.written import write_reconstructed
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.products.segments import Segments
    from hfanalysis.validate.residuals import write_residuals
    from hfanalysis.validate.validation import validate

    log, definition = context.believed()
    segments = context.read(Segments).fired
    absent = context.absent.get("calibrate")
    calibration = None if absent else context.read(Calibration)
    adopted = read_adopted(context.root, context.definition)
    found = validate(log, segments, definition, calibration, absent, adopted.acting)
    write_residuals(context.scratch("residuals.h5"), found.residuals, context.provenance())
    again = partial(write_reconstructed, found=found.reconstructed)
    write_histories(context.scratch("performance.h5"), found.histories, context.provenance(), again)
    context.write(found.product.but(effects=adopted.product()))


STAGE = Stage(
    name="validate",
    needs=("ingest", "health", "segment"),
    wants=("calibrate",),
    products=("residuals.h5", "performance.h5", "validation.json"),
    run=run,
)
