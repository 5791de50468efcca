"""The diagnosis on the way through: what it may stop, and where the test that proves it is made."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products.disk import HashCache
from hfanalysis.record.definition import load_definition
from hfanalysis.stages import ORDER, freshness, way_to
from hfanalysis.stages import diagnose as stage
from hfanalysis.stages.base import Context, load_stage
from hfanalysis.stages.open_test import open_test

REPOSITORY = Path(__file__).parents[2]


def context(tmp_path: Path, **settings: str) -> Context:
    made = open_test(
        REPOSITORY, "HF5", tmp_path, settings={f"diagnose.{name}": value for name, value in settings.items()}
    )
    return made.at(load_stage("diagnose"))


def test_the_diagnosis_is_on_the_way_to_the_page() -> None:
    assert "diagnose" in way_to("report")
    assert way_to("run") == ORDER
    assert "diagnose" in load_stage("report").wants


def test_a_test_is_no_proof_of_itself(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="HF5, the test itself"):
        stage._proofs(context(tmp_path, proof_test="HF5"))
    with pytest.raises(InputError, match="HF6"):
        stage._proofs(context(tmp_path, proof_test="HF6"))
    assert [proof.test.id for proof in stage._proofs(context(tmp_path, proof_test="HF4"))] == ["HF4"]


def test_the_raw_files_of_the_test_that_proves_are_in_the_key(tmp_path: Path) -> None:
    made = context(tmp_path, proof_test="HF4")
    assert made.stage is not None
    hashes = HashCache(tmp_path / "hashes.json")
    assert set(freshness._of_others(made, made.stage, hashes)["others"]["HF4"]) == {"test.toml", "log.csv"}


def test_two_tests_that_prove_each_other_do_not_wait_for_each_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    worked: list[Path] = []

    def bring(_name: str, other: Context) -> Context:
        worked.append(other.out)
        return other

    subject = SimpleNamespace(compared=lambda: (None, None))
    monkeypatch.setattr("hfanalysis.stages.runner.run_to", bring)
    monkeypatch.setattr(stage, "subject_of", lambda _context: subject)
    for name, other in (("HF5", "HF4"), ("HF4", "HF5")):
        made = replace(open_test(REPOSITORY, name, tmp_path), settings={"diagnose.proof_test": other})
        proof = stage._other(made.at(load_stage("diagnose")))
        assert proof is not None
        assert proof.name == other
        assert worked[-1].is_relative_to(tmp_path / name)
    assert len(set(worked)) == 2


# An AbsentError would read as "this test has no engine to run".
def test_a_sibling_that_holds_nothing_is_passed_over_but_not_one_that_was_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def bring(_name: str, _other: Context) -> Context:
        raise AbsentError("no firing")

    monkeypatch.setattr("hfanalysis.stages.runner.run_to", bring)
    monkeypatch.setattr(stage, "nearest", lambda _: [load_definition(REPOSITORY / "raw_tests" / "HF4" / "test.toml")])
    assert stage._other(context(tmp_path)) is None
    with pytest.raises(InputError, match="HF4 cannot prove anything: no firing"):
        stage._other(context(tmp_path, proof_test="HF4"))
