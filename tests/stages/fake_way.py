"""A way through of three small stages, to see the runner at work without any physics."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest

from hfanalysis.errors import AbsentError, InputError
from hfanalysis.stages import base, runner
from hfanalysis.stages.base import Context, Stage
from hfanalysis.stages.open_test import open_test

TOML = """\
schema = 1
[test]
id = "T1"
kind = "hot_fire"
[log]
files = ["log.csv"]
time = { column = "time", unit = "s" }
[channels.p_tank]
column = "p_tank"
unit = "bar"
"""

RUNS: list[str] = []
"""The stages that were really run, in order."""

FAULTS: dict[str, Exception] = {}
"""What a stage is to end with."""

BLOCK = "x" * 4096
PAUSE = 0.0
"""[s] between the blocks of the first stage, so that there is something to interrupt."""


def first(context: Context) -> None:
    """A big product, written block by block, and a small one."""
    _begin("first")
    rows = len((context.raw / "log.csv").read_text().splitlines())
    with context.scratch("first.bin").open("w") as file:
        for _ in range(20):
            file.write(BLOCK)
            file.flush()
            time.sleep(PAUSE)
        file.write(f"{rows}\nend")
    context.write_json("first.json", {"rows": rows})


def second(context: Context) -> None:
    """Depends on the first and on a parameter."""
    _begin("second")
    context.write_json("second.json", {"rows": context.read_json("first.json")["rows"] * context.parameter("factor")})


def third(context: Context) -> None:
    """Takes the second where it is there."""
    _begin("third")
    context.scratch("third.html").write_text(context.absent.get("second", "all there"))


def _begin(name: str) -> None:
    RUNS.append(name)
    if name in FAULTS:
        raise FAULTS[name]


STAGES = {
    "first": Stage("first", (), ("first.bin", "first.json"), first),
    "second": Stage("second", ("first",), ("second.json",), second, parameters={"factor": 1}),
    "third": Stage("third", ("first",), ("third.html",), third, wants=("second",)),
}


def install(patch: pytest.MonkeyPatch) -> None:
    """Put these stages in the place of the real ones."""
    patch.setattr(base, "load_stage", STAGES.__getitem__)
    patch.setattr(runner, "ORDER", tuple(STAGES))
    RUNS.clear()
    FAULTS.clear()


def make_test(root: Path) -> None:
    """One test below ``root``."""
    folder = root / "raw_tests" / "T1"
    folder.mkdir(parents=True)
    (folder / "test.toml").write_text(TOML)
    (folder / "log.csv").write_text("time,p_tank\n0,50\n1,49\n2,48\n")


def ran(root: Path, name: str, *, force: bool = False, out: Path | None = None, **settings: Any) -> list[str]:
    """Run up to a stage; the stages that were really run."""
    RUNS.clear()
    named = {key.replace("__", "."): value for key, value in settings.items()}
    runner.run_to(name, open_test(root, "T1", out, settings=named), force=force)
    return list(RUNS)


__all__ = ["FAULTS", "RUNS", "AbsentError", "InputError", "install", "make_test", "ran"]


if __name__ == "__main__":  # a child that may be killed: fake_way.py ROOT STAGE
    import sys

    PAUSE = 0.01
    install(pytest.MonkeyPatch())
    ran(Path(sys.argv[1]), sys.argv[2], force=True)
