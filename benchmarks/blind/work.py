"""What a worker does with one case: the stages, as a user runs them. Nothing here may know the answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

PROOF = "proof_test"
"""Parameter of the diagnosis: another test of the stand, on which the effect's constants are tried frozen."""


@dataclass(frozen=True)
class Job:
    """One case to diagnose; ``first`` is the earlier test of the same stand."""

    root: Path
    products: Path
    id: str
    first: str | None = None
    settings: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Result:
    """How long it took, the last stage of it, and the processor [s], and the parameters that were set."""

    seconds: float
    diagnosis_seconds: float
    settings: dict[str, Any]
    processor_seconds: float | None = None


def known_parameters() -> Mapping[str, Any]:
    """The parameters of the diagnosis with their defaults."""
    from hfanalysis.stages.base import load_stage

    return load_stage("diagnose").parameters


def prepare() -> None:
    """Load what every case needs."""
    from hfanalysis.stages.base import load_stage

    for name in ("ingest", "segment", "calibrate", "diagnose"):
        load_stage(name)


def settings_of(job: Job, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """What is set for a case: the variant's parameters, and the stand's first test where the diagnosis takes one."""
    proof = {f"diagnose.{PROOF}": job.first} if job.first and PROOF in parameters else {}
    return {**job.settings, **proof}


def diagnose(job: Job) -> Result:
    """Bring one case from its log to ``diagnosis.json``, everything anew, so that the time is that of all of it.

    Raises AnalysisError where the diagnosis refuses the test, NotConvergedError where its search did not converge.
    """
    from hfanalysis.diagnose.naming.polish import assert_converged
    from hfanalysis.stages.open_test import open_test
    from hfanalysis.stages.runner import run_to

    settings = settings_of(job, known_parameters())
    if f"diagnose.{PROOF}" in settings and job.first is not None:
        run_to("calibrate", open_test(job.root, job.first, out=job.products))
    began: dict[str, float] = {}

    def notice(text: str, _fraction: float | None = None) -> None:
        began.setdefault(text, perf_counter())

    started, used = perf_counter(), process_time()
    done = run_to("diagnose", open_test(job.root, job.id, job.products, progress=notice, settings=settings), force=True)
    ended = perf_counter()
    assert_converged(done.read_json("diagnosis.json").get("not_converged"))
    return Result(ended - started, ended - began.get("diagnose", started), settings, process_time() - used)
