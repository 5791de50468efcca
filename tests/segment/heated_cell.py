"""A load cell that drifts with its heat, on a firing whose chamber is seen to be empty before the log ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from tests.segment.stand import AMBIENT, Trial, fire, log_of

from hfanalysis.record.log import TestLog

EMPTY = 9.0
"""[s] after the opening: from here on the chamber is at ambient pressure."""


def quenched() -> Trial:
    """A firing whose chamber is back at ambient pressure at EMPTY, logged for 10 s more."""
    test = fire(rate=200.0, after=14.0)
    out = test.time > EMPTY
    values = {n: np.where(out, AMBIENT if n == "p_chamber" else 0.0, v) for n, v in test.values.items()
              if n in ("p_chamber", "thrust")}  # fmt: skip
    return replace(test, values={**test.values, **values})


def heated(test: Trial, size: float) -> TestLog:
    """The cell drifts by ``size`` [N] until the fire is out and then recovers half of that."""
    log = log_of(test, white=0.0)
    drift = np.interp(test.time, [0.0, EMPTY, 21.0], [0.0, size, 0.5 * size])
    thrust = replace(log["thrust"], values=log["thrust"].values + drift, zero_std=1.0)
    chamber = replace(log["p_chamber"], zero_std=100.0)
    return replace(log, channels={**log.channels, "thrust": thrust, "p_chamber": chamber})
