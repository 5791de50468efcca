"""t_end is a level of the chamber's pressure: what only it ends may burn on, and the intervals say so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.segment.stand import AMBIENT, Trial, definition, fire, log_of, segments_of

from hfanalysis.calibrate.evidence_from_log import burning_of
from hfanalysis.performance.measured import measured
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import ObservedSection
from hfanalysis.units import Value

END, GONE = 6.0, 8.0
"""[s] of t_end, and of the last pressure above ambient."""


@pytest.fixture(scope="module")
def burn() -> Trial:
    return fire(rate=200.0)


def trickling(test: Trial) -> TestLog:
    """From END on the chamber stays at 1.5 times ambient, until GONE; the cell reads 40 N there."""
    log, origin = log_of(test), segments_of(test).t_open.value or 0.0
    channels = dict(log.channels)
    for name, level, rest in (("p_chamber", 1.5 * AMBIENT, AMBIENT), ("thrust", 40.0, 0.0)):
        time = channels[name].time - origin
        values = np.where(time > GONE, rest, np.where(time > END, level, channels[name].values))
        channels[name] = replace(channels[name], values=values)
    return replace(log, channels=channels)


def test_what_only_t_end_ends_may_burn_on_until_the_chamber_is_at_ambient(burn: Trial) -> None:
    segments = segments_of(burn, t_end=Quantity(END, "s", 0.02), t_purge=Quantity.absent("none"))
    found = measured(trickling(burn), segments, definition(burn.stand), None)
    time, impulse = found["burn_time"], found["total_impulse"]
    assert time.value == END
    assert "below 1.8 times ambient" in str(time.why)
    assert "may burn on" in str(time.why)
    assert time.interval is not None
    assert time.interval[1] == pytest.approx(GONE, abs=0.1)
    assert impulse.interval is not None
    assert impulse.value is not None
    assert impulse.interval[1] >= impulse.value + 40.0 * (GONE - END) * 0.9


def test_a_burn_that_somebody_saw_end_does_not(burn: Trial) -> None:
    segments = segments_of(burn, t_end=Quantity(END, "s", 0.02), t_purge=Quantity.absent("none"))
    seen = definition(burn.stand, observed=ObservedSection(burn_time=Value(END, 0.02)))
    found = measured(trickling(burn), segments, seen, None)["burn_time"]
    assert found.interval is not None
    assert found.interval[1] < END + 0.1


def test_the_fit_of_a_and_n_takes_t_end_for_no_burn_time_and_says_so(burn: Trial) -> None:
    segments = segments_of(burn, t_end=Quantity(END, "s", 0.02))
    time, remarks = burning_of(segments, definition(burn.stand))
    assert time is None
    assert any("t_end" in words and "may burn on" in words for words in remarks)
    gone = segments_of(burn, t_end=Quantity(END, "s", 0.02), t_fuel_gone=Quantity(5.5, "s", 0.02))
    time, remarks = burning_of(gone, definition(burn.stand))
    assert time is not None
    assert not remarks
