"""On which other test a diagnosis is proved."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from tests.inference.adopted.firing import make_root

from hfanalysis.errors import AnalysisError
from hfanalysis.record.definition import load_definition
from hfanalysis.stages.diagnose import STAGE, _other, _proofs


def context(root: Path, proof_test: str = "") -> Any:
    """What the stage sees of a test T1, and of the root that it lies in."""
    definition = load_definition(root / "raw_tests" / "T1" / "test.toml")
    parameters = {**STAGE.parameters, "proof_test": proof_test}
    known = SimpleNamespace(definition=definition, root=root, id="T1", parameter=parameters.__getitem__)
    return cast("Any", SimpleNamespace(**vars(known), out=root / "processed" / "T1", progress=lambda *_: None))


def another(root: Path, name: str, old: str = "", new: str = "") -> None:
    text = (root / "raw_tests" / "T1" / "test.toml").read_text(encoding="utf-8")
    folder = root / "raw_tests" / name
    folder.mkdir()
    (folder / "log.csv").write_text("time,p_tank,p_run,p_chamber,thrust\n", encoding="utf-8")
    (folder / "test.toml").write_text(text.replace('id = "T1"', f'id = "{name}"').replace(old, new), encoding="utf-8")


def test_it_is_another_hot_fire_of_the_same_stand(tmp_path: Path) -> None:
    root = make_root(tmp_path)
    assert _proofs(context(root)) == []
    another(root, "T4")
    another(root, "T3")
    another(root, "T2", 'stand = "paper"', 'stand = "another"')
    another(root, "T5", 'kind = "hot_fire"', 'kind = "cold_flow"')
    another(root, "T6", "schema = 1", "schema = none of these")
    assert [proof.test.id for proof in _proofs(context(root))] == ["T3", "T4"]


def test_a_sister_that_cannot_be_calibrated_is_passed_over(tmp_path: Path) -> None:
    root = make_root(tmp_path)
    another(root, "T3")  # its log is empty
    assert _other(context(root)) is None


def test_the_one_that_is_asked_for_has_to_be_there(tmp_path: Path) -> None:
    with pytest.raises(AnalysisError, match="T9"):
        _other(context(make_root(tmp_path), "T9"))
