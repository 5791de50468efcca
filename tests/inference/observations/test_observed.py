"""What a log is reduced to: block means, and the covariance of their noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.inference import logged, made
from tests.inference.made import covariance_of

from hfanalysis.engine.unsteady import Burn
from hfanalysis.errors import AbsentError
from hfanalysis.inference.observations.blocks import MERGED, NEAR
from hfanalysis.inference.observations.channel import FORM_ERROR, ObservedChannel
from hfanalysis.inference.observations.covariance import coherence_of
from hfanalysis.inference.observations.frame import (
    AROUND_CHANGE,
    BEFORE_END,
    BLOCK,
    EVENT_STD,
    FIRST,
    REST_BLOCKS,
    phases_of,
)
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.observations.recorded import TOGETHER, as_read
from hfanalysis.quantity import Quantity
from hfanalysis.record.accuracy import SPAN_SHARE
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import ObservedSection as Seen
from hfanalysis.units import Value


def channel(test: Observed, name: str) -> ObservedChannel:
    return next(c for c in test.channels if c.name == name)


def changes() -> list[float]:
    run: Burn = logged.run()
    assert run.liquid_out is not None
    return [run.liquid_out, run.burn_time]


def test_blocks_are_means_of_the_samples_in_them() -> None:
    log, test = logged.log(), logged.reduced()
    time = log["p_run"].time - logged.OPENING
    run = channel(test, "p_run")
    for k in (0, 3, 25, 40, run.time.size - 1):
        half = 0.5 * BLOCK * run.count[k]
        inside = (time >= run.time[k] - half - 1e-9) & (time < run.time[k] + half - 1e-9)
        assert inside.sum() == round(run.count[k] * BLOCK * logged.RATE)
        assert run.value[k] == pytest.approx(log["p_run"].values[inside].mean())


def test_blocks_are_single_near_changes_and_merged_elsewhere() -> None:
    run = channel(logged.reduced(), "p_run")
    away = np.min([np.abs(run.time - t) for t in changes()], axis=0)
    lively = (run.time < FIRST + NEAR - BLOCK) | (away < NEAR - BLOCK)
    assert (run.count[lively] == 1).all()
    assert (run.count[~lively] == MERGED).mean() > 0.8
    assert run.count.max() == MERGED
    assert away.min() > AROUND_CHANGE
    assert run.time[0] > FIRST
    assert run.time[-1] < changes()[1]


def test_the_model_is_averaged_as_the_samples_are() -> None:
    test = logged.reduced(logged.log(seed=None))
    for c in test.channels:
        assert c.averaged(test.grid)[~c.resting] == pytest.approx(c.time[~c.resting], abs=1e-9)
        read = np.interp(test.grid, *_clean(c.name))
        error = c.averaged(read)[~c.resting] - c.value[~c.resting]
        assert np.abs(error).max() < 2e-3 * np.ptp(c.value), c.name


def _clean(name: str) -> tuple[np.ndarray, np.ndarray]:
    time, read = logged.clean()
    return time, read[name]


def test_sensors_at_rest_are_compared_where_their_truth_is_known() -> None:
    test = logged.reduced()
    for c in test.channels:
        after = c.resting & (c.time > 0.0)
        assert after.sum() == (REST_BLOCKS if c.name in ("p_chamber", "thrust") else 0), c.name
        assert (c.resting & (c.time <= 0.0)).sum() == (2 if c.name in ("p_tank", "m_tank") else 0), c.name
        assert (test.resting[c.first] == c.resting).all()
    chamber = channel(test, "p_chamber")
    assert chamber.value[chamber.resting] == pytest.approx(test.ambient, abs=1e3)
    assert chamber.time[chamber.resting].min() > changes()[1] + 0.5


ZEROED = ("p_run", "p_chamber", "thrust")


def zeroed(log: TestLog) -> TestLog:
    """The same with zeros that were taken before the opening."""
    return TestLog({n: replace(c, zero_std=1e-3 * c.accuracy) if n in ZEROED else c for n, c in log.channels.items()})


def test_sensors_with_a_zero_are_compared_at_rest_before_the_opening() -> None:
    test = logged.reduced(zeroed(logged.log()))
    for c in test.channels:
        before = c.resting & (c.time < 0.0)
        assert before.sum() == (7 if c.name in ZEROED else 2), c.name
        assert (c.time[before] < -BEFORE_END).all()
        assert c.averaged(test.grid) == pytest.approx(c.time, abs=1e-9)
    run = channel(test, "p_run")
    assert run.value[run.resting] == pytest.approx(test.ambient, abs=1e3)


@pytest.mark.parametrize(("start", "end", "rise"), [(-1.5, 0.0, 5e4), (-0.7, -0.3, 1e5)])
def test_a_zero_that_moves_before_the_opening_is_not_compared(start: float, end: float, rise: float) -> None:
    """An igniter that burns before the valve opens, or flashes [Pa/s]."""
    time = logged.clean()[0]
    burns = np.where((time > start) & (time < end), rise * (time - start), 0.0)
    test = logged.reduced(zeroed(logged.log(plus={"p_chamber": burns})))
    assert not (channel(test, "p_chamber").resting & (channel(test, "p_chamber").time < 0.0)).any()
    assert (channel(test, "thrust").resting & (channel(test, "thrust").time < 0.0)).sum() == 7


def test_what_moves_under_load_alone_is_no_error_of_the_zero() -> None:
    test = logged.reduced(zeroed(logged.log()))
    for name in ZEROED:
        one = test.only((name,))
        c = one.channels[0]
        moved = 0.5 * c.accuracy * np.ones((c.time.size, 1))
        always, loaded = (np.sum(one.whiten(m) ** 2) for m in (moved, moved * ~c.resting[:, np.newaxis]))
        assert always < 0.6, name
        assert loaded > 4.0 * always, name


def test_a_log_that_ends_with_the_burn_has_no_rest_after_it() -> None:
    whole, end = logged.log(), changes()[1] + logged.OPENING + 0.2
    short = TestLog({n: _cut(c, end) for n, c in whole.channels.items()})
    test = logged.reduced(short)
    assert not (channel(test, "thrust").resting).any()
    assert channel(test, "p_tank").resting.sum() == 2


def test_the_rest_after_the_flow_begins_where_the_chamber_stands_still() -> None:
    """What burns on fades: over the first of four blocks it is four deviations of noise, over the first half two."""
    time, end = logged.clean()[0], changes()[1]
    glow = np.where(time > end, 5e4 * np.exp(-np.maximum(time - end, 0.0) / 0.25), 0.0)
    still, glowing = (
        channel(logged.reduced(logged.log(plus=plus)), "p_chamber") for plus in (None, {"p_chamber": glow})
    )
    first, later = (c.time[c.resting & (c.time > 0.0)] for c in (still, glowing))
    assert first.size == later.size == REST_BLOCKS
    assert first[0] + 0.2 < later[0] < first[0] + 0.9
    assert later[1] - later[0] < 0.95 * (first[1] - first[0])
    rest = channel(logged.reduced(logged.log(plus={"p_chamber": glow})), "p_chamber")
    assert np.abs(rest.value - logged.reduced().ambient)[rest.resting & (rest.time > 0.0)].max() < 1.5e3


@pytest.mark.parametrize(("quiet", "blocks"), [(0.02, 0), (0.3, 1), (0.65, 1), (1.15, 2)])
def test_a_log_that_begins_shortly_before_the_opening_has_as_much_rest(quiet: float, blocks: int) -> None:
    log = TestLog({n: _begun(c, logged.OPENING - quiet) for n, c in logged.log().channels.items()})
    tank = channel(logged.reduced(log), "p_tank")
    assert (tank.time < 0.0).sum() == blocks
    assert tank.resting.sum() == blocks


def _begun(c, start: float):  # type: ignore[no-untyped-def]
    kept = c.time >= start
    return replace(c, time=c.time[kept], values=c.values[kept], flags=c.flags[kept])


def _cut(c, end: float):  # type: ignore[no-untyped-def]
    kept = c.time < end
    return replace(c, time=c.time[kept], values=c.values[kept], flags=c.flags[kept])


@pytest.mark.parametrize("with_common", [False, True])
def test_noise_of_that_covariance_is_white_after_whitening(with_common: bool) -> None:
    test = made.observed(common=with_common)
    covariance = covariance_of(test)
    root = np.linalg.cholesky(covariance)
    assert test.whiten(root) @ test.whiten(root).T == pytest.approx(np.eye(root.shape[0]), abs=1e-6)
    draws = test.whiten(root @ np.random.default_rng(2).standard_normal((root.shape[0], 40)))
    assert draws.std() == pytest.approx(1.0, abs=0.02)
    moved = np.hypot(EVENT_STD, FORM_ERROR * test.events["t_v"][0]) / EVENT_STD
    assert test.log_size == pytest.approx(0.5 * np.linalg.slogdet(covariance)[1] + np.log(moved))


def test_the_covariance_of_a_log_is_positive() -> None:
    test = logged.reduced()
    assert test.common is not None
    assert np.linalg.eigvalsh(covariance_of(test)).min() > 0.0
    assert np.isfinite(test.log_size)


def test_the_noise_of_a_log_is_white_after_whitening() -> None:
    """Offsets and gains are within the covariance but not in the log, so that a little less than 1 is left."""
    squares = []
    for seed in range(4):
        noisy, still = (logged.reduced(logged.log(s)) for s in (seed, None))
        noise = np.concatenate([a.value - b.value for a, b in zip(noisy.channels, still.channels, strict=True)])
        squares.append(float(np.mean(noisy.whiten(noise) ** 2)))
    assert 0.6 < np.mean(squares) < 1.1, squares


def test_blocks_of_white_noise_are_as_uncertain_as_their_samples_say() -> None:
    test = logged.reduced()
    samples = BLOCK * logged.RATE
    for name in ("p_tank", "p_run"):
        c = channel(test, name)
        one = (c.count == 1) & ~c.resting
        expected = logged.WHITE[name] / np.sqrt(samples)
        assert np.median(c.noise_std[one]) == pytest.approx(expected, rel=0.5), name
        assert np.median(c.noise_std[c.count == MERGED]) < 0.8 * np.median(c.noise_std[one]), name


def test_an_indefinite_covariance_is_still_whitened() -> None:
    test = made.observed(common=True)
    assert test.common is not None
    odd = replace(test, common=3.0 * test.common)
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(covariance_of(odd))
    whitened = odd.whiten(np.ones((sum(c.time.size for c in odd.channels), 1)))
    assert np.isfinite(whitened).all()
    assert np.isfinite(odd.log_size)


def test_a_sensor_that_was_zeroed_errs_by_its_gain() -> None:
    """Of an error that stays, the rest before the opening leaves next to nothing."""
    plain, after = (channel(logged.reduced(of), "p_run") for of in (logged.log(), zeroed(logged.log())))
    rest, loaded = np.flatnonzero(after.resting), np.flatnonzero(~after.resting)
    inside, across = after.covariance[np.ix_(rest, rest)], after.covariance[np.ix_(rest, loaded)]
    left = after.covariance[np.ix_(loaded, loaded)] - across.T @ np.linalg.solve(inside, across)
    zero = (SPAN_SHARE * plain.accuracy) ** 2
    assert plain.covariance - left == pytest.approx(np.full_like(left, zero), rel=0.02)
    gain = after.value[loaded] / after.value.max()
    assert (left > zero * np.outer(gain, gain)).mean() > 0.99


def test_a_drift_that_ingest_took_off_is_seen_again() -> None:
    plain = logged.log()["thrust"]
    raw = plain.values + 40.0
    taken = replace(plain, values=plain.values - 7.0, zero=40.0, drift=20.0, raw=raw)
    assert as_read(taken).values == pytest.approx(plain.values)
    assert as_read(plain) is plain


def test_without_blocks_the_rest_is_as_it_was() -> None:
    test = made.observed(common=True)
    out = {c.name: (c.time > 2.0) & (c.time < 3.0) & (c.name != "p_run") for c in test.channels}
    less = test.without(out)
    for a, b in zip(test.channels, less.channels, strict=True):
        kept = np.flatnonzero(~out[a.name])
        assert b.time.tolist() == a.time[kept].tolist()
        assert b.value.tolist() == a.value[kept].tolist()
        assert (b.covariance == a.covariance[np.ix_(kept, kept)]).all()
    inside = np.concatenate([~out[c.name] for c in test.channels])
    assert covariance_of(less) == pytest.approx(_form_free(test, less, inside), rel=1e-9)
    assert channel(less, "p_run").time.size == channel(test, "p_run").time.size


def _form_free(test: Observed, less: Observed, inside: np.ndarray) -> np.ndarray:
    """The covariance of the kept blocks; the model-form error goes with the range of what is left."""
    return (
        covariance_of(test.with_errors(0.0, 0.0))[np.ix_(inside, inside)]
        + covariance_of(less)
        - covariance_of(less.with_errors(0.0, 0.0))
    )


def test_only_some_channels() -> None:
    test = made.observed(common=True)
    both, one = test.only(("p_chamber", "thrust")), test.only(("p_tank", "thrust"))
    assert both.names == ("p_chamber", "thrust")
    assert both.common is not None
    assert one.names == ("p_tank", "thrust")
    assert one.common is None
    assert one.whiten(np.ones((one.channels[0].time.size + one.channels[1].time.size, 1))).shape[1] == 1


def test_as_if_noise_were_white() -> None:
    test = logged.reduced().with_white_noise()
    assert test.common is None
    for c in test.channels:
        burning = np.where(c.resting, 0.0, 1.0)
        gain = c.value * burning / np.abs(c.value).max()
        shared = (SPAN_SHARE * c.accuracy) ** 2 * (np.outer(burning, burning) + np.outer(gain, gain))
        assert c.covariance - shared == pytest.approx(np.diag(c.noise_std**2), abs=1e-6 * c.accuracy**2)


def test_a_larger_model_form_error_is_a_smaller_residual() -> None:
    test = made.observed()
    step = np.concatenate([np.where(c.time > 3.0, 1e-3 * np.ptp(c.value), 0.0) for c in test.channels])
    sizes = [
        float(np.sum(test.with_errors(form, form).whiten(step) ** 2)) for form in (0.0, FORM_ERROR, 30.0 * FORM_ERROR)
    ]
    assert sizes[0] > sizes[1] > 5.0 * sizes[2]
    assert test.with_errors(0.1, 0.1).log_size > test.log_size


@pytest.mark.parametrize("excess", [1.0, 60.0], ids=["as estimated", "not positive"])
def test_rows_are_whitened_anew_for_another_form(excess: float) -> None:
    """Also where the common oscillation was estimated so large that no covariance could be like that."""
    test, rng = logged.reduced(), np.random.default_rng(3)
    assert test.common is not None
    own = [np.sqrt(channel(test, name).covariance.diagonal()) for name in TOGETHER]
    test = replace(test, common=test.common if excess == 1.0 else excess * np.outer(*own))
    coarse = test.with_errors(0.01, 0.002)
    blocks = sum(c.time.size for c in test.channels)
    raw, scalars = rng.standard_normal((blocks, 2)), rng.standard_normal((3, 2))
    assert list(test.events) == ["t_v", "t_fuel_out"]
    at, deviation = test.events["t_v"]
    fewer = np.hypot(deviation, FORM_ERROR * at) / np.hypot(deviation, 0.01 * at)
    fine = np.concatenate([test.whiten(raw), scalars])
    expected = np.concatenate([coarse.whiten(raw), scalars * [[fewer], [1.0], [1.0]]])
    assert coarse.rewhitened(fine, test) == pytest.approx(expected, rel=1e-6, abs=1e-9)
    assert test.rewhitened(fine, test) == pytest.approx(fine, rel=1e-6, abs=1e-9)


def test_what_is_made_for_an_error_of_one_side_serves_all_forms_with_it() -> None:
    test = logged.reduced()
    one, other = test.with_errors(0.01, 0.002), test.with_errors(0.01, 0.005)
    rows = np.random.default_rng(4).standard_normal(sum(c.time.size for c in test.channels))
    alone = replace(other)  # which shares nothing
    assert one.whiten(rows) != pytest.approx(other.whiten(rows))
    assert other.whiten(rows).tolist() == alone.whiten(rows).tolist()
    assert other.slow_noise.shares.tolist() == alone.slow_noise.shares.tolist()
    same = [a is b for (_, a), (_, b) in zip(one._factors, other._factors, strict=True)]
    assert same == [c.name not in TOGETHER for c in test.channels if c.name != TOGETHER[1]]


def test_what_cannot_be_compared_is_left_out() -> None:
    log = logged.log()
    dead = replace(log["p_run"], values=np.full_like(log["p_run"].values, 1e5))
    assert "p_run" not in logged.reduced(TestLog({**log.channels, "p_run": dead})).names
    light = replace(log["m_tank"], values=log["m_tank"].values - 1.0)
    assert "m_tank" not in logged.reduced(TestLog({**log.channels, "m_tank": light})).names
    assert "m_tank" in logged.reduced().names


def test_a_test_without_tank_chamber_and_thrust_cannot_be_compared() -> None:
    with pytest.raises(AbsentError, match="neither tank, chamber nor thrust"):
        logged.reduced(logged.log(only=("p_run", "m_tank")))
    assert logged.reduced(logged.log(only=("thrust",))).names == ("thrust",)


def test_instants_and_what_was_weighed_are_observations() -> None:
    test = logged.reduced()
    assert test.events["t_v"][0] == changes()[0]
    assert set(test.events) == {"t_v", "t_fuel_out"}
    assert test.stated == {}
    seen = Seen(burn_time=Value(6.2), fuel_mass_after=Value(0.3, 0.001), throat_radius_after=Value(0.0235, 1e-6))
    left = logged.reduced(definition=logged.stated(observed=seen), t_fuel_out=Quantity.absent("fuel is left"))
    assert left.stated["fuel_mass_after"] == (0.3, 5e-3)
    assert left.stated["throat_radius_after"] == (0.0235, 2e-5)
    assert set(logged.reduced(definition=logged.stated(observed=seen)).stated) == {"throat_radius_after"}


def test_a_log_that_is_cut_short_is_compared_as_far_as_it_goes() -> None:
    end = 4.0
    short = TestLog({n: _cut(c, logged.OPENING + end) for n, c in logged.log().channels.items()})
    absent = {name: Quantity.absent("the log ends before") for name in ("t_v", "t_fuel_out")}
    test = logged.reduced(short, **absent)
    assert test.names == logged.reduced().names
    assert test.end == pytest.approx(end, abs=0.01)
    assert test.grid[-1] < end
    assert test.longest < end


def test_the_noise_of_a_wandering_sensor_is_coherent() -> None:
    white, slow = np.eye(40), np.exp(-np.abs(np.subtract.outer(np.arange(40), np.arange(40))) / 5.0)
    assert coherence_of(white) == pytest.approx(1.0)
    assert coherence_of(slow) == pytest.approx(5.0, rel=0.15)


def test_phases_follow_each_other_though_nitrogen_could_enter_before_the_liquid_is_gone() -> None:
    early = logged.segments(t_purge=Quantity(1.5, "s", 0.01))
    t_v = early.time("t_v")
    assert t_v is not None
    assert t_v > 1.5
    found = phases_of(early, 8.0)
    assert list(found) == ["filling", "liquid", "vapor", "nitrogen", "end"]
    assert found["nitrogen"] == found["vapor"] == t_v
