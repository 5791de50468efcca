"""Tables that cost seconds to make, kept in the user's cache folder; what is spoilt or of other code is made anew."""

from __future__ import annotations

import inspect
import io
import os
from collections.abc import Callable
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.sources import source_digest
from hfanalysis.users import own_temporary

_SEAL = 32
"""Length of a SHA-256 [B]. Source: definition."""


def cache_directory() -> Path:
    """Where tables are kept: $HFA_CACHE, else the user's cache folder, or one for temporary files who has no home."""
    if os.environ.get("HFA_CACHE"):
        return Path(os.environ["HFA_CACHE"])
    home = Path(os.path.expanduser("~"))
    base = os.environ.get("XDG_CACHE_HOME") or (home / ".cache" if home.is_absolute() else None)
    return Path(base) / "hfanalysis" if base else own_temporary()


def cached(name: str, shape: tuple[int, ...], make: Callable[[], Array]) -> Array:
    """The array of that name and shape (any unit [-]), from the cache where it is there and whole, else made and kept.

    ``name`` has to say what determines the array and is not in the sources of ``make``: versions of libraries, nodes.
    """
    path = cache_directory() / f"{name}-{source_digest(Path(inspect.getfile(make)))[:12]}.npy"
    stored = _load(path, shape)
    if stored is not None:
        return stored
    fresh = make()
    _store(path, fresh)
    return fresh


def _load(path: Path, shape: tuple[int, ...]) -> Array | None:
    """The array as it was kept; None where it is absent, or not what its checksum, its last bytes, says."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    content, seal = content[:-_SEAL], content[-_SEAL:]
    if sha256(content).digest() != seal:
        return None
    stored = np.load(io.BytesIO(content), allow_pickle=False)
    return np.asarray(stored, dtype=np.float64) if stored.shape == shape else None


def _store(path: Path, values: Array) -> None:
    temporary = path.with_name(f".{path.name}.{os.getpid()}.npy")
    content = io.BytesIO()
    np.save(content, values)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.write_bytes(content.getvalue() + sha256(content.getvalue()).digest())
        temporary.replace(path)
    except OSError:  # a read-only home costs time at each start, nothing else
        with suppress(OSError):
            temporary.unlink()
