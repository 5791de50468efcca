"""Without an engine to run: what the channels show by themselves, and how sure that is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.inference import logged

from hfanalysis.diagnose.without_engine import channels_alone
from hfanalysis.errors import AbsentError
from hfanalysis.inference.subject import Subject
from hfanalysis.products.health import Finding
from hfanalysis.record.log import TestLog
from hfanalysis.report.names import called

WHY = "tank.volume is not stated"


def subject(drift: float, layer: float = 0.0) -> Subject:
    """A test whose thrust cell ends ``drift`` [N] from where it began, and whose tank at rest is ``layer`` [Pa] up."""
    time, _ = logged.clean()
    grown = drift * np.clip(time / 3.0, 0.0, 1.0)
    made = logged.log(plus={"thrust": grown, "p_tank": layer * np.exp(-np.maximum(time, 0.0) / 0.3)})
    zeroed = TestLog({**made.channels, "p_chamber": replace(made["p_chamber"], zero_std=1e3)})
    shifted = Finding(
        kind="zero",
        channels=("thrust",),
        verdict="suspect",
        evidence="reads 300 N after the firing",
        means="",
        cure=None,
    )
    return Subject(zeroed, logged.segments(), None, logged.stated(), (), (shifted,) if drift else ())


def test_a_cell_that_does_not_come_back_is_the_sensors_health_and_no_name() -> None:
    with pytest.raises(AbsentError, match=r"nothing that a model would lack; thrust \(zero\): reads 300 N"):
        channels_alone(subject(300.0), WHY)


def test_sensors_that_show_nothing_wrong_are_no_answer() -> None:
    with pytest.raises(AbsentError, match="by themselves, show nothing that a model would lack"):
        channels_alone(subject(0.0), WHY)


def test_what_the_tank_shows_is_named_and_the_cell_that_does_not_come_back_is_told_beside_it() -> None:
    found = channels_alone(subject(300.0, 8e5), WHY)
    assert (found.verdict, found.effects, found.partners) == ("ambiguous", (), {})
    assert found.set90 == ("tank_stratification", "tank_nonequilibrium")
    assert [row.equation for row in found.localisation] == ["sensor", "tank_energy"]
    assert found.localisation[0].source.value == pytest.approx(300.0, rel=0.1)
    assert "reads 300 N" in found.sentences[0]
    assert WHY in found.sentences[-1]
    assert {line.partition(":")[0] for line in found.decisive_measurements} == {called(n) for n in found.set90}


def test_of_two_names_for_all_that_is_seen_both_are_in_the_set_and_nothing_is_added() -> None:
    found = channels_alone(subject(0.0, 8e5), WHY)
    assert (found.verdict, found.effects, found.partners) == ("ambiguous", (), {})
    assert found.set90 == ("tank_stratification", "tank_nonequilibrium")
    assert sum(found.posterior.values()) == pytest.approx(1.0)
