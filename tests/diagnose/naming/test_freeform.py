"""Unknown sources: in sensors at rest as well, and faster than an engine; in the engine until the liquid ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.inference import made

from hfanalysis.diagnose.answer.source_places import of_unknown
from hfanalysis.diagnose.answer.words import place_sentence
from hfanalysis.diagnose.naming.freeform import unknown_instead
from hfanalysis.engine.effect import Active, Effect, Parameter
from hfanalysis.engine.sites import AT_FLOW, FEED_LOSS, IS_LIQUID, term
from hfanalysis.inference.candidate import Bench, Candidate, candidate
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.form import FINEST, Form
from hfanalysis.inference.splines import Splines
from hfanalysis.inference.unknowns import in_slopes
from hfanalysis.inference.unknowns.smooth_source import CORRELATIONS, SmoothSource


def misread(channel: str, course: Callable[[np.ndarray], np.ndarray]) -> Active:
    """A sensor that reads a course over time too much."""
    return Effect(
        name="misread",
        equation="sensor",
        meaning="in no library",
        reference="this test",
        parameters=(Parameter("size", "", "of the course", 1.0),),
        phases=(),
        sites=(channel,),
        distort=lambda times, channels, values: {
            **channels,
            channel: channels[channel] + values["size"] * course(times),
        },
    ).at(size=1.0)


def drift(times: np.ndarray) -> np.ndarray:
    return 3e4 * (1.0 - np.exp(-np.maximum(times, 0.0) / 3.0))


def wind(times: np.ndarray) -> np.ndarray:
    return np.where(times > 0.0, 60.0 * np.sin(2.0 * np.pi * 0.7 * times), 0.0)


@cache
def found(channel: str, course: Callable[[np.ndarray], np.ndarray], form: Form) -> tuple[Candidate, Candidate, Bench]:
    """The base model at a form, the best unknown source, and the data."""
    test = made.observed(misread(channel, course))
    bench = Bench(test)
    base = candidate((), fit(made.hypothesis(), bench.at(form)), form)
    return base, unknown_instead(base, [], base, bench)[0], bench


def test_a_sensor_that_drifts_stays_there_when_the_flow_is_over() -> None:
    base, best, bench = found("p_chamber", drift, FINEST)
    assert best.names == ("offset of p_chamber",)
    assert best.log_evidence > base.log_evidence + 50.0
    chamber = next(c for c in bench.observed.channels if c.name == "p_chamber")
    rest = chamber.time[chamber.resting & (chamber.time > 0.0)]
    assert rest.size > 0
    read = best.fit.hypothesis.offset("p_chamber", best.fit.x, rest)
    assert read == pytest.approx(drift(rest), abs=4.0 * made.NOISE["p_chamber"])
    history = best.history(bench.observed)
    assert (np.abs(history.mean - drift(history.time)) < 3.5 * history.std).all()


def test_wind_on_the_stand_is_seen_behind_a_coarse_form() -> None:
    """The base model takes it for an error of its own in chamber and thrust: a form at which nothing else is seen."""
    base, best, bench = found("thrust", wind, Form(0, 4))
    assert base.leftover < 1.3
    assert best.names == ("offset of thrust",)
    assert best.form.chamber < base.form.chamber
    assert best.log_evidence > base.log_evidence + 20.0
    history = best.history(bench.observed)
    assert (np.abs(history.mean - wind(history.time)) < 3.5 * history.std).mean() > 0.95
    row = of_unknown(history, 1.0, bench.observed.phases)
    assert row.rms.value == pytest.approx(60.0 / np.sqrt(2.0), rel=0.2)
    assert "goes up and down by 4" in place_sentence(row)


@term
def _growing_loss(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_FLOW and env[IS_LIQUID] > 0.0:
        site[FEED_LOSS] += p[0] * t


def flashing(rate: float) -> Active:
    """A loss in the feed line that grows [Pa/s] as long as liquid flows, and is gone with it."""
    return Effect(
        name="growing_loss",
        equation="feed",
        meaning="in no library",
        reference="this test",
        parameters=(Parameter("rate", "Pa/s", "at which it grows", 1e4),),
        phases=("liquid",),
        term=_growing_loss,
        sites=("feed_loss",),
    ).at(rate=rate)


def test_a_source_may_end_with_the_liquid() -> None:
    test = made.observed(flashing(2e4))
    bench = Bench(test)
    base = candidate((), fit(made.hypothesis(), bench.at(FINEST)), FINEST)
    best = unknown_instead(base, [], base, bench)[0]
    assert best.names == ("feed_loss",)
    block = best.fit.hypothesis.blocks[0]
    t_v = test.events["t_v"][0]
    assert block.splines.liquid_out == t_v
    history = best.history(test)
    wet = history.time < t_v
    assert not history.mean[~wet].any()
    assert history.mean[wet][-1] > 0.5 * history.mean.max()
    # what loss the line had anyway is calibrated with it: the growth is what is seen
    grown = history.mean[wet] - 2e4 * history.time[wet]
    assert (np.abs(grown - grown.mean()) < 3.0 * history.std[wet] + 2e3).all()
    through = [s for s in in_slopes(base.fit, test) if s.place.name == "feed_loss" and isinstance(s, SmoothSource)]
    until, beyond = sorted(through, key=lambda s: s.splines.liquid_out)
    assert until.log_evidence > beyond.log_evidence + 5.0


def test_a_slow_source_is_coherent_over_many_splines() -> None:
    _, best, bench = found("p_chamber", drift, FINEST)
    base = candidate((), fit(made.hypothesis(), bench.at(FINEST)), FINEST)
    slow = next(s for s in in_slopes(base.fit, bench.at(FINEST)) if s.place.name == best.names[0])
    assert isinstance(slow, SmoothSource)
    assert slow.correlation == max(CORRELATIONS)


def test_splines_are_held_beyond_their_ends_or_fade_or_break_off() -> None:
    at = np.array([-3.0, 0.0, 2.2, 6.0, 40.0])
    splines = Splines.over(0.0, 6.0, 0.5)
    fading, held = splines.at(at), replace(splines, held=True).at(at)
    assert np.array_equal(held[1:4], fading[1:4])
    assert np.array_equal(held[[0, 4]], fading[[1, 3]])
    assert not fading[[0, 4]].any()
    wet = Splines.over(0.0, 6.0, 0.5, wet=True).at(at)
    assert np.array_equal(wet[:3], fading[:3])
    assert not wet[3:].any()
