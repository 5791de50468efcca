"""What no name explains is laid over the states of the engine, adopted, and proved on another test."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.effects.test_learnt import table
from tests.engine.stand import engine_on_stand
from tests.inference import made

from hfanalysis.diagnose.answer.learnt import Learning, hint, learn, over_state
from hfanalysis.diagnose.answer.proof import OtherTest, prove
from hfanalysis.diagnose.answer.verdict import Verdict, verdict_of
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.naming import Naming, name_effects
from hfanalysis.effects import effect
from hfanalysis.effects.learnt import STATES

TRIED = ("load_cell_drift", "tank_heat")
TRUE = table("unknown_injector_factor_by_p_tank_of_liquid", 3.6e6, 5e6, [0.0, 0.0, -0.1, -0.2, -0.2, -0.1, 0.0, 0.0])
TIME = np.linspace(0.0, 8.0, 41)


@cache
def answered() -> tuple[Naming, Verdict, Learning]:
    found = name_effects(made.hypothesis(), made.observed(TRUE), Catalogue({n: effect(n) for n in TRIED}, {}))
    verdict = verdict_of(found)
    return found, verdict, learn(found, verdict.chosen)


def test_an_unknown_is_learnt_over_a_state_and_closes_the_gap_so() -> None:
    _, verdict, learning = answered()
    assert verdict.label == "unknown"
    assert learning.reason is None
    assert learning.product is not None
    assert learning.product.site == "injector_factor"
    assert learning.product.state == "p_tank"
    assert learning.product.evidences["p_chamber"] < -10.0  # with which it is not one to one
    assert "of_ratio" not in learning.product.evidences  # no injector knows of it
    assert learning.active is not None
    assert learning.active.effect.name.startswith("unknown_injector_factor_by_p_tank")
    assert learning.product.closed_fraction > 0.7


def test_it_closes_that_of_another_load_too() -> None:
    found, verdict, learning = answered()
    engine = engine_on_stand(temperature=288.0, oxidizer_mass=7.0, effects=(TRUE,))
    base = made.hypothesis()
    centers = {"temperature": 288.4, "oxidizer_mass": 7.02}
    free = tuple(replace(f, center=centers.get(f.name, f.center)) for f in base.free)
    own = replace(base, engine=replace(base.engine, temperature=288.4, oxidizer_mass=7.02), free=free)
    proof = prove(found, verdict.chosen, OtherTest("T2", own, made.observed(seed=7, engine=engine)), learning.active)
    assert proof.fractions["other_test"] is not None
    assert proof.fractions["other_test"] > 0.5


def test_the_state_that_a_course_follows_is_told_from_one_that_it_does_not() -> None:
    up_and_down, falling = np.sin(0.8 * TIME) + 2.0, 5.0 - 0.5 * TIME
    source, covariance = 3.0 * up_and_down**2, 1e-2 * np.eye(TIME.size)
    right = over_state("p_chamber", up_and_down, source, covariance)
    wrong = over_state("m_liquid", 1.0 / (1.0 + (falling - 3.0) ** 2), source, covariance)
    assert right is not None
    assert wrong is not None
    assert right.log_evidence > wrong.log_evidence + 10.0
    assert right.values[-1] == pytest.approx(27.0, rel=0.1)
    assert (right.bands > 0.0).all()
    assert over_state("p_tank", np.full(TIME.size, 3.0), source, covariance) is None


def test_a_hint_finds_the_powers_and_when_it_begins() -> None:
    pressure, flux = 2e6 + 1e6 * np.sin(TIME), 400.0 * np.exp(-0.2 * TIME)
    courses = {name: np.full(TIME.size, 1.0) for name in STATES} | {"p_chamber": pressure, "oxidizer_flux": flux}
    rng = np.random.default_rng(3)
    late = TIME >= 2.6
    source = np.where(late, -2e-6 * pressure**0.8, 0.0) * (1.0 + 0.01 * rng.standard_normal(TIME.size))
    found = hint(courses, source, np.full(TIME.size, 0.02), TIME)
    assert found is not None
    assert list(found.powers) == ["p_chamber"]
    assert found.powers["p_chamber"] == pytest.approx(0.8, abs=0.05)
    assert found.factor < 0.0
    assert found.start == pytest.approx(2.6)
    assert found.words == "it goes with chamber pressure to the power 0.8 from 2.6 s on"


def test_no_hint_where_nothing_simple_fits() -> None:
    courses = dict.fromkeys(STATES, 1.0 + TIME)
    rng = np.random.default_rng(4)
    assert hint(courses, rng.uniform(0.1, 5.0, TIME.size), np.full(TIME.size, 1e-3), TIME) is None
    assert hint(courses, np.where(TIME > 4.0, 1.0, -1.0), np.full(TIME.size, 0.01), TIME) is None  # changes its sign
    assert hint(courses, np.ones(TIME.size), np.full(TIME.size, 10.0), TIME) is None  # not seen
