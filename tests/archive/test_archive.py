"""A campaign as one file: what goes in comes out, a piece at a time, and nothing leads out of it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from benchmarks.archive import Counting
from pyarrow import csv, parquet
from scipy.io import loadmat
from tests.campaign.test_query import products
from tests.cli.run import hfa
from tests.products import cf

import hfanalysis
from hfanalysis.archive import stacked
from hfanalysis.archive import writing as writer
from hfanalysis.archive.layout import checked
from hfanalysis.archive.reading import Archive
from hfanalysis.archive.writing import Kept, write
from hfanalysis.campaign.query import matching
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products import netcdf
from hfanalysis.products.tidy import rows_of_test

Columns = Mapping[str, np.ndarray[Any, np.dtype[Any]]]
LOG = "ingest"
RESIDUALS = "residuals/full/p_chamber"


def log_of(seed: int, count: int, channels: tuple[str, ...]) -> Columns:
    rng = np.random.default_rng(seed)
    flags = rng.integers(0, 3, count).astype(np.uint8)
    return {"time": np.sort(rng.random(count)), **{name: rng.random(count) for name in channels}, "flags": flags}


LOGS = {
    "A": log_of(1, 70, ("p_tank", "p_purge")),
    "B": log_of(2, 130, ("p_tank",)),
    "C": log_of(3, 40, ("p_tank", "thrust")),
}


def written(path: Path, groups: Mapping[str, Columns]) -> None:
    with netcdf.product(path, "made up", {}) as file:
        for name, columns in groups.items():
            group = file.require_group(name) if name else file
            netcdf.axis(group, "time", columns["time"])
            for own, values in columns.items():
                if own != "time":
                    netcdf.variable(group, own, values, ("Pa", f"{own} in words"))


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for name, (c_i, verdict) in {"A": (0.30, "identified"), "B": (0.45, "identified"), "C": (0.5, "doubted")}.items():
        folder = products(tmp_path, name, c_i, verdict, 1e4)
        written(folder / "ingest.h5", {"": LOGS[name]})
        if name != "B":
            written(folder / "residuals.h5", {"full/p_chamber": LOGS[name]})
        (folder / "report.html").write_text("a page")
        (folder / ".lock").write_text("")
        (folder / ".state").mkdir()
        (folder / ".state" / "ingest.json").write_text('{"key": "k"}')
    return tmp_path


def kept(root: Path) -> list[Kept]:
    facts = {"stand": "north", "kind": "hot_fire", "source": "synthetic", "date": None}
    return [Kept(n, root / "raw_tests" / n, root / "processed" / n, {**facts, "test": n}) for n in LOGS]


@pytest.fixture
def path(root: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An archive whose pieces are smaller than its tests."""
    monkeypatch.setattr(stacked, "CHUNK", 32)
    write(root / "all.h5", kept(root))
    return root / "all.h5"


@pytest.fixture
def archive(path: Path) -> Iterator[Archive]:
    with Archive(path) as opened:
        yield opened


@pytest.mark.parametrize("test", LOGS)
def test_a_series_comes_out_as_it_went_in(archive: Archive, test: str) -> None:
    found = archive.read(LOG, test)
    assert set(found.variables) == set(LOGS[test])
    for name, values in LOGS[test].items():
        assert found[name].dtype == values.dtype
        np.testing.assert_array_equal(found[name], values)
    assert found["p_tank"].attrs == {"units": "Pa", "long_name": "p_tank in words"}


def test_what_a_test_does_not_have_is_absent(archive: Archive) -> None:
    assert archive.tests == ("A", "B", "C")
    assert archive.series == (LOG, RESIDUALS)
    np.testing.assert_array_equal(archive.read(RESIDUALS, "C")["thrust"], LOGS["C"]["thrust"])
    for series, test, why in (
        (RESIDUALS, "B", "B has no residuals"),
        ("ingst", "A", "did you mean 'ingest'"),
        (LOG, "D", "no test D"),
    ):
        with pytest.raises(AbsentError, match=why):
            archive.read(series, test)


def test_it_is_a_file_of_common_tools(path: Path, archive: Archive) -> None:
    cf.check(path)
    with archive.tree() as tree:
        stack = tree[f"series/{LOG}"]
        assert stack["time_count"].values.tolist() == [70, 130, 40]
        np.testing.assert_array_equal(stack["p_tank"][70:200], LOGS["B"]["p_tank"])
        assert np.isnan(stack["p_purge"][70:]).all()
        assert tree["stand"].values.tolist() == ["north"] * 3
    assert archive.index["date"].values.tolist() == [""] * 3


@pytest.mark.parametrize(
    "condition", ["C_i > 0.4", "total_impulse > 1 and C_i < 0.4", "calibration.one_by_one.C_i = 9"]
)
@pytest.mark.parametrize("doubted", [False, True])
def test_a_condition_finds_the_same_tests_as_in_their_folders(
    root: Path, path: Path, condition: str, doubted: bool
) -> None:
    every = ("--all",) if doubted else ()
    own = json.loads(hfa("find", condition, "--root", root, "--json", *every).out)
    other = json.loads(hfa("find", condition, "--archive", path, "--json", *every).out)
    assert own["tests"]
    for found in (own, other):
        for test in found["tests"].values():
            test["facts"].pop("source")
            for row in test["quantities"]:
                row.pop("why")
    assert own == other


def test_its_quantities_are_those_of_the_products(root: Path, path: Path, archive: Archive) -> None:
    assert [row for test in archive.tests for row in archive.rows(test)] == [
        row for test in LOGS for row in rows_of_test(root / "processed" / test)
    ]
    assert hfa("table", "--archive", path).out == hfa("table", *LOGS, "--root", root).out
    assert matching(archive.asked(["C_i"]), "C_i > 0.4") == ["B"]


def content(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_a_test_is_given_back_as_it_was(root: Path, path: Path, tmp_path: Path) -> None:
    back = tmp_path / "back"
    ended = hfa("open", path, "C", "--root", back)
    assert ended.status == 0
    assert content(back / "raw_tests") == {f"C/{n}": c for n, c in content(root / "raw_tests" / "C").items()}
    made = content(root / "processed" / "C")
    assert content(back / "processed" / "C") == {n: c for n, c in made.items() if n not in ("report.html", ".lock")}
    again = hfa("open", path, "C", "--root", back)
    assert again.status == 2
    assert "is there already" in again.err
    assert hfanalysis.open("C", back).definition.test.stand == "north"


def test_a_lean_archive_has_the_numbers_and_not_the_files_of_products(root: Path) -> None:
    made = hfa("archive", "--root", root, "--write", root / "lean.h5", "--lean")
    assert made.status == 0
    assert "without HDF5 products" in made.err
    assert hfa("archive", "--root", root, "--write", root / "lean.h5", "--lean", "--quiet") == (0, "", "")
    with Archive(root / "lean.h5") as lean:
        assert not [name for name in lean.files("A") if name.endswith(".h5")]
        np.testing.assert_array_equal(lean.read(LOG, "A")["p_tank"], LOGS["A"]["p_tank"])


def test_the_same_tests_make_the_same_file(root: Path, path: Path) -> None:
    first = path.read_bytes()
    write(path, kept(root))
    assert path.read_bytes() == first


@pytest.mark.parametrize("name", ["../x", "raw/../../x", "/etc/x", "processed", "other/x", "raw/a\\b", "raw/c:x"])
def test_nothing_is_given_back_outside_of_its_folders(
    root: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str
) -> None:
    with pytest.raises(InputError, match="expected a file below raw/ or processed/"):
        checked(name)
    monkeypatch.setattr(writer, "_files_of", lambda test, lean: [(name, test.raw / "log.csv")])
    write(root / "odd.h5", kept(root))
    ended = hfa("open", root / "odd.h5", "A", "--root", tmp_path / "back")
    assert ended.status == 2
    assert not (tmp_path / "back").exists()


def test_a_damaged_file_is_not_given_back(path: Path) -> None:
    with h5py.File(path, "a") as file:
        data = file["files/data"]
        data[3] = data[3] ^ 255
    with Archive(path) as damaged, pytest.raises(InputError, match=r"log\.csv of A is damaged"):
        damaged.content("A", "raw/log.csv")


def spoilt(path: Path, how: str) -> None:
    with h5py.File(path, "a") as file:
        if how == "link":
            file["series/elsewhere"] = h5py.ExternalLink("secret.h5", "/x")
        elif how == "layout":
            file.attrs["layout"] = 99
        elif how == "name":
            file["test"][0] = "../A"
        else:
            del file["quantities"]


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ("link", "link into another file"),
        ("layout", "layout 99"),
        ("name", "name of a folder"),
        ("part", "which it is not"),
    ],
)
def test_what_is_no_archive_is_refused(path: Path, how: str, why: str) -> None:
    spoilt(path, how)
    ended = hfa("open", path)
    assert ended.status == 2
    assert why in ended.err


def test_a_file_that_is_none_is_refused(root: Path) -> None:
    (root / "log.h5").write_text("time,p\n")
    assert hfa("open", root / "log.h5").status == 2
    assert "no such file" in hfa("open", root / "none.h5").err
    assert "no products of any test" in hfa("archive", "--root", root / "raw_tests", "--write", root / "x.h5").err


@pytest.mark.parametrize("ending", ["csv", "parquet", "mat"])
def test_a_series_for_other_programs(path: Path, tmp_path: Path, ending: str) -> None:
    target = tmp_path / f"log.{ending}"
    assert hfa("open", path, "--series", LOG, "--write", target).status == 0
    if ending == "mat":
        (tests,) = loadmat(target, squeeze_me=True, struct_as_record=False)["tests"][1:2]
        assert tests.test == "B"
        np.testing.assert_array_equal(tests.p_tank, LOGS["B"]["p_tank"])
        return
    table = csv.read_csv(target) if ending == "csv" else parquet.read_table(target)
    assert table["test"].to_pylist() == ["A"] * 70 + ["B"] * 130 + ["C"] * 40
    np.testing.assert_array_equal(table["p_tank"].to_numpy(), np.concatenate([log["p_tank"] for log in LOGS.values()]))
    assert table["thrust"].to_pylist()[:200] == [None] * 200


def test_what_to_write_and_where_go_together(path: Path) -> None:
    assert "expected both" in hfa("open", path, "--series", LOG).err
    assert "expected a name that ends with" in hfa("open", path, "--series", LOG, "--write", "x.doc").err


def test_one_channel_of_one_test_is_read_without_the_rest(tmp_path: Path) -> None:
    tests = list[Kept]()
    for place in range(30):
        folder = products(tmp_path, f"T{place}", 0.3, "identified", 1e4)
        written(folder / "ingest.h5", {"": log_of(place, 40_000, ("p_tank", "p_run", "thrust"))})
        tests.append(Kept(f"T{place}", tmp_path / "raw_tests" / f"T{place}", folder, {}))
    target = tmp_path / "many.h5"
    write(target, tests, lean=True)
    with Counting(target) as file, Archive(target, file) as many:
        opened = file.total
        found = many.read(LOG, "T17")
        assert found.sizes["time"] == 40_000
        assert file.total < 0.1 * target.stat().st_size
        assert opened < 0.02 * target.stat().st_size


def test_it_is_opened_from_python(path: Path) -> None:
    with hfanalysis.Archive(path) as opened:
        assert repr(opened) == f"<Archive {path}: 3 tests, 2 series>"
        assert isinstance(opened.read(LOG, "A"), xr.Dataset)
