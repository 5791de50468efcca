"""What an HDF5 file itself holds: nothing that it fetches from other files, everything once, and read when it is asked
for.

An HDF5 file may name other files in three ways: links, virtual data sets, and data sets whose bytes lie elsewhere. A
log that does is refused: what it names need not be of the test, and is not in the record of what was read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from hfanalysis.errors import InputError

DEEPEST = 64
"""Groups within groups beyond which nobody names a channel [groups]."""


@dataclass(frozen=True)
class Stored:
    """A data set's numbers, which are read when an array is made of it."""

    path: Path
    key: str
    finished: Callable[[NDArray[np.float64]], NDArray[np.float64]] = lambda numbers: numbers
    """What is made of the numbers as they are in the file."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        with h5py.File(self.path, "r") as file:
            numbers = np.asarray(file[self.key][()], dtype=np.float64).ravel()
        return self.finished(numbers).astype(dtype or np.float64, copy=False)


def datasets(path: Path, file: h5py.File) -> Iterator[tuple[tuple[str, ...], h5py.Dataset]]:
    """The data sets with their names, group by group; one that has several names, or lies in a group that has, is
    listed under the first.

    Raises :class:`InputError` where one is in another file.
    """
    yield from _within(path, file, (), {_place(file)})


def _within(
    path: Path, group: h5py.Group, above: tuple[str, ...], seen: set[Any]
) -> Iterator[tuple[tuple[str, ...], h5py.Dataset]]:
    for key in group:
        names = (*above, key)
        link = group.get(key, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            raise _elsewhere(path, names, "a link into another file", link.filename)
        if isinstance(link, h5py.SoftLink):
            continue  # another name of what is listed under its own
        item = group[key]
        if _place(item) in seen:
            continue
        seen.add(_place(item))
        if isinstance(item, h5py.Dataset):
            _check_own(path, names, item)
            yield names, item
        elif isinstance(item, h5py.Group) and len(names) < DEEPEST:
            yield from _within(path, item, names, seen)


def _place(item: Any) -> Any:
    """What tells one object in a file from another."""
    info = h5py.h5o.get_info(item.id)
    return info.fileno, info.addr


def _check_own(path: Path, names: tuple[str, ...], item: h5py.Dataset) -> None:
    if item.is_virtual:
        raise _elsewhere(path, names, "a virtual data set", ", ".join(one.file_name for one in item.virtual_sources()))
    if item.external:
        raise _elsewhere(path, names, "data kept in another file", ", ".join(str(one[0]) for one in item.external))


def _elsewhere(path: Path, names: tuple[str, ...], what: str, where: str) -> InputError:
    return InputError(f"{path}: {'/'.join(names)!r} is {what} ({where}); expected all data in the log itself")
