"""Locks on open files, by what the system has: ``flock``, or Windows' ``locking`` of a file's first byte.

Either is freed by the system where the process is killed. A system with neither (that of a browser, which runs one
process) goes without.
"""

from __future__ import annotations

import errno
import importlib
import time
from contextlib import suppress
from types import ModuleType

PAUSE = 0.1
"""[s] between two attempts where the system has no waiting of its own."""

NO_LOCKS = {errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS, errno.ENOLCK, errno.EINVAL}
"""What file systems say that have no locks: some network shares, FUSE, folders of a host in its virtual machine."""

HELD = {errno.EACCES, errno.EAGAIN, errno.EDEADLK}
"""What Windows says of a byte that another process has locked. Source: Microsoft's C run-time library, _locking."""


def attempt(descriptor: int) -> bool:
    """Whether the lock was to be had; False where another process holds it. Raises OSError where there are none."""
    if posix := _module("fcntl"):
        with suppress(BlockingIOError):
            posix.flock(descriptor, posix.LOCK_EX | posix.LOCK_NB)
            return True
        return False
    windows = _module("msvcrt")
    return windows is None or _first_byte(windows, descriptor)


def wait(descriptor: int) -> None:
    """Go on when the lock is ours. Raises OSError where there are none."""
    if posix := _module("fcntl"):
        posix.flock(descriptor, posix.LOCK_EX)
        return
    while not attempt(descriptor):
        time.sleep(PAUSE)


def _first_byte(windows: ModuleType, descriptor: int) -> bool:
    try:
        windows.locking(descriptor, windows.LK_NBLCK, 1)
    except OSError as error:
        if error.errno not in HELD:
            raise
        return False
    return True


def _module(name: str) -> ModuleType | None:
    with suppress(ImportError):
        return importlib.import_module(name)
    return None
