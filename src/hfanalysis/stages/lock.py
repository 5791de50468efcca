"""One run at a time works on a test's product folder."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterator
from hashlib import sha256
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.products.disk import make_folder, share
from hfanalysis.stages import file_locks

NAME = ".lock"


@contextlib.contextmanager
def locked(folder: Path, waiting: Callable[[], None]) -> Iterator[None]:
    """Hold the folder's lock; ``waiting`` is called once if another run has it. The system frees it if we are killed.

    The folder may be deleted by somebody while we wait: a lock that is no longer the one on disk is taken anew. Where
    the folder's file system has no locks, a file in this machine's folder for temporary files stands for it.
    """
    descriptor = _open(folder, waiting)
    try:
        yield
    finally:
        os.close(descriptor)


def _open(folder: Path, waiting: Callable[[], None]) -> int:
    while True:
        try:
            make_folder(folder)
        except FileNotFoundError:  # not for want of a parent: the file system takes no folders
            raise InputError(f"{folder}: cannot be made; choose another place with --out DIR") from None
        with contextlib.suppress(FileNotFoundError):
            descriptor = _open_file(folder / NAME)
            if not _take(descriptor, waiting):
                os.close(descriptor)
                return _instead(folder, waiting)
            if _is_on_disk(descriptor, folder / NAME):
                return descriptor
            os.close(descriptor)


def _open_file(path: Path) -> int:
    """The lock's file; that of somebody else may be there to read only, which is enough to lock it."""
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except PermissionError:
        return os.open(path, os.O_RDONLY)
    share(path)
    return descriptor


def _take(descriptor: int, waiting: Callable[[], None]) -> bool:
    """Wait for the lock; False where the file system has none."""
    try:
        if not file_locks.attempt(descriptor):
            waiting()
            file_locks.wait(descriptor)
    except OSError as error:
        if error.errno not in file_locks.NO_LOCKS:
            raise
        return False
    return True


def _instead(folder: Path, waiting: Callable[[], None]) -> int:
    """A locked file among this machine's temporary ones, by the folder's name; other machines do not see it."""
    name = f"hfanalysis-{sha256(str(folder.resolve()).encode()).hexdigest()[:24]}.lock"
    path = Path(tempfile.gettempdir()) / name
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o600)
    if not _take(descriptor, waiting):
        os.close(descriptor)
        raise InputError(f"{folder}: found no locks, nor in {path.parent}; choose another file system with --out DIR")
    return descriptor


def _is_on_disk(descriptor: int, path: Path) -> bool:
    """Whether the open file is the one that has this name now."""
    with contextlib.suppress(FileNotFoundError):
        return os.path.samestat(os.fstat(descriptor), path.stat())
    return False
