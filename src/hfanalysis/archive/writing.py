"""Writing an archive: each test once, in the order of their names."""

from __future__ import annotations

import hashlib
import json
import zlib
from array import array
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np

from hfanalysis.archive.layout import CHUNK, FILES, LEFT_OUT, MADE, NO_VERDICT, QUANTITIES, RAW, SERIES, TITLE, VERSION
from hfanalysis.archive.stacked import Numbers, Stack, attributes
from hfanalysis.campaign.query import FACTS
from hfanalysis.errors import InputError
from hfanalysis.products.disk import atomic
from hfanalysis.products.hdf5 import FORMAT, created
from hfanalysis.products.netcdf import CONVENTIONS
from hfanalysis.products.tidy import FILES as WITH_QUANTITIES
from hfanalysis.products.tidy import rows_of_test
from hfanalysis.progress import Progress, silent
from hfanalysis.version import __version__


@dataclass(frozen=True)
class Kept:
    """A test that is archived: its ``name``, the folders of its log and of its products, and the facts it states."""

    name: str
    raw: Path
    made: Path
    facts: Mapping[str, str | None]


def write(path: Path, tests: Sequence[Kept], lean: bool = False, progress: Progress = silent) -> None:
    """These tests as one file, whole or not at all; ``lean``: without the bytes of the HDF5 products, whose numbers it
    has anyway.

    Raises InputError where a test lacks its products, OSError where the disk does not take it.
    """
    for test in tests:
        if not any((test.made / f"{name}.json").is_file() for name in WITH_QUANTITIES):
            raise InputError(f"{test.made}: no products of {test.name}; hfa run {test.name} makes them")
    with atomic(path) as scratch, created(scratch, h5netcdf.File, libver=FORMAT) as file:
        made = {"hfanalysis": __version__, "tests": len(tests)}
        file.attrs.update(Conventions=CONVENTIONS, title=TITLE, layout=VERSION, provenance=json.dumps(made))
        _index(file, tests)
        series, numbers, files = _Series(file, len(tests)), _Numbers(), _Files(file, len(tests))
        for place, test in enumerate(tests):
            progress(test.name, place / len(tests))
            numbers.add(place, test)
            for product in sorted(test.made.glob("*.h5")):
                series.add(place, product)
            for name, source in _files_of(test, lean):
                files.add(place, name, source.read_bytes())
        progress("closing the archive", 1.0)
        series.close()
        numbers.write(file.create_group(QUANTITIES))
        files.close()


def _index(file: h5netcdf.File, tests: Sequence[Kept]) -> None:
    file.dimensions["test"] = len(tests)
    _texts(file, "test", "test", [t.name for t in tests], "name of the test")
    for fact in FACTS:
        if fact != "test":
            _texts(file, fact, "test", [t.facts.get(fact) or "" for t in tests], f"{fact}, as test.toml states it")


def _texts(group: h5netcdf.Group, name: str, axis: str, texts: Sequence[str], about: str) -> None:
    made = group.create_variable(name, (axis,), h5py.string_dtype())
    if texts:
        made[:] = np.array(texts, dtype=object)
    made.attrs.update(units="1", long_name=about)


def _files_of(test: Kept, lean: bool) -> list[tuple[str, Path]]:
    """The files of a test by their names in the archive."""
    out = list[tuple[str, Path]]()
    for kind, folder in ((RAW, test.raw), (MADE, test.made)):
        for path in sorted(p for p in folder.rglob("*") if p.is_file() and not p.is_symlink()):
            left_out = kind == MADE and (
                path.name in LEFT_OUT or path.suffix in LEFT_OUT or (lean and path.suffix == ".h5")
            )
            if not left_out:
                out.append((f"{kind}/{path.relative_to(folder).as_posix()}", path))
    return out


class _Series:
    """What HDF5 products hold, by product, group and axis."""

    def __init__(self, file: h5netcdf.File, tests: int) -> None:
        self._root, self._tests = file, tests
        self._stacks: dict[tuple[str, str], Stack] = {}

    def add(self, place: int, product: Path) -> None:
        """All that one product of test number ``place`` has along an axis."""
        found: dict[tuple[str, str], dict[str, tuple[Numbers, dict[str, Any]]]] = {}
        with h5py.File(product, "r") as file:

            def visit(name: str, item: h5py.Group | h5py.Dataset) -> None:
                axis = _axis_of(item)
                if axis is not None:
                    group, _, own = name.rpartition("/")
                    where = f"/{SERIES}/{product.stem}/{group}".rstrip("/"), axis
                    found.setdefault(where, {})[own] = (item[()], attributes(dict(item.attrs)))

            file.visititems(visit)
        for (group, axis), variables in sorted(found.items()):
            if (group, axis) not in self._stacks:
                self._stacks[group, axis] = Stack(_group(self._root, group), axis)
            self._stacks[group, axis].add(place, variables)

    def close(self) -> None:
        """Nothing more comes."""
        for stack in self._stacks.values():
            stack.close(self._tests)


def _group(root: h5netcdf.File, name: str) -> h5netcdf.Group:
    group = root
    for part in name.strip("/").split("/"):
        group = group.groups[part] if part in group.groups else group.create_group(part)
    return group


def _axis_of(item: h5py.Group | h5py.Dataset) -> str | None:
    """The axis that numbers stand along; None for a group, for texts, and for what has no axis or several."""
    if not isinstance(item, h5py.Dataset) or item.ndim != 1 or item.dtype.kind not in "fiu":
        return None
    if item.is_scale:
        return str(item.name).rpartition("/")[2]
    scales = list(item.dims[0].values())
    return str(scales[0].name).rpartition("/")[2] if scales else None


CELLS: dict[str, str] = {
    "value": "value, in the unit of its name", "std": "standard deviation",
    "low95": "lower end of the 95 % interval", "high95": "upper end of the 95 % interval",
}  # fmt: skip


@dataclass
class _Rows:
    """The numbers of one name, test by test."""

    unit: str
    tests: array[int] = field(default_factory=lambda: array("i"))
    cells: dict[str, array[float]] = field(default_factory=lambda: {name: array("d") for name in CELLS})
    verdicts: array[int] = field(default_factory=lambda: array("b"))


class _Numbers:
    """Every quantity of the JSON products, by its way through them."""

    def __init__(self) -> None:
        self._names: dict[str, _Rows] = {}
        self._verdicts: dict[str, int] = {}

    def add(self, place: int, test: Kept) -> None:
        """Those of one test."""
        for row in rows_of_test(test.made):
            name = f"{row['product']}.{row['name']}"
            rows = self._names.setdefault(name, _Rows(row["unit"]))
            rows.unit = rows.unit or row["unit"]
            rows.tests.append(place)
            for cell, column in rows.cells.items():
                column.append(float("nan") if row[cell] is None else row[cell])
            rows.verdicts.append(self._verdicts.setdefault(row["verdict"], len(self._verdicts)))

    def write(self, group: h5netcdf.Group) -> None:
        """All of them: the names, how many numbers each has, and these, name by name."""
        order = {product: i for i, product in enumerate(WITH_QUANTITIES)}
        names = sorted(self._names, key=lambda n: order[n.partition(".")[0]])
        rows = [self._names[name] for name in names]
        group.dimensions.update({"name": len(names), "number": sum(len(r.tests) for r in rows)})
        _texts(group, "name", "name", names, "way through the product")
        _texts(group, "unit", "name", [r.unit for r in rows], "unit of its numbers")
        count = group.create_variable("count", ("name",), np.int64, data=np.array([len(r.tests) for r in rows]))
        count.attrs.update(units="1", sample_dimension="number", long_name="numbers of each name")
        self._column(
            group, "of_test", np.int32, chain.from_iterable(r.tests for r in rows), "place of its test along test"
        )
        for cell, about in CELLS.items():
            self._column(group, cell, np.float64, chain.from_iterable(r.cells[cell] for r in rows), about)
        made = self._column(group, "verdict", np.int8, chain.from_iterable(r.verdicts for r in rows), "verdict")
        made.attrs["flag_values"] = np.arange(len(self._verdicts), dtype=np.int8)
        made.attrs["flag_meanings"] = " ".join(verdict.replace(" ", "_") or NO_VERDICT for verdict in self._verdicts)

    @staticmethod
    def _column(group: h5netcdf.Group, name: str, kind: Any, values: Any, about: str) -> h5netcdf.Variable:
        numbers = np.fromiter(values, dtype=kind)
        packed = {"chunks": (min(CHUNK, numbers.size),), "compression": "gzip", "shuffle": True} if numbers.size else {}
        made = group.create_variable(name, ("number",), kind, data=numbers, **packed)
        made.attrs.update(units="1", long_name=about)
        return made


class _Files:
    """The files of the tests, each compressed by itself, end to end."""

    def __init__(self, file: h5netcdf.File, tests: int) -> None:
        self._group, self._tests = file.create_group(FILES), tests
        self._group.dimensions["byte"] = None
        self._data = self._group.create_variable("data", ("byte",), np.uint8, chunks=(1 << 20,))
        self._data.attrs.update(units="1", long_name="bytes of all files, each compressed by itself (zlib), end to end")
        self._names, self._hashes, self._sizes, self._of = list[str](), list[str](), list[int](), list[int]()
        self._waiting, self._at, self._end = list[bytes](), 0, 0

    def add(self, place: int, name: str, content: bytes) -> None:
        """A file of test number ``place``."""
        packed = zlib.compress(content, 6)
        self._names.append(name)
        self._hashes.append(hashlib.sha256(content).hexdigest())
        self._sizes.append(len(packed))
        self._of.append(place)
        self._waiting.append(packed)
        self._end += len(packed)
        if self._end - self._at > 1 << 24:
            self._write()

    def _write(self) -> None:
        if self._waiting:
            self._group.resize_dimension("byte", self._end)
            self._data[self._at : self._end] = np.frombuffer(b"".join(self._waiting), dtype=np.uint8)
            self._at, self._waiting = self._end, []

    def close(self) -> None:
        """Nothing more comes."""
        self._write()
        self._group.dimensions["file"] = len(self._names)
        _texts(self._group, "name", "file", self._names, "name below the test's folders")
        _texts(self._group, "sha256", "file", self._hashes, "SHA-256 of its content")
        sizes = self._group.create_variable("size", ("file",), np.int64, data=np.array(self._sizes, dtype=np.int64))
        sizes.attrs.update(units="1", sample_dimension="byte", long_name="bytes of each file, compressed (zlib)")
        counts = np.bincount(np.array(self._of, dtype=np.int64), minlength=self._tests)
        made = self._group.create_variable("count", ("test",), np.int64, data=counts)
        made.attrs.update(units="1", sample_dimension="file", long_name="files of each test")
