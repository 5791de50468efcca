"""Does the flow fail before the liquid is gone?"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some
from tests.inference import logged

from hfanalysis.inference.observations.frame import AROUND_CHANGE, BLOCK
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.observations.recorded import TOGETHER
from hfanalysis.inference.observations.reduction import observe_test
from hfanalysis.inference.unknowns.failing_flow import UNEVEN, FailingFlow
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.signals import Signal

SEGMENTS = logged.segments(t_fuel_out=Quantity.absent("not seen"))
T_V = SEGMENTS.time("t_v") or 0.0
STEP = 1e-3


def read(share: float, seconds: float, step: float = STEP, noise: float = 0.01) -> dict[str, Signal]:
    """Channels that lose a share of themselves within so many seconds before the end of the liquid, and fall there."""
    rng, time = np.random.default_rng(2), np.arange(-2.0, T_V + 1.0, step)
    failed = np.where(time < T_V, share * np.clip(1.0 + (time - T_V) / seconds, 0.0, 1.0), 0.5)
    out = {"p_tank": Signal("p_tank", time, 5e6 - 4e5 * time, 1e3, step)}
    for name, level, rest in (("p_chamber", 2e6, 1e5), ("thrust", 3e3, 0.0)):
        burning = rest + level * (1.0 - 0.03 * time) * (1.0 - failed)
        value = np.where(time < 0.0, rest, burning) + noise * level * rng.standard_normal(time.size)
        out[name] = Signal(name, time, value, noise * level, step)
    return out


def failing_flow(signals: dict[str, Signal], segments: Segments) -> FailingFlow | None:
    return logged.seen(FailingFlow, signals, phases=segments)


@settings(max_examples=15)
@given(some.floats(0.15, 0.7), some.floats(0.04, 0.18))
def test_a_failing_flow_is_timed_and_sized(share: float, seconds: float) -> None:
    found = failing_flow(read(share, seconds), SEGMENTS)
    assert found is not None
    assert found.t_v == T_V
    assert found.seconds == pytest.approx(seconds, rel=0.35)
    assert found.share == pytest.approx(share, rel=0.3)


@settings(max_examples=15)
@given(some.floats(0.0, 0.02))
def test_a_flow_that_goes_on_to_its_end_is_none(noise: float) -> None:
    assert failing_flow(read(0.0, 0.1, noise=max(noise, 1e-6)), SEGMENTS) is None


def test_the_log_evidence_grows_with_what_fails_up_to_what_a_knee_may_be_rounded_by() -> None:
    half, whole = (failing_flow(read(share, 0.08, noise=1e-4), SEGMENTS) for share in (0.2, 0.4))
    assert half is not None
    assert whole is not None
    assert whole.log_evidence > 3.0 * half.log_evidence
    assert whole.log_evidence < 0.5 * (0.4 / UNEVEN) ** 2 * 10


def test_a_bend_of_half_a_second_is_for_the_blocks() -> None:
    assert failing_flow(read(0.2, 0.5), SEGMENTS) is None


def test_what_does_not_tell() -> None:
    both = read(0.4, 0.08)
    assert failing_flow({n: s for n, s in both.items() if n != "thrust"}, SEGMENTS) is None
    assert failing_flow({n: s for n, s in both.items() if n != "p_tank"}, SEGMENTS) is None
    assert failing_flow(read(0.4, 0.08, step=0.02), SEGMENTS) is None
    assert failing_flow(both, logged.segments(t_v=Quantity(T_V, "s", 0.01))) is None
    early = logged.segments(t_fuel_out=Quantity(T_V - 1.0, "s", 0.01))
    assert failing_flow(both, early) is None


@pytest.mark.parametrize(("shown", "is_one"), [(T_V - 0.1, False), (T_V + 0.1, False), (T_V + 0.5, True)])
def test_where_no_flame_is_shown_the_fuel_may_have_ended(shown: float, is_one: bool) -> None:
    found = logged.seen(FailingFlow, read(0.4, 0.08), phases=SEGMENTS, shown=shown)
    assert (found is not None) is is_one


def reduced(share: float) -> Observed:
    """The stand's log with a flow that fails in the last 80 ms of the liquid."""
    time, clean = logged.clean()
    near = np.where(time < T_V, share * np.clip(1.0 + (time - T_V) / 0.08, 0.0, 1.0), 0.0)
    plus = {n: -near * (clean[n] - clean[n][0]) for n in TOGETHER}
    return observe_test(logged.log(plus=plus), SEGMENTS, logged.stated())


def test_no_blocks_are_compared_while_the_flow_fails() -> None:
    steady, failing = reduced(0.0), reduced(0.4)
    assert not steady.unknowns
    assert [type(unknown).__name__ for unknown in failing.unknowns] == ["FailingFlow"]
    for before, after in zip(steady.channels, failing.channels, strict=True):
        gone = np.setdiff1d(before.time, after.time)
        assert gone.size > 0
        assert ((gone > T_V - 0.4) & (gone < T_V)).all()
        blind = T_V - 0.5 * 0.08 - AROUND_CHANGE + BLOCK, T_V
        assert not ((after.time > blind[0]) & (after.time < blind[1])).any()
