"""A flow of water through the injector: C_i with the density of water, or what is lacking for it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.segment.stand import AMBIENT, HOLE_AREA, HOLES, channel, definition

from hfanalysis.calibrate.tank import calibrate
from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import TankConstants
from hfanalysis.products.segments import EVENTS, Segments
from hfanalysis.quantity import IDENTIFIED, NOT_IDENTIFIABLE, Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import ObservedSection
from hfanalysis.units import Value

TRUE, DROP, LASTS = 0.62, 2.4e5, 18.0
FLOW = TRUE * HOLES * HOLE_AREA * np.sqrt(2.0 * 998.2 * DROP)


def log_of(*without: str, drop: float = DROP) -> TestLog:
    """Twenty seconds at 50 Hz, the valve open for LASTS from 100 s on."""
    rng, time = np.random.default_rng(1), np.arange(95.0, 125.0, 0.02)
    flows = (time > 100.0) & (time < 100.0 + LASTS)
    gone = FLOW * np.clip(time - 100.0, 0.0, LASTS)
    values = {"p_run": AMBIENT + drop * flows + 2e3 * rng.standard_normal(time.size),
              "m_tank": 20.0 - gone + 0.02 * rng.standard_normal(time.size)}  # fmt: skip
    return TestLog({n: channel(n, time, v) for n, v in values.items() if n not in without})


def constants(log: TestLog, **stated: Any) -> TankConstants:
    none = Quantity.absent("water")
    segments = Segments.of(Quantity(100.0, "s", 0.01), dict.fromkeys(EVENTS, none), kind="water_flow")
    return calibrate(log, segments, definition(kind="water_flow", **stated), 20).constants


def test_the_coefficient_is_found_with_the_density_of_water() -> None:
    made = constants(log_of())
    assert made.C_i.verdict == IDENTIFIED
    assert made.C_i.interval is not None
    assert made.C_i.interval[0] < TRUE < made.C_i.interval[1]
    assert (made.C_i.std or 1.0) < 0.05 * TRUE
    assert made.C_d["spi"] == made.C_i
    assert "of water" in (made.C_i.why or "")


def test_nothing_of_nitrous_oxide_is_said() -> None:
    made = constants(log_of())
    for name in ("m", "Z", "K_loss", "vapor_mass_at_t_v", "oxidizer_mass"):
        assert made.quantities[name].value is None
        assert "water flows" in str(made.quantities[name].reason)


def test_without_a_cell_what_was_in_and_what_was_left_tell_the_flow() -> None:
    gone = FLOW * LASTS
    seen = ObservedSection(oxidizer_mass_after=Value(20.0 - gone, 0.01))
    made = constants(log_of("m_tank"), mass=Value(20.0, 0.01), observed=seen)
    assert made.C_i.value == pytest.approx(TRUE, rel=0.02)


def test_without_any_mass_there_is_none_and_the_reason_is_said() -> None:
    made = constants(log_of("m_tank"), mass=None).C_i
    assert made.verdict == NOT_IDENTIFIABLE
    assert "no live m_tank" in str(made.reason)


@pytest.mark.parametrize(("log", "words"), [(log_of("p_run"), "no live p_run"), (log_of(drop=-5e4), "nothing flows")])
def test_a_flow_that_is_not_seen_is_refused(log: TestLog, words: str) -> None:
    with pytest.raises(AbsentError, match=words):
        constants(log)
