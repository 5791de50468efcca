"""hfa diagnose --apply and --retract: making what a diagnosis names part of the model, and undoing that."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from hfanalysis.cli.exit_status import tell
from hfanalysis.cli.perform import stage
from hfanalysis.cli.request import Request
from hfanalysis.diagnose.answer.tried_on import tried_sentences
from hfanalysis.effects import FOLDER, library
from hfanalysis.effects.learnt import STATES
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.inference.adopted import file_for
from hfanalysis.inference.adopted.draft import draft
from hfanalysis.inference.adopted.effects import Adopted, of_diagnosis, of_tables, write_adopted
from hfanalysis.products.diagnosis import Diagnosis, Learnt
from hfanalysis.products.disk import atomic, read_json
from hfanalysis.sentences import capitalised
from hfanalysis.stages.base import Context
from hfanalysis.stages.open_test import open_test
from hfanalysis.version import __version__

LEAST_ELSEWHERE = 0.2
"""Part of the misfit of another test that a table has to take away there to be said to hold."""

MARK = "Adopted by hfa diagnose"
"""How a file begins that a diagnosis wrote, and another may write over."""


def apply(request: Request, stand: bool, unknown: bool = False) -> None:
    """Diagnose, and adopt what is named, proved on the test that it was, or else what is ``unknown`` as it was found.
    Raises AbsentError where there is nothing to adopt."""
    context = stage("diagnose", proved_as_before(request))
    found = context.read(Diagnosis)
    path = adopt(context, found, stand, unknown)
    tell(f"{path}: written; every stage of {_whose(context, stand)} now has it in its model")
    if unknown and found.learnt is not None:
        tell(_proved_elsewhere(found))
        if (form := write_draft(context, found.learnt)) is not None:
            tell(f"{form}: a draft of an effect of its form; rename it draft_{context.id}.py to make it the team's own")
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


def _proved_elsewhere(found: Diagnosis) -> str:
    """What another test of the stand says of a table, in a sentence."""
    other = found.gap.other_test
    if other is None or other.closed_fraction is None:
        return "no other test of the stand tells whether it holds there: it is what this one test shows"
    part = f"{100.0 * other.closed_fraction:.0f} % of the misfit of {other.test}"
    if other.closed_fraction < LEAST_ELSEWHERE:
        return f"it takes away {part}: it does not hold there, so do not predict with it"
    return f"it takes away {part}, with this table"


def write_draft(context: Context, found: Learnt) -> Path | None:
    """A draft of an effect file beside the team's own, of the form that is hinted at; None where none is."""
    code = draft(found, f"draft_{context.id}")
    if code is None:
        return None
    path = context.root / FOLDER / f"{context.id}.draft"
    with atomic(path) as scratch:
        scratch.write_text(code, encoding="utf-8")
    return path


def adopt(context: Context, diagnosis: Diagnosis, stand: bool = False, unknown: bool = False) -> Path:
    """Write the effects that a diagnosis.json names, or else what is ``unknown``, over the state that it follows, with
    what was in the model beside it; returns the file.

    Raises AbsentError where there is nothing to adopt, InputError for a file that somebody has written by hand.
    """
    if unknown:
        return _adopt_unknown(context, diagnosis, stand)
    if diagnosis.verdict != "named" or not diagnosis.effects:
        raise AbsentError(
            f"test {context.id}: there is nothing to adopt: the diagnosis names no effect (verdict "
            f"{diagnosis.verdict!r}; what holds 90 %: {', '.join(map(diagnosis.plain, diagnosis.set90))})"
            + ("; --unknown adopts what has no name as it was found" if diagnosis.learnt is not None else "")
        )
    found = of_diagnosis(diagnosis.effects, library(context.root / FOLDER))
    named = ", ".join(f"{e.name} with probability {e.probability:.2f}" for e in diagnosis.effects)
    words = [f"Verdict {diagnosis.verdict}: {named}.", *tried_sentences(diagnosis)]
    return _written(context, found, stand, words)


def _adopt_unknown(context: Context, diagnosis: Diagnosis, stand: bool) -> Path:
    found = diagnosis.learnt
    if found is None:
        why = diagnosis.not_learnt or f"the verdict is {diagnosis.verdict!r}, not 'unknown'"
        raise AbsentError(f"test {context.id}: there is nothing unknown to adopt: {why}")
    other = diagnosis.gap.other_test
    if stand and other is not None and (other.closed_fraction or 0.0) < LEAST_ELSEWHERE:
        raise AbsentError(
            f"test {context.id}: it is not adopted for all tests of the stand: {_proved_elsewhere(diagnosis)}; without "
            "--stand it is adopted for this test alone"
        )
    tables = {**{row.name: row.parameters for row in found.beside}, found.effect: found.parameters}
    adopted = of_tables(tables, library(context.root / FOLDER))
    words = [
        f"Something without a name (probability {diagnosis.posterior['unknown']:.2f}), as it was found, over the "
        f"{STATES[found.state][2]}; the band is that of the fit.",
        capitalised(_proved_elsewhere(diagnosis)) + ".",
    ]
    words += tried_sentences(diagnosis)
    if found.hint is not None:
        words.append(f"A hint, not a name: {found.hint.words}.")
    return _written(context, adopted, stand, words, " --unknown")


def _written(context: Context, found: Adopted, stand: bool, words: list[str], how: str = "") -> Path:
    path = _path(context, stand)
    if path.is_file() and not path.read_text(encoding="utf-8", errors="replace").startswith(f"# {MARK}"):
        raise InputError(f"{path}: found a file that no diagnosis wrote; expected none: move it away first")
    write_adopted(path, found, _header(context, stand, words, how))
    return path


def _header(context: Context, stand: bool, words: list[str], how: str) -> list[str]:
    option = " --stand" if stand else ""
    return [
        f"{MARK} {context.id} --apply{how}{option} (hfanalysis {__version__}).",
        *words,
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
