"""A log in HDF5 holds its own data: nothing is fetched from other files, nothing is read that nobody named."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.record.test_formats import P, mat73
from tests.record.test_formats import tdms as tdms_bytes

from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers import hdf5, hdf5_inside, matlab, tdms


def matlab_with(folder: Path, change: Callable[[h5py.File], None]) -> Path:
    """A MATLAB 7.3 file with one array and what ``change`` adds."""
    whole = mat73(folder / "whole.h5", PT1=P)
    with h5py.File(folder / "secret.h5", "w") as file:
        file["key"] = np.arange(8.0)[None, :]
    (folder / "secret.raw").write_bytes(np.arange(8.0).tobytes())
    path = folder / "t.mat"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        change(file)
    return path


def linked(file: h5py.File) -> None:
    file["other"] = h5py.ExternalLink("secret.h5", "/key")


def virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout((1, 8), dtype="f8")
    layout[:] = h5py.VirtualSource("secret.h5", "key", (1, 8))
    file.create_virtual_dataset("other", layout)


def outside(file: h5py.File) -> None:
    file.create_dataset("other", (1, 8), "f8", external=[("secret.raw", 0, 64)])


@pytest.mark.parametrize(
    ("change", "said"), [(linked, "link into"), (virtual, "virtual data set"), (outside, "kept in another file")]
)
def test_what_names_another_file_is_refused_with_its_name(
    tmp_path: Path, change: Callable[[h5py.File], None], said: str
) -> None:
    with pytest.raises(InputError, match=f"'other' is .*{said}.*secret"):
        matlab.open_source(matlab_with(tmp_path, change), FileSpec("t.mat"))


def diamonds(file: h5py.File) -> None:
    """Sixty groups, each with two names for the next: 2^60 ways to the last; which has a name for the first."""
    first = group = file.create_group("g")
    for _ in range(60):
        new = group.create_group("a")
        group["b"] = new
        group = new
    group["back"] = first
    group["soft"] = h5py.SoftLink("/g")
    group["last"] = P[None, :]


def test_links_that_meet_again_are_followed_once(tmp_path: Path) -> None:
    found = matlab.open_source(matlab_with(tmp_path, diamonds), FileSpec("t.mat"))
    assert [name.rpartition(".")[2] for name in found.columns] == ["PT1", "last"]


def test_what_nobody_named_is_not_read(tmp_path: Path) -> None:
    def vast(file: h5py.File) -> None:
        file.create_dataset("vast", (1, 10**12), "f8", chunks=(1, 1 << 16), fillvalue=1.0)

    found = matlab.open_source(matlab_with(tmp_path, vast), FileSpec("t.mat"))
    (chunk,) = found.chunks([found.columns.index("PT1")], [], lambda share: None)
    np.testing.assert_array_equal(next(iter(chunk.columns.values())), P)


def test_numbers_are_finished_when_they_are_read(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "t.h5", "w") as file:
        file["PT1"] = np.array([1, 2, -99, 4], dtype=np.int16)
        file["PT1"].attrs.update(units="bar", _FillValue=np.int16(-99), scale_factor=0.5)
        file.create_dataset("vast", (10**12,), "f8", chunks=(1 << 16,), fillvalue=1.0)
    found = hdf5.open_source(tmp_path / "t.h5", FileSpec("t.h5"))
    assert (found.columns, found.units) == (("PT1", "vast"), ("bar", ""))
    (chunk,) = found.chunks([0], [], lambda share: None)
    np.testing.assert_array_equal(chunk.columns[0], [0.5, 1.0, np.nan, 2.0])


def test_an_index_beside_a_tdms_file_is_not_believed(tmp_path: Path) -> None:
    (tmp_path / "t.tdms").write_bytes(tdms_bytes())
    (tmp_path / "t.tdms_index").write_bytes(b"TDSh" + b"\xff" * 60)
    assert "Data.pt" in tdms.open_source(tmp_path / "t.tdms", FileSpec("t.tdms")).columns


def test_an_object_is_listed_once() -> None:
    with h5py.File("x", "w", driver="core", backing_store=False) as file:
        file["a"], file["b"] = np.zeros(3), np.zeros(3)
        file["c"] = file["a"]
        assert [names for names, _ in hdf5_inside.datasets(Path("x"), file)] == [("a",), ("b",)]
