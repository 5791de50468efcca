"""What a test can tell apart, on made-up observations of the stand's engine."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.engine.stand import engine_on_stand
from tests.products.filled import loaded

from hfanalysis.diagnose.added_sensors import FURTHER, USUAL, Sensor, missing_sensors
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.separability import NOMINAL, TWINS, Outlook, look_ahead, projected
from hfanalysis.effects import library
from hfanalysis.engine.unsteady import burn
from hfanalysis.inference.fitting.hypothesis import Hypothesis, base_hypothesis
from hfanalysis.inference.fitting.predict import readings, with_spare_fuel
from hfanalysis.inference.observations.channel import ObservedChannel
from hfanalysis.inference.observations.frame import EVENT_STD
from hfanalysis.inference.observations.observed import Observed

NOISE = {"p_tank": 3e3, "p_run": 3e3, "p_chamber": 3e3, "thrust": 5.0, "m_tank": 0.01}
"""Standard deviation of a block's noise [SI], and of the sensor's offset."""

END, STEP = 7.0, 0.04
FEW = ("p_tank", "p_chamber", "thrust")


@cache
def base() -> Hypothesis:
    return base_hypothesis(engine_on_stand(), loaded(8.35, 0.02))


@cache
def full() -> Observed:
    """All canonical channels, 0.1 to 7 s, with white noise and an offset."""
    engine = base().at(np.zeros(base().size))
    burnt = burn(with_spare_fuel(engine), END + 2.0, run_on=True)
    assert burnt.liquid_out is not None
    grid = np.concatenate([[0.0], np.arange(0.1, END, STEP)])
    resting = grid == 0.0
    events = {"t_v": (burnt.liquid_out, EVENT_STD)}
    empty = Observed((), grid, resting, events, {}, {"liquid": 0.0}, END, END, engine.ambient_pressure)
    read = readings(empty, burnt)
    rows = np.flatnonzero(~resting & (np.abs(grid - burnt.liquid_out) > 0.06))
    return replace(empty, channels=tuple(_channel(n, grid[rows], read[n][rows], rows) for n in NOISE))


def _channel(name: str, time: np.ndarray, value: np.ndarray, rows: np.ndarray) -> ObservedChannel:
    std, none = np.full(time.size, NOISE[name]), np.zeros(time.size, dtype=bool)
    covariance = NOISE[name] ** 2 * (1.0 + np.eye(time.size))
    return ObservedChannel(name, time, value, rows, np.ones_like(rows), none, std, NOISE[name], covariance)


@cache
def outlook(names: tuple[str, ...], *effects: str) -> Outlook:
    """With these channels, for these effects (default: the library)."""
    found = {n: e for n, e in library().items() if not effects or n in effects}
    return look_ahead(base(), full().only(names), Catalogue(found, {}))


def test_information_is_positive_semidefinite() -> None:
    for names in (FEW, tuple(NOISE)):
        matrix = outlook(names).now.matrix
        values = np.linalg.eigvalsh(matrix)
        assert np.allclose(matrix, matrix.T)
        assert values.min() > -1e-9 * values.max()
        assert values.max() > 1.0


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 30), st.integers(0, 6), st.integers(1, 5))
def test_projecting_out_is_what_the_normal_equations_say(seed: int, rows: int, nuisances: int, strengths: int) -> None:
    slopes = np.random.default_rng(seed).standard_normal((rows, nuisances + strengths))
    a, b = slopes[:, :nuisances], slopes[:, nuisances:]
    expected = b.T @ b - b.T @ a @ np.linalg.solve(a.T @ a + np.eye(nuisances), a.T @ b)
    assert np.allclose(projected(slopes, nuisances), expected, atol=1e-9)


@pytest.mark.parametrize("name", ["tank_heat", "combustion_efficiency", "nozzle_throat_erosion"])
def test_d_prime_is_by_how_much_a_run_with_the_effect_departs(name: str) -> None:
    # from runs with and without a little of it, not from tangents: the nuisances' directions alone are taken over
    few, size = outlook(FEW), 0.02
    observed, (effect, nothing) = full().only(FEW), (library()[name], np.zeros(base().size))
    engine = with_spare_fuel(base().at(nothing))
    pushed = replace(engine, effects=(effect.at(**{effect.strength.name: size * effect.strength.typical}),))
    with_it, without = (burn(e, END + 2.0, 1e-7, run_on=True) for e in (pushed, engine))
    one, other = (readings(observed, burnt) for burnt in (with_it, without))
    departure = np.concatenate([c.averaged(one[c.name] - other[c.name]) for c in observed.channels])
    assert with_it.liquid_out is not None
    assert without.liquid_out is not None
    events = (with_it.liquid_out - without.liquid_out) / EVENT_STD
    column = -np.concatenate([observed.whiten(departure), [events]])[:, None] / size
    slopes = np.concatenate([few.slopes[:, : few.nuisances], column], axis=1)
    direct = float(np.sqrt(projected(slopes, few.nuisances)[0, 0]))
    assert direct == pytest.approx(few.now.detectability(name), rel=0.05)


def test_d_prime_goes_with_the_strength() -> None:
    found = outlook(FEW)
    at_five, at_ten = (found.strength_at("tank_heat", d) for d in (5.0, 10.0))
    assert at_ten == pytest.approx(2.0 * at_five)
    typical = library()["tank_heat"].strength.typical
    assert found.strength_at("tank_heat", found.now.detectability("tank_heat")) == pytest.approx(typical)
    heat = library()["tank_heat"]
    power, *shape = heat.parameters
    once, thrice = (
        look_ahead(base(), full().only(FEW), Catalogue({"tank_heat": replace(heat, parameters=(p, *shape))}, {}))
        for p in (power, replace(power, typical=3.0 * typical))
    )
    assert thrice.now.detectability("tank_heat") == pytest.approx(3.0 * once.now.detectability("tank_heat"), rel=1e-6)
    assert thrice.strength_at("tank_heat", 5.0) == pytest.approx(once.strength_at("tank_heat", 5.0), rel=1e-6)


@pytest.mark.parametrize("added", ["p_run", "m_tank"])
def test_a_further_channel_never_shows_less(added: str) -> None:
    few, more = outlook(FEW).now, outlook((*FEW, added)).now
    for name in library():
        assert more.detectability(name) >= few.detectability(name) * (1.0 - 1e-6)
    assert any(more.detectability(name) > 1.05 * few.detectability(name) for name in library())


def test_no_virtual_sensor_shows_less() -> None:
    found = outlook(FEW)
    for sensor in found.extra:
        more = found.with_sensor(sensor)
        for name in found.effects:
            assert more.detectability(name) >= found.now.detectability(name) * (1.0 - 1e-9)


def test_an_effect_is_its_own_copys_twin() -> None:
    heat = library()["tank_heat"]
    effects = {"tank_heat": heat, "warm_tank": replace(heat, name="warm_tank", twins=())}
    found = look_ahead(base(), full(), Catalogue(effects, {}))
    assert found.now.correlation("tank_heat", "warm_tank") == pytest.approx(1.0)
    assert found.now.apart("tank_heat", "warm_tank") == pytest.approx(0.0, abs=1e-3)
    assert list(found.twins) == [("tank_heat", "warm_tank")]
    assert all(not found.separated(sensor) for sensor in found.extra)


def test_heat_in_the_chamber_and_lost_combustion_are_twins_and_heat_in_the_tank_is_none_of_theirs() -> None:
    found = outlook(tuple(NOISE))
    assert found.now.apart("chamber_heat_loss", "combustion_efficiency") < TWINS
    assert found.now.apart("tank_heat", "combustion_efficiency") > TWINS


def _sensor(found: Outlook, name: str) -> Sensor:
    return next(s for s in found.extra if s.name == name)


def test_the_throats_radius_tells_erosion_from_a_lagging_transducer_and_from_lost_heat() -> None:
    alone = outlook(("p_chamber",))
    throat = _sensor(alone, "throat_radius_after")
    erosion, lag = "nozzle_throat_erosion", "chamber_tap_lag"
    more = alone.with_sensor(throat)
    assert alone.now.beside(erosion, lag) < TWINS < 2.0 * TWINS < more.beside(erosion, lag)
    assert abs(more.correlation(erosion, lag)) < 0.5 * abs(alone.now.correlation(erosion, lag))
    assert alone.twins["chamber_heat_loss", erosion] < TWINS < alone.separated(throat)["chamber_heat_loss", erosion]


def test_the_tanks_mass_tells_heat_in_the_tank_from_lost_combustion() -> None:
    few = outlook(FEW)
    pair = ("combustion_efficiency", "tank_heat")
    assert few.twins[pair] < TWINS < few.separated(_sensor(few, "m_tank"))[pair]
    assert pair not in few.separated(_sensor(few, "throat_radius_after"))
    assert pair not in outlook((*FEW, "m_tank")).twins


def test_a_sensor_that_is_there_is_not_offered_again() -> None:
    offered = {s.name for s in missing_sensors(full())}
    assert offered.isdisjoint(full().names)
    assert {s.name for s in missing_sensors(full().only(FEW))} == offered | {"p_run", "m_tank"}
    measured = replace(full(), stated={"throat_radius_after": (0.0, 5e-5)})
    assert "throat_radius_after" not in {s.name for s in missing_sensors(measured)}
    assert {s.name for s in (*USUAL, *FURTHER)} >= offered


def test_a_virtual_channel_is_worth_about_what_the_real_one_is() -> None:
    found = outlook(FEW)
    sensor = _sensor(found, "m_tank")
    real, virtual = outlook((*FEW, "m_tank")).now, found.with_sensor(sensor)
    gained = {n: real.detectability(n) / found.now.detectability(n) for n in ("tank_heat", "n2_purge")}
    for name, gain in gained.items():
        assert virtual.detectability(name) / found.now.detectability(name) == pytest.approx(gain, rel=0.5)


def test_a_test_too_short_for_a_block_gains_nothing_from_a_further_channel() -> None:
    found = look_ahead(base(), replace(full().only(FEW), end=0.1), Catalogue({"tank_heat": library()["tank_heat"]}, {}))
    assert found.extra[_sensor(found, "m_tank")].shape[0] == 0
    assert found.with_sensor(_sensor(found, "m_tank")).detectability("tank_heat") == pytest.approx(
        found.now.detectability("tank_heat")
    )


def test_without_a_thrust_cell_its_drift_is_never_seen_and_a_cell_would_show_it() -> None:
    found = outlook(("p_tank", "p_chamber"))
    assert "load_cell_drift" not in found.visible
    assert found.now.detectability("load_cell_drift") == 0.0
    cell = _sensor(found, "thrust")
    assert found.shown(cell)["load_cell_drift"] > 5.0


def test_what_cannot_be_negative_is_no_rival_where_it_would_have_to_be() -> None:
    now = outlook(tuple(NOISE)).now
    pair = ("injector_choked_vapor", "injector_two_phase")
    assert now.correlation(*pair) < -0.9
    assert now.at_nominal(*pair) == pytest.approx(NOMINAL)
    free = replace(now, one_sided=frozenset())
    assert free.at_nominal(*pair) < TWINS


def test_a_rival_that_may_change_its_shape_is_never_farther() -> None:
    now = outlook(tuple(NOISE)).now
    kept = np.flatnonzero(~now.shapes)
    owners = tuple(now.owners[i] for i in kept)
    stiff = replace(
        now, owners=owners, matrix=now.matrix[np.ix_(kept, kept)], shapes=now.shapes[kept], one_sided=frozenset()
    )
    free = replace(now, one_sided=frozenset())
    for rival in ("tank_wall_heat_capacity", "tank_nonequilibrium", "injector_two_phase"):
        assert free.at_nominal("tank_heat", rival) <= stiff.at_nominal("tank_heat", rival) * (1.0 + 1e-9)
    assert free.at_nominal("tank_heat", "tank_wall_heat_capacity") < TWINS
    assert free.at_nominal("tank_heat", "tank_wall_heat_capacity") < 0.7 * stiff.at_nominal(
        "tank_heat", "tank_wall_heat_capacity"
    )
