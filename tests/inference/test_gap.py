"""The gap between model and test: what offset, gain and the instants may be off by is none of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from tests.inference import made

from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.gap import LEAST_GAP, residuals_of, total_gap
from hfanalysis.inference.observations.observed import Observed


def late_valve(test: Observed, known: bool) -> Observed:
    """The test as if its chamber had filled late, in the first tenths of a second; whether that is ``known`` to be
    possible."""
    channels = []
    for c in test.channels:
        moved = np.where(c.resting, 0.0, 0.05 * c.value.max() * np.exp(-c.time / 0.1))[:, None]
        channels.append(replace(c, value=c.value + 1.5 * moved[:, 0], moved=moved if known else None))
    return replace(test, channels=tuple(channels))


def test_what_an_opening_may_be_off_by_is_no_gap() -> None:
    plain = made.observed()
    found = fit(made.hypothesis(), plain)
    seen, blamed = (late_valve(plain, known) for known in (True, False))
    assert total_gap(found, plain) < LEAST_GAP
    assert total_gap(found, blamed) > 2.0
    assert total_gap(found, seen) < 0.25 * total_gap(found, blamed)


def test_a_source_that_goes_on_is_a_gap_whatever_the_instants() -> None:
    plain = made.observed()
    found = fit(made.hypothesis(), plain)
    known = late_valve(plain, True)
    channels = tuple(
        replace(c, value=c.value + 3e4 * np.sin(3.0 * c.time) * ~c.resting) if c.name == "p_chamber" else c
        for c in known.channels
    )
    left = residuals_of(found, replace(known, channels=channels))["p_chamber"]
    assert np.sqrt(np.mean(left**2)) > 1.5e4
