"""Tests on the processes of a cluster: each ends by itself, and what dies with its process is told."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import cloudpickle
import dask
import distributed
import psutil
import pytest
from tests.campaign.rows import definition
from tests.cli.run import hfa

from hfanalysis.campaign import cluster as place
from hfanalysis.campaign import side_by_side
from hfanalysis.campaign.cluster import Cluster
from hfanalysis.campaign.side_by_side import Ended, Work, run_all, run_one
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.interface.ending import plainly

cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers do not have this file's folder


@pytest.fixture(scope="module")
def workers() -> Iterator[Cluster]:
    with Cluster(2) as opened:
        yield opened


def killing(name: str, work: Work) -> str:
    """ "bad" ends the process each time; "once" the first time; the others say what they find."""
    mark = work.root / f"{name}.died"
    if name == "bad" or (name == "once" and not mark.exists()):
        with mark.open("a") as file:
            file.write("x")
        os._exit(1)
    return f"{name} {os.environ['OMP_NUM_THREADS']}"


def test_what_kills_its_process_is_named_and_the_others_are_there(workers: Cluster, tmp_path: Path) -> None:
    names = ["one", "bad", "two", "once", "three"]
    found = dict(workers.each(killing, names, Work(tmp_path)))
    assert found.pop("bad") == f"bad: the process that ran it died {place.DEATHS + 1} times; it is not tried again"
    assert found == {name: f"{name} 1" for name in names if name != "bad"}
    assert (tmp_path / "bad.died").read_text() == "x" * (place.DEATHS + 1)
    assert (tmp_path / "once.died").read_text() == "x"


def test_a_process_that_is_not_started_again_is_replaced(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """One that dies while it is being started is given up by the library."""
    monkeypatch.setattr(place, "LOOKED_AFTER", 0.2)
    with Cluster(1) as opened:
        lent = opened._client.cluster
        (nanny,) = lent.workers.values()
        nanny.status = distributed.Status.failed
        (process,) = (p for p in psutil.Process().children(recursive=True) if p.pid == nanny.pid)
        process.kill()
        assert dict(opened.each(killing, ["one"], Work(tmp_path))) == {"one": "one 1"}
        assert len(lent.plan) == 2


def profiled(_name: str, _work: Work) -> bool:
    """Whether the worker keeps a record of where its time goes, of every second, for ever."""
    return bool(dask.config.get("distributed.worker.profile.enabled"))


def test_workers_do_not_fill_their_memory_with_what_they_did(workers: Cluster, tmp_path: Path) -> None:
    assert dict(workers.each(profiled, ["one"], Work(tmp_path))) == {"one": False}


def test_nobody_else_reaches_the_processes(workers: Cluster) -> None:
    me = psutil.Process()
    listening = [
        at.laddr.ip for p in (me, *me.children(recursive=True)) for at in p.net_connections() if at.status == "LISTEN"
    ]
    assert len(listening) >= 3
    assert set(listening) == {"127.0.0.1"}


def test_how_each_ends_is_told(workers: Cluster, tmp_path: Path) -> None:
    told, doing = dict[str, Ended](), list[str]()
    found = run_all(["one", "two"], Work(tmp_path), workers, told.__setitem__, doing.append)
    assert list(found) == ["one", "two"]
    assert found == told
    assert found["one"].status == 2
    assert found["one"].said.startswith("test 'one': no such folder in ")
    assert not found["one"].defect


def test_what_a_run_is_at_is_told_to_who_watches(workers: Cluster, tmp_path: Path) -> None:
    definition(tmp_path, "T1")
    doing = list[str]()
    found = run_all(["T1"], Work(tmp_path), workers, lambda *_: None, doing.append)
    assert found["T1"].status in (2, 3)
    assert "T1: ingest" in doing


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (AbsentError("no tank pressure"), 3, "no tank pressure"),
        (InputError("found x"), 2, "found x"),
        (PermissionError(13, "Permission denied", "there"), 2, "there: Permission denied"),
        (MemoryError(), 2, "the memory is not enough"),
        (ZeroDivisionError("oh"), 1, "ZeroDivisionError: oh"),
    ],
)
def test_a_run_raises_nothing(monkeypatch: pytest.MonkeyPatch, error: Exception, status: int, said: str) -> None:
    def failing(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(side_by_side, "open_test", failing)
    ended = run_one("T1", Work(Path()))
    assert ended.status == status
    assert said in ended.said
    assert ended.defect == (status == 1)
    assert (plainly(error) is None) == ended.defect


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """A scheduler of somebody else's, with one worker."""
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, silence_logs=50,
        scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
    ) as lent:  # fmt: skip
        yield lent.scheduler_address


def making(name: str, work: Work) -> str:
    """What one sees of the tests, and a product, where the worker is told to work."""
    folder = work.root / "processed" / name
    before = (folder / "old.json").read_text()
    (folder / ".state").mkdir()
    (folder / ".state" / "new.json").write_text("made")
    (folder / ".lock").write_text("")
    log = (work.root / "raw_tests" / name / "log.csv").read_text()
    return f"{before} {log.splitlines()[0]} {sorted(p.name for p in (work.root / 'raw_tests').iterdir())}"


@pytest.mark.parametrize("shared", [True, False])
def test_workers_that_do_not_see_the_folder_are_sent_it_and_give_the_products_back(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, address: str, shared: bool
) -> None:
    for test in ("T1", "T2"):
        definition(tmp_path, test)
    (tmp_path / "processed" / "T1").mkdir(parents=True)
    (tmp_path / "processed" / "T1" / "old.json").write_text("old")
    if not shared:
        monkeypatch.setattr(place, "seen", lambda _root: os.getpid())
    with Cluster(scheduler=address) as others:
        assert dict(others.each(making, ["T1"], Work(tmp_path))) == {"T1": "old time,p ['T1', 'T2']"}
    made = tmp_path / "processed" / "T1"
    assert (made / ".state" / "new.json").read_text() == "made"
    assert (made / ".lock").exists() is shared  # it is of those who see the folder


class _answers:
    """Another version here than on the workers, to which the function itself is sent."""

    def __init__(self, theirs: Callable[[], str]) -> None:
        self._theirs = theirs

    def __call__(self) -> str:
        return "0.0"

    def __reduce__(self) -> tuple[object, ...]:
        return _same, (self._theirs,)


def _same(function: Callable[[], str]) -> Callable[[], str]:
    return function


def test_a_worker_of_another_version_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, address: str) -> None:
    theirs = place.version
    monkeypatch.setattr(place, "version", _answers(theirs))
    with Cluster(scheduler=address) as others, pytest.raises(InputError, match=r"expected the one here, 0\.0"):
        list(others.each(making, ["T1"], Work(tmp_path)))


def test_a_scheduler_that_does_not_answer_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(place, "SECONDS", 0.2)
    definition(tmp_path, "T1")
    ended = hfa("campaign", "--root", tmp_path, "--scheduler", "tcp://127.0.0.1:1", "--quiet")
    assert ended.status == 2
    assert "expected the address of a scheduler that runs" in ended.err
    assert "whoever reaches it can run anything on its workers" in ended.err


@pytest.mark.parametrize("name", ["../x", "/x", "a/../../x"])
def test_a_worker_puts_nothing_elsewhere(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="expected a file below"):
        place.put(tmp_path / "T1", {name: b""})
    assert not any(tmp_path.iterdir())


def test_a_scheduler_without_workers_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(place, "SECONDS", 1.0)
    with (
        distributed.LocalCluster(
            n_workers=0, host="127.0.0.1", dashboard_address=None, silence_logs=50,
            scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},
        ) as lent,
        Cluster(scheduler=lent.scheduler_address) as none,
        pytest.raises(InputError, match="has no worker"),
    ):  # fmt: skip
        list(none.each(making, ["T1"], Work(tmp_path)))


def test_a_process_that_ends_before_it_has_begun_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def ending(*_: object, **__: object) -> None:
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr(distributed, "LocalCluster", ending)
    with pytest.raises(InputError, match=r"ended before it had begun .*expected memory for 3 of them"), Cluster(3):
        pass
