"""Logs whose answers are there, as those of an archive: made again without the search that the answers cost.

Most of what a case costs is to find the strength that its d' asks for, and d' against every rival; both are in its
answer, of which they are taken. As an archive keeps six digits of a strength, some samples of a log are the next
value that the logger can write.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any
from unittest.mock import patch

from simulated.blind import write
from simulated.blind.build import Built, build
from simulated.blind.effects import Hidden
from simulated.blind.plan import Case

EVERY = 50
"""Logs between two lines of progress."""


def built_of(case: Case, answer: Mapping[str, Any]) -> Built:
    """The case with the strengths and the detectability of its answer."""
    strengths = {effect["name"]: effect["strength"] for effect in answer["effects"]}

    def set_strengths(_: None, hidden: tuple[Hidden, ...], __: Case) -> tuple[Hidden, ...]:
        return tuple(h.at(strengths[h.effect.name]) for h in hidden)

    names = ("d_prime", "against", "given_others", "after_best_of_library")
    known = {name: answer[name] for name in names}
    with patch.multiple(
        "simulated.blind.build",
        Detector=lambda *_: None,
        _set_strengths=set_strengths,
        _detectability=lambda *_: known,
    ):
        return build(case)


def log_path(case: Case, root: Path) -> Path:
    """Where the log of a case lies."""
    return root / "raw_tests" / case.id / "log.csv"


def write_log(case: Case, root: Path) -> None:
    """Write what the engineer gets of a case whose answer is there, which stays as it is."""
    answer = json.loads(write.answer_path(case, root).read_text(encoding="utf-8"))
    with (
        patch("simulated.blind.write.build", lambda case: built_of(case, answer)),
        patch("simulated.blind.write.answer", lambda _: answer),
    ):
        write.write_case(case, root)


def write_logs(cases: Sequence[Case], root: Path, jobs: int) -> None:
    """Write those of all ``cases``, telling how far it is; where one cannot be, its answer goes, to be sought anew."""
    if not cases:
        return
    with get_context("spawn").Pool(jobs) as pool:
        for done, failed in enumerate(pool.imap_unordered(partial(_tried, root=root), cases), 1):
            if failed is not None:
                print(failed, file=sys.stderr, flush=True)
            if done % EVERY == 0 or done == len(cases):
                print(f"{done}/{len(cases)} logs written", file=sys.stderr, flush=True)


def _tried(case: Case, root: Path) -> str | None:
    try:
        write_log(case, root)
    except Exception as error:
        write.answer_path(case, root).unlink(missing_ok=True)
        return f"{case.id}: {type(error).__name__}: {error}"
    return None
