"""Write the cases that are not there, diagnose those that are not done, note each as it comes."""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from simulated.blind.plan import Case, plan
from simulated.blind.version import generator_digest
from simulated.blind.write import answer_path, write_all

from .archive import pack, unpack
from .folder import DIED, DONE, LATE, UNWRITTEN, Folder, Note, code_digest, probabilities_digest, write_json
from .logs import log_path, write_logs
from .pool import Outcome, Pool
from .progress import display
from .work import PROOF, Job, known_parameters

REFUSED, SOME_FAILED, INTERRUPTED = 2, 1, 130


class Refused(Exception):
    """What was asked for does not fit what is there; the message says why."""


@dataclass(frozen=True)
class Request:
    """What to run.

    Attributes:
        split, total, seed: the plan.
        folder: where; its variant says under which name.
        jobs: processes.
        limit: of the plan, only the first so many.
        kind: of these, only the tests of one kind.
        targets: only those with one of these d' asked for, if there are any.
        each: only the first so many of every effect and d'.
        archive: a file with what was found before, elsewhere; what is found is added to it.
        settings: parameters of stages by ``"stage.name"``.
        keep: keep products that another version of the code made.
        retry: try again what failed.
        seconds: longest time for one case [s].
        every: cases between two lines of progress.
    """

    split: str
    total: int
    folder: Folder
    jobs: int = 1
    seed: int = 0
    limit: int | None = None
    settings: dict[str, Any] = field(default_factory=dict)
    keep: bool = False
    retry: bool = False
    seconds: float = 300.0
    every: int = 10
    kind: str | None = None
    targets: tuple[float, ...] = ()
    each: int | None = None
    archive: Path | None = None


def variant_settings(variant: str | None, given: dict[str, Any], known: Iterable[str]) -> dict[str, Any]:
    """The parameters of a variant: those given, else the diagnosis's own parameter ``variant``.

    Raises Refused where the diagnosis has no such parameter: it would run the full method under another name.
    """
    settings = dict(given)
    if variant and not settings:
        settings = {"diagnose.variant": variant}
    names = {f"diagnose.{name}" for name in known}
    for key in settings:
        if key not in names:
            raise Refused(f"the diagnosis has no parameter {key!r}; it has {', '.join(sorted(names)) or 'none'}")
    if settings and not variant:
        raise Refused("parameters were set but no --variant says under which name")
    return settings


def check_plan(cases: Sequence[Case], root: Path) -> None:
    """Refuse a folder whose cases are of another plan: the same number may stand for another test."""
    for case in cases:
        path = answer_path(case, root)
        if not path.exists():
            continue
        answer = json.loads(path.read_text(encoding="utf-8"))
        there = (answer["seed"], answer["kind"], answer["target_d_prime"], {e["name"] for e in answer["effects"]})
        if there != (case.seed, case.kind, case.target, set(case.effects)):
            raise Refused(f"{path}: a case of another plan; give another --out, or the --n and --seed of that plan")


def is_done(note: Note | None, product: Path, request: Request, now: tuple[str, str]) -> bool:
    """Whether a case need not be diagnosed again.

    On the calibration split the fitted constants do not matter, for it is the evidences that are wanted there.
    """
    if note is None or note.status in (DIED, UNWRITTEN):
        return False
    if note.status == DONE and not product.exists():
        return False
    if note.status != DONE and request.retry:
        return False
    if request.keep:
        return True
    same = note.code == now[0] and (request.split == "calibration" or note.probabilities == now[1])
    return same and {k: v for k, v in note.settings.items() if k != f"diagnose.{PROOF}"} == request.settings


def job_of(case: Case, request: Request) -> Job:
    """A case as a worker sees it: nothing of what is hidden."""
    folder = request.folder
    first = f"{case.id[:-1]}A" if case.second else None
    return Job(folder.root, folder.processed, case.id, first, request.settings)


def note_of(outcome: Outcome, now: tuple[str, str], limit: float) -> Note:
    """What is kept of an outcome; one that came to the time limit [s] took at least that."""
    result = outcome.result
    return Note(
        outcome.job.id,
        outcome.status,
        outcome.message,
        result.seconds if result else (limit if outcome.status == LATE else None),
        result.diagnosis_seconds if result else None,
        outcome.first,
        *now,
        result.settings if result else outcome.job.settings,
        result.processor_seconds if result else None,
    )


def written(cases: Sequence[Case], request: Request, now: tuple[str, str]) -> list[Case]:
    """The cases that are there after those that were missing are written; what cannot be written is noted."""
    root = request.folder.root
    check_plan(cases, root)
    missing = [c for c in cases if not answer_path(c, root).exists()]
    reasons = dict(line.split(": ", 1) for line in write_all(missing, root, request.jobs)) if missing else {}
    for case, reason in reasons.items():
        request.folder.write_note(Note(case, UNWRITTEN, reason, code=now[0], probabilities=now[1]))
    return [c for c in cases if answer_path(c, root).exists()]


def without_log(cases: Sequence[Case], jobs: Sequence[Job], root: Path) -> list[Case]:
    """Of the cases that jobs need those whose answer is there, as of an archive, and whose log is not."""
    needed = {name for job in jobs for name in (job.id, job.first)}
    return [c for c in cases if c.id in needed and answer_path(c, root).exists() and not log_path(c, root).exists()]


def state_plan(request: Request) -> None:
    """What the folder goes by; a part of a plan of which more was run before changes nothing of that."""
    went_by = {"split": request.split, "n": request.total, "seed": request.seed, "limit": request.limit}
    parts = {"kind": request.kind, "targets": request.targets, "each": request.each}
    chosen = {name: value for name, value in parts.items() if value}
    file = request.folder.plan_file
    if not chosen or not file.exists():
        write_json(file, {**went_by, **chosen, "jobs": request.jobs, "settings": request.settings})


def asked_for(request: Request) -> list[Case]:
    """The cases of the plan that are asked for."""
    cases = plan(request.total, request.split, request.seed)[: request.limit]
    if request.kind is not None:
        cases = [case for case in cases if case.kind == request.kind]
    if request.targets:
        cases = [case for case in cases if case.target in request.targets]
    if request.each is None:
        return cases
    there = Counter[tuple[str, tuple[str, ...], float]]()
    out = []
    for case in cases:
        cell = (case.kind, case.effects, case.target)
        there[cell] += 1
        if there[cell] <= request.each:
            out.append(case)
    return out


def archive_of(request: Request) -> Path | None:
    """The file that results are kept in; a variant has its own beside that of the full method."""
    path, variant = request.archive, request.folder.variant
    if path is None or variant is None:
        return path
    name, dot, ending = path.name.partition(".")
    return path.with_name(f"{name}-{variant}{dot}{ending}")


def run(request: Request, make_pool: Callable[[Request], Pool] | None = None) -> int:
    """Do what is not done yet.

    Returns:
        0; 1 where a case failed; 130 where the run was interrupted (the same command goes on).
    """
    folder = request.folder
    request = _checked(request)
    cases = asked_for(request)
    now = (code_digest(), probabilities_digest())
    archive = archive_of(request)
    if archive is not None:
        known = None if request.keep else now
        taken = unpack(archive, folder, {c.id for c in cases}, known, generator_digest())
        print(f"{archive}: {taken} cases taken from it", file=sys.stderr, flush=True)
    todo = [c for c in cases if not is_done(folder.note(c.id), folder.product(c.id), request, now)]
    write_logs(without_log(cases, [job_of(c, request) for c in todo], folder.root), folder.root, request.jobs)
    there = {c.id for c in written(cases, request, now)}
    state_plan(request)
    todo = [c for c in todo if c.id in there]
    print(f"{len(cases)} cases, {len(there) - len(todo)} done, {len(todo)} to diagnose", file=sys.stderr, flush=True)
    for case in todo:
        (folder.runs / f"{case.id}.json").unlink(missing_ok=True)
    pool = (make_pool or _pool)(request)
    interrupted = False
    try:
        with display(len(todo), request.every) as shown:
            for outcome in pool.run([job_of(c, request) for c in todo]):
                note = note_of(outcome, now, request.seconds)
                folder.write_note(note)
                shown.done(note)
    except KeyboardInterrupt:
        print("interrupted; the same command goes on from here", file=sys.stderr)
        interrupted = True
    if archive is not None:
        print(f"{archive}: {pack(folder, archive)} cases", file=sys.stderr)
    return INTERRUPTED if interrupted else _summary([folder.note(c.id) for c in cases])


def _checked(request: Request) -> Request:
    from dataclasses import replace

    if not request.folder.variant and not request.settings:
        return request
    settings = variant_settings(request.folder.variant, request.settings, known_parameters())
    return replace(request, settings=settings)


def _pool(request: Request) -> Pool:
    return Pool(request.jobs, request.seconds, request.folder.runs / "log" / "workers.log")


def _summary(notes: Sequence[Note | None]) -> int:
    lost = [n for n in notes if n is None or n.status != DONE]
    print(f"{len(notes) - len(lost)} of {len(notes)} diagnosed", file=sys.stderr)
    return SOME_FAILED if lost else 0
