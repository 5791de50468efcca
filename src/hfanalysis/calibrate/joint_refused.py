"""When a fit of all constants together is refused, and when adopted effects change nothing.

Effects that are not the whole story leave a misfit that the constants take up as far as their bounds let them: what
they are then is no property of the engine.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.engine.effect import Active
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.fitting.bounds import on_bounds
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import predict
from hfanalysis.inference.gap import noise_of, root_mean_square
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.subject import Subject
from hfanalysis.products.calibration import Calibration
from hfanalysis.record.channels import unit_of
from hfanalysis.record.definition import TestDefinition
from hfanalysis.sentences import said, text

MANY = 20.0
"""Times its noise by which a channel is missed of a fit that is refused. Evidence: with the four effects that its
diagnosis names the replica HF5 is missed by 8 times the noise of means in p_run, with one of them alone, or another, by
more than 150."""

FACTOR = 2.0
"""How many times larger or smaller than one by one a constant may be."""

COMPARED = ("C_i", "K_loss")
"""Constants that both ways find from the same channels."""

UNSEEN = 1.0
"""Standard deviations of all that is observed together by which effects have to change it to be seen at all."""

SHOWN = {"Pa": "bar"}


def reasons(
    found: Candidate, observed: Observed, one_by_one: Calibration, definition: TestDefinition
) -> tuple[str, ...]:
    """Why a fit of all constants together is none to go by; none where it is. ``one_by_one``: the constants beside."""
    values, area = found.fit.values, definition.injector_area
    together = {"K_loss": values.get("loss_factor"), "C_i": values["area"] / area.value if area is not None else None}
    return (*_missed(found, observed), *on_bounds(found.fit), *_leapt(together, one_by_one))


def _missed(found: Candidate, observed: Observed) -> list[str]:
    rms, noise = root_mean_square(found.fit, observed), noise_of(observed)
    worst = max(rms, key=lambda name: rms[name] / noise[name])
    if rms[worst] <= MANY * noise[worst]:
        return []
    unit = SHOWN.get(unit_of(worst), unit_of(worst))
    return [
        text(
            "{channel} is missed by {size} (rms), {times} times its noise",
            channel=worst,
            size=said(rms[worst], unit, ".3g"),
            times=f"{rms[worst] / noise[worst]:.0f}",
        )
    ]


def _leapt(together: Mapping[str, float | None], one_by_one: Calibration) -> list[str]:
    """Constants that are another than one by one by more than FACTOR."""
    out = []
    for name in COMPARED:
        value, before = together[name], getattr(one_by_one, name).value
        if value and before and not 1.0 / FACTOR < value / before < FACTOR:
            out.append(f"{name} would be {value:.3g}, where one by one it is {before:.3g}")
    return out


def change_nothing(subject: Subject, effects: Sequence[Active]) -> bool:
    """Whether a run with effects is, for what the channels show, one without: constants are what they are without.

    Raises AbsentError where the test has no engine that runs.
    """
    hypothesis, observed = subject.compared(as_run=True)
    acting = replace(hypothesis, engine=replace(hypothesis.engine, effects=(*hypothesis.engine.effects, *effects)))
    try:
        without, with_them = (_residual(h, observed) for h in (hypothesis, acting))
    except (ValueError, ArithmeticError):
        return False
    return bool(np.linalg.norm(with_them - without) < UNSEEN)


def _residual(hypothesis: Hypothesis, observed: Observed) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return predict(hypothesis, observed, np.zeros(hypothesis.size), tangents=False).residual
