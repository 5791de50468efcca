"""Reading an archive: what it holds is known at once, and what is asked for is read alone."""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, BinaryIO

import h5py
import numpy as np
from numpy.typing import NDArray

from hfanalysis.archive.layout import (
    FILES,
    MADE,
    NO_VERDICT,
    QUANTITIES,
    RAW,
    SERIES,
    TITLE,
    VERSION,
    checked,
    checked_test,
)
from hfanalysis.archive.stacked import missing
from hfanalysis.campaign.query import FACTS, Asked, asked_of
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products.disk import make_folder
from hfanalysis.products.tidy import COLUMNS, Row, rows
from hfanalysis.products.tidy import FILES as WITH_QUANTITIES
from hfanalysis.record.readers.hdf5_inside import datasets
from hfanalysis.units import near

if TYPE_CHECKING:
    import xarray as xr

COUNT = "_count"
"""Ending of what says how much of an axis is of which test."""


class Archive:
    """An archive, open: ``with Archive(path) as kept``. ``tests``: the names of its tests, in their order.

    Raises InputError where the file is no archive, or fetches anything from another file.
    """

    def __init__(self, path: str | Path, file: BinaryIO | None = None) -> None:
        self.path = Path(path)
        try:
            self._file = h5py.File(file if file is not None else self.path, "r")
        except OSError as error:
            if not self.path.exists():
                raise AbsentError(f"{self.path}: no such file; hfa archive --write {self.path} makes it") from None
            raise InputError(f"{self.path}: expected an archive of hfa archive: {error}") from None
        try:
            self._check()
        except BaseException:
            self.close()
            raise
        self.tests = tuple(checked_test(name) for name in self._texts(self._file, "test"))
        self._places = {name: place for place, name in enumerate(self.tests)}

    def _check(self) -> None:
        about = self._file.attrs
        if about.get("title") != TITLE or any(name not in self._file for name in ("test", QUANTITIES, FILES)):
            raise InputError(f"{self.path}: expected an archive of hfa archive, which it is not")
        if about.get("layout") != VERSION:
            raise InputError(f"{self.path}: layout {about.get('layout')} of archives; this version reads {VERSION}")
        for _ in datasets(self.path, self._file):
            pass  # refused where one of them lies in another file

    def close(self) -> None:
        """Gives the file back."""
        self._file.close()

    def __enter__(self) -> Archive:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Archive {self.path}: {len(self.tests)} tests, {len(self.series)} series>"

    @property
    def index(self) -> xr.Dataset:
        """The tests and what they state: ``stand``, ``kind``, ``source``, ``date`` along ``test``."""
        import xarray as xr

        facts = {name: ("test", self._facts[name]) for name in FACTS if name != "test"}
        return xr.Dataset(facts, coords={"test": list(self.tests)})

    def tree(self) -> xr.DataTree:
        """All of it as xarray has it, read as it is asked for; to be closed by whoever opens it."""
        import xarray as xr

        return xr.open_datatree(self.path, engine="h5netcdf", decode_times=False)

    @cached_property
    def series(self) -> tuple[str, ...]:
        """What HDF5 products hold along an axis: "ingest", "residuals/full/p_chamber" and so on."""
        found = list[str]()
        if SERIES in self._file:

            def visit(name: str, item: h5py.Group | h5py.Dataset) -> None:
                if name.endswith(COUNT) and isinstance(item, h5py.Dataset):
                    found.append(name.rpartition("/")[0])

            self._file[SERIES].visititems(visit)
        return tuple(dict.fromkeys(found))

    def read(self, series: str, test: str) -> xr.Dataset:
        """What one test has of a series, and nothing else of the file: its variables over its axes, with units.

        Raises AbsentError where the archive, or the test, does not have it.
        """
        import xarray as xr

        place = self._place(test)
        if series not in self.series:
            raise AbsentError(f"{self.path}: no {series}{near(series, self.series)}")
        group, made = self._file[SERIES][series], dict[str, Any]()
        for name in [n for n in group if n.endswith(COUNT) and isinstance(group[n], h5py.Dataset)]:
            axis = name.removesuffix(COUNT)
            begin, end = self._stretch(f"{SERIES}/{series}/{name}", place)
            if begin == end:
                continue
            along = group[name].attrs["sample_dimension"]
            for own, item in group.items():
                if isinstance(item, h5py.Dataset) and own != name and self._along(item) == along:
                    values = item[begin:end]
                    if own == axis or not _is_missing(values):
                        made[own] = (axis, values, _told(item))
        if not made:
            raise AbsentError(f"{self.path}: {test} has no {series}")
        return xr.Dataset(made)

    def rows(self, test: str) -> Iterator[Row]:
        """Every quantity of one test, with its reason, from its products' own files."""
        have = self.files(test)
        for product in WITH_QUANTITIES:
            if (name := f"{MADE}/{product}.json") in have:
                yield from rows(test, product, json.loads(self.content(test, name)))

    def asked(self, names: Sequence[str]) -> dict[str, Asked]:
        """The tests as a condition on these names sees them: with the quantities alone that it can mean."""
        known = self._names
        wanted = [i for i, n in enumerate(known) if any(n == w or n.rpartition(".")[2] == w for w in names)]
        found: list[list[Row]] = [[] for _ in self.tests]
        for i in wanted:
            for place, row in self._numbers(i):
                found[place].append(row)
        return {test: asked_of(found[place], self._stated(place)) for place, test in enumerate(self.tests)}

    def files(self, test: str) -> tuple[str, ...]:
        """The names of a test's files in the archive: raw/… beside its test.toml, processed/… among its products."""
        begin, end = self._stretch(f"{FILES}/count", self._place(test))
        return tuple(self._texts(self._file[FILES], "name", begin, end))

    def content(self, test: str, name: str) -> bytes:
        """One file of a test. Raises AbsentError where it has none of that name, InputError where it is not what was
        written."""
        have = self.files(test)
        if name not in have:
            raise AbsentError(f"{self.path}: {test} has no file {name}{near(name, have)}")
        place = self._stretch(f"{FILES}/count", self._place(test))[0] + have.index(name)
        begin, end = self._stretch(f"{FILES}/size", place)
        (told,) = self._texts(self._file[FILES], "sha256", place, place + 1)
        try:
            content = zlib.decompress(self._file[FILES]["data"][begin:end].tobytes())
        except zlib.error as error:
            raise InputError(f"{self.path}: {name} of {test} is damaged: {error}") from None
        if hashlib.sha256(content).hexdigest() != told:
            raise InputError(f"{self.path}: {name} of {test} is damaged: its hash is another")
        return content

    def give_back(self, test: str, raw_tests: Path, processed: Path) -> None:
        """The files of a test, as they were, into folders of its name below these two.

        Raises InputError where a folder of that name is there, or a file is damaged or would lie elsewhere.
        """
        kept = {checked(name): self.content(test, name) for name in self.files(test)}
        folders = {RAW: raw_tests / test, MADE: processed / test}
        if taken := [folder for folder in folders.values() if folder.exists()]:
            raise InputError(f"{taken[0]}: is there already; expected no test of that name (--root DIR: another place)")
        for place, content in kept.items():
            target = folders[place.parts[0]].joinpath(*place.parts[1:])
            make_folder(target.parent)
            target.write_bytes(content)

    def _place(self, test: str) -> int:
        if test not in self._places:
            raise AbsentError(f"{self.path}: no test {test}{near(test, self.tests)}")
        return self._places[test]

    @cached_property
    def _names(self) -> list[str]:
        return self._texts(self._file[QUANTITIES], "name")

    @cached_property
    def _facts(self) -> dict[str, list[str]]:
        return {name: self._texts(self._file, name) for name in FACTS if name != "test"}

    def _stated(self, place: int) -> dict[str, str | None]:
        return {"test": self.tests[place], **{name: texts[place] or None for name, texts in self._facts.items()}}

    def _numbers(self, name: int) -> Iterator[tuple[int, Row]]:
        """The numbers of one name, with the places of their tests."""
        group = self._file[QUANTITIES]
        begin, end = self._stretch(f"{QUANTITIES}/count", name)
        product, _, own = self._names[name].partition(".")
        (unit,) = self._texts(group, "unit", name, name + 1)
        verdicts = [
            v.replace("_", " ").replace(NO_VERDICT, "") for v in str(group["verdict"].attrs["flag_meanings"]).split()
        ]
        columns = {c: group[c][begin:end].tolist() for c in ("of_test", "value", "std", "low95", "high95", "verdict")}
        for place, value, std, low, high, verdict in zip(*columns.values(), strict=True):
            numbers = [None if number != number else number for number in (value, std, low, high)]
            test = self.tests[place]
            cells = (test, product, own, numbers[0], unit, *numbers[1:], verdicts[verdict], "")
            yield place, dict(zip(COLUMNS, cells, strict=True))

    def _stretch(self, counts: str, place: int) -> tuple[int, int]:
        """From where to where something is of which there is so much of each."""
        if counts not in self._ends:
            self._ends[counts] = np.concatenate([[0], np.cumsum(self._file[counts][()])])
        begin, end = self._ends[counts][place : place + 2]
        return int(begin), int(end)

    @cached_property
    def _ends(self) -> dict[str, NDArray[np.int64]]:
        return {}

    @staticmethod
    def _along(item: h5py.Dataset) -> str:
        scales = list(item.dims[0].values()) if item.ndim == 1 else []
        return str(scales[0].name).rpartition("/")[2] if scales else ""

    @staticmethod
    def _texts(group: h5py.Group, name: str, begin: int | None = None, end: int | None = None) -> list[str]:
        return [str(text) for text in group[name].asstr()[begin:end]] if group[name].size else []


def _is_missing(values: NDArray[Any]) -> bool:
    """Whether a test does not have a variable."""
    fill = missing(values.dtype)
    return bool(np.isnan(values).all() if fill != fill else (values == fill).all())


def _told(item: h5py.Dataset) -> dict[str, Any]:
    return {key: item.attrs[key] for key in ("units", "long_name", "flag_values", "flag_meanings") if key in item.attrs}
