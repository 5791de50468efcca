"""What no log can give away, with the reason: such cases are listed under it, not one by one.

By what was done to the case, not by how it came out; only where nothing else was done to it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from benchmarks.fuzz import cases
from benchmarks.fuzz.table import Array, Case, base_log

PACE = 0.15
"""Part by which a clock may run fast or slow unseen [-]: c* and C_i go with it, and of an engine that nobody has
measured they are known no better. A burn that was timed is known to a tenth."""
GAIN = 0.06
"""Part by which a gauge or cell may read high or low unseen [-]. Source: thrust coefficients of real nozzles are 0.92
to 1 of the ideal one, those of c* 0.7 to 1."""
LINE = 0.8
"""Share of the truth down to which a run-line gauge may read unseen [-]: as behind a line that loses more, which is not
measured otherwise."""
DRIFT = 0.1
"""Part of its range by which a gauge of tank or line may drift over the log unseen [-]; of that, a third by the end of
the liquid. Source: what mass and energy of a blowdown tell of its load, 5 % (calibrate/rest.py)."""

REASONS = {
    "pace": "a clock that runs evenly, up to 15 % too fast or slow: all flows go with it, as by another injector, and "
    "the burn was timed no better",
    "gain": "a gauge that reads up to 6 % too much or too little, more than its stated accuracy: as much is open in "
    "the nozzle's and the combustion's efficiencies",
    "line": "a run-line gauge that reads up to a fifth too little: as behind a feed line that loses more",
    "drift": "a gauge of tank or line that drifts by up to a tenth of its range over the log: it ends at a "
    "pressure that nothing else tells",
    "holes": "another area of the injector's holes, or another number of them, was stated: the log tells C_i times it "
    "alone, and C_i stays one that holes can have",
    "noise": "noise on a channel: the interval is as wide as the noise makes it, and one in twenty of 95 % misses",
    "table": "another table of nitrous oxide was stated: the number is what the statement asks for, and the product "
    "says by which table",
}


def reason(row: Mapping[str, Any], seed: int) -> str:
    """Why a case of these mutations cannot be told from a log alone; empty where it should be."""
    if len(row["mutators"]) > 1:
        return ""
    if row["mutators"] == ["toml: statement added"] and {"model", "properties"} <= set(row["hit"]):
        return REASONS["table"]
    if row["mutators"] == ["values: white noise"]:
        return REASONS["noise"]
    if row["mutators"] == ["toml: number scaled"] and "injector" in row["hit"]:
        return REASONS["holes"]
    if row["mutators"][0] not in ("clock: other pace", "values: scale", "values: drift"):
        return ""
    return _by_size(row["mutators"][0].partition(": ")[2], cases.build(row["number"], seed))


def _by_size(kind: str, case: Case) -> str:
    log, base = case.log, base_log(case.stand)
    if kind == "other pace":
        pace = float(np.ptp(log.time) / np.ptp(base.time))
        return REASONS["pace"] if abs(pace - 1.0) < PACE else ""
    name = next(name for name in log.channels if not np.array_equal(log.channels[name], base.channels[name], True))
    now, before = log.channels[name], base.channels[name]
    if kind == "scale":
        factor = _median(now / before)
        if name == "p_run" and LINE < factor < 1.0:
            return REASONS["line"]
        return REASONS["gain"] if abs(factor - 1.0) < GAIN else ""
    small = float(np.nanmax(np.abs(now - before))) < DRIFT * float(np.nanmax(np.abs(before)))
    return REASONS["drift"] if small and name in ("p_tank", "p_run", "p_purge") else ""


def _median(x: Array) -> float:
    return float(np.nanmedian(x))
