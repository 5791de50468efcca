"""What the study of campaigns counts, on made-up runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from benchmarks import campaign as study

ALIKE = "| two pinned processes | 100 | 4 of 4 | the same, byte by byte |"


def run(products: str = "a", seconds: float = 100.0, **other: Any) -> dict[str, Any]:
    took = {f"G{i}": 40.0 for i in range(4)}
    return {"seconds": seconds, "start": 10.0, "products": products, "took": took, "failed": {}, "empty": 0.002,
            "own": 110.0, "sizes": [800.0] * 20, "kills": 3, "ended": [2]} | other  # fmt: skip


def lines(together: dict[str, Any], killed: dict[str, Any]) -> list[str]:
    return study.told(4, run(), together, killed, sent=4e6, given=2e6)


def test_what_is_the_same_is_told_as_such_and_what_is_not_too() -> None:
    told = lines(run(seconds=125.0), run("b", failed={study.DEADLY: "deadly: died"}))
    assert told[2] == ALIKE
    assert told[3] == "| a campaign on two workers | 125 | 4 of 4 | the same, byte by byte |"
    assert told[4] == "| the same, 3 workers killed, and all of it once | 100 | 4 of 4 | **other** |"
    text = "\n".join(told)
    assert "Throughput 0.80 of that of two pinned processes" in text
    assert "Between two tests a worker waits 17500 ms" in text  # 2 x 115 s less 160 s, over 4
    assert '"deadly: died"' in text


def test_a_test_that_kills_its_process_and_is_not_named_is_seen() -> None:
    assert "**not named**" in "\n".join(lines(run(), run()))


def test_one_worker_takes_the_sum_of_the_tests() -> None:
    assert study.estimate([3.0], tests=10, count=1, each=0.0, sent=0.0, given=0.0) == pytest.approx(30.0)


def test_more_workers_than_the_scheduler_can_serve_wait_for_it() -> None:
    assert study.estimate([3.0], tests=100, count=100, each=1.0, sent=0.0, given=0.0) == pytest.approx(103.0)


def test_more_than_the_link_can_carry_waits_for_it() -> None:
    """Each worker begins when it has been sent its share; what each gives back takes a second of the link."""
    found = study.estimate([3.0], tests=100, count=100, each=0.0, sent=study.LINK, given=study.LINK)
    assert found == pytest.approx(1.0 + 3.0 + 100.0)


def test_products_are_compared_without_what_is_of_the_run(tmp_path: Path) -> None:
    for name, log in (("one", "now"), ("two", "later")):
        for file, text in (("report.html", "page"), ("run.log", log)):
            (tmp_path / name / "G0").mkdir(parents=True, exist_ok=True)
            (tmp_path / name / "G0" / file).write_text(text)
    assert study.products(tmp_path / "one", ["G0"]) == study.products(tmp_path / "two", ["G0"])
    (tmp_path / "two" / "G0" / "report.html").write_text("another")
    assert study.products(tmp_path / "one", ["G0"]) != study.products(tmp_path / "two", ["G0"])
