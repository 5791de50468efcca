"""The gap between model and test: what offset, gain and the instants may be off by is none of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from tests.inference import made

from hfanalysis.arrays import Array
from hfanalysis.inference.fitting.fit import Fit, fit
from hfanalysis.inference.gap import LEAST_GAP, flowing, residuals_of, total_gap
from hfanalysis.inference.observations.channel import ObservedChannel
from hfanalysis.inference.observations.observed import Observed


def changed(test: Observed, how: Callable[[ObservedChannel], ObservedChannel]) -> Observed:
    return replace(test, channels=tuple(how(c) for c in test.channels))


def slow(channel: ObservedChannel) -> Array:
    """What a channel lacks (blocks,) in the first tenths of a second, where the valve opens late."""
    return np.where(channel.resting, 0.0, -0.05 * channel.value.max() * np.exp(-channel.time / 0.15))


def late(test: Observed, deviations: float, known: bool = True) -> Observed:
    """The test with a valve that opens late by so many deviations, which are ``known`` to be possible or not."""
    return changed(
        test,
        lambda c: replace(c, value=c.value + deviations * slow(c), moved=slow(c)[:, None] if known else None),
    )


def fitted() -> tuple[Observed, Fit]:
    plain = made.observed()
    return plain, fit(made.hypothesis(), plain)


def test_what_an_opening_may_be_off_by_is_no_gap_and_more_of_it_is() -> None:
    plain, found = fitted()
    blamed = total_gap(found, late(plain, 1.5, known=False))
    assert total_gap(found, plain) < LEAST_GAP
    assert blamed > 2.0
    assert total_gap(found, late(plain, 1.5)) < 0.25 * blamed
    assert total_gap(found, late(plain, 8.0)) > 0.5 * total_gap(found, late(plain, 8.0, known=False))


def test_an_instant_is_off_in_all_channels_or_in_none() -> None:
    plain, found = fitted()
    one = changed(
        plain,
        lambda c: replace(c, moved=slow(c)[:, None], value=c.value + 1.5 * slow(c) * (c.name == "thrust")),
    )
    alone = changed(one, lambda c: replace(c, moved=c.moved if c.name == "thrust" else None))
    assert total_gap(found, one) > 2.0 * max(total_gap(found, alone), LEAST_GAP)


def test_a_source_that_goes_on_is_a_gap_whatever_the_instants() -> None:
    plain, found = fitted()
    wave = changed(
        late(plain, 1.0),
        lambda c: replace(c, value=c.value + 3e4 * np.sin(3.0 * c.time) * ~c.resting * (c.name == "p_chamber")),
    )
    assert np.sqrt(np.mean(residuals_of(found, wave)["p_chamber"] ** 2)) > 1.5e4


def test_what_the_model_misses_while_the_line_fills_is_no_sensors_offset() -> None:
    plain, found = fitted()
    phases = {**plain.phases, "liquid": 0.5}
    filling = changed(
        replace(plain, phases=phases), lambda c: replace(c, value=np.where(c.time < 0.5, 0.7 * c.value, c.value))
    )
    before, after = (residuals_of(found, test) for test in (replace(plain, phases=phases), filling))
    for c in filling.channels:
        counts = flowing(c, filling)
        assert np.abs(before[c.name] - after[c.name])[counts].max() < 0.05 * c.noise_std.mean()
