"""diagnose: where model and measurement disagree, which effect is missing, and the proof that it is.

Reads ``ingest.h5``, ``segments.json`` and ``base_calibration.json`` (the base model is what is diagnosed, whatever has
been adopted), and those of another test of the same stand, to prove it there with frozen constants. A test whose run
line was not recorded starts from a calibration of injector and line as one; one that cannot be calibrated at all, or
whose engine cannot be run, gets what its channels show by themselves. Writes ``diagnosis.json`` and ``diagnosis.h5``.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from hfanalysis.errors import AbsentError, AnalysisError, InputError
from hfanalysis.record.definition import TestDefinition, find_definition, load_definition
from hfanalysis.stages.base import BASE, Context, Stage
from hfanalysis.stages.stand import nearest

if TYPE_CHECKING:
    from hfanalysis.diagnose.answer.proof import OtherTest
    from hfanalysis.inference.subject import Subject


def run(context: Context) -> None:
    """Name what the model lacks."""
    from hfanalysis.diagnose.diagnosis import diagnose
    from hfanalysis.diagnose.naming.variants import settings_of
    from hfanalysis.diagnose.product_histories import write_empty, write_histories
    from hfanalysis.diagnose.without_engine import channels_alone
    from hfanalysis.effects import FOLDER, library

    effects = library(context.root / FOLDER)
    settings = settings_of(str(context.parameter("variant")))
    subject = subject_of(context)
    try:
        if not subject.calibration:
            raise AbsentError(context.absent["calibrate"])
        found = diagnose(subject, effects, lambda: _other(context), context.progress, settings)
    except AbsentError as missing:
        write_empty(context.scratch("diagnosis.h5"), context.provenance())
        context.write(channels_alone(subject, str(missing)))
        return
    write_histories(context.scratch("diagnosis.h5"), found, context.provenance())
    context.write(found.product)


def subject_of(context: Context) -> Subject:
    """What the products of a test give a diagnosis to work on; without a calibration where none can be had."""
    from hfanalysis.diagnose.without_law import with_start
    from hfanalysis.diagnose.without_run_line import NOTE, lumped_calibration
    from hfanalysis.inference.subject import Subject
    from hfanalysis.products.calibration import Calibration
    from hfanalysis.products.health import Health
    from hfanalysis.products.segments import Segments

    # what may be wrong with a sensor is a hypothesis of the diagnosis: no accuracy is widened for it
    log = context.log(widened=False)
    segments = context.read(Segments).fired
    told = context.read(Health).findings
    if "p_tank" in log and "p_run" not in log:
        with suppress(AbsentError):
            found = lumped_calibration(log, segments, context.definition)
            return Subject(log, segments, found, context.definition, (NOTE,), told)
    base = None if "calibrate" in context.absent else context.read(Calibration, BASE + Calibration.file)
    subject = Subject(log, segments, base, context.definition, (), told)
    return with_start(subject) if base is not None else subject


def _other(context: Context) -> OtherTest | None:
    """The other test to prove it on: the first of those it may be proved on that can be run.

    Its products are made in a folder of this test's own: two tests that are diagnosed at once, each the other's proof,
    would wait for each other's lock for ever.
    """
    from hfanalysis.diagnose.answer.proof import OtherTest
    from hfanalysis.stages.freshness import STATE
    from hfanalysis.stages.open_test import open_test
    from hfanalysis.stages.runner import run_to

    folder = context.out / STATE / "proof"
    for name in [proof.test.id for proof in _proofs(context)]:
        try:
            other = run_to("calibrate", open_test(context.root, name, folder, progress=context.progress))
            return OtherTest(name, *subject_of(other).compared())
        except AnalysisError as error:
            if context.parameter("proof_test"):
                raise InputError(f"diagnose.proof_test: {name} cannot prove anything: {error}") from None
    return None


def _proofs(context: Context) -> list[TestDefinition]:
    """The other tests that it may be proved on: the one that is asked for, else the nearest hot fires of the stand."""
    asked = str(context.parameter("proof_test"))
    if asked == context.id:
        raise InputError(f"diagnose.proof_test: found {asked}, the test itself; expected another one")
    if asked:
        return [load_definition(find_definition(context.root, asked))]
    return [other for other in nearest(context) if other.test.kind == "hot_fire"]


STAGE = Stage(
    name="diagnose",
    needs=("ingest", "health", "segment"),
    wants=("calibrate",),
    products=("diagnosis.json", "diagnosis.h5"),
    run=run,
    adopts=False,
    tries_effects=True,
    runs=("calibrate",),
    parameters={"proof_test": "", "variant": ""},
    others=_proofs,
)
