"""What thrust, chamber pressure and tank cell may say before they are doubted, by equilibrium and by weighing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.segment.stand import Trial, channel, fire, log_of, segments_of

from hfanalysis.engine.thrust_coefficient import GAMMAS
from hfanalysis.thermo.combustion import Gas, equilibrium
from hfanalysis.validate.full import _cell_reads


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


@pytest.fixture(scope="module")
def gases() -> list[Gas]:
    """Nitrous oxide and paraffin from fuel-rich to lean at the pressures of small stands."""
    return [equilibrium(p, ratio) for p in (6e5, 30e5) for ratio in (3.0, 5.0, 7.0, 9.0)]


def test_heat_capacity_ratios_hold_those_of_the_burnt_gas(gases: list[Gas]) -> None:
    """Shifting ratios lie below the frozen ones, by a tenth at most."""
    frozen = [gas.gamma for gas in gases]
    assert GAMMAS[0] < min(frozen) < max(frozen) < GAMMAS[1]
    assert GAMMAS[0] > 0.9 * min(frozen)
    assert GAMMAS[1] < 1.1 * max(frozen)


@pytest.mark.parametrize(("off", "reads"), [(0.03, True), (-0.03, True), (0.08, False), (-0.08, False)])
def test_a_tank_cell_is_compared_where_it_reads_what_is_loaded_to_a_twentieth(
    burn: Trial, off: float, reads: bool
) -> None:
    loaded = burn.stand.mass
    read = np.full(burn.time.size, (1.0 + off) * loaded)
    log = log_of(burn)
    weighed = replace(log, channels={**log.channels, "m_tank": channel("m_tank", burn.time + 100.0, read)})
    assert _cell_reads(weighed, segments_of(burn), loaded) is reads
