"""A case run in a process of its own, with its memory and time bounded, and what came of it."""

from __future__ import annotations

import faulthandler
import io
import json
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections.abc import Mapping
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any
from unittest.mock import patch

from benchmarks.fuzz import cases, document
from benchmarks.fuzz.table import Case

SECONDS = 120.0
"""A case may take this long [s]. Evidence: the unspoilt ones take two on an idle core."""
MEMORY = 3 << 30
"""Address space that a case may take [B]: a log of 0.1 MB has no use for it."""
SAMPLES = 60
"""Draws of the calibration's inputs: enough for an interval."""
QUANTITIES = {"C_i": "calibration.json", "m": "calibration.json", "t_v": "segments.json", "impulse": "validation.json"}


EVERY = 5
"""One case in so many has a and n fitted, too, and the model run with them: four fifths of the time, and none of the
numbers that are judged."""


def attempt(case: Case) -> dict[str, Any]:
    """What came of a case: ``status`` (-1: killed), ``seconds``, ``said``, ``error`` (of a defect), ``found``."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
        root = cases.put(case, Path(folder))
        start = time.perf_counter()
        status, busy = _in_a_process(root, whole=case.number < 0 or case.number % EVERY == 0)
        seconds = time.perf_counter() - start
        told = root / "told.json"
        ended = {"status": -1, "said": "", "error": _ended(status, root)}
        outcome = json.loads(told.read_text()) if told.exists() else ended
        outcome |= {"seconds": round(seconds, 2), "busy": round(busy, 2)}
        outcome |= {"found": found(root / "processed" / document.ID)}
    return outcome


def _ended(status: int, root: Path) -> str:
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        return f"hang: {_where(root)}" if number == signal.SIGALRM else f"killed by {signal.Signals(number).name}"
    return f"ended with {os.WEXITSTATUS(status)} and no word"


def _where(root: Path) -> str:
    """The innermost lines of what a case was doing when its time was up."""
    lines = (root / "hung.txt").read_text().splitlines() if (root / "hung.txt").exists() else []
    return " < ".join(line.strip() for line in lines if "File" in line)[:600]


def _in_a_process(root: Path, whole: bool) -> tuple[int, float]:
    """Fork, since all that is slow has been imported here; returns the status as ``os.wait4`` has it, and the time on
    the processor [s].
    """
    child = os.fork()
    if child == 0:
        try:
            faulthandler.dump_traceback_later(SECONDS - 5.0, file=(root / "hung.txt").open("w"))
            signal.setitimer(signal.ITIMER_REAL, SECONDS)
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            (root / "told.json").write_text(json.dumps(_run(root) if whole else _without_law(root)))
        finally:
            os._exit(0)
    _, status, used = os.wait4(child, 0)
    return status, used.ru_utime + used.ru_stime


def _without_law(root: Path) -> dict[str, Any]:
    """As :func:`_run`, a and n left out."""
    from hfanalysis.calibrate import fuel_law
    from hfanalysis.products.calibration import FuelLaw

    with patch.object(fuel_law, "_fitted", lambda *_: FuelLaw.absent("left out")):
        return _run(root)


def _run(root: Path) -> dict[str, Any]:
    """As the command line runs it."""
    import typer

    from hfanalysis.cli import perform
    from hfanalysis.cli.exit_status import plain_exit
    from hfanalysis.cli.request import Request

    settings = (f"calibrate.samples={SAMPLES}",)
    out, said = io.StringIO(), io.StringIO()
    error, status = "", 0
    with redirect_stdout(out), redirect_stderr(said):
        try:
            with plain_exit():
                perform.stage("validate", Request(document.ID, root, None, False, False, False, settings))
        except typer.Exit as ended:
            status = ended.exit_code
        except BaseException as defect:
            status, error = 1, _defect(defect)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {"status": status, "said": said.getvalue()[-6000:], "error": error, "peak_mb": peak // 1024}


def _defect(error: BaseException) -> str:
    frames = [f for f in traceback.extract_tb(error.__traceback__) if "hfanalysis" in f.filename]
    at = f"{Path(frames[-1].filename).name}:{frames[-1].lineno} {frames[-1].name}" if frames else "?"
    return f"{type(error).__name__} at {at}: {str(error)[:300]}"


def found(folder: Path) -> dict[str, Any]:
    """The four quantities with interval and verdict where they are there, and what the health stage found."""
    out: dict[str, Any] = {}
    for name, file in QUANTITIES.items():
        quantity = _quantity(_product(folder / file), name)
        if quantity is not None and quantity.get("value") is not None:
            out[name] = {key: quantity.get(key) for key in ("value", "std", "ci95", "verdict", "reason", "why")}
    out["health"] = _findings(_product(folder / "health.json"))
    return out


def _quantity(product: Mapping[str, Any], name: str) -> Any:
    if name == "impulse":
        return ((product.get("performance") or {}).get("measured") or {}).get("total_impulse")
    return (product.get("quantities") or product.get("events") or {}).get(name, product.get(name))


def _product(path: Path) -> dict[str, Any]:
    try:
        product = json.loads(path.read_text())
    except (OSError, ValueError):
        return {}
    return product if isinstance(product, dict) else {}


def _findings(product: Mapping[str, Any]) -> list[str]:
    """``channel kind`` of every finding."""
    channels = product.get("channels") or {}
    own = [f"{name} {one.get('kind')}" for name, channel in channels.items() for one in channel.get("findings", ())]
    return [*own, *(f"{' '.join(one.get('channels', ()))} {one.get('kind')}" for one in product.get("between", ()))]


if __name__ == "__main__":  # python -m benchmarks.fuzz.attempt NUMBER SEED: one case, as it comes out
    print(json.dumps(attempt(cases.build(int(sys.argv[1]), int(sys.argv[2]))), indent=2))
