"""One run at a time works on a test's product folder."""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Callable, Iterator
from pathlib import Path

from hfanalysis.errors import InputError

NAME = ".lock"


@contextlib.contextmanager
def locked(folder: Path, waiting: Callable[[], None]) -> Iterator[None]:
    """Hold the folder's lock; ``waiting`` is called once if another run has it. The system frees it if we are killed.

    The folder may be deleted by somebody while we wait: a lock that is no longer the one on disk is taken anew.
    """
    descriptor = _open(folder, waiting)
    try:
        yield
    finally:
        os.close(descriptor)


def _open(folder: Path, waiting: Callable[[], None]) -> int:
    while True:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except FileNotFoundError:  # not for want of a parent: the file system takes no folders
            raise InputError(f"{folder}: cannot be made; choose another place with --out DIR") from None
        with contextlib.suppress(FileNotFoundError):
            descriptor = os.open(folder / NAME, os.O_RDWR | os.O_CREAT, 0o666)
            _take(descriptor, waiting)
            if _is_on_disk(descriptor, folder / NAME):
                return descriptor
            os.close(descriptor)


def _take(descriptor: int, waiting: Callable[[], None]) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        waiting()
        fcntl.flock(descriptor, fcntl.LOCK_EX)


def _is_on_disk(descriptor: int, path: Path) -> bool:
    """Whether the open file is the one that has this name now."""
    with contextlib.suppress(FileNotFoundError):
        return os.path.samestat(os.fstat(descriptor), path.stat())
    return False
