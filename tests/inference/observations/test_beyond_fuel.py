"""A test whose fuel is gone before its oxidizer: the tank is compared on, against a model whose fire is out as well."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.engine.stand import engine_on_stand
from tests.inference import logged
from tests.products.filled import loaded
from tests.segment.stand import signal

from hfanalysis.diagnose.diagnosis import until_when
from hfanalysis.effects import effect
from hfanalysis.engine.observe import observe
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.inference.fitting.fit import fit
from hfanalysis.inference.fitting.hypothesis import Hypothesis, base_hypothesis
from hfanalysis.inference.fitting.predict import predict, readings, with_spare_fuel
from hfanalysis.inference.observations.alignment import MOST_MOVED, model_times, share
from hfanalysis.inference.observations.flow_end import APART, AROUND_END, AT_ONCE, WITHOUT_FIRE, find_flow_end
from hfanalysis.inference.observations.frame import AROUND_CHANGE, TANK_SIDE
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.observations.reduction import observe_test
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import ObservedSection as Seen
from hfanalysis.record.signals import Signal
from hfanalysis.units import Value

Array = NDArray[np.float64]

CLOSING, DRAINING = 9.5, 0.12
"""When the valve ahead of p_run closes [s], and how fast the line behind it drains."""

LESS = 0.6
"""Part of the fuel with which it is gone while there is liquid; all of it is gone in the vapor."""


@cache
def short_of_fuel(late: bool = True) -> Engine:
    whole = engine_on_stand()
    return whole if late else replace(whole, fuel_mass=LESS * whole.fuel_mass)


@cache
def run(late: bool = True) -> Burn:
    return burn(short_of_fuel(late), CLOSING, run_on=True)


@cache
def log(late: bool = True) -> TestLog:
    """What its sensors read, until after the valve has closed."""
    done, rng = run(late), np.random.default_rng(7)
    time = np.arange(-logged.QUIET + 0.5 / logged.RATE, CLOSING + 3.0, 1.0 / logged.RATE)
    read = observe(done, np.clip(time, 0.0, CLOSING))
    fallen = np.exp(-np.maximum(time - CLOSING, 0.0) / DRAINING)
    ambient = done.steps.engine.ambient
    for name, rest in (("p_run", ambient), ("p_chamber", ambient), ("thrust", 0.0)):
        read[name] = rest + np.where(time < 0.0, 0.0, fallen) * (read[name] - rest)
    noisy = {name: read[name] + std * rng.standard_normal(time.size) for name, std in logged.WHITE.items()}
    return TestLog({n: logged.channel(n, time + logged.OPENING, v, logged.ACCURACY[n]) for n, v in noisy.items()})


def fuel_out(late: bool = True) -> float:
    assert run(late).fuel_out
    return run(late).burn_time


@cache
def reduced(late: bool = True) -> Observed:
    return observations(late, log(late), fuel_out(late))


def observations(late: bool, of: TestLog, noted: float, std: float = 6e-3, t_v: Quantity | None = None) -> Observed:
    """What a log is reduced to; the end that was ``noted`` at the stand [s] is usually that of the fire."""
    liquid_out = run(late).liquid_out
    assert liquid_out is not None
    known = {"t_v": t_v or Quantity(liquid_out, "s", 1e-3), "t_fuel_out": Quantity(fuel_out(late), "s", std)}
    seen = Seen(burn_time=Value(round(noted, 1)))
    return observe_test(of, logged.segments(**known), logged.stated(observed=seen))


def hypothesis(late: bool = True) -> Hypothesis:
    engine = short_of_fuel(late)
    return base_hypothesis(engine, loaded(engine.oxidizer_mass, 0.02))


def truth(late: bool = True) -> Array:
    engine, base = short_of_fuel(late), hypothesis(late)
    true = {name: getattr(engine.feed, name, getattr(engine, name, None)) for name in base.names}
    return np.array([f.place(float(true[f.name])) for f in base.free])


def last(test: Observed, name: str) -> float:
    """Until when a channel is compared while something flows [s]."""
    channel = next(c for c in test.channels if c.name == name)
    return float(channel.time[~channel.resting].max())


@pytest.mark.parametrize("late", [True, False])
def test_the_tank_is_compared_until_shortly_before_the_valve_closes(late: bool) -> None:
    test = reduced(late)
    assert test.fuel_out == fuel_out(late)
    for name in test.names:
        if name in TANK_SIDE and name != "p_run":  # its pressure goes by that of a chamber without a flame
            assert CLOSING - AROUND_END - 0.2 < last(test, name) <= CLOSING - AROUND_END + 0.06
        else:
            assert last(test, name) < fuel_out(late)
    assert "t_v" in test.events


def test_an_end_of_the_flow_that_was_noted_is_kept_to() -> None:
    assert last(observations(True, log(), 8.0), "p_tank") <= 8.0 - AROUND_END


def test_a_log_that_ends_with_the_fire_is_compared_as_before() -> None:
    end = logged.OPENING + fuel_out() + 0.4
    cut = {n: replace(c, time=c.time[c.time < end], values=c.values[c.time < end], flags=c.flags[c.time < end])
           for n, c in log().channels.items()}  # fmt: skip
    test = observations(True, TestLog(cut), fuel_out())
    assert test.fuel_out is None
    assert max(last(test, name) for name in test.names) < fuel_out()


def test_a_fire_that_fades_is_compared_as_before() -> None:
    test = observations(True, log(), fuel_out(), std=1.5 * AT_ONCE)
    assert test.fuel_out is None
    assert max(last(test, name) for name in test.names) < fuel_out()


def fading(ends: float, begins: float = 2.0, lasts: float = 1.5) -> TestLog:
    """The log, whose valve closes at ``ends`` [s] while the fire still fades: to its e-th part of the excess in so
    long."""
    whole, out = log(), {}
    for name, c in whole.channels.items():
        since = np.maximum(c.time - logged.OPENING - begins, 0.0)
        closed = c.time - logged.OPENING > ends
        rest = {"p_chamber": run().steps.engine.ambient, "p_run": run().steps.engine.ambient, "thrust": 0.0}
        values = c.values.copy()
        if name in ("p_chamber", "thrust"):
            values = rest[name] + (values - rest[name]) * np.exp(-since / lasts)
        after = rest.get(name, float(values[~closed][-1]))
        out[name] = replace(c, values=np.where(closed, after, values))
    return TestLog(out)


def test_a_fire_that_may_have_faded_when_the_valve_closes_is_compared_until_it_fades() -> None:
    ends = 2.6
    unseen = Quantity.absent("not seen")
    known = logged.segments(t_end=Quantity(ends, "s", 0.01), t_fuel_out=unseen, t_fuel_gone=unseen, t_v=unseen)
    fades, burns = (observe_test(of, known, logged.stated()) for of in (fading(ends), fading(ends, lasts=1e9)))
    assert burns.flame_shown is None
    assert last(burns, "p_tank") > ends - 0.3
    assert fades.flame_shown == pytest.approx(2.0, abs=0.25)
    assert max(last(fades, name) for name in fades.names) < fades.flame_shown
    assert until_when(burns) == ()
    # the end of the flow may have been taken for that of the fuel: it fades from before then on
    late = {n: Quantity(ends - 0.02, "s", 0.01) for n in ("t_fuel_out", "t_fuel_gone")}
    known = logged.segments(t_end=Quantity(ends, "s", 0.01), t_v=unseen, **late)
    seen = observe_test(fading(ends), known, logged.stated())
    assert seen.flame_shown is None
    berth = AROUND_CHANGE + 0.02  # that of an instant which is known to some tenths only, and a block
    assert last(fades, "p_tank") - berth < max(last(seen, name) for name in seen.names) < fades.flame_shown


def test_how_fast_liquid_flows_without_fire_is_known_to_a_tenth_only() -> None:
    early, late = reduced(False), reduced()
    t_v, deviation = early.events["t_v"]
    assert early.spread("t_v") > 0.9 * WITHOUT_FIRE * (t_v - fuel_out(False)) > 10.0 * deviation
    assert late.spread("t_v") < 1.1 * late.events["t_v"][1]


def test_fuel_and_liquid_that_end_together_are_not_followed() -> None:
    together = Quantity(fuel_out(False) + 0.5 * APART, "s", 1e-3)
    assert observations(False, log(False), fuel_out(False), t_v=together).fuel_out is None


@pytest.mark.parametrize("late", [True, False])
def test_the_model_burns_out_when_the_fuel_was_seen_to_end_whatever_its_web(late: bool) -> None:
    test, x = reduced(late), truth(late)
    slower = x.copy()
    slower[hypothesis(late).names.index("a")] -= 0.1
    burnt = predict(hypothesis(late), test, slower, tangents=False).burnt
    assert burnt.burn_time == pytest.approx(fuel_out(late), abs=1e-9)
    web = hypothesis(late).engine.outer_radius - burnt.state("port_radius")[-1]
    assert web > 1e-4
    row = sum(c.time.size for c in test.channels) + list(test.events).index("t_fuel_out")
    assert predict(hypothesis(late), test, slower, tangents=False).residual[row] > 1.0
    assert abs(predict(hypothesis(late), test, x, tangents=False).residual[row]) < 0.1


@pytest.mark.parametrize("late", [True, False])
def test_the_truth_leaves_noise_and_a_fire_that_burns_on_does_not(late: bool) -> None:
    test = reduced(late)
    on = replace(test, fuel_out=None)
    right, wrong = (predict(hypothesis(late), t, truth(late), tangents=False) for t in (test, on))
    beyond = np.concatenate([(c.time > fuel_out(late)) & ~c.resting for c in test.channels])
    assert beyond.sum() > 60
    # the noise of a sample is estimated from four quiet seconds
    assert 0.6 < np.mean(right.residual[: beyond.size][beyond] ** 2) < 1.4
    # how fast the tank empties without fire is taken as known to a tenth only, so that it is the readings that tell
    told, untrue = readings(test, right.burnt), readings(on, wrong.burnt)
    apart = [c.averaged(told[c.name] - untrue[c.name]) / c.noise_std for c in test.channels]
    assert np.mean(np.concatenate(apart)[beyond] ** 2) > 3.0


@pytest.mark.parametrize("late", [True, False])
def test_slopes_are_differences_of_predictions(late: bool) -> None:
    made, test = hypothesis(late).with_effect(effect("tank_heat")), reduced(late)
    assert made.names[-4:] == ("tank_heat.power", "tank_heat.lag", "tank_heat.fade", "tank_heat.begun")
    x = np.concatenate([truth(late), [0.4, 1.0, -0.5, 0.3]])
    here = predict(made, test, x, tangents=True)
    assert here.slopes is not None
    for k, name in enumerate(made.names):
        step = 1e-2 * np.eye(x.size)[k]
        up, down = (predict(made, test, x + s * step, tangents=False).residual for s in (1, -1))
        quotient = (up - down) / 2e-2
        # as in a test with fuel left: runs are exact to some hundredths of the noise
        assert np.linalg.norm(here.slopes[:, k] - quotient) < 0.02 * np.linalg.norm(quotient) + 1.0, name


def test_the_constants_come_back_from_a_wrong_start() -> None:
    start = truth()
    start[hypothesis().names.index("area")] += 0.3
    found = fit(hypothesis(), reduced(), start)
    assert found.converged
    assert found.values["area"] == pytest.approx(short_of_fuel().feed.area, rel=0.05)
    assert found.residual @ found.residual < 1.4 * found.residual.size


def test_without_a_flame_the_tank_tells_what_it_holds_and_not_what_flows() -> None:
    """Nitrogen enters once the tank is below its line, most of it beyond the fuel's end. There nobody knows the flow:
    only what pressure the tank has with so much in it tells, and a flow that is known would tell three times as much.
    """
    test = reduced()
    beyond = {c.name: c.time > fuel_out() for c in test.channels}
    before = information(test.without(beyond))
    assert 1.1 * before < information(test) < 3.0 * before


def information(test: Observed) -> float:
    """What a test tells of the nitrogen's strength, with the engine's constants free."""
    made = hypothesis().with_effect(effect("n2_purge"))
    start = np.concatenate([truth(), np.zeros(made.size - hypothesis().size)])
    slopes = predict(made, test, start, tangents=True).slopes
    assert slopes is not None
    strength = made.names.index("n2_purge.area")
    a, b = np.delete(slopes, strength, axis=1), slopes[:, strength]
    return float(b @ (b - a @ np.linalg.solve(a.T @ a + np.eye(a.shape[1]), a.T @ b)))


def test_a_test_with_fuel_left_is_predicted_as_if_there_were_no_such_end() -> None:
    seen = Seen(burn_time=Value(6.5))
    left = logged.reduced(definition=logged.stated(observed=seen), t_fuel_out=Quantity.absent("fuel is left"))
    assert left.fuel_out is None
    engine = with_spare_fuel(engine_on_stand(), left.fuel_out)
    one, two = (burn(e, 9.0, run_on=True) for e in (engine, replace(engine, fuel_end=100.0)))
    assert np.array_equal(one.states, two.states)
    assert np.array_equal(one.outputs, two.outputs)
    times = np.linspace(0.0, 9.0, 50)
    dry, gone = 5.8, 5.83
    shifted = np.where(times < dry, times * gone / dry, times + gone - dry)
    assert np.array_equal(model_times(times, dry, gone, left.fuel_out), shifted)
    assert np.array_equal(share(times, dry, gone, left.fuel_out), np.minimum(times / dry, 1.0))


@pytest.mark.parametrize("fuel", [7.0, 4.0])
def test_model_and_measurement_have_their_knees_together(fuel: float) -> None:
    seen, gone, times = 5.8, 5.9, np.linspace(0.0, 9.0, 901)
    assert model_times(np.array([seen, fuel]), seen, gone, fuel) == pytest.approx([gone, fuel])
    there = model_times(times, seen, gone, fuel)
    assert (np.diff(there) > 0.0).all()
    nearby = (model_times(times, seen, gone + s, fuel) for s in (1e-6, -1e-6))
    up, down = nearby
    assert share(times, seen, gone, fuel) == pytest.approx((up - down) / 2e-6, abs=1e-6)
    far = seen + 1.01 * MOST_MOVED * abs(fuel - seen)
    assert model_times(times, seen, far, fuel) == pytest.approx(model_times(times, seen, far))


AMBIENT, FUEL_OUT, ERROR = 1e5, 2.0, 2e4


def pressures(closing: float = 6.0, end: float = 9.0) -> tuple[Array, Array, Array]:
    """A tank that empties through a line that takes a tenth, until it is closed."""
    time = np.arange(0.0, end, 2e-3)
    tank = AMBIENT + 25e5 * np.exp(-0.4 * np.minimum(time, closing))
    return time, tank, AMBIENT + 0.9 * (tank - AMBIENT)


def as_logged(name: str, time: Array, value: Array, seed: int) -> Signal:
    return signal(name, time, value + 5e3 * np.random.default_rng(seed).standard_normal(time.size))


def flow_end(time: Array, tank: Array, line: Array, t_purge: float | None = None) -> float | None:
    both = as_logged("p_tank", time, tank, 1), as_logged("p_run", time, line, 2)
    return find_flow_end(*both, FUEL_OUT, AMBIENT, ERROR, t_purge)


@pytest.mark.parametrize("closing", [4.0, 6.0])
@pytest.mark.parametrize("draining", [0.03, 0.12, 1.0])
def test_a_line_that_drains_tells_of_a_valve_ahead_of_it(closing: float, draining: float) -> None:
    time, tank, line = pressures(closing=closing)
    line = np.where(time > closing, AMBIENT + (line - AMBIENT) * np.exp(-(time - closing) / draining), line)
    found = flow_end(time, tank, line)
    assert found is not None
    # the comparison stops AROUND_END before what is found
    assert closing - 0.1 - 0.5 < found < closing + AROUND_END


@pytest.mark.parametrize("closing", [4.0, 6.0])
def test_a_tank_that_empties_no_more_tells_of_a_valve_behind_the_line(closing: float) -> None:
    time, tank, line = pressures(closing=closing)
    line = np.where(time > closing, tank, line)
    found = flow_end(time, tank, line)
    assert found is not None
    assert closing - 0.1 - 0.5 < found < closing + AROUND_END


def test_nitrogen_raises_the_tank_behind_a_closed_valve() -> None:
    time, tank, line = pressures(closing=6.0)
    tank = tank + np.where(time > 6.0, 2e5 * (time - 6.0), 0.0)
    found = flow_end(time, tank, np.where(time > 6.0, tank, line), t_purge=1.0)
    assert found is not None
    assert 5.5 < found < 6.0 + AROUND_END


def test_nitrogen_that_holds_the_tank_is_no_closed_valve() -> None:
    time, tank, line = pressures(closing=4.0)
    assert flow_end(time, tank, line, t_purge=3.9) == pytest.approx(9.0, abs=0.1)
    assert flow_end(time, tank, line) == pytest.approx(4.0, abs=0.5)


def test_a_flow_that_is_no_longer_logged_has_ended() -> None:
    time, tank, line = pressures(closing=9.0)
    assert flow_end(time, tank, line) == pytest.approx(9.0, abs=0.1)
    kept = (time < 5.0) | (time > 5.5)
    assert flow_end(time[kept], tank[kept], line[kept]) == pytest.approx(5.0, abs=0.1)
    kept = time < FUEL_OUT + 0.5
    assert flow_end(time[kept], tank[kept], line[kept]) is None


def test_an_empty_tank_flows_no_more() -> None:
    time, tank, line = pressures(closing=20.0, end=15.0)
    empty = 2.5 * np.log(25e5 / 0.3e5)  # e-folding 2.5 s, down to 0.3 bar
    assert flow_end(time, tank, line) == pytest.approx(empty, abs=0.3)
