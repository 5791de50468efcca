"""What runs where there is no fcntl: Windows, and a system with no locks at all."""

from __future__ import annotations

import ast
import errno
import multiprocessing
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import hfanalysis
from hfanalysis.products import disk
from hfanalysis.stages import file_locks, lock

POSIX_ONLY = {
    "chown", "fork", "geteuid", "getuid", "ftruncate", "pread", "pwrite", "kill", "killpg", "setsid", "mkfifo",
    "sched_getaffinity", "O_NOFOLLOW", "SIGKILL", "SIGALRM", "setitimer", "alarm",
}  # fmt: skip
MODULES = {"fcntl", "resource", "pwd", "grp", "termios", "tty", "pty"}


def windows() -> ModuleType:
    """msvcrt as its documentation has it, on what this system has."""
    import fcntl

    made = ModuleType("msvcrt")
    made.LK_NBLCK = 2  # type: ignore[attr-defined]

    def locking(descriptor: int, mode: int, count: int) -> None:
        assert (mode, count) == (2, 1)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise PermissionError(errno.EACCES, "Permission denied") from None

    made.locking = locking  # type: ignore[attr-defined]
    return made


@pytest.fixture(params=["posix", "windows"])
def system(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    if request.param == "windows":
        monkeypatch.setitem(sys.modules, "msvcrt", windows())
        monkeypatch.setitem(sys.modules, "fcntl", None)
    return


def hold(folder: Path, held: object, go: object) -> None:
    with lock.locked(folder, lambda: None):
        held.set()  # type: ignore[attr-defined]
        go.wait(20)  # type: ignore[attr-defined]


def test_one_run_waits_for_another_and_a_killed_one_frees_it(system: None, tmp_path: Path) -> None:
    fork = multiprocessing.get_context("fork")
    held, go = fork.Event(), fork.Event()
    other = fork.Process(target=hold, args=(tmp_path, held, go))
    other.start()
    assert held.wait(20)
    waited: list[float] = []

    def waiting() -> None:
        waited.append(time.monotonic())
        other.kill()

    with lock.locked(tmp_path, waiting):
        assert len(waited) == 1
    other.join()


def test_a_lock_whose_file_was_deleted_meanwhile_is_taken_anew(
    system: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    attempt, taken = file_locks.attempt, []

    def deleted_first(descriptor: int) -> bool:
        if not taken:
            (tmp_path / lock.NAME).unlink()
        taken.append(descriptor)
        return attempt(descriptor)

    monkeypatch.setattr(file_locks, "attempt", deleted_first)
    with lock.locked(tmp_path, lambda: None):
        assert len(taken) == 2
        assert (tmp_path / lock.NAME).exists()
        assert not attempt_elsewhere(tmp_path / lock.NAME)


def attempt_elsewhere(path: Path) -> bool:
    descriptor = os.open(path, os.O_RDWR)
    try:
        return file_locks.attempt(descriptor)
    finally:
        os.close(descriptor)


def test_a_system_without_locks_goes_without(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fcntl", None)
    with lock.locked(tmp_path, lambda: pytest.fail("there is nobody to wait for")):
        assert (tmp_path / lock.NAME).exists()


def test_windows_synchronizes_files_and_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(disk, "WINDOWS", True)
    opened: list[tuple[Path, int]] = []
    real = os.open
    monkeypatch.setattr(os, "open", lambda path, flags, *more: opened.append((path, flags)) or real(path, flags, *more))
    disk.write_json(tmp_path / "x.json", {"a": 1})
    disk.fsync(tmp_path)
    assert [flags for _, flags in opened] == [os.O_RDWR]
    assert disk.read_json(tmp_path / "x.json") == {"a": 1}


def test_without_owners_nothing_is_shared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(os, "geteuid")
    monkeypatch.delattr(os, "chown")
    tmp_path.chmod(0o770)
    disk.write_json(tmp_path / "x.json", {})
    assert disk.read_json(tmp_path / "x.json") == {}


GUARDED = {"geteuid", "sched_getaffinity", "chown"}
"""What is behind a ``hasattr`` in the same module (chown: behind that of geteuid)."""


def test_the_library_calls_nothing_that_windows_lacks() -> None:
    found = []
    for path in sorted(Path(hfanalysis.__file__).parent.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Attribute) and ast.unparse(node.value) in ("os", "signal"):
                if node.attr in POSIX_ONLY and not (node.attr in GUARDED and "hasattr(os, " in text):
                    found.append(f"{path.name}: {ast.unparse(node)}")
            elif isinstance(node, ast.Import | ast.ImportFrom):
                names = [node.module] if isinstance(node, ast.ImportFrom) else [item.name for item in node.names]
                found += [f"{path.name}: import {name}" for name in names if name in MODULES]
    assert found == []
