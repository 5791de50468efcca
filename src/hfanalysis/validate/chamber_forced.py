"""chamber_forced: the measured chamber pressure in, the thrust out (report, 4.3.2): chemistry and nozzle alone.

The chamber's residence time is milliseconds, so that the mixture in it is that of the flows entering; under a given
pressure the thrust depends on it through gamma only.
"""

from __future__ import annotations

import numpy as np

from hfanalysis.engine.observe import read_as
from hfanalysis.errors import AbsentError
from hfanalysis.inference.adopted.corrected_log import corrected
from hfanalysis.inference.full_run import FullRun
from hfanalysis.performance.flows import Flows, nozzle_along
from hfanalysis.products.segments import Segments
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.validate.residuals import Residual, compared


def run_chamber_forced(
    log: TestLog, segments: Segments, full: FullRun, flows: Flows, ambient: float, end: float
) -> list[Residual]:
    """Measured and modeled thrust from the opening to ``end`` [s], as the cell reads it; ``ambient`` [Pa].

    What effects make of throat and thrust is that of the ``full`` run. Raises AbsentError where the log has no thrust
    or no chamber pressure.
    """
    origin, engine = segments.t_open.value or 0.0, full.engine
    true = corrected(log, origin, engine.effects)
    thrust, chamber = (Signal.of(true[name]).shifted(origin) for name in ("thrust", "p_chamber"))
    time = thrust.between(0.0, end).time
    if not time.size:
        raise AbsentError("the thrust has no good sample over the burn")
    pressure = np.maximum(chamber.at(time), 0.1 * ambient)
    mixed = np.isfinite(flows.of_ratio)
    ratio = np.interp(time, flows.time[mixed], flows.of_ratio[mixed]) if mixed.any() else np.full(time.size, np.nan)
    nozzle = nozzle_along(engine, pressure, ratio, ambient, full.factor("throat_factor", time))
    model = nozzle.thrust * full.factor("thrust_factor", time)
    read = read_as({"thrust": model}, time, engine.effects, {"p_chamber": pressure})["thrust"]
    return [compared(log, segments, "thrust", time, read, _notes(segments, end))]


def _notes(segments: Segments, end: float) -> tuple[str, ...]:
    t_purge = segments.time("t_purge")
    if t_purge is None or t_purge > end:
        return ()
    return (f"nitrogen enters at {t_purge:.2f} s; the gas in the nozzle is taken to be without it",)
