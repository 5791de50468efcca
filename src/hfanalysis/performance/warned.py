"""The numbers of a test's burn that the rules of :mod:`hfanalysis.engine.cautions` look at.

Means over the liquid phase: single samples are noise. The flux in the port is not among them: what burnt has shown that
it does.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hfanalysis.arrays import Array, Mask
from hfanalysis.engine import cautions
from hfanalysis.engine.unsteady import Engine
from hfanalysis.performance.efficiency import Ideal
from hfanalysis.performance.flows import HISTORY_STEP, Flows, nozzle_along
from hfanalysis.products.beyond import Beyond
from hfanalysis.products.segments import Segments
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal


def of_injector(log: TestLog, segments: Segments, time: Array, chamber: Array, liquid: Mask) -> Iterator[Beyond]:
    """From the measured p_run, where there is one; ``chamber`` [Pa] and the ``liquid`` phase (n,) at ``time`` [s]."""
    if "p_run" not in log:
        return
    before = Signal.of(log["p_run"]).shifted(segments.t_open.value or 0.0).reduced(HISTORY_STEP).at(time)
    drop = float(np.mean((before - chamber)[liquid]))
    yield from cautions.stiffness(drop / float(np.mean(chamber[liquid])))
    yield from cautions.reversed_flow(drop)


def of_nozzle(engine: Engine, flows: Flows, found: Ideal, ambient: float, liquid: Mask) -> Iterator[Beyond]:
    """From the measured chamber pressure in the ``liquid`` phase, (n,), into ``ambient`` [Pa]."""
    gammas = nozzle_along(engine, found.pressure, flows.of_ratio, ambient).gamma[liquid]
    gamma, pressure = float(np.nanmean(gammas)), float(np.mean(found.pressure[liquid]))
    yield from cautions.separation(pressure, ambient, gamma, engine.exit_area / engine.throat_area)
