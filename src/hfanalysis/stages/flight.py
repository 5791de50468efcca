"""flight: the rocket's flight on the measured thrust, with bands, and engine files for flight simulators.

Reads ``ingest.h5``, ``health.json`` and, where they are there, ``segments.json`` and ``calibration.json``; writes
``flight.json``, ``flight.h5``, ``TEST.eng``, ``TEST_static.eng`` and ``TEST.rse``.
"""

from __future__ import annotations

from hfanalysis.errors import AbsentError
from hfanalysis.flight.winds import GUST_SEEDS, WINDS
from hfanalysis.stages.base import Context, Stage


def run(context: Context) -> None:
    """Fly the test's rocket."""
    from hfanalysis.inference.adopted.corrected_log import corrected
    from hfanalysis.inference.adopted.effects import read_adopted
    from hfanalysis.measured_flight.firing import firing
    from hfanalysis.measured_flight.held import in_winds
    from hfanalysis.measured_flight.motor import export, rocketpy
    from hfanalysis.measured_flight.product import fly_measured, product, write_histories
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.products.segments import Segments

    definition = context.definition
    if definition.rocket is None:
        raise AbsentError(f"test {context.id}: test.toml has no [rocket] to fly")
    adopted, segments = read_adopted(context.root, definition), context.read(Segments).fired
    # physics that was adopted is in the measured thrust; what sensors add to it is taken off
    log = corrected(context.log(), segments.t_open.value or 0.0, adopted.acting)
    calibration = None if "calibrate" in context.absent else context.read(Calibration)
    seed, shots = int(context.parameter("seed")), bool(context.parameter("shot_to_shot"))
    flown = firing(log, segments, calibration, definition, bool(context.parameter("raw_thrust")), seed)
    flights = int(context.parameter("flights"))
    found = fly_measured(flown, definition.rocket, flights, seed, context.progress, shots)
    winds, seeds = context.parameter("winds"), int(context.parameter("gust_seeds"))
    stable = in_winds(flown, definition, winds, seeds, found.ascent.end[0] + 5.0, context.progress)
    files = export(found, definition, stable)
    context.scratch("{test}.eng").write_text(files.eng, encoding="utf-8")
    context.scratch("{test}_static.eng").write_text(files.static_eng, encoding="utf-8")
    context.scratch("{test}.rse").write_text(files.rse, encoding="utf-8")
    context.scratch("{test}_rocketpy.py").write_text(rocketpy(found, definition, stable, files), encoding="utf-8")
    write_histories(context.scratch("flight.h5"), found, stable, context.provenance())
    context.write(product(found, definition.rocket, stable).but(effects=adopted.product(), warnings=flown.warnings))


STAGE = Stage(
    name="flight",
    needs=("ingest", "health", "segment"),
    wants=("calibrate",),
    products=("flight.json", "flight.h5", "{test}.eng", "{test}_static.eng", "{test}.rse", "{test}_rocketpy.py"),
    run=run,
    parameters={
        "flights": 4000,
        "seed": 1,
        "raw_thrust": False,
        "winds": list(WINDS),
        "gust_seeds": GUST_SEEDS,
        "shot_to_shot": False,
    },
    least={"flights": 10, "seed": 0, "winds": 0.0, "gust_seeds": 1},
)
