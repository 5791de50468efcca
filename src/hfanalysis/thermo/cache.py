"""Tables that cost seconds to make, kept in the user's cache folder; what is spoilt or of other code is made anew."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.sources import source_digest


def cache_directory() -> Path:
    """Where tables are kept: $HFA_CACHE, else the user's cache folder."""
    if os.environ.get("HFA_CACHE"):
        return Path(os.environ["HFA_CACHE"])
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(base) / "hfanalysis"


def cached(name: str, shape: tuple[int, ...], make: Callable[[], Array]) -> Array:
    """The array of that name and shape (any unit [-]), from the cache where it is there and finite, else made and kept.

    ``name`` has to say what determines the array and is not in the sources of ``make``: versions of libraries, nodes.
    """
    path = cache_directory() / f"{name}-{source_digest(Path(inspect.getfile(make)))[:12]}.npy"
    try:
        stored = np.load(path, allow_pickle=False)
        if stored.shape == shape and np.isfinite(stored).all():
            return np.asarray(stored, dtype=np.float64)
    except (OSError, ValueError, EOFError):
        pass  # absent, unreadable or cut short: made anew below
    fresh = make()
    _store(path, fresh)
    return fresh


def _store(path: Path, values: Array) -> None:
    temporary = path.with_name(f".{path.name}.{os.getpid()}.npy")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        np.save(temporary, values)
        temporary.replace(path)
    except OSError:  # a read-only home costs time at each start, nothing else
        with suppress(OSError):
            temporary.unlink()
