"""Products on disk: written whole or not at all, hashed, and byte-identical from run to run.

A product is first written under a temporary name in its own folder and renamed when it is complete, so that a reader
(or a killed run) never meets half of one.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hfanalysis.sources import SETTLED_NS

TEMPORARY = ".tmp-"
"""How the temporary name of an unfinished product begins."""

_CHUNK = 1 << 20
"""Bytes read at a time [B]."""


def temporary_path(path: Path) -> Path:
    """The name under which ``path`` is written until it is complete: in the same folder, so that renaming is atomic."""
    return path.with_name(f"{TEMPORARY}{os.getpid()}-{path.name}")


def fsync(path: Path) -> None:
    """Have the file (or the folder's list of names) on the disk before going on."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@contextlib.contextmanager
def atomic(path: Path) -> Iterator[Path]:
    """A temporary path to write to, renamed to ``path`` if the block ends well and removed if it does not."""
    path.parent.mkdir(parents=True, exist_ok=True)
    scratch = temporary_path(path)
    try:
        yield scratch
        fsync(scratch)
        os.replace(scratch, path)
    finally:
        scratch.unlink(missing_ok=True)


def remove_temporaries(folder: Path) -> None:
    """Remove what killed runs left behind in ``folder`` (the caller holds the folder's lock)."""
    for left in folder.glob(f"{TEMPORARY}*"):
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
        if known is not None and known[:-1] == state:
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
        """Keep what is known for the next run."""
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
        now = max(time.time_ns(), newest)
        os.utime(path, ns=(now, now))
