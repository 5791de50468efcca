"""Every test through all stages, several at a time, on the processes of a cluster: what ends one ends no other."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from hfanalysis.campaign.cluster import Cluster, Telling
from hfanalysis.interface.bringing import check_spine
from hfanalysis.interface.ending import ABSENT, DEFECT, DONE, INPUT_AT_FAULT, plainly
from hfanalysis.stages import ORDER, RUN
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to


@dataclass(frozen=True)
class Ended:
    """How the run of a test ended: its exit status, and what it said of it ("" where all went well)."""

    status: int
    said: str

    @property
    def defect(self) -> bool:
        """Whether it is our fault."""
        return self.status not in (DONE, INPUT_AT_FAULT, ABSENT)


@dataclass(frozen=True)
class Work:
    """What is done with every test: where it is, where its products go, whether all is redone, and up to which stage
    (RUN: all of them, the diagnosis with them)."""

    root: Path
    out: Path | None = None
    force: bool = False
    to: str = RUN


def run_all(
    tests: Sequence[str],
    work: Work,
    cluster: Cluster,
    ended: Callable[[str, Ended], None],
    doing: Callable[[str], None] = lambda _text: None,
) -> Mapping[str, Ended]:
    """All stages of every test, on the workers of a ``cluster``.

    ``ended`` is called, from this thread, as each one ends; ``doing`` with what the workers are at. A test that has
    ended the process it ran in too often (:data:`hfanalysis.campaign.cluster.DEATHS`) has ended with a defect.
    """
    found: dict[str, Ended] = {}
    for test, outcome in cluster.each(run_one, tests, work, doing):
        found[test] = outcome if isinstance(outcome, Ended) else Ended(DEFECT, outcome)
        ended(test, found[test])
    return {test: found[test] for test in tests}


def run_one(test: str, work: Work) -> Ended:
    """The stages of one test, in the process of a worker; it raises nothing."""
    try:
        context = open_test(work.root, test, work.out, progress=Telling(test))
        last = ORDER[-1] if work.to == RUN else work.to
        check_spine(run_to(last, context, force=work.force, whole=work.to == RUN))
    except Exception as error:
        known = plainly(error)
        return Ended(*known) if known else Ended(DEFECT, traceback.format_exc())
    return Ended(DONE, "")
