"""Slack: what the form of a named effect may get wrong.

A real effect never has quite the shape that its closure gives it. A named effect may therefore be some tenths larger or
smaller from one second to the next, and from phase to phase, in all channels alike. Before a second effect is claimed,
or an unknown one, the data have to be more probable than that.
"""

from __future__ import annotations

import numpy as np

from hfanalysis.inference.candidate import Bench, Candidate, price
from hfanalysis.inference.fitting.courses import SHAPE_ERROR, courses
from hfanalysis.inference.fitting.fit import promised
from hfanalysis.inference.fitting.form import STEPS, Form

DIFFERS = 3.0
"""Log evidence [natural log] that slack has to bring for a course to be said to differ. Source: odds of twenty."""


def slack_gain(found: Candidate, bench: Bench) -> float:
    """By how much slack in its effects makes the data more probable for a candidate [natural log], at the form that
    suits it then.

    Slack is linear, and moves the other constants little: no run is needed.
    """
    plain, observed = found.fit, bench.at(found.form)
    if (columns := courses(found.fit.hypothesis, observed, found.fit.x)) is None:
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
    if (columns := courses(found.fit.hypothesis, observed, found.fit.x)) is None:
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
