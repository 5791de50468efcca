"""Products on disk: written whole or not at all, hashed, and byte-identical from run to run.

A product is first written under a temporary name in its own folder and renamed when it is complete, so that a reader
(or a killed run) never meets half of one.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import shutil
import stat
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hfanalysis.sources import SETTLED_NS

TEMPORARY = ".tmp-"
"""How the temporary name of an unfinished product begins."""

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""What the system says where no more fits: the disk, the user's share of it, the largest file that is allowed."""

REFUSED = (errno.ENOTDIR, errno.EEXIST, errno.EACCES, errno.EPERM, errno.EROFS, *FULL)
"""What the system says that does not let us write: something that a person can do something about."""

WINDOWS = os.name == "nt"
"""Whether this is Windows, where a folder cannot be synchronized and nobody's group owns a file."""

_CHUNK = 1 << 20
"""Bytes read at a time [B]."""


def temporary_path(path: Path) -> Path:
    """The name under which ``path`` is written until it is complete: in the same folder, so that renaming is atomic."""
    return path.with_name(f"{TEMPORARY}{os.getpid()}-{path.name}")


def fsync(path: Path) -> None:
    """Have the file (or the folder's list of names) on the disk before going on.

    Windows opens no folder and takes a file that may be written to; there names are the file system's business.
    """
    if WINDOWS and path.is_dir():
        return
    descriptor = os.open(path, os.O_RDWR if WINDOWS else os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@contextlib.contextmanager
def atomic(path: Path) -> Iterator[Path]:
    """A temporary path to write to, renamed to ``path`` if the block ends well and removed if it does not."""
    make_folder(path.parent)
    scratch = temporary_path(path)
    try:
        yield scratch
        fsync(scratch)
        share(scratch)
        os.replace(scratch, path)
    finally:
        scratch.unlink(missing_ok=True)


def make_folder(folder: Path) -> None:
    """The folder and those above it, open to whom the folder is open that they are made in."""
    for new in reversed([folder, *folder.parents]):
        if not new.is_dir():
            new.mkdir(exist_ok=True)
            share(new)


def share(path: Path) -> None:
    """Give a new file or folder to the group of the folder it lies in, where that may write there: who works in one
    ``processed/`` goes on with what another has made."""
    if not hasattr(os, "geteuid"):  # Windows: what is made in a folder takes on its rights
        return
    folder, own = path.parent.stat(), path.stat()
    if not folder.st_mode & stat.S_IWGRP or own.st_uid != os.geteuid():
        return
    with contextlib.suppress(OSError):  # not a member of that group, or a file system without owners
        if own.st_gid != folder.st_gid:
            os.chown(path, -1, folder.st_gid)
        wider = stat.S_IRGRP | stat.S_IWGRP
        wider |= stat.S_IXGRP | folder.st_mode & stat.S_ISGID if path.is_dir() else 0
        os.chmod(path, stat.S_IMODE(own.st_mode) | wider)


def remove_temporaries(folder: Path) -> None:
    """Remove what killed runs left behind in ``folder`` and below it (the caller holds the folder's lock)."""
    for left in folder.rglob(f"{TEMPORARY}*"):
        left.unlink(missing_ok=True)


def _plain(value: Any) -> Any:
    """NumPy numbers and arrays, tuples' relatives and paths, as JSON knows them."""
    if hasattr(value, "to_json"):
        return value.to_json()
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Path):
        return value.as_posix()
    raise TypeError(f"{type(value).__name__} is not something a JSON product can hold")


def to_json(data: Any) -> str:
    """The JSON text of a product: the keys in the order given, floats in full, no NaN, a newline at the end.

    Quantities (anything with ``to_json``) and NumPy values may appear anywhere in ``data``.

    >>> print(to_json({"value": 1.5}), end="")
    {
      "value": 1.5
    }
    """
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False, default=_plain) + "\n"


def write_json(path: Path, data: Any) -> None:
    """Write a JSON product, whole or not at all."""
    text = to_json(data)
    with atomic(path) as scratch:
        scratch.write_text(text, encoding="utf-8")


def read_json(path: Path) -> dict[str, Any]:
    """Read a JSON product."""
    data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return data


def sha256_file(path: Path) -> str:
    """SHA-256 of a file's bytes, read in chunks."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(_CHUNK):
            digest.update(chunk)
    return digest.hexdigest()


def sha256_json(data: Any) -> str:
    """SHA-256 of data, whatever the order of its keys."""
    text = json.dumps(data, sort_keys=True, allow_nan=False, default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()


class HashCache:
    """SHA-256 of files, not read again while size, times and inode stay the same.

    A file younger than two seconds is not remembered: a second write within one tick of the file system's clock would
    go unseen.
    """

    def __init__(self, store: Path) -> None:
        self._store = store
        self._known: dict[str, list[Any]] = self._load()
        self._kept = dict(self._known)

    def _load(self) -> dict[str, list[Any]]:
        try:
            known = read_json(self._store)
        except (OSError, ValueError):
            return {}
        return known if isinstance(known, dict) else {}

    def __call__(self, path: Path) -> str:
        """The file's SHA-256. Raises OSError where it cannot be read."""
        name, state = str(path.resolve()), _state(path)
        known = self._known.get(name)
        if isinstance(known, list) and known[:-1] == state:
            return str(known[-1])
        digest = sha256_file(path)
        self._remember(name, path, state, digest)
        return digest

    def _remember(self, name: str, path: Path, state: list[int], digest: str) -> None:
        settled = time.time_ns() - max(state[1], state[2]) > SETTLED_NS
        if settled and _state(path) == state:
            self._known[name] = [*state, digest]
        else:
            self._known.pop(name, None)

    def save(self) -> None:
        """Keep what is known for the next run, if that is not what is kept already."""
        if self._known != self._kept:
            write_json(self._store, self._known)


def _state(path: Path) -> list[int]:
    """What tells that a file was not touched: size, modification and change time, inode."""
    stat = path.stat()
    return [stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns, stat.st_ino]


def touch_after(path: Path, inputs: list[Path], since: int) -> None:
    """Make ``path`` no older than any of ``inputs`` and than ``since`` [ns], so that make, which only knows times,
    finds it up to date."""
    newest = max([since, *(item.stat().st_mtime_ns for item in inputs)])
    if path.stat().st_mtime_ns < newest:
        _set_time(path, max(time.time_ns(), newest))


def touch_before(path: Path, newer: Path) -> None:
    """Make ``path`` older than the file ``newer``, by more than file systems' stamps can blur."""
    _set_time(path, newer.stat().st_mtime_ns - SETTLED_NS)


def _set_time(path: Path, when: int) -> None:
    """Set both times [ns]; of somebody else's file, which only a copy in its place can have others."""
    try:
        os.utime(path, ns=(when, when))
    except PermissionError:
        with atomic(path) as scratch:
            shutil.copyfile(path, scratch)
            os.utime(scratch, ns=(when, when))
