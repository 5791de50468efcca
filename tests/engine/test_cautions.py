"""Each rule of an engineer's warnings: a number that draws it, one that does not, and what it says."""

from __future__ import annotations

import pytest

from hfanalysis.engine import cautions
from hfanalysis.engine.cautions import Cautions
from hfanalysis.thermo.nitrous import saturation

DRAWN: dict[str, tuple[Cautions, Cautions]] = {
    "injector_stiffness": (cautions.stiffness(0.19), cautions.stiffness(0.2)),
    "chamber_above_tank": (cautions.beyond_tank(70e5, 56.9e5), cautions.beyond_tank(27.6e5, 56.9e5)),
    "rail_speed": (cautions.rail_speed(20.5), cautions.rail_speed(34.0)),
    "thrust_to_weight": (cautions.thrust_to_weight(3.31), cautions.thrust_to_weight(11.2)),
    "nozzle_separation": (
        cautions.separation(6.3e5, 101325.0, 1.25, 2.674),
        cautions.separation(6.5e5, 101325.0, 1.25, 2.674),
    ),
    "tank_below_triple_point": (cautions.frozen_tank(166.0), cautions.frozen_tank(182.4)),
    "of_ratio": (cautions.mixture(3.0, 6.3, 0.14, "impulse"), cautions.mixture(5.0, 6.3, 0.02, "impulse")),
    "oxidizer_left": (cautions.left_over(3.4, 1.6), cautions.left_over(0.7, 0.7)),
    "reversed_flow": (cautions.reversed_flow(-2e5), cautions.reversed_flow(1e5)),
    "oxidizer_flux": (cautions.oxidizer_flux(1082.0), cautions.oxidizer_flux(350.0)),
}
"""By the rule's name: what draws it, and what does not. HF5 of the report left its rail at 20.5 m/s with 3.31 times
its weight; its design with 34.0 m/s and 11.2. Schmucker's pressure is passed at 6.4 bar (separation.onset)."""


@pytest.mark.parametrize("name", DRAWN)
def test_what_lies_beyond_its_limit_is_drawn_and_nothing_else(name: str) -> None:
    drawn, quiet = DRAWN[name]
    assert [caution.name for caution in drawn] == [name]
    assert quiet == ()


@pytest.mark.parametrize("name", DRAWN)
def test_a_sentence_has_value_limit_and_source(name: str) -> None:
    (caution,) = DRAWN[name][0]
    assert caution.source in caution.text
    assert caution.value.value != caution.limit
    assert sum(character.isdigit() for character in caution.text) >= 2
    assert caution.to_json().keys() == {"name", "value", "limit", "source", "text"}


def test_no_number_is_no_warning() -> None:
    nothing = float("nan")
    assert (cautions.stiffness(nothing), cautions.rail_speed(nothing), cautions.frozen_tank(nothing)) == ((), (), ())


def test_the_triple_point_is_where_the_properties_begin() -> None:
    assert pytest.approx(saturation("coolprop").t_min, abs=0.02) == cautions.TRIPLE_POINT


def test_a_mixture_has_too_much_of_one_side() -> None:
    (rich,), (lean,) = cautions.mixture(3.0, 6.3, 0.14, "impulse"), cautions.mixture(14.0, 6.3, 0.08, "impulse")
    assert rich.text.endswith("too much fuel")
    assert lean.text.endswith("too much oxidizer")
