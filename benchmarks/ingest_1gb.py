"""How fast and in how much memory a large log is ingested, beside pandas reading the same file.

    python -m benchmarks.ingest_1gb --gigabytes 1

writes a log of 20 channels at 1 kHz into a temporary folder, reads it with ``pandas.read_csv`` in chunks and ingests
it, each in a process of its own, and prints both times, their ratio and the peak resident memory.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

CHANNELS = 20
BLOCK = 20_000
PRESSURES = ("p_tank", "p_run", "p_chamber", "p_purge", "p_fill")
NAMES = (*PRESSURES, "thrust", "m_tank", "T_tank", "T_run", "T_chamber", *(f"p_extra_{i}" for i in range(10)))
UNITS = {"t": "lbf", "m": "kg", "T": "degC", "p": "psi"}


def write_test(folder: Path, size: int) -> Path:
    """A test whose log has about ``size`` bytes; returns the path of its test.toml."""
    test = folder / "BIG"
    test.mkdir(parents=True)
    _write_log(test / "log.csv", size)
    lines = ["schema = 1", "[test]", 'id = "BIG"', 'kind = "hot_fire"', 'source = "synthetic"', "[log]"]
    lines += ['files = ["log.csv"]', 'time = { column = "time", unit = "s" }']
    for name in NAMES:
        lines += [f"[channels.{name}]", f'column = "{name}"', f'unit = "{UNITS[name[0]]}"']
        lines += ['zero = "ambient"'] if name == "p_chamber" else ['tare = "auto"'] if name == "thrust" else []
    (test / "test.toml").write_text("\n".join(lines) + "\n")
    return test / "test.toml"


def _write_log(path: Path, size: int) -> None:
    """Noise about the level of each channel, and a burn in the middle block."""
    rng = np.random.default_rng(1)
    quiet = np.array([900.0, 14.7, 14.7, 550.0, 800.0, 0.0, 8.0, 20.0, 18.0, 15.0, *np.linspace(10.0, 500.0, 10)])
    blocks = [_rows(rng, quiet), _rows(rng, quiet + 200.0)]
    with path.open("w") as log:
        log.write("time," + ",".join(NAMES) + "\n")
        start = 0
        while log.tell() < size:
            burning = 0.45 * size < log.tell() < 0.5 * size
            log.write("".join(f"{(start + i) / 1000:.3f},{row}" for i, row in enumerate(blocks[burning])))
            start += BLOCK
        log.flush()
        os.fsync(log.fileno())


def _rows(rng: np.random.Generator, level: np.ndarray) -> list[str]:
    values = level + rng.normal(scale=1.5, size=(BLOCK, CHANNELS))
    return [",".join(f"{x:.4f}" for x in row) + "\n" for row in values]


def read_with_pandas(log: Path) -> float:
    """Seconds pandas alone takes: every column, in chunks, by the C parser; no option but the size of the chunks.

    The chunks are dropped as they come: nothing is kept, checked, converted or written.
    """
    import pandas as pd

    start = time.perf_counter()
    for _ in pd.read_csv(log, chunksize=100_000):
        pass
    return time.perf_counter() - start


def read_with_ingest(definition: Path) -> float:
    """Seconds ingest takes, from test.toml to ingest.h5, with compiled code cached."""
    from hfanalysis.record.definition import load_definition
    from hfanalysis.record.ingest import ingest

    with tempfile.TemporaryDirectory() as folder:
        ingest(load_definition(write_test(Path(folder), 1_000_000)), Path(folder) / "ingest.h5")
    start = time.perf_counter()
    ingest(load_definition(definition), definition.parent / "ingest.h5")
    return time.perf_counter() - start


def measure(what: str, path: Path) -> dict[str, float]:
    """Seconds and peak resident memory [GB] of one way of reading, in a process of its own."""
    command = [sys.executable, __file__, "--measure", what, str(path)]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--gigabytes", type=float, default=1.0)
    arguments.add_argument("--measure", nargs=2, metavar=("WHAT", "PATH"), help=argparse.SUPPRESS)
    options = arguments.parse_args()
    if options.measure:
        what, path = options.measure
        seconds = read_with_pandas(Path(path)) if what == "pandas" else read_with_ingest(Path(path))
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9
        print(json.dumps({"seconds": seconds, "peak": peak}))
        return
    with tempfile.TemporaryDirectory() as folder:
        definition = write_test(Path(folder), int(options.gigabytes * 1e9))
        pandas = measure("pandas", definition.parent / "log.csv")
        ours = measure("ingest", definition)
    print(f"log of {options.gigabytes:g} GB, {CHANNELS} channels at 1 kHz")
    print(f"pandas.read_csv in chunks  {pandas['seconds']:7.1f} s  peak {pandas['peak']:.2f} GB")
    print(f"hfa ingest                 {ours['seconds']:7.1f} s  peak {ours['peak']:.2f} GB")
    print(f"speed against pandas alone {pandas['seconds'] / ours['seconds']:7.2f}    (at least 1 wanted)")


if __name__ == "__main__":
    main()
