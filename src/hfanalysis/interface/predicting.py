"""Predictions frozen and scored: what the tests' folders hold, brought together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hfanalysis.errors import AbsentError, InputError
from hfanalysis.interface.bringing import bring
from hfanalysis.interface.of_test import engine_of_test
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.disk import atomic, fsync, make_folder, read_json, sha256_file, temporary_path, to_json
from hfanalysis.products.flight import Flight
from hfanalysis.products.prediction import Origin, Prediction, Score
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Validation
from hfanalysis.progress import Progress, silent
from hfanalysis.quantity import Quantity
from hfanalysis.record.planned import load_planned
from hfanalysis.record.schema import unsafe
from hfanalysis.simulation import plots
from hfanalysis.simulation import predict as model
from hfanalysis.simulation.foretelling import Base
from hfanalysis.stages.base import Context
from hfanalysis.stages.freshness import raw_files

FOLDER = "predictions"
"""Where in a root predictions are."""

ON_THE_DAY = ".day"
"""What the name of a prediction ends in that was made with the temperature of the day."""

THERE = "{path}: is there already; a prediction is never written over: give the test another id"
"""How another prediction of the same name is refused."""

READ = ("segments.json", "base_calibration.json", "calibration.json", "validation.json", "flight.json")
"""Products of a test that a prediction reads."""

BASE = "base_calibration.json"


def predict(
    plan: str | Path,
    tests: Sequence[str],
    root: str | Path = ".",
    *,
    temperature: str | None = None,
    draws: int = model.DRAWS,
    progress: Progress = silent,
) -> tuple[Path, str]:
    """Freeze what a planned test will measure, as ``hfa predict``; returns the file and its SHA-256.

    Beside it a picture of it over the temperature of the tank is written.

    Args:
        plan: a test.toml without its log.
        tests: fired tests, the last of which is "last time".
        root: the folder that holds ``raw_tests/``; the prediction goes to ``root/predictions/``.
        temperature: of the tank on the day, with its unit; the prediction's name then ends in ``.day``.
        draws: engines drawn.
        progress: told what is being done.

    Raises:
        InputError: there is one of that name already, for none is ever written over; or the plan is at fault.
        AbsentError: a test has no engine that runs.
    """
    stated, root = load_planned(Path(plan)), Path(root)
    path = _path(root, stated.test.id + (ON_THE_DAY if temperature is not None else ""))
    if path.exists():
        raise InputError(THERE.format(path=path))
    contexts = [_brought(root, test, progress) for test in tests]
    bases = [_base(context) for context in contexts]
    origins = {context.id: _origin(context, base) for context, base in zip(contexts, bases, strict=True)}
    found = model.predict(stated, bases, origins, temperature, draws)
    _freeze(path, to_json(found))
    if (picture := plots.prediction(found)) is not None:
        with atomic(path.with_suffix(".svg")) as scratch:
            scratch.write_text(picture, encoding="utf-8")
    return path, sha256_file(path)


def _freeze(path: Path, text: str) -> None:
    """Write it whole, unless another has been quicker: then InputError, and what is there stays."""
    make_folder(path.parent)
    scratch = temporary_path(path)
    try:
        scratch.write_text(text, encoding="utf-8")
        fsync(scratch)
        path.hardlink_to(scratch)
    except FileExistsError:
        raise InputError(THERE.format(path=path)) from None
    finally:
        scratch.unlink(missing_ok=True)


def score(
    name: str, root: str | Path = ".", test: str | None = None, *, out: Path | None = None, progress: Progress = silent
) -> Score:
    """Lay a frozen prediction over its ``test`` (default: of the same id), as ``hfa score``.

    ``out``: where the test's products are, instead of ``root/processed``.

    Raises InputError where there is no such prediction, or the test's log is among its inputs; AbsentError where
    nothing can be compared.
    """
    root = Path(root)
    path = _path(root, name)
    if not path.is_file():
        raise InputError(f"{path}: not found; hfa predict writes it, before the test is fired")
    frozen = Prediction.from_json(read_json(path))
    context = _brought(root, test or frozen.name, progress, out)
    return model.score(frozen, sha256_file(path), context.id, _raw(context), _measured(context), _products(context))


def _path(root: Path, name: str) -> Path:
    if unsafe(name):
        raise InputError(f"{name!r}: expected the name of a prediction, without path separators")
    return root / FOLDER / f"{name}.json"


def _brought(root: Path, test: str, progress: Progress, out: Path | None = None) -> Context:
    """As far as flight where there is a rocket, else validate."""
    context = bring("validate", root, test, out, progress=progress)
    if context.definition.rocket is not None:
        try:
            context = bring("flight", root, test, out, progress=progress)
        except AbsentError:  # an apogee is then what is lacking
            return bring("validate", root, test, out, progress=progress)
    return context


def _base(context: Context) -> Base:
    without = context.read(Calibration, BASE)
    return Base(engine_of_test(context), without, _measured(context))


def _measured(context: Context) -> dict[str, Quantity]:
    """What is predicted, as the log has it [SI]."""
    column, segments = context.read(Validation).performance.measured, context.read(Segments).fired
    names = ("total_impulse", "peak_thrust", "peak_chamber_pressure", "burn_time")
    found = {name: getattr(column, name) for name in names} | {"t_v": segments.t_v}
    there = context.definition.rocket is not None and context.product(Flight.file).is_file()
    apogee = context.read(Flight).apogee if there else Quantity.absent("no [rocket] is given, or it does not fly")
    return {**found, "apogee": apogee}


def _origin(context: Context, base: Base) -> Origin:
    acting = tuple(active.effect.name for active in base.found.adopted.acting)
    return Origin(raw=_raw(context), test_toml=context.definition.sha256, products=_products(context), effects=acting)


def _raw(context: Context) -> dict[str, str]:
    """The test's logs by SHA-256; a rocket's drag table is no log."""
    logs = {spec.file for spec in context.definition.log.files}
    there = {path.relative_to(context.raw).as_posix(): path for path in raw_files(context.definition)}
    return {name: sha256_file(path) for name, path in there.items() if name in logs}


def _products(context: Context) -> dict[str, str]:
    return {name: sha256_file(context.product(name)) for name in READ if context.product(name).is_file()}
