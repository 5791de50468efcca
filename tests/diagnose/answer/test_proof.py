"""Proof on another test of the stand: constants of an effect are frozen, those of the engine are that test's own."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest
from tests.engine.stand import engine_on_stand
from tests.inference import made

from hfanalysis.diagnose.answer.proof import OtherTest, prove
from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.naming import Naming, name_effects
from hfanalysis.effects import effect
from hfanalysis.inference.candidate import Candidate
from hfanalysis.inference.fitting.hypothesis import Hypothesis

HEAT = effect("tank_heat").at(power=3000.0)

TRIED = ("load_cell_drift", "tank_heat")


@cache
def named() -> Naming:
    return name_effects(made.hypothesis(), made.observed(HEAT), Catalogue({n: effect(n) for n in TRIED}, {}))


def single(name: str) -> Candidate:
    return next(c for c in named().singles if c.names == (name,))


def elsewhere(hypothesis: Hypothesis, power: float = 3000.0) -> OtherTest:
    """A colder test of the same stand, with a little less in the tank."""
    heat = effect("tank_heat").at(power=power)
    engine = engine_on_stand(temperature=288.0, oxidizer_mass=8.0, effects=(heat,))
    return OtherTest("T2", hypothesis, made.observed(seed=7, engine=engine))


def on_the_other(off: float = 0.0) -> Hypothesis:
    """Its base model, calibrated wrongly: the injector's area by a share ``off``."""
    found = made.hypothesis()
    feed = replace(found.engine.feed, area=found.engine.feed.area * (1.0 + off))
    engine = replace(found.engine, temperature=288.4, oxidizer_mass=8.02, feed=feed)
    centers = {"temperature": 288.4, "oxidizer_mass": 8.02, "area": feed.area}
    free = tuple(replace(f, center=centers.get(f.name, f.center)) for f in found.free)
    return replace(found, engine=engine, free=free)


@pytest.mark.parametrize("off", [0.0, 0.3, -0.2])
def test_the_right_effect_closes_the_gap_of_another_test_from_wherever_it_was_calibrated(off: float) -> None:
    proof = prove(named(), single("tank_heat"), elsewhere(on_the_other(off)))
    assert proof.fractions["other_test"] is not None
    assert proof.fractions["other_test"] > 0.9
    assert proof.other is not None
    assert proof.other.after["p_tank"] < 0.3 * proof.other.before["p_tank"]


def test_a_wrong_effect_does_not() -> None:
    proof = prove(named(), single("load_cell_drift"), elsewhere(on_the_other()))
    assert proof.fractions["other_test"] is not None
    assert proof.fractions["other_test"] < 0.3


def test_constants_that_are_not_those_of_the_stand_do_not_close_it() -> None:
    """A cooled tank: heat makes it worse."""
    proof = prove(named(), single("tank_heat"), elsewhere(on_the_other(), power=-3000.0))
    assert proof.fractions["other_test"] is not None
    assert proof.fractions["other_test"] < 0.0


def test_a_test_that_cannot_be_modeled_is_said_to_prove_nothing() -> None:
    other = elsewhere(on_the_other())
    engine = other.hypothesis.engine
    nowhere = replace(other.hypothesis, engine=replace(engine, feed=replace(engine.feed, volume=1e-3)))
    proof = prove(named(), single("tank_heat"), replace(other, hypothesis=nowhere))
    assert proof.fractions["other_test"] is None
    assert any("T2 cannot be modeled" in note for note in proof.notes)
