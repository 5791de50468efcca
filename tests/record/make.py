"""Small tests on disk for the tests of ingest."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hfanalysis.record.definition import load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import TestLog, read_log

HEAD = 'schema = 1\n[test]\nid = "T"\nkind = "hot_fire"\nsource = "synthetic"\n'
LOG = '[log]\nfiles = ["log.csv"]\ntime = { column = "time", unit = "s" }\n'


def write(root: Path, toml: str, files: Mapping[str, str | bytes]) -> Path:
    """A test's folder with the tables ``toml`` below [test]; returns the path of its test.toml."""
    folder = root / "raw_tests" / "T"
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    (folder / "test.toml").write_text(HEAD + toml)
    return folder / "test.toml"


def read(root: Path, toml: str, files: Mapping[str, str | bytes]) -> TestLog:
    """The test as ingested."""
    ingest(load_definition(write(root, toml, files)), root / "ingest.h5")
    return read_log(root / "ingest.h5")


def csv(**columns: NDArray[np.float64]) -> str:
    """A log with these columns."""
    rows = zip(*columns.values(), strict=True)
    return ",".join(columns) + "\n" + "".join(",".join(f"{x:.6g}" for x in row) + "\n" for row in rows)


def channel(name: str, unit: str, *more: str) -> str:
    """The table of a channel whose column has its own name."""
    return "\n".join([f"[channels.{name}]", f'column = "{name}"', f'unit = "{unit}"', *more]) + "\n"
