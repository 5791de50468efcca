"""Residuals: measured minus model, on disk and in figures."""

from __future__ import annotations

import json
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from tests.products.cf import check

from hfanalysis.validate.residuals import PHASES, Residual, gaps, phases_of, write_residuals

TIME = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
MEASURED = np.array([50e5, 49e5, 48e5, 40e5, 30e5])
MODEL = np.array([50e5, 48e5, 49e5, 37e5, 34e5])
NOISE = np.full(5, 2e3)
PHASE = np.array([2, 2, 2, 3, 3], dtype=np.int8)
RESIDUAL = Residual("p_tank", "Pa", TIME, MEASURED, MODEL, NOISE, PHASE)
PROVENANCE = {"version": "1.0", "raw": {"log.csv": "abc"}}


@pytest.fixture
def product(tmp_path: Path) -> Path:
    path = tmp_path / "residuals.h5"
    write_residuals(path, {"tank_free": [RESIDUAL]}, PROVENANCE)
    return path


def test_a_residual_is_measured_minus_model() -> None:
    np.testing.assert_array_equal(RESIDUAL.residual, [0.0, 1e5, -1e5, 3e5, -4e5])


def test_a_gap_by_hand() -> None:
    """Liquid: 0, +1, -1 bar. Vapor: +3, -4 bar."""
    found = gaps([RESIDUAL])["p_tank"]
    assert set(found) == {"liquid", "vapor"}
    assert found["liquid"].bias == pytest.approx(0.0, abs=1e-6)
    assert found["liquid"].rms == pytest.approx(1e5 * np.sqrt(2.0 / 3.0))
    assert found["vapor"].bias == pytest.approx(-0.5e5)
    assert found["vapor"].rms == pytest.approx(1e5 * np.sqrt(12.5))
    for phase, samples in (("liquid", 3), ("vapor", 2)):
        assert found[phase].noise == pytest.approx(2e3)
        assert found[phase].samples == samples
        assert found[phase].unit == "Pa"


def test_samples_without_a_number_do_not_count() -> None:
    holed = np.array([50e5, np.nan, 48e5, np.nan, np.nan])
    found = gaps([Residual("p_tank", "Pa", TIME, holed, MODEL, NOISE, PHASE)])["p_tank"]
    assert set(found) == {"liquid"}
    assert found["liquid"].samples == 2
    assert found["liquid"].bias == pytest.approx(-0.5e5)


@pytest.mark.parametrize(
    ("t_v", "t_purge", "expected"),
    [
        (3.0, 5.0, [0, 1, 2, 2, 3, 3, 4]),
        (3.0, None, [0, 1, 2, 2, 3, 3, 3]),
        (None, None, [0, 1, 2, 2, 2, 2, 2]),
        (3.0, 2.0, [0, 1, 2, 4, 4, 4, 4]),
        (None, 2.0, [0, 1, 2, 4, 4, 4, 4]),
    ],
)
def test_the_phase_of_a_sample(t_v: float | None, t_purge: float | None, expected: list[int]) -> None:
    """Filling up to t_feed = 1 s, liquid up to t_v, vapor; nitrogen wherever it is in."""
    time = np.array([-0.5, 0.5, 1.0, 2.5, 3.0, 4.5, 5.0])
    assert phases_of(time, 1.0, t_v, t_purge).tolist() == expected


def test_the_residuals_open_in_xarray(product: Path) -> None:
    check(product)
    with xr.open_dataset(product, engine="h5netcdf", group="tank_free/p_tank") as data:
        assert set(data.data_vars) == {"measured", "model", "residual", "noise_std", "phase"}
        assert data["residual"].dims == ("time",)
        np.testing.assert_array_equal(data["time"], TIME)
        np.testing.assert_array_equal(data["residual"], data["measured"] - data["model"])
        at_3_s = data.sel(time=3.0)
        assert float(at_3_s["residual"]) == 3e5
        assert data["time"].attrs["units"] == "s"
        assert data["measured"].attrs["units"] == "Pa"


def test_the_residuals_open_in_h5py_with_units_and_names(product: Path) -> None:
    with h5py.File(product) as file:
        group = file["tank_free/p_tank"]
        for name in ("measured", "model", "residual", "noise_std"):
            assert group[name].attrs["units"] == "Pa"
            assert group[name].attrs["long_name"].startswith("p_tank: ")
            assert group[name].dims[0][0] == group["time"]
        assert group["residual"].attrs["long_name"] == "p_tank: measured minus model"
        assert group["time"].attrs["units"] == "s"
        assert group["time"].attrs["long_name"] == "time after the valve opening"
        np.testing.assert_array_equal(group["residual"], RESIDUAL.residual)
        meanings = group["phase"].attrs["flag_meanings"].split()
        assert [meanings[i] for i in group["phase"]] == ["liquid", "liquid", "liquid", "vapor", "vapor"]
        assert tuple(meanings) == PHASES
        assert json.loads(file.attrs["provenance"]) == PROVENANCE


def test_the_same_residuals_make_the_same_bytes(product: Path, tmp_path: Path) -> None:
    again = tmp_path / "again.h5"
    time.sleep(1.1)  # HDF5 dates its objects to the second
    write_residuals(again, {"tank_free": [RESIDUAL]}, dict(reversed(PROVENANCE.items())))
    assert again.read_bytes() == product.read_bytes()
    other = tmp_path / "other.h5"
    write_residuals(other, {"tank_free": [RESIDUAL]}, {**PROVENANCE, "version": "1.1"})
    assert other.read_bytes() != product.read_bytes()


def test_modes_and_channels_have_their_own_groups(tmp_path: Path) -> None:
    thrust = Residual("thrust", "N", TIME, MEASURED, MODEL, NOISE, PHASE)
    path = tmp_path / "residuals.h5"
    write_residuals(path, {"tank_free": [RESIDUAL], "full": [RESIDUAL, thrust]}, {})
    with h5py.File(path) as file:
        assert set(file) == {"tank_free", "full"}
        assert set(file["full"]) == {"p_tank", "thrust"}
        assert file["full/thrust/residual"].attrs["units"] == "N"
