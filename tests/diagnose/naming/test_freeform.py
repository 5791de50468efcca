"""Unknown sources in sensors: at rest as well, and faster than an engine."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from tests.diagnose import made

from hfanalysis.diagnose.answer.verdict import of_unknown
from hfanalysis.diagnose.answer.words import place_sentence
from hfanalysis.diagnose.fitting.fit import fit
from hfanalysis.diagnose.fitting.form import FINEST, Form
from hfanalysis.diagnose.fitting.probe import Splines
from hfanalysis.diagnose.naming.candidate import Bench, Candidate, candidate
from hfanalysis.diagnose.naming.course import course_of
from hfanalysis.diagnose.naming.freeform import unknown_sources
from hfanalysis.engine.effect import Active, Effect, Parameter


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
    return base, unknown_sources(base, base, bench)[0], bench


def test_a_sensor_that_drifts_stays_there_when_the_flow_is_over() -> None:
    base, best, bench = found("p_chamber", drift, FINEST)
    assert best.names == ("offset of p_chamber",)
    assert best.log_evidence > base.log_evidence + 50.0
    chamber = next(c for c in bench.observed.channels if c.name == "p_chamber")
    rest = chamber.time[chamber.resting & (chamber.time > 0.0)]
    assert rest.size > 0
    read = best.fit.hypothesis.offset("p_chamber", best.fit.x, rest)
    assert read == pytest.approx(drift(rest), abs=4.0 * made.NOISE["p_chamber"])
    course = course_of(best.fit, "offset of p_chamber", bench.observed)
    assert (np.abs(course.mean - drift(course.time)) < 3.5 * course.std).all()


def test_wind_on_the_stand_is_seen_behind_a_coarse_form() -> None:
    """The base model takes it for an error of its own in chamber and thrust: a form at which nothing else is seen."""
    base, best, bench = found("thrust", wind, Form(0, 4))
    assert base.leftover < 1.3
    assert best.names == ("offset of thrust",)
    assert best.form.chamber < base.form.chamber
    assert best.log_evidence > base.log_evidence + 20.0
    course = course_of(best.fit, "offset of thrust", bench.observed)
    assert (np.abs(course.mean - wind(course.time)) < 3.5 * course.std).mean() > 0.95
    row = of_unknown(course, 1.0, bench.observed.phases)
    assert row["rms"].value == pytest.approx(60.0 / np.sqrt(2.0), rel=0.2)
    assert "goes up and down by 4" in place_sentence(row)


def test_splines_are_held_beyond_their_ends_or_fade() -> None:
    at = np.array([-3.0, 0.0, 2.2, 6.0, 40.0])
    fading, held = (Splines.over(0.0, 6.0, 0.5, held).at(at) for held in (False, True))
    assert np.array_equal(held[1:4], fading[1:4])
    assert np.array_equal(held[[0, 4]], fading[[1, 3]])
    assert not fading[[0, 4]].any()
