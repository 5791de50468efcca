"""hfa diagnose on whole tests: what is hidden in the log is named, and what is not recorded is not needed."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests import few_effects
from tests.cli import run
from tests.inference.adopted.firing import make_root

from hfanalysis.effects import effect

KEYS = {
    "verdict",
    "effects",
    "set90",
    "posterior",
    "localisation",
    "gap",
    "upper_limits",
    "twins",
    "decisive_measurements",
    "runtime_s",
    "seed",
}
"""Of diagnosis.json, as it was agreed upon."""

RATE = 2e-4


def hfa(root: Path, *arguments: str, environment: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "hfanalysis", *arguments, "--root", str(root)]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """An environment in which a diagnosis has a few effects to choose from: the whole library is asked once."""
    return few_effects.environment(tmp_path_factory.mktemp("few"))


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A test T1 with a throat that erodes, diagnosed."""
    made = make_root(tmp_path_factory.mktemp("stand"), effect("nozzle_throat_erosion").at(rate=RATE))
    done = hfa(made, "diagnose", "T1")
    assert done.returncode == 0, done.stderr
    assert "Missing from the model, with probability: throat that erodes" in done.stdout
    return made


@pytest.fixture(scope="module")
def product(root: Path) -> dict:  # type: ignore[type-arg]
    return json.loads((root / "processed" / "T1" / "diagnosis.json").read_text(encoding="utf-8"))


def test_the_product_says_what_was_hidden(product: dict) -> None:  # type: ignore[type-arg]
    assert set(product) >= KEYS
    assert product["verdict"] == "named"
    assert product["set90"] == ["nozzle_throat_erosion"]
    assert sum(product["posterior"].values()) == pytest.approx(1.0)
    assert {"none", "unknown", "nozzle_throat_erosion"} <= set(product["posterior"])
    found = product["effects"][0]
    assert set(found) >= {"name", "probability", "equation", "parameters"}
    rate = found["parameters"]["rate"]
    assert rate["unit"] == "m/s"
    assert abs(rate["value"] - RATE) < 3.5 * rate["std"]
    assert rate["std"] < 0.3 * RATE


def test_the_place_the_gap_and_the_proof_are_there(product: dict) -> None:  # type: ignore[type-arg]
    row = product["localisation"][0]
    assert set(row) >= {"equation", "phase", "t_start", "t_end", "source", "significance"}
    assert row["equation"] == "nozzle"
    gap = product["gap"]
    channels = {"p_tank", "p_run", "p_chamber", "thrust"}
    for arm in ("before", "after", "noise"):
        assert set(gap[arm]) == channels
    assert gap["before"]["p_chamber"] > 5.0 * gap["after"]["p_chamber"]
    assert set(gap["closed_fraction"]) == {"same", "held_out", "other_test", "placebo"}
    assert gap["closed_fraction"]["same"] > 0.9
    assert gap["closed_fraction"]["held_out"] > 0.8
    assert gap["closed_fraction"]["other_test"] is None
    assert "nozzle_throat_erosion" not in product["upper_limits"]
    assert product["upper_limits"]["tank_heat"]["unit"] == "W"
    assert ["chamber_tap_lag", "nozzle_throat_erosion"] in product["twins"]


def test_histories_are_on_file(root: Path, product: dict) -> None:  # type: ignore[type-arg]
    with h5py.File(root / "processed" / "T1" / "diagnosis.h5") as file:
        source = file["sources/nozzle_throat_erosion"]
        assert (source["low90"][:] < source["high90"][:]).all()
        assert source["mean"].attrs["units"] == product["localisation"][0]["source"]["unit"]
        for name, rms in product["gap"]["after"].items():
            left = file[f"residuals/{name}"]
            assert np.sqrt(np.mean(left["after"][:] ** 2)) == pytest.approx(rms)
            assert np.sqrt(np.mean(left["before"][:] ** 2)) == pytest.approx(product["gap"]["before"][name])


def without(root: Path, channels: tuple[str, ...], to: Path) -> Path:
    """The same test as if these channels had not been recorded."""
    shutil.copytree(root / "raw_tests", to / "raw_tests")
    path = to / "raw_tests" / "T1" / "test.toml"
    text = path.read_text(encoding="utf-8")
    for channel in channels:
        text = re.sub(rf"^{channel} = .*\n", "", text, flags=re.MULTILINE)
    path.write_text(text, encoding="utf-8")
    return to


def cut(root: Path, to: Path, end: float) -> Path:
    """The same test as if the logger had stopped ``end`` seconds after the opening."""
    shutil.copytree(root / "raw_tests", to / "raw_tests")
    path = to / "raw_tests" / "T1" / "log.csv"
    lines = path.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines[1:] if float(line.split(",")[0]) < 100.0 + end]
    path.write_text("\n".join([lines[0], *kept]) + "\n", encoding="utf-8")
    return to


@pytest.fixture(scope="module")
def short(root: Path, few: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same test, diagnosed as if thrust had not been recorded and the logger had stopped in the burn."""
    folder = tmp_path_factory.mktemp("short")
    made = cut(without(root, ("thrust",), folder / "without"), folder / "cut", 6.2)
    done = hfa(made, "diagnose", "T1", environment=few)
    assert done.returncode == 0, done.stderr
    return made


def test_what_was_not_recorded_is_not_compared(short: Path) -> None:
    found = json.loads((short / "processed" / "T1" / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["compared"]["channels"] == ["p_tank", "p_run", "p_chamber"]
    assert found["compared"]["end"] == pytest.approx(6.2, abs=0.05)
    assert "nozzle_throat_erosion" in found["set90"]
    assert found["localisation"][0]["t_end"]["value"] < 6.3
    assert "load_cell_drift" not in {**found["posterior"], **found["upper_limits"]}


def test_a_second_run_writes_the_same_bytes(short: Path, few: dict[str, str], tmp_path: Path) -> None:
    shutil.copytree(short / "raw_tests", tmp_path / "raw_tests")
    assert hfa(tmp_path, "diagnose", "T1", environment=few).returncode == 0
    one, two = (folder / "processed" / "T1" / "diagnosis.json" for folder in (short, tmp_path))
    assert one.read_bytes() == two.read_bytes()


@pytest.mark.parametrize(
    ("missing", "reason"),
    [
        (("p_chamber",), "no p_chamber"),
        (("p_tank",), "no p_tank"),
        (("p_tank", "p_run", "p_chamber"), "no p_tank"),
        (("p_run", "p_chamber", "thrust"), "no firing and no flow: nothing in p_tank responds"),
    ],
)
def test_what_cannot_be_calibrated_is_refused_with_its_reason(
    missing: tuple[str, ...], reason: str, root: Path, tmp_path: Path
) -> None:
    done = run.hfa("diagnose", "T1", "--root", without(root, missing, tmp_path))
    assert done.status == 3
    assert re.search(reason, done.err), done.err
    assert "Traceback" not in done.err
    assert not (tmp_path / "processed" / "T1" / "diagnosis.json").exists()


def test_without_the_run_line_injector_and_line_are_one(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = without(root, ("p_run",), tmp_path)
    calibrated = run.hfa("calibrate", "T1", "--root", made)
    assert calibrated.status == 0
    assert "p_run is not logged: the feed line is taken to lose" in calibrated.err
    few_effects.install(monkeypatch)
    done = run.hfa("diagnose", "T1", "--root", made)
    assert done.status == 0, done.err
    found = json.loads((made / "processed" / "T1" / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["compared"]["channels"] == ["p_tank", "p_chamber", "thrust"]
    assert found["verdict"] == "named"
    assert found["set90"] == ["nozzle_throat_erosion"]
    rate = found["effects"][0]["parameters"]["rate"]
    assert abs(rate["value"] - RATE) < 3.5 * rate["std"]
    assert "taken for one orifice" in found["notes"][0]
    assert "loss_factor" not in found["constants"]["with"]


def drifted(root: Path, to: Path) -> Path:
    """The test as if nothing but thrust and p_chamber had been recorded, by a cell whose zero drifts by 300 N."""
    made = without(root, ("p_tank", "p_run"), to)
    folder = made / "raw_tests" / "T1"
    text = (folder / "test.toml").read_text(encoding="utf-8")
    text = text.replace('tare = "none"', 'tare = "before"').replace(
        '"p_chamber", unit', '"p_chamber", zero = "ambient", unit'
    )
    (folder / "test.toml").write_text(text, encoding="utf-8")
    table = np.genfromtxt(folder / "log.csv", delimiter=",", names=True)
    table["thrust"] += 300.0 * (1.0 - np.exp(-np.maximum(table["time"] - 100.0, 0.0) / 2.0))
    header = ",".join(table.dtype.names)
    np.savetxt(folder / "log.csv", table, fmt="%.9g", delimiter=",", header=header, comments="")
    return made


def test_a_cell_that_rests_high_is_told_where_no_model_can_be_had_and_is_no_name(root: Path, tmp_path: Path) -> None:
    made = drifted(root, tmp_path)
    done = run.hfa("diagnose", "T1", "--root", made)
    assert done.status == 3
    assert "no p_tank" in done.err
    assert re.search(
        r"nothing that a model would lack; thrust \(zero\): reads (29\d|30\d) N after the firing", done.err
    )
    assert not (made / "processed" / "T1" / "diagnosis.json").exists()


def test_a_log_that_stops_before_the_liquid_is_gone_is_refused(root: Path, tmp_path: Path) -> None:
    done = run.hfa("diagnose", "T1", "--root", cut(root, tmp_path, 2.0))
    assert done.status == 3
    assert "no end of the liquid" in done.err
    assert "Traceback" not in done.err
