"""What an engineer would warn of in a test: a soft injector and a nozzle that its flow leaves, by what was measured."""

from __future__ import annotations

import numpy as np
import pytest
from simulated.narrow_port import fired, judged
from tests.segment.stand import Stand, fire, log_of, segments_of

from hfanalysis.engine.cautions import LEAST_STIFFNESS
from hfanalysis.performance.warned import of_injector, of_nozzle


def drops(chamber: float) -> list[float]:
    """Pressure drops over chamber pressure that are warned of, in a test whose chamber is at ``chamber`` [Pa]."""
    test = fire(Stand(chamber=chamber), rate=200.0)
    time = np.arange(0.5, test.t_v - 0.1, 0.02)
    inside, everywhere = np.full(time.size, chamber), np.ones(time.size, dtype=bool)
    found = of_injector(log_of(test, without=("m_tank",)), segments_of(test), time, inside, everywhere)
    return [beyond.value.value or 0.0 for beyond in found if beyond.name == "injector_stiffness"]


def test_a_soft_injector_is_warned_of_and_a_stiff_one_is_not() -> None:
    assert drops(14e5) == []
    (soft,) = drops(36e5)
    assert 0.0 < soft < LEAST_STIFFNESS


def test_without_the_run_line_nothing_is_said() -> None:
    test = fire(Stand(chamber=36e5), rate=200.0)
    time = np.arange(0.5, 2.0, 0.02)
    everywhere = np.ones(time.size, dtype=bool)
    log = log_of(test, without=("p_run",))
    assert list(of_injector(log, segments_of(test), time, np.full(time.size, 36e5), everywhere)) == []


@pytest.mark.parametrize(("ambient", "names"), [(0.9e5, []), (3e5, ["nozzle_separation"])])
def test_a_flow_that_leaves_its_nozzle_is_warned_of(ambient: float, names: list[str]) -> None:
    test = fired(0.5)
    _, found = judged(test, None, "nozzle")
    assert [b.name for b in of_nozzle(test.engine, test.flows, found, ambient, found.counted)] == names
