"""Tests in processes of their own."""

from __future__ import annotations

from pathlib import Path

from hfanalysis.campaign.side_by_side import Ended, _said, run_all


def test_how_each_ends_is_told_and_none_ends_another(tmp_path: Path) -> None:
    told: dict[str, Ended] = {}
    found = run_all(["one", "two"], ["--root", str(tmp_path)], 2, told.__setitem__)
    assert list(found) == ["one", "two"]
    assert found == told
    assert found["one"].status == 2
    assert found["one"].said.startswith("test 'one': no such folder in ")
    assert not found["one"].defect


def test_a_message_is_told_without_what_is_only_a_warning_and_a_traceback_whole() -> None:
    assert _said("hfa: warning: noisy\n  rest of it\nhfa: p_tank: found nothing\n") == "p_tank: found nothing"
    traceback = "Traceback (most recent call last):\n  File ...\nValueError: x"
    assert _said(f"hfa: warning: noisy\n{traceback}\n") == traceback
    assert _said("") == "it ended without a word"
    assert Ended(1, traceback).defect
