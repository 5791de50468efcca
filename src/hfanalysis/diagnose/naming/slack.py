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

SOONEST, DENSER = 0.1, 3.0
"""Seconds from the beginning of a phase to the second knot, and the ratio of distances from there until they are
SHAPE_TIME: what begins with a phase, a line that fills or a layer that is drawn off, is over in tenths of a second."""

DIFFERS = 3.0
"""Log evidence [natural log] that slack has to bring for a course to be said to differ. Source: odds of twenty."""


def slack_gain(found: Candidate, bench: Bench) -> float:
    """By how much slack in its effects makes the data more probable for a candidate [natural log], at the form that
    suits it then.

    Slack is linear, and moves the other constants little: no run is needed.
    """
    plain, observed = found.fit, bench.at(found.form)
    if (columns := _columns(found, observed)) is None:
        return 0.0

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


def course_error(found: Candidate, bench: Bench) -> float:
    """By how much the course of what a candidate adds differs from its closure's, as part of itself [-]; 0 where the
    data are no more probable with slack than without."""
    if not found.names or slack_gain(found, bench) < DIFFERS:
        return 0.0
    observed = bench.at(found.form)
    if (columns := _columns(found, observed)) is None:
        return 0.0
    white = observed.whiten(columns)
    residual = found.fit.residual[: white.shape[0]]
    slopes = np.hstack([found.fit.slopes[: white.shape[0]], -white])
    size = found.fit.x.size
    step = -np.linalg.solve(
        slopes.T @ slopes + np.eye(slopes.shape[1]), slopes.T @ residual + np.pad(found.fit.x, (0, white.shape[1]))
    )
    slack, whole = columns @ step[size:], columns.sum(axis=1) / SHAPE_ERROR
    size_of = [float(np.linalg.norm(observed.whiten(added))) for added in (slack, whole)]
    return size_of[0] / max(size_of[1], 1e-12)


def _columns(found: Candidate, observed: Observed) -> Array | None:
    """What slack of a standard deviation adds to the blocks of all channels [SI], a column per knot; None where the
    engine cannot be run."""
    try:
        signature = signatures(found.fit.hypothesis, observed, found.fit.x)
    except (ValueError, ArithmeticError):
        return None
    return SHAPE_ERROR * _over_time(signature, observed)


def _knots(start: float, end: float) -> Array:
    """Instants [s] between which slack is linear: dense where a phase begins.

    >>> _knots(0.0, 4.0).round(2).tolist()
    [0.0, 0.1, 0.4, 1.3, 2.65, 4.0]
    """
    knots, step = [start], SOONEST
    while step < SHAPE_TIME and knots[-1] + 2.0 * step < end:
        knots.append(knots[-1] + step)
        step *= DENSER
    rest = max(int(np.ceil((end - knots[-1]) / SHAPE_TIME)), 1)
    return np.concatenate([knots[:-1], np.linspace(knots[-1], end, rest + 1)])


def _over_time(signature: Array, observed: Observed) -> Array:
    """Columns: each signature times hats over the time of each phase."""
    time = np.concatenate([c.time for c in observed.channels])
    ends = [0.0, *(t for name, t in observed.phases.items() if name == "vapor"), float(time.max())]
    columns = []
    for start, end in pairwise(ends):
        knots = _knots(start, end)
        inside = (time >= start) & (time < end)
        for k in range(knots.size):
            hat = np.interp(time, knots, np.eye(knots.size)[k]) * inside
            columns += [signature[:, j] * hat for j in range(signature.shape[1])]
    out = np.column_stack(columns)
    return np.asarray(out[:, np.abs(out).max(axis=0) > 0.0])
