"""A run may be killed at any moment, and two may run at once: no half product, no clash."""

from __future__ import annotations

import json
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.stages import fake_way
from tests.stages.fake_way import ran

from hfanalysis.products.disk import TEMPORARY, sha256_file


def start(root: Path) -> subprocess.Popen[bytes]:
    """A run of the first two stages in a process of its own."""
    return subprocess.Popen([sys.executable, fake_way.__file__, str(root), "second"], stderr=subprocess.PIPE)


def started(child: subprocess.Popen[bytes], root: Path) -> None:
    """Wait until the child is at work."""
    for _ in range(1000):
        if list((root / "processed/T1").glob(f"{TEMPORARY}*")) or child.poll() is not None:
            return
        time.sleep(0.01)


def whole(root: Path) -> bool:
    """Whether every product that is there is complete."""
    folder = root / "processed/T1"
    binary = folder / "first.bin"
    for path in folder.glob("*.json"):
        json.loads(path.read_text())
    return not binary.exists() or binary.read_text().endswith("end")


@pytest.mark.parametrize("seed", range(8))
def test_a_killed_run_leaves_whole_products_or_none(root: Path, seed: int) -> None:
    raw = sha256_file(root / "raw_tests/T1/log.csv")
    child = start(root)
    started(child, root)
    time.sleep(random.Random(seed).uniform(0.0, 0.3))
    child.send_signal(signal.SIGKILL)
    child.communicate()
    assert whole(root)
    ran(root, "second")
    assert whole(root)
    assert json.loads((root / "processed/T1/second.json").read_text())["rows"] == 4
    assert not list((root / "processed/T1").glob(f"{TEMPORARY}*"))
    assert sha256_file(root / "raw_tests/T1/log.csv") == raw


def test_what_a_killed_run_left_in_an_inner_folder_is_removed(root: Path) -> None:
    left = root / "processed/T1/.state/stand" / f"{TEMPORARY}5468-HF4.h5"
    left.parent.mkdir(parents=True)
    left.write_text("half")
    child = start(root)
    assert child.communicate()[1] == b""
    assert not left.exists()


def test_two_runs_at_once_do_not_clash(root: Path) -> None:
    children = [start(root), start(root)]
    assert [child.communicate()[1] for child in children] == [b"", b""]
    assert [child.returncode for child in children] == [0, 0]
    assert whole(root)
    assert ran(root, "second") == []
