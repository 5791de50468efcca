"""Workers that stay, are replaced when they die or take too long, and never lose a case."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from pathlib import Path
from time import monotonic
from typing import Any

from .folder import DIED, DONE, FAILED, LATE
from .work import Job, diagnose, prepare

Task = Callable[[Job], Any]
READY, BROKEN = "ready", "broken"
ATTEMPTS = 2
"""A case whose worker dies is tried once more: what killed the worker may not have been the case."""
STARTUP = 300.0
"""Longest time a worker may take to load [s]."""


@dataclass(frozen=True)
class Outcome:
    """What became of a job: what the task returned, or why it did not."""

    job: Job
    status: str
    result: Any = None
    message: str = ""
    first: bool = False


def _follow(parent: int) -> None:
    """End with the process that started this one, however that ended."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def _serve(pipe: Connection, task: Task, load: Callable[[], None], log: Path) -> None:
    """A worker: takes jobs until the pipe closes. What is printed goes to the log."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_follow, args=(os.getppid(),), daemon=True).start()
    with log.open("a", buffering=1, encoding="utf-8") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        print(f"worker {os.getpid()} starts", flush=True)
        try:
            load()
        except BaseException:
            pipe.send((BROKEN, traceback.format_exc(), None))
            return
        pipe.send((READY, "", None))
        while True:
            try:
                job = pipe.recv()
            except EOFError:
                return
            pipe.send(_tried(task, job))


def _tried(task: Task, job: Job) -> tuple[str, str, Any]:
    """Status, message and result of one job."""
    try:
        return DONE, "", task(job)
    except Exception as error:
        print(f"{job.id}: {traceback.format_exc()}", file=sys.stderr, flush=True)
        return FAILED, f"{type(error).__name__}: {error}", None


@dataclass
class _Worker:
    """A process, the pipe to it and what it is at."""

    process: Any
    pipe: Connection
    job: Job | None = None
    ready: bool = False
    taken: int = 0
    since: float = field(default_factory=monotonic)

    def give(self, job: Job) -> None:
        self.job, self.since = job, monotonic()
        self.pipe.send(job)
        self.taken += 1

    def end(self) -> None:
        self.process.kill()
        self.process.join()
        self.pipe.close()


class Pool:
    """Runs jobs on a number of processes; ``limit`` is the longest time for one [s]."""

    def __init__(
        self, count: int, limit: float, log: Path, task: Task = diagnose, load: Callable[[], None] = prepare
    ) -> None:
        self.count, self.limit, self.log = count, limit, log
        self.task, self.load = task, load
        self._workers: list[_Worker] = []
        self._waiting: list[Job] = []
        self._attempts: dict[str, int] = {}
        self._still_born = 0

    def run(self, jobs: Sequence[Job]) -> Iterator[Outcome]:
        """Outcomes as they come, one for each job. A test of a stand waits for the one before it."""
        self._waiting = list(jobs)
        self.log.parent.mkdir(parents=True, exist_ok=True)
        try:
            while self._waiting or any(w.job for w in self._workers):
                self._hire()
                self._hand_out()
                yield from self._collect()
        finally:
            for worker in self._workers:
                worker.end()
            self._workers.clear()

    def _hire(self) -> None:
        """As many workers as there is work for."""
        wanted = min(self.count, len(self._waiting) + sum(w.job is not None for w in self._workers))
        while len(self._workers) < wanted:
            here, there = get_context("spawn").Pipe()
            process = get_context("spawn").Process(target=_serve, args=(there, self.task, self.load, self.log))
            process.start()
            there.close()
            self._workers.append(_Worker(process, here))

    def _hand_out(self) -> None:
        for worker in self._workers:
            job = self._next() if worker.ready and worker.job is None else None
            if job is None:
                continue
            # where it died between two cases, the next look at its pipe replaces it and takes the case up again
            with suppress(OSError):
                worker.give(job)

    def _next(self) -> Job | None:
        """The next job whose stand's first test is not being worked at."""
        busy = {w.job.id for w in self._workers if w.job}
        for i, job in enumerate(self._waiting):
            if job.first not in busy:
                return self._waiting.pop(i)
        return None

    def _collect(self) -> Iterator[Outcome]:
        now = monotonic()
        left = [w.since + self._allowed(w) - now for w in self._workers if w.job or not w.ready]
        heard = wait([w.pipe for w in self._workers], timeout=max(min(left, default=0.0), 0.0))
        for worker in list(self._workers):
            if worker.pipe in heard:
                yield from self._hear(worker)
            elif (worker.job or not worker.ready) and monotonic() - worker.since > self._allowed(worker):
                yield from self._too_late(worker)

    def _allowed(self, worker: _Worker) -> float:
        return self.limit if worker.ready else STARTUP

    def _hear(self, worker: _Worker) -> Iterator[Outcome]:
        try:
            status, message, result = worker.pipe.recv()
        except (EOFError, OSError):
            yield from self._dead(worker)
            return
        if status == BROKEN:
            raise RuntimeError(f"a worker could not load what it needs:\n{message}")
        if status == READY:
            worker.ready, self._still_born = True, 0
            return
        assert worker.job is not None
        job, worker.job = worker.job, None
        yield Outcome(job, status, result, message, worker.taken == 1)

    def _dead(self, worker: _Worker) -> Iterator[Outcome]:
        self._workers.remove(worker)
        worker.end()
        if not worker.ready:
            self._still_born += 1
            if self._still_born > 2:
                raise RuntimeError(f"workers die before they begin (exit status {worker.process.exitcode})")
        if worker.job is None:
            return
        self._attempts[worker.job.id] = self._attempts.get(worker.job.id, 0) + 1
        if self._attempts[worker.job.id] < ATTEMPTS:
            self._waiting.insert(0, worker.job)
        else:
            yield Outcome(worker.job, DIED, message=f"its worker died twice, exit status {worker.process.exitcode}")

    def _too_late(self, worker: _Worker) -> Iterator[Outcome]:
        self._workers.remove(worker)
        worker.end()
        if worker.job is None:
            raise RuntimeError(f"a worker took more than {STARTUP:g} s to load")
        yield Outcome(worker.job, LATE, message=f"took more than {self.limit:g} s")
