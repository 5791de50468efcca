"""Roots of functions: found to what is asked, between ends of unlike signs, from Python and in compiled code."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hfanalysis.compiled import compiled, inner, law
from hfanalysis.roots import root_between, root_near

FUNCTIONS = [
    (lambda x, a: math.exp(x) - a, 5.0, -3.0, 4.0, math.log(5.0)),
    (lambda x, a: math.atan(a * (x - 0.3)), 200.0, -1.0, 9.0, 0.3),
    (lambda x, a: (x - a) ** 3, 0.7, 0.0, 1.9, 0.7),
    (lambda x, a: x**9 - a, 1e-3, 0.0, 2.0, 1e-3 ** (1.0 / 9.0)),
]


@pytest.mark.parametrize(("function", "given", "low", "high", "zero"), FUNCTIONS)
def test_a_root_is_found_to_what_is_asked(function, given, low, high, zero) -> None:  # type: ignore[no-untyped-def]
    found = root_between(function)(given, low, high, 1e-10)
    assert found == pytest.approx(zero, abs=2e-10)


def test_a_root_takes_few_evaluations() -> None:
    asked: list[float] = []

    def noted(x: float, a: float) -> float:
        asked.append(x)
        return math.exp(x) - a

    root_between(noted)(5.0, -3.0, 4.0, 1e-7)
    assert len(asked) < 14


def test_an_end_may_be_the_root_and_one_sign_has_none() -> None:
    line = root_between(lambda x, a: x - a)
    assert line(1.0, 1.0, 2.0, 1e-9) == 1.0
    assert line(2.0, 1.0, 2.0, 1e-9) == 2.0
    assert math.isnan(line(3.0, 1.0, 2.0, 1e-9))
    assert math.isnan(line(math.nan, 1.0, 2.0, 1e-9))


def test_a_guess_does_not_change_what_is_found() -> None:
    cubic = root_near(root_between(lambda x, a: x**3 - a))
    found = [cubic(8.0, 0.0, 50.0, 1e-11, guess, 0.1) for guess in (1.95, 2.1, 30.0, math.nan)]
    assert found == pytest.approx([2.0] * 4, abs=1e-10)


@inner
def _square(x: float, a: float) -> float:
    return x * x - a


_found = law(root_between(_square))


@compiled
def _root_of(a: float) -> float:
    return _found(a, 0.0, 10.0, 1e-12)


def test_compiled_code_finds_the_same() -> None:
    assert _root_of(2.0) == pytest.approx(np.sqrt(2.0), abs=1e-12)
