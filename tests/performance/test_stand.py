"""An upright stand weighs the fuel; a feed line pushes on the cell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.segment.stand import Trial, definition, fire, log_of, segments_of

from hfanalysis.performance.measured import measured
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import GrainSection, ObservedSection, StandSection
from hfanalysis.units import Value

GRAVITY, FUEL = 9.80665, 5.0
BURN = ObservedSection(burn_time=Value(9.0, 0.1))


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def table(log: TestLog, test: Trial, stand: StandSection | None) -> Quantity:
    stated = definition(test.stand, observed=BURN, grain=GrainSection(mass=Value(FUEL, 0.01)))
    return measured(log, segments_of(test), replace(stated, stand=stand), None)["total_impulse"]


def weighed(test: Trial, sign: float) -> TestLog:
    """The cell loses the fuel's weight as the fuel burns, that is with the impulse."""
    log = log_of(test)
    thrust, origin = log["thrust"], segments_of(test).t_open.value or 0.0
    force = np.where(thrust.time > origin, thrust.values, 0.0)
    share = np.cumsum(force) / np.sum(force)
    read = replace(thrust, values=thrust.values - sign * GRAVITY * FUEL * share)
    return replace(log, channels={**log.channels, "thrust": read})


@pytest.mark.parametrize(("orientation", "sign"), [("nozzle up", 1.0), ("nozzle down", -1.0)])
def test_the_fuels_weight_is_put_back(burn: Trial, orientation: str, sign: float) -> None:
    true = table(log_of(burn), burn, None).value
    off = table(weighed(burn, sign), burn, None).value
    back = table(weighed(burn, sign), burn, StandSection(orientation=orientation)).value  # type: ignore[arg-type]
    assert true is not None
    assert off is not None
    assert abs(off - true) > 0.2 * GRAVITY * FUEL * 9.0
    assert back == pytest.approx(true, abs=0.05 * abs(off - true))


def test_upright_without_a_direction_the_interval_has_both(burn: Trial) -> None:
    plain, either = (table(log_of(burn), burn, s) for s in (None, StandSection(orientation="vertical")))
    assert either.value == plain.value
    assert either.interval is not None
    assert either.interval[1] - either.interval[0] >= GRAVITY * FUEL * 9.0


def test_lying_down_nothing_changes(burn: Trial) -> None:
    assert table(log_of(burn), burn, StandSection()) == table(log_of(burn), burn, None)


def test_the_feed_lines_push_is_taken_off_with_its_pressure(burn: Trial) -> None:
    log = log_of(burn)
    line = np.interp(log["thrust"].time, log["p_run"].time, log["p_run"].values)
    above = np.clip((line - line[0]) / (line.max() - line[0]), 0.0, 1.0)
    pushed = replace(log["thrust"], values=log["thrust"].values + 60.0 * above)
    off = replace(log, channels={**log.channels, "thrust": pushed})
    true, read = table(log, burn, None).value, table(off, burn, None).value
    told = table(off, burn, StandSection(feed_line_tare=Value(60.0))).value
    assert true is not None
    assert read is not None
    assert read - true > 100.0
    assert told == pytest.approx(true, abs=0.03 * (read - true))
