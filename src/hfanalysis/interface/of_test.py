"""What is known of a test's engine, from its products and those of its stand."""

from __future__ import annotations

from pathlib import Path

from hfanalysis.effects import FOLDER, library
from hfanalysis.errors import AbsentError
from hfanalysis.inference.adopted import file_for
from hfanalysis.inference.adopted.effects import Adopted, read_adopted, read_effects
from hfanalysis.inference.full_run import run_full
from hfanalysis.interface.bringing import bring
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.campaign import Campaign, CommonLaw, StandRow
from hfanalysis.products.disk import read_json
from hfanalysis.products.segments import Segments
from hfanalysis.progress import Progress, silent
from hfanalysis.quantity import Quantity
from hfanalysis.simulation.commented import write
from hfanalysis.simulation.of_test import OfTest, text_of
from hfanalysis.stages.base import Context, load_stage
from hfanalysis.stages.open_test import PROCESSED

ENGINES = "engines"
"""Where in a root engine files are."""

CONSTANTS = ("C_i", "K_loss", "m", "a", "n")
"""What a campaign has of a stand."""


def engine_file(
    test: str,
    root: str | Path = ".",
    *,
    stand: str | None = None,
    flight: bool = False,
    out: str | Path | None = None,
    progress: Progress = silent,
) -> tuple[Path, tuple[str, ...]]:
    """Write the engine file of a calibrated test, as ``hfa engine``; returns it and what is left out, in words.

    Args:
        test: its name.
        root: the folder that holds ``raw_tests/``.
        stand: whose constants and effects it has; else the test's own.
        flight: without what is of the stand alone.
        out: the file, instead of ``root/engines/TEST.toml``.
        progress: told what is being done.

    Raises:
        InputError: a file is there that was not written so, or was changed since.
        AbsentError: the test has no engine that runs, or none that can be.
    """
    context = bring("validate", Path(root), test, progress=progress)
    path = Path(out) if out is not None else Path(root) / ENGINES / f"{test}{'.flight' if flight else ''}.toml"
    written = text_of(engine_of_test(context, stand), path.absolute(), flight)
    write(path, written.text)
    return path, written.left_out


def engine_of_test(context: Context, stand: str | None = None) -> OfTest:
    """The engine of a test that validate has been through, run once as validate runs it.

    With the constants of ``stand`` where its campaign has them, and the effects adopted for it. Raises AbsentError
    where the test has no engine that runs, or the stand no constants.
    """
    if "calibrate" in context.absent:
        raise AbsentError(f"test {context.id}: no engine: {context.absent['calibrate']}")
    calibration, adopted = context.read(Calibration), read_adopted(context.root, context.definition)
    whose: dict[str, str] = {}
    if stand is not None:
        calibration, adopted, whose = _of_stand(context, stand, calibration)
    log, definition = context.at(load_stage("validate")).believed()
    segments = context.read(Segments).fired
    full = run_full(log, segments, calibration, definition, adopted.acting)
    return OfTest(context.definition, calibration, full, adopted, whose)


def _of_stand(context: Context, stand: str, own: Calibration) -> tuple[Calibration, Adopted, dict[str, str]]:
    row = _row(context, stand)
    found = {name: quantity for name, quantity in _constants(row).items() if quantity.value is not None}
    if not found:
        reasons = "; ".join(f"{name}: {quantity.reason}" for name, quantity in _constants(row).items())
        raise AbsentError(f"stand {stand}: its tests have no constant together ({reasons})")
    whose = {
        name: f"of stand {stand}, {len(row.tests)} tests together"
        if name in found
        else f"calibrated from {context.id} alone, for stand {stand} has none: {_constants(row)[name].reason}"
        for name in CONSTANTS
    }
    whose["joint"] = f"Of what stand {stand} has together the standard deviations are known alone."
    path = file_for(context.root, stand)
    adopted = read_effects(path, library(context.root / FOLDER)) if path.is_file() else Adopted()
    law = {"regression_rate_reference": Quantity.absent("of one test")} if "a" in found else {}
    return own.but(**found, **law, joint=None, tank_temperature=None), adopted, whose


def _row(context: Context, stand: str) -> StandRow:
    """What the campaign says of the stand; AbsentError where there is none."""
    path = _campaign(context)
    if not path.is_file():
        raise AbsentError(f"{path}: not found; hfa campaign writes what the tests of a stand say together")
    stands = Campaign.from_json(read_json(path)).stands
    name = next((name for name in (stand, f"{stand} ({context.definition.test.source})") if name in stands), None)
    if name is None:
        raise AbsentError(f"{path}: has no stand {stand!r}; there are {', '.join(stands) or 'none'}")
    return stands[name]


def _campaign(context: Context) -> Path:
    folder = context.out.parent if context.out.parent.is_dir() else context.root / PROCESSED
    return folder / Campaign.file


def _constants(row: StandRow) -> dict[str, Quantity]:
    law = row.regression
    fuel = {"a": law.a, "n": law.n} if isinstance(law, CommonLaw) else dict.fromkeys("an", Quantity.absent(law.reason))
    return {**{name: found.mean for name, found in row.constants.items()}, **fuel}
