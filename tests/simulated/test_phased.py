"""Logs whose phases are known, and how the study of their intervals tells what it found."""

from __future__ import annotations

from benchmarks.phase_coverage import EVENTS, held, lines
from simulated.phased import as_found, draw


def test_a_drawn_log_has_its_events_in_order_and_they_are_found() -> None:
    case = draw(1)
    assert case.drawn == draw(1).drawn
    true = case.truth
    assert 0.0 < true["t_feed"] < true["t_fuel_out"] < true["t_fuel_gone"] < true["t_v"] < true["t_end"]
    found = as_found(case)["found"]
    assert all(abs(found[name]["value"] - true[name]) < 4.0 * found[name]["std"] for name in EVENTS)


def test_an_event_that_is_not_found_or_not_there_counts_for_no_interval() -> None:
    kind = {
        "rate": 20.0, "jitter": 0.0, "bits": 0, "slow": 0.0, "lag": 0.0, "fuel": "left", "fade": 1.0, "purge": "late",
        "firings": 1,
    }  # fmt: skip
    there, absent = {"value": 1.0, "ci95": [0.9, 1.1]}, {"value": None}
    pairs = [(1.05, there), (1.2, there), (None, there), (1.0, absent)]
    results = [{"kind": kind, "truth": dict.fromkeys(EVENTS, t), "found": dict.fromkeys(EVENTS, f)} for t, f in pairs]
    assert held(results, "t_v") == (1, 2)
    table = list(lines(results))
    assert table[3] == "| all | " + " | ".join(["50 (2)"] * len(EVENTS)) + " |"
    assert table[-2].endswith("| 1 | 1 | 1 | 1 | 1 | 1 |")
    assert table[-1].endswith("| 1 | 1 | 1 | 1 | 1 | 1 |")
