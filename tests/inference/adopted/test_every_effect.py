"""Every effect of the library, adopted at a typical strength, goes through all stages that have effects in them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.effects.runs import typical
from tests.inference.adopted.firing import make_root

from hfanalysis.effects import library
from hfanalysis.inference.adopted.effects import of_diagnosis, write_adopted
from hfanalysis.products.diagnosis import NamedEffect, Plausibility
from hfanalysis.quantity import Quantity
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

SETTINGS = {"calibrate.samples": 10}


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_root(tmp_path_factory.mktemp("root"))


@pytest.mark.parametrize("name", sorted(library()))
def test_it_is_calibrated_and_validated_with(name: str, root: Path) -> None:
    active = typical(name)
    parameters = {
        p.name: Quantity(v, "" if p.unit == "-" else p.unit)
        for p, v in zip(active.effect.parameters, active.values, strict=True)
    }
    judged = {"probability": 1.0, "equation": active.effect.equation, "meaning": active.effect.meaning}
    size = Plausibility(size=None, plausible=None, why="")
    named = NamedEffect(name=name, parameters=parameters, plausibility=size, **judged)
    path = root / "engines" / "T1.effects.toml"
    path.parent.mkdir(exist_ok=True)
    write_adopted(path, of_diagnosis([named], library()), [])
    out = run_to("validate", open_test(root, "T1", settings=SETTINGS)).out
    for product in ("calibration", "validation"):
        found = json.loads((out / f"{product}.json").read_text(encoding="utf-8"))
        assert [row["name"] for row in found["effects"]] == [name], product
    calibrated = json.loads((out / "calibration.json").read_text(encoding="utf-8"))
    assert 0.1 < calibrated["C_i"]["value"] < 1.0
