"""What is there, but too small to matter."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

import numpy as np
import pytest
from tests.diagnose.answer.test_verdict import eroded

from hfanalysis.diagnose.answer import standing
from hfanalysis.diagnose.answer import too_small as smallness
from hfanalysis.diagnose.answer.source_places import places
from hfanalysis.diagnose.answer.too_small import (
    MATTERS,
    least_of,
    too_small,
    with_parts,
    without_small_sources,
    without_the_small,
)
from hfanalysis.diagnose.answer.verdict import effects_product, verdict_of
from hfanalysis.diagnose.answer.words import headline, place_sentence
from hfanalysis.engine.unsteady import Burn
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.places import SourcePlace
from hfanalysis.inference.unknown import History, Unknown
from hfanalysis.products.diagnosis import Diagnosis, Place


def row(factor: float = 1.0, **changed: object) -> Place:
    """Where the throat erodes, its loss of thrust so many times what it is."""
    (found,) = places(verdict_of(eroded()), eroded())
    assert found.history is not None
    mean = tuple((factor * np.asarray(found.history.mean)).tolist())
    (sized,) = with_parts([found.but(history=found.history.but(mean=mean), **changed)], burnt(), without(), observed())
    return sized


def burnt() -> Burn:
    return eroded().singles[0].fit.burnt


def without() -> Burn:
    return eroded().base.fit.burnt


def observed() -> Observed:
    return eroded().bench.observed


def test_a_loss_of_thrust_is_a_part_of_the_thrust() -> None:
    history, part = row().history, row().part
    assert history is not None
    assert part is not None
    assert part == pytest.approx(np.abs(history.mean).max() / burnt().output("thrust").max())
    assert part > 2.0 * MATTERS


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
    largest = max(np.abs(c.value).max() for c in observed().channels if c.name == "thrust")
    read = row(equation="sensor", channel="thrust")
    assert read.history is not None
    assert read.part == pytest.approx(np.abs(read.history.mean).max() / largest)
    assert "% of the largest reading." in str(place_sentence(read))
    assert "% of the thrust." in str(place_sentence(row()))
    of_fuel = row(equation="grain").but(part=0.021)
    assert "In all it is 2.1 % of the fuel, burnt at another time." in str(place_sentence(of_fuel))
    assert row(equation="sensor", channel="no_such").part is None


def test_what_is_open_beside_a_name_is_not_asked_for_its_size() -> None:
    assert too_small([row(1e-3, beside=True)]) == {}


def test_little_nitrogen_does_much() -> None:
    """A kilogram of it takes the volume of thirteen of liquid, one of vapor that leaks that of five."""
    flow = replace(row().source, unit="kg/s")
    of_injector = least_of(row(equation="injector", source=flow))
    into = least_of(row(equation="tank_volume", site="n2_purge", source=flow))
    assert of_injector / into == pytest.approx(13.0)
    assert into < least_of(row(equation="tank_volume", site="tank_leak", source=flow)) < of_injector


@pytest.mark.parametrize(
    ("equation", "unit", "least"),
    [("injector", "kg/s", 0.03), ("injector", "1", 0.03), ("tank_energy", "W", 0.03), ("tank_energy", "Pa", MATTERS),
     ("tank_volume", "Pa", MATTERS), ("feed", "Pa", 0.2), ("sensor", "Pa", MATTERS),
     ("chamber_mass", "kg/s", MATTERS)],
)  # fmt: skip
def test_what_laws_of_an_equation_differ_by_is_too_small(equation: str, unit: str, least: float) -> None:
    assert least_of(row(equation=equation, source=replace(row().source, unit=unit))) == least


def test_the_headline_says_that_it_is_there() -> None:
    from tests.products.filled import filled

    product = filled(Diagnosis, {}).but(
        verdict="none", effects=(), posterior={"none": 0.02, "tank_heat": 0.97}, set90=("tank_heat",),
        too_small={"tank_heat": 4e-4},
    )  # fmt: skip
    said = "Tank heat (0.97) is there, but too small to matter: 0.04 % of what it is part of."
    assert headline(product) == said


def test_where_the_first_name_is_too_small_the_one_beside_it_is_what_is_claimed() -> None:
    found = eroded()
    one = found.singles[0]
    both = replace(one, names=("other", *one.names), log_evidence=one.log_evidence + 20.0)
    verdict = replace(verdict_of(found), chosen=both, partners={one.names[0]: 0.93})
    left, small = without_the_small(verdict, [row(), row(1e-3, site="other")], found)
    assert list(small) == ["other"]
    (claimed,) = effects_product(left, observed())
    assert (claimed.name, claimed.probability) == (one.names[0], 0.93)


def test_a_name_beside_the_first_that_is_too_small_is_no_claim() -> None:
    found = eroded()
    one = found.singles[0]
    both = replace(one, names=(*one.names, "other"), log_evidence=one.log_evidence + 20.0)
    verdict = replace(verdict_of(found), chosen=both, partners={"other": 0.99})
    left, small = without_the_small(verdict, [row(), row(1e-3, site="other")], found)
    assert left.chosen is one
    assert left.partners == {}
    assert list(small) == ["other"]


def test_where_what_is_left_without_the_small_is_not_the_whole_story_it_is_unknown_beside_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = eroded()
    one = found.singles[0]
    both = replace(one, names=(*one.names, "other"), log_evidence=one.log_evidence + 20.0)
    verdict = replace(verdict_of(found), chosen=both, partners={"other": 0.99})
    for module in (smallness, standing):
        monkeypatch.setattr(module, "against", lambda *_: ("thrust is missed",))
    left, _ = without_the_small(verdict, [row(), row(1e-3, site="other")], found)
    assert left.label == "unknown"
    assert left.chosen is one
    assert left.doubts == ("thrust is missed",)
    assert left.posterior["unknown"] > left.posterior["nozzle_throat_erosion"]
    assert sum(left.posterior.values()) == pytest.approx(1.0)


@pytest.mark.parametrize("about", [0.0, 0.9, -0.9])
def test_fuel_that_burns_later_within_a_second_of_its_end_is_no_part(about: float) -> None:
    """How a fire fades nobody knows; what burns at another time beyond that is measured by its mass."""
    base = replace(without(), fuel_out=True)
    history, flow = row().history, burnt().output("fuel_flow")
    assert history is not None
    time = base.burn_time + about + np.linspace(-0.05, 0.05, 21)
    brief = history.but(time=tuple(time.tolist()), mean=(float(flow.max()),) * 21)
    (sized,) = with_parts([row().but(equation="grain", history=brief)], burnt(), base, observed())
    assert sized.part == 0.0
    earlier = brief.but(time=tuple((time - about - 2.0).tolist()))
    (sized,) = with_parts([row().but(equation="grain", history=earlier)], burnt(), base, observed())
    assert sized.part == pytest.approx(0.1 * flow.max() / np.trapezoid(flow, burnt().time))


def test_a_loss_in_the_line_is_a_part_of_the_line_s() -> None:
    lost = burnt().output("tank_pressure") - burnt().output("run_pressure")
    read = row(equation="feed", source=replace(row().source, unit="Pa"))
    assert read.history is not None
    assert read.part is not None
    largest = np.abs(read.history.mean).max()
    wet = burnt().time < (burnt().liquid_out or np.inf)
    assert largest / lost.max() < read.part < largest / lost[wet].min()
    crowded = replace(burnt(), time=np.sort(np.r_[burnt().time, np.linspace(0.0, 1e-3, 5000)]))
    (same,) = with_parts([read], crowded, without(), observed())
    assert same.part == pytest.approx(read.part, rel=0.01)


@dataclass(frozen=True)
class Wavy:
    """A free curve of one size."""

    size: float
    unit: str

    def history(self, fit: Fit, observed: Observed) -> History:
        """As large all along."""
        time = np.linspace(0.0, 3.0, 20)
        place = SourcePlace("somewhere", "injector", self.unit, 0.1)
        return History(place, time, np.full(20, self.size), np.full(20, 0.1 * self.size), 0.1)


@pytest.mark.parametrize(
    ("size", "unit", "kept"), [(0.05, "1", 1), (1e-4, "1", 0), (0.3, "kg/s", 1), (1e-4, "kg/s", 0)]
)
def test_a_free_curve_that_is_too_small_is_nothing_unknown(size: float, unit: str, kept: int) -> None:
    """What two right models differ by is no source; where that is all, there is none."""
    found = eroded()
    curve = replace(found.singles[0], names=("somewhere",), source=cast("Unknown", Wavy(size, unit)))
    assert len(without_small_sources(replace(found, unknown=(curve,))).unknown) == kept
