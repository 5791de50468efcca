"""hfa diagnose --apply --unknown: what has no name is adopted as it was found, in every stage, engine file and draw."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.effects.runs import with_effects
from tests.effects.test_learnt import table
from tests.inference.adopted.firing import make_root
from tests.products.filled import filled

from hfanalysis.cli.adopt import adopt, write_draft
from hfanalysis.diagnose.answer.learnt import quantities
from hfanalysis.diagnose.answer.words import learnt_sentences
from hfanalysis.effects import FOLDER, library, trust
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.inference.adopted.effects import effects_in, read_adopted, tables
from hfanalysis.products.diagnosis import Diagnosis, Learnt, OtherTest, PowerLaw
from hfanalysis.report.names import called
from hfanalysis.stages.base import Context
from hfanalysis.stages.open_test import open_test
from hfanalysis.wording.numbers import adopted_in_words

NAME = "unknown_regression_factor_by_oxidizer_flux"
VALUES = [0.0, 0.1, 0.2, 0.1, 0.0, -0.1, 0.0, 0.1]
ACTIVE = table(NAME, 50.0, 600.0, VALUES, 0.02)
HINT = PowerLaw(
    factor=-2e-3, powers={"p_chamber": 0.8, "oxidizer_flux": -0.2}, start=2.6, end=5.0, words="it goes with x"
)


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return make_root(tmp_path)


def opened(root: Path) -> Context:
    return open_test(root, "T1")


def unknown(**changes: Any) -> Diagnosis:
    found = Learnt(
        effect=NAME, site="regression_factor", equation="grain", state="oxidizer_flux", parameters=quantities(ACTIVE),
        evidences={"oxidizer_flux": 0.0}, alike=("p_chamber",), closed_fraction=0.83, hint=HINT,
    )  # fmt: skip
    product = filled(
        Diagnosis, {"verdict": "unknown", "set90": ["unknown"], "posterior": {"unknown": 0.97, "none": 0.01}}
    )
    return product.but(**({"learnt": found} | changes))


def test_what_is_unknown_is_adopted_and_acts_as_it_was_found(root: Path) -> None:
    path = adopt(opened(root), unknown(), unknown=True)
    text = path.read_text(encoding="utf-8")
    assert "Something without a name (probability 0.97), as it was found, over the oxidizer flux" in text
    assert "No other test of the stand tells whether it holds there" in text
    assert "Adopted by hfa diagnose T1 --apply --unknown (hfanalysis" in text
    assert "inner" not in text
    (active,) = read_adopted(root, opened(root).definition).effects
    assert active == ACTIVE
    assert float(with_effects(active).steps.at(np.array([2.0]))[1][0, 5]) != pytest.approx(
        float(with_effects().steps.at(np.array([2.0]))[1][0, 5]), rel=1e-3
    )


def test_what_was_in_the_model_beside_it_is_adopted_with_it(root: Path) -> None:
    beside = {"name": "tank_heat", "probability": 0.8, "equation": "tank_energy", "parameters": {
        "power": {"value": 900.0, "unit": "W", "std": 100.0, "ci95": None}}}  # fmt: skip
    found = filled(Diagnosis, {"verdict": "named", "effects": [beside]}).effects
    product = unknown()
    assert product.learnt is not None
    adopt(opened(root), product.but(learnt=product.learnt.but(beside=found)), unknown=True)
    assert [a.effect.name for a in read_adopted(root, opened(root).definition).effects] == ["tank_heat", NAME]


def test_only_its_band_is_drawn(root: Path) -> None:
    adopt(opened(root), unknown(), unknown=True)
    adopted = read_adopted(root, opened(root).definition)
    drawn = [adopted.drawn(adopted.acting, np.random.default_rng(i))[0].named for i in range(200)]
    assert {d["value_2"] for d in drawn} == {0.2}
    assert np.std([d["shift"] for d in drawn]) == pytest.approx(1.0, abs=0.2)


def test_an_engine_file_has_it_as_a_table_and_reads_it_again(root: Path) -> None:
    adopt(opened(root), unknown(), unknown=True)
    content = tables(read_adopted(root, opened(root).definition))
    assert "state" not in content[NAME]
    assert effects_in(content, root / "engine.toml", library()).effects == (ACTIVE,)
    with pytest.raises(InputError, match="found 'state'; expected one of strength, shift"):
        effects_in({NAME: {**content[NAME], "state": "1"}}, root / "engine.toml", library())


def test_where_there_is_nothing_to_adopt_the_reason_is_said(root: Path) -> None:
    with pytest.raises(AbsentError, match="nothing unknown to adopt: it is an event"):
        adopt(opened(root), unknown(learnt=None, not_learnt="it is an event"), unknown=True)
    with pytest.raises(AbsentError, match="the verdict is 'none', not 'unknown'"):
        adopt(opened(root), unknown(learnt=None, verdict="none"), unknown=True)
    with pytest.raises(AbsentError, match="--unknown adopts what has no name as it was found"):
        adopt(opened(root), unknown())


def test_what_does_not_hold_on_another_test_is_not_adopted_for_all(root: Path) -> None:
    product = unknown()
    gap = {"test": "T2", "closed_fraction": -0.27, "before": {}, "after": {}}
    other = product.but(gap=product.gap.but(other_test=OtherTest(**gap)))
    with pytest.raises(
        AbsentError, match=r"takes away -27 % of the misfit of T2: it does not hold there.*this test alone"
    ):
        adopt(opened(root), other, stand=True, unknown=True)
    text = adopt(opened(root), other, unknown=True).read_text(encoding="utf-8")
    assert "It takes away -27 % of the misfit of T2: it does not hold there, so do not predict with it." in text
    holds = product.but(gap=product.gap.but(other_test=OtherTest(**{**gap, "closed_fraction": 0.6})))
    assert adopt(opened(root), holds, stand=True, unknown=True).name == "paper.effects.toml"


def test_the_draft_is_an_effect_that_a_team_can_make_its_own(root: Path) -> None:
    product = unknown()
    assert product.learnt is not None
    path = write_draft(opened(root), product.learnt)
    assert path == root / FOLDER / "T1.draft"
    assert "draft_T1" not in library(root / FOLDER)  # until somebody makes it one
    path.rename(path.with_name("draft_T1.py"))
    trust.agree(root / FOLDER, note=False)
    found = library(root / FOLDER)["draft_T1"]
    assert found.equation == "grain"
    acting = found.at(strength=-2e-3, start=0.0)
    p, g = 12e5, 300.0
    assert dict(acting.named)["power_of_p_chamber"] == pytest.approx(0.8)
    slow = with_effects(found.at(strength=-0.3 / (p**0.8 * g**-0.2), start=0.0))
    flow = [float(run.steps.at(np.array([2.0]))[1][0, 5]) for run in (slow, with_effects())]
    assert flow[0] < 0.9 * flow[1]
    assert write_draft(opened(root), product.learnt.but(hint=None)) is None


def test_the_words_tell_the_state_the_hint_and_the_command() -> None:
    told = learnt_sentences(unknown())
    assert told[0] == "Of the engine's states it follows best the oxidizer flux, and nearly as well chamber pressure."
    assert told[1] == "A hint at its form, not a name: it goes with x."
    assert told[2] == "As a table over that state it takes away 83 % of the misfit."
    assert told[3] == "To adopt it: hfa diagnose TEST --apply --unknown."
    assert learnt_sentences(unknown(learnt=None, not_learnt="it is an event")) == [
        "It cannot be adopted as it was found: it is an event."
    ]


def test_it_is_told_by_the_ends_of_its_table(root: Path) -> None:
    adopt(opened(root), unknown(), unknown=True)
    found = read_adopted(root, opened(root).definition).product()
    told = adopted_in_words(found, called)
    assert told == (
        "Included in the model: unknown regression factor by oxidizer flux, −0.1 to 0.2 (engines/T1.effects.toml)."
    )
