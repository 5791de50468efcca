"""An archive of ten thousand tests: how soon it is open, what is read for one channel of one of them, and a query.

python -m benchmarks.archive [--tests 10000] [--own 50]

``--own`` tests are generated (HF5 at 20 Hz, each with noise of its own) and analysed up to the calibration; the others
are these under other names. Pages are left out.
"""

from __future__ import annotations

import argparse
import csv
import io
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.last_digits import times
from benchmarks.studies import one_thread

ROOT = Path(__file__).resolve().parent.parent
EVERY = 50
"""Rows of the replica's log of which one stays: 20 Hz."""

NOISE = 1e-3
"""Of each reading, by which tests differ."""


def generate(root: Path, name: str, seed: int) -> None:
    """A test of its own below ``root``, with its log."""
    source, folder = ROOT / "raw_tests" / "HF5", root / "raw_tests" / name
    folder.mkdir(parents=True)
    stated = (source / "test.toml").read_text(encoding="utf-8").replace('id = "HF5"', f'id = "{name}"')
    (folder / "test.toml").write_text(stated, encoding="utf-8")
    with (source / "log.csv").open(encoding="utf-8", newline="") as read:
        header, *rows = csv.reader(read)
    rng = np.random.default_rng(seed)
    with (folder / "log.csv").open("w", encoding="utf-8", newline="") as write:
        out = csv.writer(write, lineterminator="\n")
        out.writerow(header)
        for row in rows[::EVERY]:
            off = 1.0 + NOISE * rng.standard_normal(len(row))
            out.writerow([row[0], *(times(c, by) for c, by in zip(row[1:], off[1:].tolist(), strict=True))])


class Counting(io.FileIO):
    """A file that counts what is read of it."""

    total = 0

    def readinto(self, buffer: Any) -> int | None:
        """As of any file."""
        found = super().readinto(buffer)
        self.total += found or 0
        return found


def main() -> int:
    """Write it, and measure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tests", type=int, default=10_000)
    parser.add_argument("--own", type=int, default=50)
    asked = parser.parse_args()
    one_thread()

    from hfanalysis.archive.reading import Archive
    from hfanalysis.archive.writing import Kept, write
    from hfanalysis.campaign.query import matching
    from hfanalysis.stages.open_test import open_test
    from hfanalysis.stages.runner import run_to

    with tempfile.TemporaryDirectory() as scratch:
        root, own = Path(scratch), [f"G{i:03d}" for i in range(asked.own)]
        for seed, name in enumerate(own):
            generate(root, name, seed)
            run_to("calibrate", open_test(root, name))
            print(f"\r{seed + 1} of {asked.own} tests generated", end="", file=sys.stderr)
        facts = {"stand": "generated", "kind": "hot_fire", "source": "synthetic", "date": None}
        tests = [
            Kept(f"T{i:05d}", root / "raw_tests" / own[i % len(own)], root / "processed" / own[i % len(own)], facts)
            for i in range(asked.tests)
        ]
        path = root / "all.h5"
        begun = time.perf_counter()
        write(path, tests)
        took, size = time.perf_counter() - begun, path.stat().st_size
        print(f"\n{asked.tests} tests, {asked.own} of them their own: {size / 1e6:.0f} MB, written in {took:.0f} s")

        begun = time.perf_counter()
        with Archive(path) as first:
            opened = time.perf_counter() - begun
            begun = time.perf_counter()
            found = matching(first.asked(["C_i"]), "C_i > 0.292")
            queried = time.perf_counter() - begun
            begun = time.perf_counter()
            with first.tree() as tree:
                in_xarray = time.perf_counter() - begun
                variables = sum(len(node.data_vars) for node in tree.subtree)
        print(f"open in {opened:.2f} s; as a tree of xarray's with {variables} variables in {in_xarray:.2f} s")
        print(f"C_i > 0.292: {len(found)} tests, in {queried:.2f} s")
        with Counting(path) as file, Archive(path, file) as counted:
            before, begun = file.total, time.perf_counter()
            read = counted.read("ingest", f"T{asked.tests * 2 // 3:05d}")
            took = time.perf_counter() - begun
            amount = f"{(file.total - before) / 1e6:.2f} of {size / 1e6:.0f} MB read"
            print(f"{len(read.data_vars)} variables of one test, {read.sizes['time']} samples: {took:.2f} s, {amount}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
