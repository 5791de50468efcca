"""HDF5 products, written so that a disk that fills up ends in an error and not in the middle of the library.

The HDF5 library cannot take back what it has begun: where a write fails it tries again as its objects are closed, in
whatever state they are, and has crashed the process. Here it never hears of a failure. What it writes goes through a
file of ours that keeps the first error to itself, and raises it once the library has let go.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py

FORMAT = ("v108", "v110")
"""HDF5 versions that MATLAB and older tools read."""


class _Deferring(io.RawIOBase):
    """A file for HDF5 to write to; after the first failure all goes nowhere, and ``failure`` says what it was."""

    def __init__(self, path: Path) -> None:
        self._file = io.FileIO(path, "w+")
        self._at = 0
        self.failure: OSError | None = None

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """As of any file."""
        self._at = {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._size()}[whence] + offset
        return self._at

    def tell(self) -> int:
        """As of any file."""
        return self._at

    def readinto(self, target: Any) -> int:
        """What is there; what was lost reads as zeros."""
        view = memoryview(target).cast("B")
        self._file.seek(self._at)
        found = self._file.readinto(view) or 0
        view[found:] = bytes(len(view) - found)
        self._at += len(view)
        return len(view)

    def write(self, data: Any) -> int:
        """Takes everything; where the disk does not, that is kept for later."""
        view = memoryview(data).cast("B")
        done = 0
        while done < len(view) and self.failure is None:
            try:
                self._file.seek(self._at + done)
                done += self._file.write(view[done:]) or 0
            except OSError as error:
                self.failure = error
        self._at += len(view)
        return len(view)

    def truncate(self, size: int | None = None) -> int:
        """As of any file."""
        size = self._at if size is None else size
        try:
            if self.failure is None:
                self._file.truncate(size)
        except OSError as error:
            self.failure = error
        return size

    def close(self) -> None:
        """Gives the file back."""
        if not self.closed:
            self._file.close()
        super().close()

    def _size(self) -> int:
        return os.fstat(self._file.fileno()).st_size


@contextmanager
def created(path: Path, opened: Callable[..., Any] = h5py.File, **options: Any) -> Iterator[Any]:
    """A new HDF5 file at ``path``, closed at the end; ``options`` as of what it is ``opened`` with (``h5netcdf.File``
    does as well). Raises OSError where the system did not take what was written."""
    target = _Deferring(path)
    try:
        with opened(target, "w", **options) as file:
            yield file
    finally:
        target.close()
        if target.failure is not None:
            raise target.failure
