"""Without an engine to run: what the channels show by themselves, and how sure that is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.inference import logged

from hfanalysis.diagnose.answer.posterior import scale
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


def test_a_cell_that_does_not_come_back_has_drifted_and_nothing_is_certain() -> None:
    found = channels_alone(subject(300.0), WHY)
    assert (found.verdict, found.set90) == ("named", ("load_cell_drift",))
    (effect,) = found.effects
    assert effect.parameters["drift"].value == pytest.approx(300.0, rel=0.1)
    assert effect.probability == found.posterior["load_cell_drift"] == 1.0 - scale().misled < 1.0
    assert sum(found.posterior.values()) == pytest.approx(1.0)
    assert WHY in found.sentences[-1]


def test_sensors_that_show_nothing_wrong_are_no_answer() -> None:
    with pytest.raises(AbsentError, match="by themselves, show nothing wrong"):
        channels_alone(subject(0.0), WHY)


def test_what_is_beside_a_drift_is_stated_beside_it_and_a_choice_is_called_one() -> None:
    found = channels_alone(subject(300.0, 8e5), WHY)
    half = 0.5 * (1.0 - scale().misled)
    assert (found.verdict, found.set90) == ("ambiguous", ("load_cell_drift",))
    assert found.partners == {"tank_stratification": half, "tank_nonequilibrium": half}
    assert [row.name for row in found.effects] == ["load_cell_drift"]
    assert found.localisation[1].equation == "tank_energy"
    assert {line.partition(":")[0] for line in found.decisive_measurements} == {
        called(name) for name in ("load_cell_drift", *found.partners)
    }


def test_of_two_names_for_all_that_is_seen_both_are_in_the_set_and_nothing_is_added() -> None:
    found = channels_alone(subject(0.0, 8e5), WHY)
    assert (found.verdict, found.effects, found.partners) == ("ambiguous", (), {})
    assert found.set90 == ("tank_stratification", "tank_nonequilibrium")
    assert sum(found.posterior.values()) == pytest.approx(1.0)
