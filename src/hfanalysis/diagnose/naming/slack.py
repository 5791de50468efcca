"""Slack: what the form of a named effect may get wrong.

A real effect never has quite the shape that its closure gives it. A named effect may therefore be some tenths larger or
smaller from one second to the next, and from phase to phase, in all channels alike. Before a second effect is claimed,
or an unknown one, the data have to be more probable than that.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.fitting.predict import signatures
from hfanalysis.diagnose.naming.candidate import SHORT, Bench, Candidate, attempted, candidate
from hfanalysis.diagnose.observations.observed import Observed

Array = NDArray[np.float64]

SHAPE_ERROR = 0.2
"""By how much, relative to itself, an effect may be larger or smaller than its closure says."""

SHAPE_TIME = 1.5
"""Seconds between the knots of that error."""


def slacked(found: Candidate, bench: Bench) -> Candidate:
    """The candidate with slack in its effects, where that makes the data more probable."""
    plain, observed = found.fit, bench.at(found.form)
    try:
        signature = signatures(plain.hypothesis, observed, plain.x)
    except (ValueError, ArithmeticError):
        return found
    columns = SHAPE_ERROR * _over_time(signature, observed)
    made = replace(plain.hypothesis, slack=columns)
    loose = attempted(made, observed, np.concatenate([plain.x, np.zeros(columns.shape[1])]), SHORT)
    if loose is None:
        return found
    judged = bench.judged(candidate(found.names, loose, found.form))
    return max(found, judged, key=lambda c: c.log_evidence)


def _over_time(signature: Array, observed: Observed) -> Array:
    """Columns: each signature times hats over the time of each phase."""
    time = np.concatenate([c.time for c in observed.channels])
    ends = [0.0, *(t for name, t in observed.phases.items() if name == "vapor"), float(time.max())]
    columns = []
    for start, end in pairwise(ends):
        count = max(int(np.ceil((end - start) / SHAPE_TIME)), 1) + 1
        knots = np.linspace(start, end, count)
        inside = (time >= start) & (time < end)
        for k in range(count):
            hat = np.interp(time, knots, np.eye(count)[k]) * inside
            columns += [signature[:, j] * hat for j in range(signature.shape[1])]
    out = np.column_stack(columns)
    return np.asarray(out[:, np.abs(out).max(axis=0) > 0.0])
