"""The one writer of HDF5 products, and that the check of them finds what is wrong."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.products.cf import check

from hfanalysis.products import netcdf

ABOUT = {"time": netcdf.TIME, "p": ("Pa", "pressure"), "flux": ("kg/(m^2 s)", "mass flux")}


@pytest.fixture
def product(tmp_path: Path) -> Path:
    path = tmp_path / "x.h5"
    columns = {"time": np.arange(3.0), "p": np.array([1.0, 2.0, np.nan]), "flux": np.zeros(3)}
    with netcdf.product(path, "a product", {"version": "1"}, stand="north") as file:
        netcdf.table(file.create_group("one"), columns, ABOUT)
        netcdf.table(file.create_group("two"), {"time": np.arange(2.0)}, ABOUT)
        netcdf.variable(file["two"], "flags", np.zeros(2, np.uint8), ("1", "quality"), flag_masks=np.uint8([1, 2]),
                        flag_meanings="dropout stuck")  # fmt: skip
    return path


def test_what_is_written_keeps_the_rules_and_is_there(product: Path) -> None:
    check(product)
    with h5py.File(product) as file:
        assert file["one/p"].attrs["units"] == "Pa"
        assert file["one/p"].dims[0].keys() == ["time"]
        assert file["one/p"][:2].tolist() == [1.0, 2.0]
        assert file["two/flags"][:].tolist() == [0, 0]
        assert file.attrs["stand"] == "north"


def test_bytes_that_are_set_are_kept(tmp_path: Path) -> None:
    with netcdf.product(tmp_path / "x.h5", "a product", {"version": "1"}) as file:
        netcdf.axis(file, "time", np.arange(3.0))
        netcdf.variable(file, "flags", np.array([0, 4, 0], np.uint8), ("1", "quality"))
    with h5py.File(tmp_path / "x.h5") as file:
        assert file["flags"][:].tolist() == [0, 4, 0]


def nested(file: h5py.File) -> None:
    netcdf.axis(file["one"].create_group("below"), "time", np.arange(9.0))


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda file: file["one"].create_dataset("q", data=np.arange(3.0)), "axis 0 has no name"),
        (lambda file: file["one/p"].attrs.update(units="psig of mine"), "pint cannot read"),
        (lambda file: file["one/p"].attrs.update(units="kg m-2 s-1"), "pint cannot read"),
        (lambda file: file["one/p"].attrs.pop("long_name"), "no long_name"),
        (lambda file: file["one/p"].attrs.pop("units"), "no units"),
        (lambda file: file.attrs.pop("Conventions"), "no Conventions"),
        (lambda file: file["two/flags"].attrs.update(flag_meanings="one"), "as many flag_meanings"),
        (nested, "of the name of one above"),
    ],
)
def test_the_check_finds_what_is_wrong(product: Path, spoil: Callable[[h5py.File], None], said: str) -> None:
    with h5py.File(product, "r+") as file:
        spoil(file)
    with pytest.raises(AssertionError, match=said):
        check(product)


def test_the_same_content_is_the_same_file_whenever_python_lets_go_of_it(tmp_path: Path) -> None:
    """A chunk that waits in a cache is written when its variable is collected: the file then lies in another order."""

    def written(name: str, keep: bool) -> bytes:
        held = []
        with netcdf.product(tmp_path / name, "a product", {}) as file:
            netcdf.axis(file, "time", np.arange(2000.0))
            for i in range(12):
                flags = (np.arange(2000) % (i + 2)).astype(np.uint8)
                made = netcdf.variable(file, f"v{i}", flags, ("1", "a part"))
                held += [made] if keep else []
        return (tmp_path / name).read_bytes()

    assert written("one.h5", keep=False) == written("other.h5", keep=True)
