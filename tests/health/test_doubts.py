"""Doubts beside the numbers: which get one, and how it reads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_args

import pytest
from tests.health.test_judge import finding
from tests.products.filled import filled

from hfanalysis.health.doubts import Doubt, doubted, with_doubts
from hfanalysis.health.rests_on import TABLES
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.health import ChannelHealth, Health
from hfanalysis.products.kinds import KINDS
from hfanalysis.products.model import AdoptedEffect, Part
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import Quantity


def health_of(name: str, verdict: Any, firing: tuple[float, float] | None = (0.0, 8.0), **about: Any) -> Health:
    trust = about.pop("trust", None)
    found = finding(verdict, name, overruled=bool(trust), **about)
    channel = ChannelHealth(verdict="healthy" if trust else verdict, trust=trust, findings=(found,))
    return Health(channels={name: channel}, between=(), firing=firing, warnings=())


IMPULSE = {"performance": {"measured": {
    "total_impulse": Quantity(16e3, "N s", 150.0, why="over the burn"),
    "peak_chamber_pressure": Quantity(12e5, "Pa", 1e4),
}}}  # fmt: skip


def test_a_number_that_rests_on_a_suspect_channel_is_doubted_with_the_reason_in_its_line() -> None:
    product = doubted(filled(Validation, IMPULSE), health_of("thrust", "suspect"))
    assert isinstance(product, Validation)
    measured = product.performance.measured
    assert measured.total_impulse.verdict == "doubted"
    assert measured.total_impulse.why == "thrust (zero): it reads 76 N; over the burn"
    assert measured.total_impulse.value == 16e3
    assert measured.peak_chamber_pressure.verdict is None


def test_without_findings_a_product_is_the_same() -> None:
    product = filled(Validation, IMPULSE)
    assert doubted(product, Health(channels={}, between=(), warnings=())) is product


def test_constants_fitted_together_rest_on_the_thrust_as_well() -> None:
    law = {"a": Quantity(1e-4, verdict="identified")}
    for fitted, verdict in (({}, "identified"), ({"oxidizer_mass_fitted": Quantity(8.3, "kg")}, "doubted")):
        found = doubted(filled(Calibration, law | fitted), health_of("thrust", "suspect"))
        assert isinstance(found, Calibration)
        assert found.a.verdict == verdict


def test_worse_verdicts_stay_and_get_the_reason() -> None:
    why = [Doubt(finding("suspect", "p_tank", evidence="it reads low"), ("p_tank",))]
    bad = with_doubts(Quantity(-3.0, verdict="unphysical", why="outside"), why)
    assert (bad.verdict, bad.why) == ("unphysical", "outside; p_tank (zero): it reads low")
    none = with_doubts(Quantity.absent("too short", verdict="not identifiable"), why)
    assert (none.verdict, none.reason) == ("not identifiable", "too short; p_tank (zero): it reads low")


def test_what_is_not_there_says_which_channel_is_left_out() -> None:
    none = {"t_end": Quantity.absent("the log has no p_chamber"), "t_feed": Quantity.absent("the log has no p_run")}
    found = doubted(filled(Segments, none), health_of("p_chamber", "unusable", kind="dead"))
    assert isinstance(found, Segments)
    assert found.t_end.reason == "the log has no p_chamber; p_chamber (dead, left out): it reads 76 N"
    assert found.t_feed.reason == "the log has no p_run"


def test_a_coefficient_by_law_rests_on_what_the_whole_does() -> None:
    found = doubted(filled(Calibration, {"C_d": {"spi": Quantity(0.6)}}), health_of("p_run", "suspect"))
    assert isinstance(found, Calibration)
    assert found.C_d["spi"].verdict == "doubted"


def test_trust_is_told_beside_the_number_and_leaves_the_verdict() -> None:
    calibration = filled(Calibration, {"C_i": Quantity(0.29, verdict="identified")})
    found = doubted(calibration, health_of("p_run", "suspect", trust="calibrated last week"))
    assert isinstance(found, Calibration)
    assert found.C_i.verdict == "identified"
    assert found.C_i.why is not None
    assert "p_run trusted (calibrated last week) against (zero): it reads 76 N" in found.C_i.why


@pytest.mark.parametrize(("span", "is_doubted"), [((3.0, 4.0), True), ((-5.0, -3.0), False), ((9.0, None), False)])
def test_a_stretch_that_is_left_out_is_a_doubt_only_in_the_firing(span: Any, is_doubted: bool) -> None:
    health = health_of("thrust", "unusable", start=span[0], end=span[1])
    product = doubted(filled(Validation, IMPULSE), health)
    assert isinstance(product, Validation)
    assert (product.performance.measured.total_impulse.verdict == "doubted") is is_doubted


def test_a_zero_that_is_off_moves_no_bend_of_a_curve() -> None:
    events = {"t_v": Quantity(5.0, "s", 0.01), "t_end": Quantity(8.0, "s", 0.01)}
    for kind, expected in (("zero", (None, None)), ("lag", ("doubted", None))):
        found = doubted(filled(Segments, events), health_of("p_tank", "suspect", kind=kind))
        assert isinstance(found, Segments)
        assert (found.t_v.verdict, found.t_end.verdict) == expected
    found = doubted(filled(Segments, events), health_of("p_chamber", "suspect"))
    assert isinstance(found, Segments)
    assert found.t_end.verdict == "doubted"


def test_a_stretch_is_a_doubt_about_the_events_near_it() -> None:
    events = {"t_open": Quantity(100.0, "s"), "t_v": Quantity(5.0, "s", 0.01)}
    for span, expected in (((102.0, 103.0), (None, None)), ((104.5, 106.0), (None, "doubted"))):
        health = health_of("p_run", "unusable", (100.0, 108.0), kind="stuck", start=span[0], end=span[1])
        found = doubted(filled(Segments, events), health)
        assert isinstance(found, Segments)
        assert (found.t_open.verdict, found.t_v.verdict) == expected


def test_what_is_held_as_stated_is_not_doubted() -> None:
    stated = {"C_i": Quantity(0.6, "", 0.001, verdict="stated", why="from a water flow")}
    found = doubted(filled(Calibration, stated), health_of("p_run", "suspect"))
    assert isinstance(found, Calibration)
    assert found.C_i == stated["C_i"]


@pytest.mark.parametrize(("why", "std"), [("from p_run, p_tank", 0.01), ("from p_chamber", 0.5), ("seen", 0.5)])
def test_an_opening_that_says_where_it_is_from_rests_on_nothing_else(why: str, std: float) -> None:
    events = {"t_open": Quantity(100.0, "s", 0.01, why=why)}
    found = doubted(filled(Segments, events), health_of("p_chamber", "suspect", kind="lag", delay=0.5))
    assert isinstance(found, Segments)
    assert found.t_open.std == pytest.approx(std, rel=0.01)
    assert found.t_open.verdict == (None if std < 0.1 else "doubted")


def test_a_late_channel_widens_its_events() -> None:
    events = {"t_open": Quantity(100.0, "s", 0.01), "t_v": Quantity(5.0, "s", 0.01), "t_end": Quantity(8.0, "s", 0.1)}
    found = doubted(filled(Segments, events), health_of("p_run", "suspect", kind="lag", delay=0.5))
    assert isinstance(found, Segments)
    assert [found.t_open.std, found.t_v.std, found.t_end.std] == pytest.approx([0.5, 0.5, 0.1], rel=0.01)
    assert found.t_v.interval == pytest.approx((4.02, 5.98), abs=0.01)


def test_a_clock_at_another_pace_widens_what_goes_with_time() -> None:
    calibration = {"C_i": Quantity(0.6, "", 0.001, (0.598, 0.602)), "m": Quantity(0.7, "", 0.01)}
    found = doubted(filled(Calibration, calibration), health_of("p_run", "suspect", kind="clock", pace=0.6))
    assert isinstance(found, Calibration)
    assert found.C_i.interval is not None
    assert found.C_i.interval[0] < 0.3 < 0.6 < found.C_i.interval[1]
    assert (found.m.std, found.m.verdict) == (0.01, "doubted")


def test_a_clock_off_by_any_factor_leaves_a_flow_positive_and_events_where_the_log_has_them() -> None:
    slow = health_of("p_run", "suspect", kind="clock", pace=810.0)
    found = doubted(filled(Calibration, {"C_i": Quantity(0.6, "", 0.001)}), slow)
    assert isinstance(found, Calibration)
    assert found.C_i.interval is not None
    assert 0.0 < found.C_i.interval[0] < 0.6 / 810.0
    assert found.C_i.interval[1] > 0.6 * 810.0
    events = doubted(filled(Segments, {"t_open": Quantity(1.0, "s", 0.1), "t_v": Quantity(5.0, "s", 0.01)}), slow)
    assert isinstance(events, Segments)
    assert (events.t_v.std, events.t_v.verdict) == (0.01, "doubted")


def test_what_the_engineer_states_rests_on_no_channel() -> None:
    burn = {"performance": {"measured": {"burn_time": Quantity(17.0, "s", 0.1, why="[observed] burn_time")}}}
    product = doubted(filled(Validation, burn), health_of("thrust", "suspect"))
    assert isinstance(product, Validation)
    assert product.performance.measured.burn_time.verdict is None


NO_CHANNEL = {
    "flight.json": {
        "terminal_velocity_drogue", "terminal_velocity_main", "wet_mass", "static_margin_on_pad",
        "normal_force_slope", "center_of_pressure", "center_of_gravity_loaded", "center_of_gravity_empty",
    },
    "validation.json": {
        "size", "value", "until", "published_regression_rate", "characteristic_length", "characteristic_length_end",
    },
    "calibration.json": {"one_by_one"},
}  # fmt: skip
"""Quantities that come from test.toml alone; ``size`` is of a sensor's error, a doubt
itself, and ``value`` of a warning; ``until`` is an event; what is in ``one_by_one`` has names of its own."""


@pytest.mark.parametrize("product", TABLES)
def test_of_every_quantity_it_is_known_what_it_rests_on(product: str) -> None:
    named = set(_quantities(KINDS[product]))
    assert named <= set(TABLES[product]) | NO_CHANNEL.get(product, set())


def _quantities(kind: type[Part]) -> Iterator[str]:
    """Names of the quantities in a model and in the models in it, but for those of adopted effects."""
    for name, field in kind.model_fields.items():
        for part in (field.annotation, *get_args(field.annotation)):
            if part is Quantity:
                yield name
            elif isinstance(part, type) and issubclass(part, Part) and part is not AdoptedEffect:
                yield from _quantities(part)


def test_constants_told_one_by_one_are_doubted_by_their_own_names() -> None:
    calibration = filled(Calibration, {"one_by_one": {"C_i": Quantity(0.29), "oxidizer_mass": Quantity(8.0)}})
    found = doubted(calibration, health_of("p_run", "suspect"))
    assert isinstance(found, Calibration)
    assert [found.one_by_one[name].verdict for name in ("C_i", "oxidizer_mass")] == ["doubted", None]
