"""Where tests are run: processes of this machine, or the workers of a scheduler, both by ``dask.distributed``.

Scheduling, and what is done where a worker dies, is the library's. Workers that do not see the tests' folder are sent
what it holds, once each, and give the products back.
"""

from __future__ import annotations

import hashlib
import logging
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from hfanalysis.effects import trust
from hfanalysis.errors import InputError
from hfanalysis.processors import THREADS, processors
from hfanalysis.products.disk import atomic
from hfanalysis.sources import PACKAGE, digest
from hfanalysis.stages.open_test import PROCESSED, RAW
from hfanalysis.version import __version__

LOCAL = "127.0.0.1"
"""Where the processes of this machine listen: nobody else's machine reaches them."""

DEATHS = 2
"""Workers that may die while they run one test, and it is tried again; with one more it has failed. Source: a worker
can be killed from outside; twice is no accident."""

SECONDS = 20.0
"""Within which a scheduler has to answer [s]."""

LOOKED_AFTER, MISSED = 2.0, 8
"""Seconds between two looks at the processes of this machine, and looks at which one is missing before another is asked
for: a busy machine takes some seconds to start one."""

TOPIC = "hfanalysis"
"""Of what workers tell about what they are doing."""

SENT = (RAW, "effects", "engines", "limits.toml")
"""What workers are sent of a root that they do not see."""

UNSENT = (".lock",)
"""Files that are of the folder they lie in, and of no other."""

Content = dict[str, bytes]


class Cluster:
    """Workers, as long as it is open: ``with Cluster(jobs=2) as cluster``."""

    def __init__(self, jobs: int | None = None, scheduler: str | None = None) -> None:
        self._jobs, self._scheduler = jobs or processors(), scheduler
        self._open = ExitStack()
        self._client: Any = None

    def __enter__(self) -> Cluster:
        try:
            self._client = self._open.enter_context(self._connected())
        except BaseException:
            self._open.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def each(
        self,
        task: Callable[[str, Any], Any],
        names: Sequence[str],
        work: Any,
        doing: Callable[[str], None] = lambda _text: None,
    ) -> Iterator[tuple[str, Any]]:
        """What ``task(name, work)`` returns for every name, as each ends; in its place the reason, as a text, where its
        workers have died.

        Raises InputError where a worker has another version of the package, or sees other files.
        """
        from distributed import as_completed

        self._check_versions()
        work, sent = self._reached(work)
        client, folder = self._client, work.out or work.root / PROCESSED
        client.subscribe_topic(TOPIC, lambda event: doing(str(event[1])))
        waiting = {}
        try:
            for name in names:
                made = None if sent is None else contents(folder / name)
                waiting[client.submit(_done, task, name, work, sent, made, pure=False)] = name
            for future in as_completed(list(waiting), loop=client.loop):
                name = waiting[future]
                outcome, made = self._outcome(future, name)
                put(folder / name, made)
                yield name, outcome
                del waiting[future]  # whose outcome the scheduler may forget
        finally:
            client.unsubscribe_topic(TOPIC)
            client.cancel(list(waiting))

    @staticmethod
    def _outcome(future: Any, name: str) -> tuple[Any, Content]:
        from distributed import KilledWorker

        try:
            outcome, made = future.result()
        except KilledWorker:
            return f"{name}: the process that ran it died {DEATHS + 1} times; it is not tried again", {}
        return outcome, made

    @contextmanager
    def _connected(self) -> Iterator[Any]:
        import dask
        from distributed import Client, LocalCluster

        environment = {f"distributed.nanny.pre-spawn-environ.{name}": "1" for name in THREADS}
        settings = {
            **environment,
            "distributed.scheduler.allowed-failures": DEATHS,
            "distributed.scheduler.worker-saturation": 1.0,  # who waits for a worker does not die with it
            "distributed.scheduler.http.routes": [],  # nothing is told to who asks by a browser
            "distributed.worker.http.routes": [],
            "distributed.admin.system-monitor.gil.enabled": False,
            "distributed.worker.profile.enabled": False,  # its record of every second grows as long as a worker lives
        }
        logging.getLogger("distributed").setLevel(logging.CRITICAL)
        with dask.config.set(settings), ExitStack() as opened:
            if self._scheduler is not None:
                try:
                    client = opened.enter_context(Client(self._scheduler, timeout=SECONDS, set_as_default=False))
                except OSError as error:
                    raise InputError(
                        f"--scheduler {self._scheduler}: {error}; expected the address of a scheduler that runs"
                    ) from None
                yield client
                return
            scratch = opened.enter_context(tempfile.TemporaryDirectory(prefix="hfanalysis-workers-"))
            try:
                cluster = opened.enter_context(
                    LocalCluster(
                        n_workers=self._jobs, threads_per_worker=1, processes=True, host=LOCAL, dashboard_address=None,
                        scheduler_kwargs={"dashboard_address": f"{LOCAL}:0"}, local_directory=scratch,
                        silence_logs=logging.CRITICAL,
                    )
                )  # fmt: skip
            except RuntimeError as error:
                raise InputError(
                    f"a process that would run tests ended before it had begun ({error}); expected memory for "
                    f"{self._jobs} of them: fewer with --jobs, or say it again"
                ) from None
            opened.enter_context(_kept_up(cluster, self._jobs))
            yield opened.enter_context(Client(cluster, set_as_default=False))

    def _check_versions(self) -> None:
        if self._scheduler is None:
            return
        own = version()
        try:
            self._client.wait_for_workers(1, timeout=SECONDS)
        except TimeoutError:
            raise InputError(f"--scheduler {self._scheduler}: has no worker; expected one at least") from None
        for worker, theirs in self._client.run(version).items():
            if theirs != own:
                raise InputError(f"worker {worker}: has hfanalysis {theirs}; expected the one here, {own}")

    def _reached(self, work: Any) -> tuple[Any, Any]:
        """The work with paths that workers know, and what they are sent where they do not see the tests' folder."""
        work = replace(work, root=work.root.resolve(), out=None if work.out is None else work.out.resolve())
        if self._scheduler is None:
            return work, None
        own = seen(work.root)
        if all(theirs == own for theirs in self._client.run(seen, work.root).values()):
            return work, None
        agreed = trust.agreed(work.root / "effects") if (work.root / "effects").is_dir() else False
        whole = {name: content for part in SENT for name, content in contents(work.root / part, part).items()}
        return work, self._client.scatter((agreed, whole), broadcast=True)


@contextmanager
def _kept_up(cluster: Any, count: int) -> Iterator[None]:
    """As long as it is open a local cluster gets a process more where one is missing for a while: a process that dies
    while it is being started is not started again by the library."""
    over = threading.Event()

    def keep() -> None:
        missed = 0
        while not over.wait(LOOKED_AFTER):
            missing = count - len(cluster.scheduler.workers)
            missed = missed + 1 if missing > 0 else 0
            if missed > MISSED:
                cluster.scale(len(cluster.plan) + missing)
                missed = 0

    thread = threading.Thread(target=keep, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def version() -> str:
    """The package's version, and the digest of its sources."""
    return f"{__version__} ({digest(frozenset(PACKAGE.rglob('*.py')))[:12]})"


def seen(root: Path) -> str | None:
    """What one sees of the tests below ``root``: a hash of their definitions; None where there are none."""
    found = sorted((root / RAW).glob("*/test.toml"))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in found)).hexdigest() if found else None


def contents(place: Path, name: str = "") -> Content:
    """The files below a folder, or the file, by their paths from there, with ``name`` before them."""
    if place.is_file():
        return {name: place.read_bytes()}
    files = (path for path in sorted(place.rglob("*")) if path.is_file() and path.name not in UNSENT)
    return {(Path(name) / path.relative_to(place)).as_posix(): path.read_bytes() for path in files}


def put(folder: Path, made: Content) -> None:
    """Files into a folder, each whole or not at all; raises InputError where one would lie outside of it."""
    if odd := [name for name in made if Path(name).is_absolute() or ".." in Path(name).parts]:
        raise InputError(f"{odd[0]!r}: expected a file below {folder}")
    for name, content in made.items():
        with atomic(folder / name) as scratch:
            scratch.write_bytes(content)


def _done(
    task: Callable[[str, Any], Any], name: str, work: Any, sent: Any, made: Content | None
) -> tuple[Any, Content]:
    """The task, in a worker's process; what it made is returned where the worker was sent what it is made of."""
    if sent is None:
        return task(name, work), {}
    agreed, whole = sent
    with tempfile.TemporaryDirectory(prefix="hfanalysis-root-", ignore_cleanup_errors=True) as scratch:
        root = Path(scratch)
        put(root, whole)
        put(root / PROCESSED / name, made or {})
        if agreed:
            trust.agree(root / "effects", note=False)
        outcome = task(name, replace(work, root=root, out=None))
        return outcome, contents(root / PROCESSED / name)


class Telling:
    """What a test's run is at, told to who watches the workers: each text once."""

    def __init__(self, test: str) -> None:
        self._test, self._last = test, ""

    def __call__(self, text: str, _share: float | None = None) -> None:
        if text == self._last:
            return
        self._last = text
        with suppress(ValueError):  # in a process that is no worker's nobody watches
            from distributed import get_worker

            get_worker().log_event(TOPIC, f"{self._test}: {text}")
