"""A run of the real pipeline, killed anywhere: whole products or none, and the next run is none the worse for it."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from hfanalysis.record.log import read_log

REPOSITORY = Path(__file__).parents[2]
PRODUCTS = ("ingest.h5", "ingest.json", "segments.json", "calibration.json")


FEW = ("--set", "calibrate.samples=40")


def hfa(root: Path) -> list[str]:
    return [sys.executable, "-m", "hfanalysis", "calibrate", "HF5", "--root", str(root), "--quiet", *FEW]


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A root where the replica HF5 has been calibrated."""
    root = tmp_path_factory.mktemp("root")
    shutil.copytree(REPOSITORY / "raw_tests" / "HF5", root / "raw_tests" / "HF5")
    subprocess.run(hfa(root), check=True, capture_output=True)
    return root


@pytest.fixture(scope="module")
def lasting(root: Path) -> float:
    """Seconds that a run takes where all is compiled."""
    shutil.rmtree(root / "processed")
    start = time.monotonic()
    subprocess.run(hfa(root), check=True, capture_output=True)
    return time.monotonic() - start


def bytes_below(folder: Path) -> dict[Path, bytes]:
    """Every file below a folder."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def contents(root: Path) -> dict[str, bytes]:
    folder = root / "processed" / "HF5"
    return {name: (folder / name).read_bytes() for name in PRODUCTS if (folder / name).exists()}


@pytest.mark.parametrize("share", [0.3, 0.85])
def test_a_run_killed_part_of_the_way_leaves_whole_products(root: Path, lasting: float, share: float) -> None:
    raw, whole = bytes_below(root / "raw_tests"), contents(root)
    shutil.rmtree(root / "processed")
    with subprocess.Popen(hfa(root), stderr=subprocess.DEVNULL) as child:
        time.sleep(share * lasting)
        child.kill()
    left = contents(root)
    assert left == {name: whole[name] for name in left}
    if "ingest.h5" in left:
        assert read_log(root / "processed/HF5/ingest.h5").channels
    subprocess.run(hfa(root), check=True, capture_output=True)
    assert contents(root) == whole
    assert json.loads(whole["calibration.json"])["test"] == "HF5"
    assert bytes_below(root / "raw_tests") == raw
