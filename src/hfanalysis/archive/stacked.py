"""Arrays of many tests end to end, written piece by piece: what is at hand at once is a piece of each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import h5netcdf
import numpy as np
from numpy.typing import NDArray

from hfanalysis.archive.layout import CHUNK

Numbers = NDArray[Any]

OF_A_FILE = ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "DIMENSION_LABELS", "_FillValue")
"""Attributes that say how a product's own file is laid out, and nothing of what is in it."""


def missing(kind: np.dtype[Any]) -> Any:
    """What stands where a test does not have a variable that others have: no number, or the greatest of its kind.

    >>> missing(np.dtype("f8")), missing(np.dtype("u1"))
    (nan, 255)
    """
    return float("nan") if kind.kind == "f" else int(np.iinfo(kind).max)


class Column:
    """One variable along one axis of an archive, filled from its beginning."""

    def __init__(
        self, group: h5netcdf.Group, name: str, axis: str, kind: np.dtype[Any], about: Mapping[str, Any]
    ) -> None:
        self._fill = missing(kind)
        self._made = group.create_variable(
            name,
            (axis,),
            kind,
            fillvalue=self._fill,
            chunks=(CHUNK,),
            compression="gzip",
            compression_opts=4,
            shuffle=True,
        )
        for key, value in about.items():
            self._made.attrs[key] = value
        self._kind, self._waiting, self._at, self.end = kind, list[Numbers](), 0, 0

    def add(self, values: Numbers) -> None:
        """Values (n,) more."""
        self._waiting.append(values)
        self.end += values.size
        if self.end - self._at >= CHUNK:
            self.write()

    def fill_to(self, end: int) -> None:
        """Nothing up to there: tests that do not have it."""
        if end > self.end:
            self.add(np.full(end - self.end, self._fill, dtype=self._kind))

    def write(self) -> None:
        """What has come since the last time."""
        if self._waiting:
            self._made[self._at : self.end] = np.concatenate(self._waiting).astype(self._kind, copy=False)
            self._at, self._waiting = self.end, []


class Stack:
    """The variables of one axis of one group of products: of every test one stretch, in the order of the tests."""

    def __init__(self, group: h5netcdf.Group, axis: str) -> None:
        self._group, self._axis = group, axis
        self._dimension = f"{group.name.strip('/').replace('/', '_')}_{axis}"
        self._columns: dict[str, Column] = {}
        self._counts: list[int] = []
        self._end = 0
        group.dimensions[self._dimension] = None

    def add(self, place: int, found: Mapping[str, tuple[Numbers, Mapping[str, Any]]]) -> None:
        """What test number ``place`` has: values (n,) and attributes by the name of a variable, the axis among them."""
        count = found[self._axis][0].size
        self._counts += [0] * (place - len(self._counts)) + [count]
        self._group.resize_dimension(self._dimension, self._end + count)
        for name, (values, about) in found.items():
            if name not in self._columns:
                self._columns[name] = Column(self._group, name, self._dimension, values.dtype, about)
            self._columns[name].fill_to(self._end)
            self._columns[name].add(values)
        self._end += count

    def close(self, tests: int) -> None:
        """Write what is waiting, and how much is of which of so many ``tests``."""
        for column in self._columns.values():
            column.fill_to(self._end)
            column.write()
        counts = np.array(self._counts + [0] * (tests - len(self._counts)), dtype=np.int64)
        made = self._group.create_variable(f"{self._axis}_count", ("test",), np.int64, data=counts)
        made.attrs.update(units="1", sample_dimension=self._dimension, long_name="samples of each test")


def attributes(found: Mapping[str, Any]) -> dict[str, Any]:
    """What a product's variable says of itself."""
    return {key: value for key, value in found.items() if key not in OF_A_FILE and not key.startswith("_Netcdf")}
