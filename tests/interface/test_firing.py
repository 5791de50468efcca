"""A test as an object: the same numbers as the command line's, as typed records and xarray's arrays."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from tests.cli.run import hfa
from tests.products.cf import check

import hfanalysis
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products import tidy

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("root")
    shutil.copytree(REPOSITORY / "raw_tests" / "HF5", folder / "raw_tests" / "HF5")
    return folder


def test_what_is_public_is_named_and_there() -> None:
    assert all(getattr(hfanalysis, name) is not None for name in hfanalysis.__all__)
    assert dir(hfanalysis) == sorted(hfanalysis.__all__)
    with pytest.raises(AttributeError, match="no attribute 'Frobnicate'"):
        hfanalysis.Frobnicate  # noqa: B018


def test_importing_the_package_loads_nothing() -> None:
    code = "import sys; import hfanalysis; print(*{name.split('.')[0] for name in sys.modules})"
    loaded = set(
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    )
    assert not {"numpy", "scipy", "xarray", "matplotlib", "numba", "h5py", "pint", "pydantic", "typer"} & loaded


def test_nothing_is_run_to_show_a_firing(root: Path, tmp_path: Path) -> None:
    shutil.copytree(root / "raw_tests", tmp_path / "raw_tests")
    fresh = hfanalysis.open("HF5", tmp_path)
    assert "REPLICA: generated, not measured" in repr(fresh)
    assert "made: nothing yet" in repr(fresh)
    assert not (tmp_path / "processed").exists()


def test_log_and_calibration_are_those_of_the_command(root: Path) -> None:
    found = hfanalysis.open("HF5", root)
    log = found.log
    assert isinstance(log, xr.Dataset)
    assert log["p_tank"].attrs["units"] == "Pa"
    assert log["p_tank"].dims == ("time",)
    kept = json.loads(hfa("calibrate", "HF5", "--root", root, "--json").out)
    assert found.calibration.quantities["C_i"].value == kept["C_i"]["value"]
    assert found.segments.t_v.value == json.loads(hfa("segment", "HF5", "--root", root, "--json").out)["t_v"]["value"]
    lines = repr(found).splitlines()
    assert lines[2].split()[:4] == ["effective", "injector", "coefficient", "0.293"]
    assert "<td>identified</td>" in found._repr_html_()
    check(found.folder / "ingest.h5")


def test_a_setting_is_that_of_the_stage(root: Path, tmp_path: Path) -> None:
    found = hfanalysis.open("HF5", root, tmp_path).run("calibrate", samples=20)
    assert found.calibration.provenance["parameters"]["samples"] == 20


def test_a_folder_names_a_test_too(root: Path) -> None:
    assert hfanalysis.open(root / "raw_tests" / "HF5").root.samefile(root)
    with pytest.raises(InputError, match="HF9"):
        hfanalysis.open("HF9", root)


def test_pressures_are_drawn_in_bar_over_the_firing(root: Path) -> None:
    figure = hfanalysis.open("HF5", root).plot.pressures()
    assert figure._repr_png_().startswith(b"\x89PNG")  # type: ignore[attr-defined]
    assert isinstance(figure, Figure)
    axes = figure.axes[0]
    assert axes.get_ylabel() == "pressure [bar]"
    tank = axes.lines[0].get_ydata()
    assert 40.0 < float(np.nanmax(tank)) < 80.0
    assert "generated, not measured" in axes.get_title(loc="left")


def test_a_diagnosis_is_not_made_unasked(root: Path) -> None:
    with pytest.raises(AbsentError, match=r'not diagnosed yet; \.run\("diagnose"\)'):
        _ = hfanalysis.open("HF5", root).diagnosis


def test_the_table_has_every_quantity_of_a_product(root: Path) -> None:
    found = hfanalysis.open("HF5", root)
    names = {row["name"] for row in found.table() if row["product"] == "calibration"}
    assert set(found.calibration.quantities) <= names
    row = next(row for row in found.table() if row["name"] == "C_i")
    quantity = found.calibration.quantities["C_i"]
    assert (row["value"], row["low95"], row["high95"]) == (quantity.value, *quantity.interval)
    assert set(row) == set(tidy.COLUMNS)


T = np.linspace(0.0, 30.0, 3001)
PRESSURE = np.where(T < 10.0, 50.0, 50.0 - 2.0 * (T - 10.0)) + 0.01 * np.sin(40.0 * T)


def test_arrays_are_a_test_as_any_other(tmp_path: Path) -> None:
    about = {"tank": {"volume": "16.5 L"}, "channels": {"p_tank": {"accuracy": "2 psi"}}}
    made = hfanalysis.firing({"time": T, "p_tank": PRESSURE}, {"p_tank": "bar"}, about, name="A 1", root=tmp_path)
    np.testing.assert_allclose(made.log["p_tank"], 1e5 * PRESSURE)
    assert made.definition.tank.volume.value == pytest.approx(16.5e-3)
    assert made.definition.channels["p_tank"].accuracy.value == pytest.approx(13789.5, rel=1e-4)
    with pytest.raises(InputError, match="there is a test of that name already"):
        hfanalysis.firing({"time": T, "p_tank": PRESSURE}, {"p_tank": "bar"}, name="A 1", root=tmp_path)


def test_a_data_frame_and_a_dataset_are_taken(tmp_path: Path) -> None:
    import pandas as pd

    frame = pd.DataFrame({"time": 1e3 * T, "p_tank": PRESSURE})
    made = hfanalysis.firing(frame, {"time": "ms", "p_tank": "bar"}, name="frame", root=tmp_path)
    np.testing.assert_allclose(made.log["time"], T, atol=1e-9)
    data = xr.Dataset({"p_tank": ("time", PRESSURE, {"units": "bar"})}, coords={"time": T})
    made = hfanalysis.firing(data, name="data", root=tmp_path)
    np.testing.assert_allclose(made.log["p_tank"], 1e5 * PRESSURE)


def test_a_column_without_a_unit_or_of_another_length_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="'p_tank': found no unit"):
        hfanalysis.firing({"time": T, "p_tank": PRESSURE}, root=tmp_path)
    with pytest.raises(InputError, match=r"expected \(3001,\)"):
        hfanalysis.firing({"time": T, "p_tank": PRESSURE[1:]}, {"p_tank": "bar"}, root=tmp_path)
    with pytest.raises(InputError, match="expected one named 'time'"):
        hfanalysis.firing({"p_tank": PRESSURE}, {"p_tank": "bar"}, root=tmp_path)
