"""What is plain in the samples without a model, as an unknown of the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.naming.places import FAILING, SWING, VALVE, clock_site
from hfanalysis.inference.candidate import SHORT, Bench, Candidate, attempted, candidate
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.observations.clocks import Delay
from hfanalysis.inference.observations.failing import FailingFlow
from hfanalysis.inference.observations.observed import Plain
from hfanalysis.inference.observations.valve_opening import SlowOpening
from hfanalysis.inference.unknowns.failing_flow import with_failing
from hfanalysis.inference.unknowns.late_channel import with_delay
from hfanalysis.inference.unknowns.slow_valve import with_valve
from hfanalysis.inference.unknowns.swing import with_swing

Array = NDArray[np.float64]

FILLING = "feed_line_fill"
"""The effect that brings the run line's pressure up gradually as well: beside it no slow valve is thought of."""


def plain_sources(parent: Candidate, named: Candidate, bench: Bench) -> list[Candidate]:
    """The parent with each of what is plain; ``named`` is the best that has names.

    What the raw samples tell counts besides, for most of it lies where no blocks are compared; but not where it speaks
    for a name as well.
    """
    tried = [_with(parent, named, plain, bench) for plain in bench.observed.plain]
    return [found for found in tried if found is not None]


def _with(parent: Candidate, named: Candidate, plain: Plain, bench: Bench) -> Candidate | None:
    spoken_for = isinstance(plain, SlowOpening) and FILLING in named.names
    if spoken_for and FILLING in parent.names:
        return None
    name, made, own = _added(parent.fit, plain)
    found = attempted(made, bench.at(parent.form), np.concatenate([parent.fit.x, own]), SHORT)
    if found is None:
        return None
    judged = bench.judged(candidate((*parent.names, name), found, parent.form, unknown=True))
    return judged if spoken_for else replace(judged, log_evidence=judged.log_evidence + plain.log_evidence)


def _added(parent: Fit, plain: Plain) -> tuple[str, Hypothesis, Array]:
    """The name of its site, the hypothesis with it, and its own x."""
    hypothesis = parent.hypothesis
    if isinstance(plain, Delay):
        return clock_site("thrust").name, *with_delay(hypothesis, "thrust", plain.seconds)
    if isinstance(plain, FailingFlow):
        return FAILING.name, *with_failing(parent, plain)
    if isinstance(plain, SlowOpening):
        return VALVE.name, *with_valve(hypothesis, plain)
    return SWING.name, *with_swing(hypothesis, plain)
