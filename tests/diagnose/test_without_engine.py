"""Without an engine to run: what the sensors show by themselves, and how sure that is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.diagnose import logged

from hfanalysis.diagnose.answer.posterior import scale
from hfanalysis.diagnose.of_test import Subject
from hfanalysis.diagnose.without_engine import sensors_alone
from hfanalysis.errors import AbsentError
from hfanalysis.testdata.log import TestLog

WHY = "tank.volume is not stated"


def subject(drift: float) -> Subject:
    """A test whose thrust cell ends ``drift`` [N] from where it began."""
    time, _ = logged.clean()
    grown = drift * np.clip(time / 3.0, 0.0, 1.0)
    made = logged.log(plus={"thrust": grown})
    zeroed = TestLog({**made.channels, "p_chamber": replace(made["p_chamber"], zero_std=1e3)})
    return Subject(zeroed, logged.segments(), {}, logged.stated())


def test_a_cell_that_does_not_come_back_has_drifted_and_nothing_is_certain() -> None:
    found = sensors_alone(subject(300.0), WHY)
    assert (found["verdict"], found["set90"]) == ("named", ["load_cell_drift"])
    (effect,) = found["effects"]
    assert effect["parameters"]["drift"].value == pytest.approx(300.0, rel=0.1)
    assert effect["probability"] == found["posterior"]["load_cell_drift"] == 1.0 - scale().misled < 1.0
    assert sum(found["posterior"].values()) == pytest.approx(1.0)
    assert WHY in found["sentences"][-1]


def test_sensors_that_show_nothing_wrong_are_no_answer() -> None:
    with pytest.raises(AbsentError, match="by themselves, show nothing wrong"):
        sensors_alone(subject(0.0), WHY)
