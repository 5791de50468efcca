"""Intervals of constants that were fitted together with adopted effects: what these, table and laws may be off by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.inference.adopted import firing

from hfanalysis.calibrate.joint_errors import errors_about, freed
from hfanalysis.effects import effect
from hfanalysis.engine.effect import Active
from hfanalysis.inference.candidate import Bench, Candidate
from hfanalysis.inference.fitting.laws import LAWS
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.schema import changed
from hfanalysis.stages.diagnose import subject_of
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to
from hfanalysis.units import Value

HEAT = effect("tank_heat").at(power=2000.0)
TRUE = {"n": 0.555, "polytropic_exponent": 1.1}
"""Of the stand's engine."""


def fitted(root: Path, *others: Active) -> tuple[Candidate, Observed, Sequence[Active], TestDefinition]:
    """A test whose tank is heated, ``others`` in its log and in no model; fitted with the heat held."""
    subject = subject_of(run_to("calibrate", open_test(firing.make_root(root, HEAT, *others), "T1")))
    hypothesis, observed = subject.compared(as_run=True)
    engine = replace(hypothesis.engine, effects=(*hypothesis.engine.effects, HEAT))
    found = Bench(observed).settled(replace(hypothesis, engine=engine))
    assert found is not None
    return found, observed, (HEAT,), subject.definition


def told(found: Candidate, name: str, errors: np.ndarray) -> tuple[float, float, float]:  # type: ignore[type-arg]
    """How far a constant is off, its deviation by the fit alone, and with all errors."""
    place = found.fit.hypothesis.names.index(name)
    free, x = found.fit.hypothesis.free[place], float(found.fit.x[place])
    alone, whole = (abs(free.slope(x)) * float(np.sqrt(c[place, place])) for c in (found.fit.covariance, errors))
    return abs(free.value(x) - TRUE[name]), alone, whole


@pytest.mark.parametrize(
    ("other", "name", "most"),
    [
        (LAWS.at(port=-0.1), "n", 0.1),
        (effect("combustion_efficiency").at(deficit=0.06), "polytropic_exponent", 0.2),
    ],
    ids=["regression with the port", "a lower level of c*"],
)
def test_where_another_law_or_level_holds_the_fit_is_sure_and_wrong_and_the_interval_is_not(
    other: Active, name: str, most: float, tmp_path: Path
) -> None:
    found, *given = fitted(tmp_path, other)
    off, alone, whole = told(found, name, errors_about(found, *given))
    assert off > 2.5 * alone
    assert off < 2.0 * whole
    assert whole < most


def test_where_the_model_holds_the_constants_hardly_move_and_the_level_is_none(tmp_path: Path) -> None:
    found, *given = fitted(tmp_path)
    free = min(freed(found, *given), key=lambda one: one.objective)
    off, alone, whole = told(found, "n", errors_about(found, *given))
    assert off < 3.0 * alone
    assert alone < whole < 0.06
    assert abs(free.values["combustion_efficiency.deficit"]) < 0.02
    assert {"tank_heat.power", "nozzle_divergence.loss"} <= set(free.hypothesis.names)


def test_a_range_is_held_in_the_engine_that_is_run_and_free_in_the_errors_of_its_constants(tmp_path: Path) -> None:
    found, observed, effects, definition = fitted(tmp_path)
    assert "throat_area" not in found.fit.hypothesis.names
    nozzle = definition.nozzle
    assert nozzle is not None
    assert nozzle.throat_radius is not None
    wide = changed(definition, nozzle=changed(nozzle, throat_radius=Value(nozzle.throat_radius.value, 0.002)))
    assert "throat_area" not in freed(found, observed, effects, definition)[0].hypothesis.names
    free = freed(found, observed, effects, wide)[0]
    assert free.values["throat_area"] == pytest.approx(found.fit.hypothesis.engine.throat_area, rel=0.05)
    assert free.stds["throat_area"] < 0.05 * free.values["throat_area"]
