"""calibrate: the injector coefficient, the feed loss, the vapor's polytropic exponent and the fuel's regression.

Reads ``ingest.h5``, ``health.json`` and ``segments.json``; writes ``calibration.json``, the calibration with the
adopted effects acting, and ``base_calibration.json``, that of the base model, which a diagnosis starts from. Without
adopted effects they are the same, where nobody says which end of the grain the chamber's gauge reads: the base model
takes its reading as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hfanalysis.errors import AbsentError
from hfanalysis.stages.base import BASE, Context, Stage

if TYPE_CHECKING:
    from hfanalysis.engine.effect import Active
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.record.definition import TestDefinition
    from hfanalysis.record.log import TestLog


def run(context: Context) -> None:
    """Calibrate the test's tank, then the regression with that tank's flow; with adopted effects all together."""
    from hfanalysis.calibrate.narrow_port import as_read
    from hfanalysis.inference.adopted.effects import read_adopted

    log, definition = context.believed()
    adopted = read_adopted(context.root, context.definition)
    without = _calibration(context, log, definition)
    found = _with_effects(context, log, definition, without, adopted.acting) if adopted.acting else without
    plain = as_read(definition)
    base = without if plain is definition else _calibration(context, log, plain)
    context.write(base.but(effects=()), BASE + found.file)
    context.write(found.but(effects=adopted.product()))


def _with_effects(
    context: Context, log: TestLog, definition: TestDefinition, base: Calibration, effects: Sequence[Active]
) -> Calibration:
    """The same with adopted effects; where one acts on the engine, its constants are fitted together."""
    from hfanalysis.calibrate.joint_fit import fitted_together
    from hfanalysis.calibrate.joint_refused import change_nothing
    from hfanalysis.calibrate.narrow_port import with_stated_tap
    from hfanalysis.inference.subject import Subject
    from hfanalysis.products.segments import Segments

    if all(active.effect.of_sensor for active in effects):
        return _calibration(context, log, definition, effects)
    segments = context.read(Segments).fired
    subject = Subject(log, segments, base, definition)
    try:
        nothing = change_nothing(subject, effects)
    except AbsentError:
        nothing = False
    if nothing:
        names = ", ".join(active.effect.name for active in effects)
        return base.but(notes=(*base.notes, f"{names} as adopted: no channel would show it, and it changes nothing"))
    found = _calibration(context, log, definition, effects)
    context.progress("fitting all constants together, adopted effects in", None)
    try:
        return fitted_together(subject, with_stated_tap(definition, effects), found)
    except AbsentError as missing:
        alone = f"constants were found one by one, not together with the adopted effects: {missing}"
        return found.but(warnings=(*found.warnings, alone))


def _calibration(
    context: Context, log: TestLog, definition: TestDefinition, effects: Sequence[Active] = ()
) -> Calibration:
    """The content of calibration.json with these effects acting."""
    from hfanalysis.calibrate.facts import held_against
    from hfanalysis.calibrate.fuel_law import contradiction, regress
    from hfanalysis.calibrate.tank import calibrate
    from hfanalysis.products.segments import Segments

    segments = context.read(Segments).fired
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
