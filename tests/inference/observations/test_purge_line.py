"""The purge line as a second look at the tank's pressure: when it counts, and what it may be off by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.inference import logged, made
from tests.segment.stand import channel

from hfanalysis.effects import effect
from hfanalysis.inference.fitting.hypothesis import Block, Hypothesis
from hfanalysis.inference.fitting.predict import predict, readings
from hfanalysis.inference.observations.channel import FORM_ERROR
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.observations.purge_line import SETTLED, VALVE, purge_line
from hfanalysis.inference.splines import Splines
from hfanalysis.quantity import Quantity
from hfanalysis.record.accuracy import SPAN_SHARE
from hfanalysis.record.log import TestLog

Array = NDArray[np.float64]

T_PURGE, CRACKING, ACCURACY = 3.0, 3e5, 1e4

NOT_STATED = 2.5e-3
"""Part of its largest reading that a sensor is accurate to where nothing is stated."""


def log(line: Array, seed: int | None = 3) -> TestLog:
    noise = 0.0 if seed is None else 6e3 * np.random.default_rng(seed).standard_normal(line.size)
    time, _ = logged.clean()
    made = logged.log(seed)
    return TestLog({**made.channels, "p_purge": channel("p_purge", time + logged.OPENING, line + noise, ACCURACY)})


def line_that_follows(share: float = 1.0, cracking: float = CRACKING) -> Array:
    """At its pressure until the tank is so far below it, then falling with the tank by a share of its fall."""
    time, read = logged.clean()
    first = float(np.interp(T_PURGE, time, read["p_tank"]))
    return np.where(time < T_PURGE, first, first + share * (read["p_tank"] - first)) + cracking


def reduced(line: Array, seed: int | None = 3) -> Observed:
    return logged.reduced(log(line, seed), t_purge=Quantity(T_PURGE, "s", 2e-3))


def test_a_line_that_follows_the_tank_reads_its_pressure() -> None:
    found = {c.name: c for c in reduced(line_that_follows(), seed=None).channels}
    assert list(found)[:2] == ["p_tank", "p_purge"]
    line, tank = found["p_purge"], found["p_tank"]
    assert line.time[0] > T_PURGE + SETTLED
    assert line.value == pytest.approx(np.interp(line.time, tank.time, tank.value), abs=2e3)


@pytest.mark.parametrize("share", [0.0, 2.0], ids=["stands", "falls faster"])
def test_a_line_that_does_not_follow_tells_nothing(share: float) -> None:
    assert "p_purge" not in reduced(line_that_follows(share)).names


def test_without_a_purge_line_or_its_sag_there_is_none() -> None:
    assert "p_purge" not in logged.reduced().names
    assert "p_purge" not in logged.reduced(log(line_that_follows())).names


@pytest.mark.parametrize("name", ["p_tank", "p_purge"])
def test_a_gap_where_the_line_begins_to_sag_leaves_nothing_to_tell_its_zero_by(name: str) -> None:
    whole = log(line_that_follows())
    since = whole[name].time - logged.OPENING - T_PURGE
    kept = (since < -1.2) | (since > 0.3)
    cut = replace(whole[name], **{key: getattr(whole[name], key)[kept] for key in ("time", "values", "flags")})
    broken = TestLog({**whole.channels, name: cut})
    assert "p_purge" in reduced(line_that_follows()).names
    assert "p_purge" not in logged.reduced(broken, t_purge=Quantity(T_PURGE, "s", 2e-3)).names


def test_its_errors_are_those_of_two_sensors_one_of_which_reads_the_tank() -> None:
    """What zeros and spans of both sensors, drawn again and again, make of tank and line."""
    of_log, change = log(line_that_follows(), None), {"t_purge": Quantity(T_PURGE, "s", 2e-3)}
    found = purge_line(of_log, logged.segments(**change), logged.stated(), logged.OPENING, 6.0)
    assert found is not None
    value = np.linspace(found.at_first, 0.3 * found.at_first, 8)
    largest = float(logged.clean()[1]["p_tank"].max())
    rng, drawn = np.random.default_rng(4), []
    for _ in range(20000):
        zero, span = SPAN_SHARE * ACCURACY * rng.standard_normal(2)
        own = SPAN_SHARE * NOT_STATED * rng.standard_normal()
        read = found.read_std * rng.standard_normal()
        of_tank = zero + span * value / largest
        of_line = zero + span * found.at_first / largest + read + own * (value - found.at_first)
        drawn.append(np.concatenate([of_tank, of_line]))
    expected = np.cov(np.array(drawn).T)
    close = {"rel": 0.05, "abs": 0.01 * ACCURACY**2}
    assert found.zero_and_span(value) == pytest.approx(expected[8:, 8:], **close)
    assert found.with_tank(value, value) == pytest.approx(expected[:8, 8:], **close)


def test_what_the_model_gets_wrong_of_the_tank_is_no_news_in_its_line() -> None:
    """Of a model-form error that moves both alike, the line's share is as likely as the tank's alone.

    Behind a valve that cracks at little, of which a tenth is less than the model's error: else the line may be off by
    itself.
    """
    test = reduced(line_that_follows(cracking=1e4))
    tank, line = test.channels[:2]
    n = tank.time.size
    coarse = test.with_errors(100.0 * FORM_ERROR, FORM_ERROR)
    both = np.sin(np.concatenate([tank.time, line.time])) * 50.0 * FORM_ERROR * np.ptp(tank.value)
    apart = np.where(np.arange(both.size) < n, both, -both)
    rest = np.zeros(sum(c.time.size for c in test.channels[2:]))
    alone = coarse.only(("p_tank",)).whiten(both[:n])
    together, against = (coarse.whiten(np.concatenate([v, rest])) for v in (both, apart))
    assert together @ together < 1.3 * alone @ alone + 5.0
    assert against @ against > 10.0 * together @ together


def hypothesis() -> Hypothesis:
    """With nitrogen from the line, and a tank's transducer that is off from ignition on, known and unknown."""
    with_both = made.hypothesis().with_effect(effect("n2_purge")).with_effect(effect("pressure_transducer_offset"))
    splines = Splines.over(0.0, 8.0, 2.0)
    names = tuple(f"source.{i}" for i in range(splines.count))
    return replace(with_both, blocks=(Block(names, 1e4 * np.eye(splines.count), splines, "p_tank"),))


def test_what_the_tanks_sensor_errs_by_as_the_lines_zero_is_taken_is_in_the_line() -> None:
    test, made_of = reduced(line_that_follows(), seed=None), hypothesis()
    x = np.zeros(made_of.size)
    x[: made.truth().size] = made.truth()
    place = made_of.names.index("pressure_transducer_offset.p_tank")
    line = test.channels[1]
    burnt = predict(made_of, test, x, tangents=False).burnt
    with_it = predict(made_of, test, x + np.eye(x.size)[place], tangents=False).burnt
    offset = made_of.values(x + np.eye(x.size)[place])["pressure_transducer_offset.p_tank"]
    change = line.averaged(readings(test, with_it)["p_purge"] - readings(test, burnt)["p_purge"])
    assert change == pytest.approx(np.full(line.time.size, offset))


def test_slopes_of_a_test_with_a_purge_line_are_differences_of_predictions(monkeypatch: pytest.MonkeyPatch) -> None:
    # the engine chooses its steps anew in every run, and a short difference would enlarge what that changes
    monkeypatch.setattr("hfanalysis.inference.fitting.predict.ACCURACY", 1e-8)
    test, made_of = reduced(line_that_follows()), hypothesis()
    x = np.concatenate([made.truth(), np.full(made_of.size - made.truth().size, 0.4)])
    x = np.clip(x, *made_of.bounds)
    here = predict(made_of, test, x, tangents=True)
    assert here.slopes is not None
    for k, name in enumerate(made_of.names):
        step = 1e-3 * np.eye(x.size)[k]  # small, for the line has a corner where the valve opens
        up, down = (predict(made_of, test, x + s * step, tangents=False).residual for s in (1, -1))
        quotient = (up - down) / 2e-3
        assert np.linalg.norm(here.slopes[:, k] - quotient) < 0.02 * np.linalg.norm(quotient) + 1.0, name


def test_leaving_blocks_or_channels_out_leaves_the_rest_as_it_is() -> None:
    test = reduced(line_that_follows())
    assert test.alike is not None
    out = {c.name: np.arange(c.time.size) % 3 == 0 for c in test.channels}
    kept = test.without(out)
    assert kept.alike == pytest.approx(test.alike[np.ix_(~out["p_tank"], ~out["p_purge"])])
    assert test.only(("p_tank", "thrust")).alike is None
    assert test.only(("p_tank", "p_purge")).alike is test.alike


def test_a_flow_through_the_check_valve_lifts_the_line_up_to_its_supply() -> None:
    purge, tank = effect("n2_purge"), np.linspace(40e5, 5e5, 60)
    stated = {"supply_pressure": 38e5, "cracking_pressure": 4e5}

    def lifted(**values: float) -> Array:
        active = purge.at(**stated, **values)
        assert purge.distort is not None
        read = purge.distort(np.zeros(tank.size), {"p_tank": tank, "p_purge": tank}, active.named)
        return np.asarray(read["p_purge"] - tank)

    driving = np.maximum(38e5 - 4e5 - tank, 0.0)
    little, much = lifted(area=1e-7, line_to_valve=0.2), lifted(area=1e-5, line_to_valve=1e3)
    assert (little[driving == 0.0] == 0.0).all()
    assert (np.diff(little[driving > 0.0]) > 0.0).all()
    assert (little <= driving).all()
    assert much[-1] == pytest.approx(driving[-1], rel=0.01)
    assert lifted(area=0.0) == pytest.approx(np.zeros(tank.size))


@pytest.mark.parametrize(
    "course", [lambda t: 1.0 + 0.0 * t, lambda t: 1.0 - np.exp(T_PURGE - t)], ids=["at once", "by and by"]
)
def test_a_valve_that_takes_a_tenth_less_once_it_is_open_says_nothing_of_the_tank(
    course: Callable[[Array], Array],
) -> None:
    test = reduced(line_that_follows())
    tank, line = test.channels[:2]
    less = np.zeros(sum(c.time.size for c in test.channels))
    of_line = slice(tank.time.size, tank.time.size + line.time.size)
    for part, odd in ((VALVE, False), (5.0 * VALVE, True)):
        less[of_line] = part * CRACKING * course(line.time)
        white = test.whiten(less)
        assert (float(white @ white) > 20.0) is odd
