"""Whatever is wrong with the input ends with one plain message that says where; the raw files stay as they are."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest
from tests.acceptance.bad_input import CASES, Bad, write_good

from hfanalysis.errors import AnalysisError
from hfanalysis.record.definition import find_definition, load_definition
from hfanalysis.record.ingest import ingest


def run(root: Path, test_id: str) -> tuple[int, str]:
    """Exit status and message of ingesting a test."""
    out = root / "processed"
    out.mkdir(exist_ok=True)
    try:
        ingest(load_definition(find_definition(root, test_id)), out / "ingest.h5")
    except AnalysisError as error:
        return error.exit_status, str(error)
    return 0, ""


def fingerprints(folder: Path) -> dict[str, str]:
    """SHA-256 of every raw file."""
    files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def test_the_unspoilt_test_is_good(tmp_path: Path) -> None:
    write_good(tmp_path)
    assert run(tmp_path, "HF1") == (0, "")


def test_there_are_a_hundred_kinds() -> None:
    assert len({case.name for case in CASES}) >= 100


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_bad_input_ends_with_one_plain_message(case: Bad, tmp_path: Path) -> None:
    case.spoil(write_good(tmp_path))
    before = fingerprints(tmp_path / "raw_tests")
    status, message = run(tmp_path, case.test)
    assert status in (2, 3), message
    assert "\n" not in message
    assert len(message) < 800
    assert [word for word in case.words if word not in message] == [], message
    assert fingerprints(tmp_path / "raw_tests") == before
