"""What the samples show without a model, as a source in the model."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.inference import made

from hfanalysis.diagnose.answer.source_places import of_unknown
from hfanalysis.diagnose.answer.words import place_sentence
from hfanalysis.diagnose.naming.plain import plain_sources
from hfanalysis.engine.effect import Active
from hfanalysis.inference.candidate import Bench, Candidate, candidate
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.form import FINEST
from hfanalysis.inference.places import PLACES
from hfanalysis.inference.splines import Splines
from hfanalysis.inference.unknown import History, Unknown
from hfanalysis.inference.unknowns import failing_flow, late_channel, slow_valve, swing
from hfanalysis.inference.unknowns.failing_flow import SHARE_OF_FLOW, FailingFlow, flow_before
from hfanalysis.inference.unknowns.late_channel import LateChannel
from hfanalysis.inference.unknowns.slow_valve import SlowValve
from hfanalysis.inference.unknowns.smooth_source import SmoothSource, seen_at, sensor_place
from hfanalysis.inference.unknowns.swing import Swing


def with_plain(plain: Unknown, *hidden: Active) -> tuple[Candidate, Candidate, Bench]:
    """The base model of a test in which something is plain, with and without it."""
    test = replace(made.observed(*hidden), unknowns=(plain,))
    bench = Bench(test)
    base = candidate((), fit(made.hypothesis(), test), FINEST)
    return base, plain_sources(base, base, bench)[0], bench


def row_of(found: Candidate, bench: Bench) -> dict[str, Any]:
    return of_unknown(found.history(bench.observed), 1.0, bench.observed.phases)


def test_a_valve_that_opens_slowly_is_a_source_in_the_feed_with_its_time() -> None:
    plain = SlowValve(0.35, 40.0)
    base, found, bench = with_plain(plain, slow_valve.EFFECT.at(seconds=0.3))
    assert found.unknown
    assert found.log_evidence - base.log_evidence > plain.log_evidence + 50.0  # 0.3 s are seen in the blocks as well
    row = row_of(found, bench)
    assert (row.equation, row.phase, row.source.unit) == ("feed", "liquid", "Pa")
    assert abs(row.opens_in.value - 0.3) < 3.0 * row.opens_in.std
    assert row.t_start.value < 0.02
    assert row.t_end.value == pytest.approx(0.3, abs=0.05)
    assert re.fullmatch(
        r"The valve takes 30\d ± [\d.]+ ms to open, by the run line's pressure; .*", place_sentence(row)
    )


def test_what_a_filling_line_shows_as_well_is_no_evidence_for_a_slow_valve() -> None:
    plain = SlowValve(0.3, 40.0)
    base, alone, bench = with_plain(plain, slow_valve.EFFECT.at(seconds=0.3))
    filling = replace(base, names=(SlowValve.also_by,))
    assert plain_sources(filling, filling, bench) == []
    beside = plain_sources(base, filling, bench)[0]
    assert alone.log_evidence - beside.log_evidence == pytest.approx(plain.log_evidence)


def test_a_flow_that_fails_is_a_source_in_the_injector_with_its_time() -> None:
    t_v = made.observed().events["t_v"][0]
    plain = FailingFlow(t_v, 0.1, 0.4, 60.0)
    base, found, bench = with_plain(plain)
    assert found.names == (plain.place.name,)
    assert found.log_evidence > base.log_evidence + 0.7 * plain.log_evidence  # blocks that are left there deny it
    row = row_of(found, bench)
    assert (row.equation, row.phase, row.source.unit) == ("injector", "liquid", "kg/s")
    assert row.t_end.value == pytest.approx(t_v, abs=0.02)
    assert abs(row.t_start.value - (t_v - 0.1)) < 3.0 * row.t_start.std
    flow = flow_before(base.fit, t_v, plain.seconds)
    assert min(row.history.mean) == pytest.approx(-0.4 * flow, rel=0.3)
    assert re.fullmatch(
        r"In the last \d+ ± \d+ ms of the liquid the injector's flow fails, by .* g/s on average: .*",
        place_sentence(row),
    )


def test_a_hidden_failing_flow_is_found_as_large_as_it_is() -> None:
    """Blocks beside the end of the liquid show what the samples there were misread as."""
    hidden = failing_flow.EFFECT.at(share=0.5, liquid=0.3)
    test = made.observed(hidden)
    plain = FailingFlow(test.events["t_v"][0], 0.4, 0.4, 60.0)
    base, found, _ = with_plain(plain, hidden)
    assert found.log_evidence > base.log_evidence + plain.log_evidence + 20.0
    assert found.fit.values[SHARE_OF_FLOW] == pytest.approx(0.5, rel=0.25)


def test_a_flow_that_swings_is_a_source_in_the_injector_with_its_frequency() -> None:
    hidden = Swing(0.03, 4.0, 1.0, 0.8, 2.6, 60.0)
    given = {name: getattr(hidden, name) for name in ("share", "frequency", "phase", "start", "end")}
    base, found, bench = with_plain(replace(hidden, share=0.025, phase=1.2), swing.EFFECT.at(**given))
    assert found.log_evidence - base.log_evidence > hidden.log_evidence + 50.0  # slower than the blocks
    row = row_of(found, bench)
    assert row.equation == "injector"
    assert abs(row.source.value - 0.03) < 3.0 * row.source.std
    assert row.source.std < 0.003
    assert (row.t_start.value, row.t_end.value) == (pytest.approx(0.8, abs=0.2), pytest.approx(2.6, abs=0.2))
    assert re.search(r"swings by (2.9|3|3.1) ± 0.\d+ % at 4 Hz", place_sentence(row))


def test_a_clock_that_is_late_is_a_source_in_the_sensor_with_its_delay() -> None:
    base, found, bench = with_plain(LateChannel(0.04, 60.0), late_channel.EFFECT.at(delay=0.05))
    assert found.log_evidence > base.log_evidence + 60.0
    row = row_of(found, bench)
    assert (row.equation, row.channel, row.source.unit) == ("sensor", "thrust", "N")
    assert row.delay.value == pytest.approx(0.05, abs=0.01)
    assert (row.t_start.value, row.phase) == (0.0, "vapor")  # it shows most where the thrust falls
    assert max(row.history.mean) > 10.0 * abs(row.history.mean[5])
    assert row.source.value < 0.5 * np.mean(row.history.mean)  # what it lacks at the start is not drawn
    assert re.search(r"\(thrust\) is read (4\d|5\d)(\.\d)? ± \S+ ms late", place_sentence(row))


THRUST = sensor_place(made.observed(), "thrust")


@pytest.mark.parametrize(
    ("course", "std", "equation"),
    [
        (lambda t: 20.0 * np.sin(np.pi * t), 1.0, "nozzle"),  # gone as the flow ends
        (lambda t: -20.0 * np.sin(np.pi * t), 1.0, "nozzle"),
        (lambda t: 20.0 * np.sin(0.9 * np.pi * t), 1.0, "sensor"),  # a cell that comes back by two thirds
        (lambda t: 20.0 * np.sin(0.9 * np.pi * t), 8.0, "nozzle"),  # not seen any more
        (lambda t: 20.0 * t, 1.0, "sensor"),  # a cell that does not come back
        (lambda t: 20.0 * np.sin(4.0 * np.pi * t), 1.0, "sensor"),  # to and fro
    ],
)
def test_a_thrust_that_departs_until_the_flow_ends_is_the_nozzles(course, std: float, equation: str) -> None:  # type: ignore[no-untyped-def]
    time = np.linspace(0.0, 1.0, 50)
    place = seen_at(THRUST, course(time), np.full(50, std))
    assert place.equation == equation
    pressure = sensor_place(made.observed(), "p_chamber")
    assert seen_at(pressure, course(time), np.full(50, std)) == pressure


def test_where_a_smooth_source_is_goes_by_its_history() -> None:
    test, splines = made.observed(), Splines.over(0.0, made.observed().last, 0.6)
    base = fit(made.hypothesis(), test, made.truth(), 0)
    time = np.linspace(0.0, test.last, 100)
    for shape, equation in ((np.sin(np.pi * time / test.last), "nozzle"), (time / test.last, "sensor")):
        coefficients = np.linalg.lstsq(splines.at(time), 20.0 * shape, rcond=None)[0]
        source = SmoothSource(THRUST, 0.0, base.x, 20.0, 1.5, coefficients, splines)
        hypothesis, own = source.added_to(base)
        x = np.concatenate([base.x, own])
        found = replace(base, hypothesis=hypothesis, x=x, covariance=np.zeros((x.size, x.size)))
        history = source.history(found, test)
        assert history.place.equation == equation
        assert np.interp(time, history.time, history.mean) == pytest.approx(20.0 * shape, abs=0.3)


def test_a_factor_acts_most_where_what_it_multiplies_is_large() -> None:
    """A flow that is 5 and then 10 % less lacks most while it is large."""
    time, flow = np.linspace(0.0, 2.0, 100), np.repeat([1.0, 0.1], 50)
    place = next(place for place in PLACES if place.name == "injector_factor")
    less = History(place, time, np.repeat([-0.05, -0.1], 50), np.ones(100), 0.1)
    phases = {"liquid": 0.0, "vapor": 1.0, "end": 2.0}
    assert of_unknown(less, 1.0, phases).phase == "vapor"
    assert of_unknown(made.replace(less, whole=flow), 1.0, phases).phase == "liquid"
