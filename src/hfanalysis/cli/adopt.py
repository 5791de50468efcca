"""hfa diagnose --apply and --retract: making what a diagnosis names part of the model, and undoing that."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from hfanalysis.cli.exit_status import tell
from hfanalysis.cli.perform import stage
from hfanalysis.cli.request import Request
from hfanalysis.effects import FOLDER, library
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.inference.adopted import file_for
from hfanalysis.inference.adopted.effects import of_diagnosis, write_adopted
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.products.disk import read_json
from hfanalysis.stages.base import Context
from hfanalysis.stages.open_test import open_test
from hfanalysis.version import __version__

MARK = "Adopted by hfa diagnose"
"""How a file begins that a diagnosis wrote, and another may write over."""


def apply(request: Request, stand: bool) -> None:
    """Diagnose, and adopt what is named, proved on the test that it was. Raises AbsentError where nothing is."""
    context = stage("diagnose", proved_as_before(request))
    path = adopt(context, context.read(Diagnosis), stand)
    tell(f"{path}: written; every stage of {_whose(context, stand)} now has it in its model")
    tell(f"next: hfa run {context.id} shows m, the misfit and the flight with it; a test of another load would try it")


def proved_as_before(request: Request) -> Request:
    """The request with the proof test that the diagnosis on disk was asked for, unless it asks for one itself."""
    if any(text.startswith("diagnose.proof_test=") for text in request.settings):
        return request
    path = open_test(request.root, request.test, request.out).product("diagnosis.json")
    try:
        other = read_json(path)["provenance"]["parameters"].get("proof_test", "")
    except (OSError, ValueError, KeyError):
        return request
    asked = (f"diagnose.proof_test={json.dumps(other)}",) if other else ()
    return replace(request, settings=(*request.settings, *asked))


def retract(request: Request, stand: bool) -> None:
    """Remove the file of adopted effects. Raises AbsentError where there is none."""
    context = open_test(request.root, request.test, request.out)
    path = _path(context, stand)
    if not path.is_file():
        raise AbsentError(f"{path}: there is no such file; nothing has been adopted for {_whose(context, stand)}")
    path.unlink()
    tell(f"{path}: removed; the model of {_whose(context, stand)} is the base model again")


def adopt(context: Context, diagnosis: Diagnosis, stand: bool = False) -> Path:
    """Write the effects that a diagnosis.json names; returns the file.

    Raises AbsentError where it names none, InputError for a file that somebody has written by hand.
    """
    if diagnosis.verdict != "named" or not diagnosis.effects:
        raise AbsentError(
            f"test {context.id}: there is nothing to adopt: the diagnosis names no effect (verdict "
            f"{diagnosis.verdict!r}; what holds 90 %: {', '.join(map(diagnosis.plain, diagnosis.set90))})"
        )
    path = _path(context, stand)
    if path.is_file() and not path.read_text(encoding="utf-8", errors="replace").startswith(f"# {MARK}"):
        raise InputError(f"{path}: found a file that no diagnosis wrote; expected none: move it away first")
    found = of_diagnosis(diagnosis.effects, library(context.root / FOLDER))
    write_adopted(path, found, _header(context, diagnosis, stand))
    return path


def _header(context: Context, diagnosis: Diagnosis, stand: bool) -> list[str]:
    named = ", ".join(f"{e.name} with probability {e.probability:.2f}" for e in diagnosis.effects)
    option = " --stand" if stand else ""
    return [
        f"{MARK} {context.id} --apply{option} (hfanalysis {__version__}).",
        f"Verdict {diagnosis.verdict}: {named}.",
        f"Every stage of {_whose(context, stand)} has it in its model as long as this file is here. To remove it:",
        f"delete the file, or hfa diagnose {context.id} --retract{option}",
    ]


def _whose(context: Context, stand: bool) -> str:
    return f"all tests of stand {context.definition.test.stand}" if stand else context.id


def _path(context: Context, stand: bool) -> Path:
    name = context.definition.test.stand if stand else context.id
    if not name:
        raise InputError(
            f"{context.definition.path}, test.stand: is missing; expected the stand whose effects are meant"
        )
    return file_for(context.root, name)
