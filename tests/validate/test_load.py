"""The residual store is read in one line, and by tools that know nothing of it."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

import hfanalysis
from hfanalysis.errors import InputError
from hfanalysis.validate.residuals import Residual, write_residuals

TIME = np.linspace(0.0, 2.0, 5)
PHASE = np.array([1, 2, 2, 3, 3], dtype=np.int8)


@pytest.fixture
def product(tmp_path: Path) -> Path:
    path = tmp_path / "processed" / "HF5" / "residuals.h5"
    path.parent.mkdir(parents=True)
    pressure = Residual("p_chamber", "Pa", TIME, np.full(5, 12e5), np.full(5, 11e5), np.full(5, 3e3), PHASE)
    thrust = Residual("thrust", "N", TIME[:3], np.ones(3), np.zeros(3), np.ones(3), PHASE[:3])
    write_residuals(path, {"full": [pressure, thrust], "chamber_forced": [thrust]}, {"version": "1"})
    return path


def test_by_name_by_folder_and_by_file(product: Path, tmp_path: Path) -> None:
    for tree in (
        hfanalysis.load_residuals("HF5", tmp_path),
        hfanalysis.load_residuals(product.parent),
        hfanalysis.load_residuals(product),
    ):
        assert set(tree.children) == {"full", "chamber_forced"}
        found = tree["full/p_chamber"].to_dataset()
        np.testing.assert_array_equal(found["residual"].sel(time=slice(0.4, 2.0)), 1e5)
        assert found["residual"].attrs["units"] == "Pa"
        assert found["time"].attrs["units"] == "s"


def test_channels_may_have_clocks_of_their_own(product: Path) -> None:
    tree = hfanalysis.load_residuals(product)
    assert tree["full/thrust"].sizes["time"] == 3
    assert tree["full/p_chamber"].sizes["time"] == 5


def test_xarray_reads_a_group_without_our_help(product: Path) -> None:
    found = xr.open_dataset(product, group="full/p_chamber", engine="h5netcdf")
    np.testing.assert_array_equal(found["measured"] - found["model"], found["residual"])
    assert list(found["residual"].dims) == ["time"]


def test_plain_hdf5_readers_find_columns_of_numbers(product: Path) -> None:
    """As MATLAB's h5read and h5readatt do: contiguous doubles by their path, and text attributes."""
    with h5py.File(product) as file:
        for name in ("time", "measured", "model", "residual", "noise_std"):
            data = file[f"/full/p_chamber/{name}"]
            assert data.dtype == np.float64
            assert data.chunks is None
            assert isinstance(data.attrs["units"], str)
        assert file["/full/p_chamber/phase"].dtype == np.int8
    assert product.read_bytes()[8] in (0, 2)  # superblock versions that HDF5 1.8 reads


def test_where_there_is_none_the_places_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"HF9: no residuals\.h5; expected .*processed/HF9/residuals\.h5"):
        hfanalysis.load_residuals("HF9", tmp_path)
