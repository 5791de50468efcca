"""calibrate: the injector coefficient, the feed loss, the vapor's polytropic exponent and the fuel's regression.

Reads ``ingest.h5``, ``health.json`` and ``segments.json``; writes ``calibration.json``, the calibration with the
adopted effects acting, and ``base_calibration.json``, that of the base model, which a diagnosis starts from. Without
adopted effects they are the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hfanalysis.errors import AbsentError
from hfanalysis.stages.base import BASE, Context, Stage

if TYPE_CHECKING:
    from hfanalysis.engine.effect import Active
    from hfanalysis.products.calibration import Calibration


def run(context: Context) -> None:
    """Calibrate the test's tank, then the regression with that tank's flow; with adopted effects all together."""
    from hfanalysis.inference.adopted.effects import read_adopted

    adopted = read_adopted(context.root, context.definition)
    base = _calibration(context, ())
    found = _with_effects(context, base, adopted.acting) if adopted.acting else base
    context.write(base.but(effects=()), BASE + found.file)
    context.write(found.but(effects=adopted.product()))


def _with_effects(context: Context, base: Calibration, effects: Sequence[Active]) -> Calibration:
    """The same with adopted effects; where one acts on the engine, its constants are fitted together."""
    from hfanalysis.calibrate.joint_fit import fitted_together
    from hfanalysis.calibrate.narrow_port import with_stated_tap
    from hfanalysis.inference.subject import Subject
    from hfanalysis.products.segments import Segments

    found = _calibration(context, effects)
    if all(active.effect.of_sensor for active in effects):
        return found
    context.progress("fitting all constants together, adopted effects in", None)
    segments = context.read(Segments).fired
    log, definition = context.believed()
    subject = Subject(log, segments, base, definition)
    try:
        return fitted_together(subject, with_stated_tap(definition, effects), found)
    except AbsentError as missing:
        alone = f"constants were found one by one, not together with the adopted effects: {missing}"
        return found.but(warnings=(*found.warnings, alone))


def _calibration(context: Context, effects: Sequence[Active]) -> Calibration:
    """The content of calibration.json with these effects acting."""
    from hfanalysis.calibrate.facts import held_against
    from hfanalysis.calibrate.fuel_law import contradiction, regress
    from hfanalysis.calibrate.tank import calibrate
    from hfanalysis.products.segments import Segments

    segments = context.read(Segments).fired
    log, definition = context.believed()
    if effects:
        from hfanalysis.inference.adopted.corrected_log import corrected

        log = corrected(log, segments.t_open.value or 0.0, effects)
    context.progress("repeating the calibration with drawn inputs", None)
    result = calibrate(log, segments, definition, int(context.parameter("samples")), effects)
    context.progress("fitting the regression", None)
    found = result.with_law(regress(log, segments, definition, result, effects))
    if said := contradiction(definition, found):
        found = found.but(warnings=(*found.warnings, said))
    return held_against(log, segments, definition, found)


STAGE = Stage(
    name="calibrate",
    needs=("ingest", "health", "segment"),
    products=("calibration.json", "base_calibration.json"),
    run=run,
    parameters={"samples": 400},
    least={"samples": 10},
)
