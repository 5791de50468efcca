"""What the study of joint laws draws and counts."""

from __future__ import annotations

from typing import Any

from benchmarks import joint as study
from tests.campaign.test_common_law import A, N, law

TRUTH = {"0": {"a": 1e-4, "n": 0.5}}


def one(a: float, n: float, named: str | None = None, odd: str | None = None, agree: float = 0.5) -> dict[str, Any]:
    tests = ["J000", "J001", "J002", odd or "J003"]
    return {
        "tests": tests, "silent": [], "odd": odd, "named": named, "agree": agree,
        "a": {"value": a, "std": 1e-6, "ci95": [a - 2e-6, a + 2e-6]},
        "n": {"value": n, "std": 0.01, "ci95": [n - 0.02, n + 0.02]}, "alone": dict.fromkeys(tests, (0.45, 0.55)),
    }  # fmt: skip


def test_draws_are_of_one_stand_and_have_one_odd_test_at_most() -> None:
    draws = study.plan(400)
    assert draws == study.plan(400)
    assert {len(draw.tests) for draw in draws} == set(range(2, 11))
    for draw in draws:
        assert len({test[1] for test in draw.tests}) == 1
        assert len(set(draw.tests)) == len(draw.tests)
        assert [test for test in draw.tests if "x" in test] == ([draw.odd] if draw.odd else [])
    with_odd = [draw for draw in draws if draw.odd]
    assert 100 < len(with_odd) < 200
    assert not any(len(draw.tests) == 3 for draw in with_odd)


def test_what_is_counted() -> None:
    told = "\n".join(
        study.told(
            [
                one(1.01e-4, 0.51),
                one(1.01e-4, 0.47, named="J001", agree=1e-3),
                one(1e-4, 0.5, named="J0x1", odd="J0x1"),
                one(1e-4, 0.5, named="J002", odd="J0x1"),
                {"tests": ["J000"], "silent": ["J001"], "odd": None},
            ],
            TRUTH,
        )
    )
    assert "| mean error | +1.0 % | -0.0100 |" in told
    assert "| 95 % intervals that hold the truth | 100 % (2 of 2) | 50 % (1 of 2) |" in told
    assert "| narrower than the narrowest of the tests alone | | 100 % (2 of 2) |" in told
    assert "| one of 4 to 10 tests has another fuel: named | 50 % (1 of 2) |" in told
    assert "| another one is named there | 50 % (1 of 2) |" in told
    assert "| 4 to 10 tests of one fuel: one is named | 50 % (1 of 2) |" in told
    assert "| tests of one fuel are said to disagree | 50 % (1 of 2) |" in told
    assert "4 of 5 draws; tests that said nothing of a and n were left out 1 times." in told


def test_a_draw_is_judged_by_the_laws_of_its_tests() -> None:
    """The one of another fuel is named, and a test without a law is left out."""
    laws = {f"J00{i}": law(150.0 + 30.0 * i) for i in range(5)} | {"J0x1": law(200.0, off=0.2)}
    draw = study.Draw("D", (*laws, "J009"), "J0x1")
    judged = study.judge(draw, laws)
    assert judged["silent"] == ["J009"]
    assert judged["named"] == judged["odd"] == "J0x1"
    assert judged["agree"] < 0.01
    level = study.judge(study.Draw("D", tuple(t for t in laws if t != "J0x1"), None), laws)
    low, high = level["alone"]["J000"]
    assert level["n"]["ci95"][1] - level["n"]["ci95"][0] < high - low
    assert "two tests are needed" in study.judge(study.Draw("D", ("J000", "J009"), None), laws)["reason"]


def test_stands_are_told_one_by_one() -> None:
    """Rates of the truth do not scatter; one that is a tenth off is the odd one there."""
    laws = {f"J00{i}": law(150.0 + 30.0 * i) for i in range(5)} | {"J0x1": law(200.0, off=0.2)}
    judged = study.judge(study.Draw("D", tuple(laws), "J0x1"), laws)
    (row,) = study.by_stand([judged], laws, {"0": {"a": A, "n": N}})[2:]
    assert row == "| 0 | 0.0 % | 100 % (1 of 1) |"
