"""What is there, but too small to matter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.diagnose.answer.test_verdict import eroded

from hfanalysis.diagnose.answer.too_small import MATTERS, OF_NITROGEN, least_of, part_of, too_small, without_the_small
from hfanalysis.diagnose.answer.verdict import places, verdict_of
from hfanalysis.diagnose.answer.words import headline
from hfanalysis.products.diagnosis import Diagnosis, Place


def row(factor: float = 1.0, **changed: object) -> Place:
    """Where the throat erodes, its loss of thrust so many times what it is."""
    (found,) = places(verdict_of(eroded()), eroded())
    assert found.history is not None
    mean = tuple((factor * np.asarray(found.history.mean)).tolist())
    return found.but(history=found.history.but(mean=mean), **changed)


def test_a_loss_of_thrust_is_a_part_of_the_thrust() -> None:
    burnt = eroded().singles[0].fit.burnt
    history = row().history
    assert history is not None
    part = part_of(row(), burnt, eroded().bench.observed)
    assert part == pytest.approx(np.abs(history.mean).max() / burnt.output("thrust").max())
    assert part > 10.0 * MATTERS


@pytest.mark.parametrize(("factor", "label"), [(1.0, "named"), (1e-3, "none")])
def test_what_is_too_small_to_matter_is_no_claim_and_is_said_to_be_there(factor: float, label: str) -> None:
    found = eroded()
    verdict, small = without_the_small(verdict_of(found), [row(factor)], found)
    assert verdict.label == label
    assert (verdict.chosen is found.base) == (label == "none")
    assert set(small) == (set() if label == "named" else {"nozzle_throat_erosion"})


def test_of_two_that_are_claimed_only_the_small_one_is_called_so() -> None:
    found = eroded()
    rows = [row(), row(1e-3, site="other")]
    verdict, small = without_the_small(verdict_of(found), rows, found)
    assert verdict.label == "named"
    assert list(small) == ["other"]
    assert small["other"] < MATTERS


def test_of_a_sensor_it_is_a_part_of_what_it_reads() -> None:
    observed = eroded().bench.observed
    largest = max(np.abs(c.value).max() for c in observed.channels if c.name == "thrust")
    part = part_of(row(equation="sensor", channel="thrust"), eroded().base.fit.burnt, observed)
    history = row().history
    assert history is not None
    assert part == pytest.approx(np.abs(history.mean).max() / largest)
    assert part_of(row(equation="sensor", channel="no_such"), eroded().base.fit.burnt, observed) is None


def test_what_is_open_beside_a_name_is_not_asked_for_its_size() -> None:
    burnt, observed = eroded().base.fit.burnt, eroded().bench.observed
    assert too_small([row(1e-3, beside=True)], burnt, observed) == {}


def test_little_nitrogen_does_much() -> None:
    flow = row().source
    assert least_of(row(equation="tank_volume", source=replace(flow, unit="kg/s"))) == OF_NITROGEN
    assert least_of(row(equation="injector", source=replace(flow, unit="kg/s"))) == MATTERS


def test_the_headline_says_that_it_is_there() -> None:
    from tests.products.filled import filled

    product = filled(Diagnosis, {}).but(
        verdict="none", effects=(), posterior={"none": 0.02, "tank_heat": 0.97}, set90=("tank_heat",),
        too_small={"tank_heat": 4e-4},
    )  # fmt: skip
    said = "Tank heat (0.97) is there, but too small to matter: 0.04 % of what goes through its equation."
    assert headline(product) == said
