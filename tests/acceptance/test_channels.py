"""docs/channels.md says what is had of a log that lacks channels: two of its rows, and that it has every one."""

from __future__ import annotations

import pytest
from pipeline.channels_page import CASES, PAGE, Case, head, row

WRITTEN = PAGE.read_text(encoding="utf-8")
CHEAP = ("thrust only", "no p_run")
"""The least that is told anything of, and the one whose numbers hold on a condition."""


@pytest.mark.parametrize("case", [case for case in CASES if case.name in CHEAP], ids=lambda case: case.name)
def test_the_row_is_what_is_had_now(case: Case) -> None:
    assert row(case) in WRITTEN, "`make readme` writes it"


def test_every_case_has_its_row() -> None:
    assert head() in WRITTEN
    assert [line.split(" | ")[0] for line in WRITTEN.splitlines() if line.startswith("| ")][1:] == [
        f"| {case.name}" for case in CASES
    ]
