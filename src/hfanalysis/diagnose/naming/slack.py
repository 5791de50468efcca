"""Slack: what the form of a named effect may get wrong.

A real effect never has quite the shape that its closure gives it. A named effect may therefore be some tenths larger or
smaller from one second to the next, and from phase to phase, in all channels alike. Before a second effect is claimed,
or an unknown one, the data have to be more probable than that.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.inference.candidate import Bench, Candidate, price
from hfanalysis.inference.fitting.fit import promised
from hfanalysis.inference.fitting.form import STEPS, Form
from hfanalysis.inference.fitting.predict import signatures
from hfanalysis.inference.observations.observed import Observed

SHAPE_ERROR = 0.2
"""By how much, relative to itself, an effect may be larger or smaller than its closure says."""

SHAPE_TIME = 1.5
"""Seconds between the knots of that error."""


def slack_gain(found: Candidate, bench: Bench) -> float:
    """By how much slack in its effects makes the data more probable for a candidate [natural log], at the form that
    suits it then.

    Slack is linear, and moves the other constants little: no run is needed.
    """
    plain, observed = found.fit, bench.at(found.form)
    try:
        signature = signatures(plain.hypothesis, observed, plain.x)
    except (ValueError, ArithmeticError):
        return 0.0
    columns = SHAPE_ERROR * _over_time(signature, observed)

    def gain(form: Form) -> float:
        dearer = price(form) - price(found.form)
        return promised(plain, observed, bench.at(form), columns) - dearer - plain.log_evidence

    form, best = found.form, gain(found.form)
    for _ in range(2 * STEPS):
        finer = {other: gain(other) for forms in form.finer for other in forms}
        if not finer or max(finer.values()) <= best:
            break
        form = max(finer, key=lambda f: finer[f])
        best = finer[form]
    return max(best, 0.0)


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
