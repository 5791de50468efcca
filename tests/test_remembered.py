"""Answers are kept for as long as what they follow from is as it was, and no longer."""

from __future__ import annotations

from pathlib import Path

import pytest

from hfanalysis.remembered import Remembered


def asked(path: Path, state: str, answer: str, lasting: bool = True) -> str:
    """What a new process would be told, which finds ``answer`` if it has to look itself."""
    memory = Remembered(path, state, lasting)
    found = str(memory("what?", lambda: answer))
    if lasting:
        memory.save()
    return found


def test_an_answer_is_found_once(tmp_path: Path) -> None:
    path = tmp_path / "folder" / "answers.json"
    assert asked(path, "as it is", "first") == "first"
    assert asked(path, "as it is", "second") == "first"
    assert asked(path, "another", "third") == "third"
    assert asked(path, "as it is", "fourth") == "fourth"
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("damage", [b"", b"{}", b"\xff\xfe", None])
def test_a_damaged_file_is_passed_over(tmp_path: Path, damage: bytes | None) -> None:
    path = tmp_path / "answers.json"
    asked(path, "as it is", "first")
    whole = path.read_bytes()
    path.write_bytes(whole.replace(b"first", b"worst") if damage is None else damage)
    assert asked(path, "as it is", "second") == "second"


def test_where_nothing_can_be_written_answers_are_found_anew(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    path = tmp_path / "file" / "answers.json"
    assert asked(path, "as it is", "first") == "first"
    assert asked(path, "as it is", "second") == "second"
