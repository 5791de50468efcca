"""The results of a run beside the answers, ready to be scored."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from simulated.blind.judged import Case, Groups, load, twins
from simulated.blind.plan import MOST_CASES, MOST_SEEDS, SPLITS

from .folder import DONE, LATE, Folder, Note


class WrongSplit(Exception):
    """Answers of another split than asked for."""


@dataclass(frozen=True)
class Results:
    """Cases by id, those not run yet, the notes, what the run went by, and the twins by all answers there are."""

    folder: Folder
    cases: dict[str, Case]
    missing: list[str]
    notes: dict[str, Note]
    plan: dict[str, Any]
    groups: Groups

    @property
    def failures(self) -> list[Note]:
        """What did not lead to a diagnosis."""
        return [note for note in self.notes.values() if note.status != DONE]

    @property
    def generators(self) -> Counter[str]:
        """Digests of the generators that made the cases, with the number of cases."""
        return Counter(str(case.answer.get("generator", "not stated")) for case in self.cases.values())

    @property
    def codes(self) -> Counter[tuple[str, str]]:
        """Digests of sources and of fitted constants, with the number of cases."""
        return Counter((self.notes[i].code, self.notes[i].probabilities) for i in self.cases)


def split_of(seed: int) -> str:
    """The split that a seed belongs to."""
    for name, start in SPLITS.items():
        if start <= seed < start + MOST_CASES * MOST_SEEDS:
            return name
    return "none"


def check_split(answers: Iterable[dict[str, Any]], split: str) -> None:
    """Raise WrongSplit unless all answers are of that split."""
    others = {split_of(a["seed"]) for a in answers} - {split}
    if others:
        raise WrongSplit(f"the folder holds cases of the split {', '.join(sorted(others))}, not of {split}")


def results(folder: Folder, split: str) -> Results:
    """All that a run has found so far. A product that no note vouches for is as good as none."""
    answers = [json.loads(p.read_text(encoding="utf-8")) for p in sorted(folder.answers.glob("*.json"))]
    check_split(answers, split)
    notes = folder.notes()
    why = {i: note.message for i, note in notes.items() if note.status != DONE}
    found, missing = load(folder.answers, folder.processed, why)
    cases = {str(c.answer["id"]): _timed(c, notes) for c in found if c.answer["id"] in notes}
    missing += sorted(str(c.answer["id"]) for c in found if c.answer["id"] not in notes)
    try:
        plan = json.loads(folder.plan_file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        plan = {}
    return Results(folder, cases, sorted(missing), notes, plan, twins(answers))


def _timed(case: Case, notes: dict[str, Note]) -> Case:
    """With the time that was measured outside, from the log on; none for the first of a process, which compiles."""
    note = notes[str(case.answer["id"])]
    seconds = note.seconds if note.status == LATE or not note.first else None
    return replace(case, product={**case.product, "runtime_s": seconds})
