"""The root finder gives what SciPy's gives, to the bit."""

from __future__ import annotations

from math import nan

import numpy as np
import pytest
from scipy.optimize import brentq

from hfanalysis.roots import root, secant


def test_roots_are_those_of_scipy() -> None:
    rng = np.random.default_rng(1)
    found = 0
    for _ in range(300):
        a, b, c, d = rng.normal(size=4)
        low, high = sorted(rng.uniform(-3.0, 3.0, 2))

        def cubic(x: float, a: float = a, b: float = b, c: float = c, d: float = d) -> float:
            return float(a * np.exp(b * x) + c * x**3 + d)

        if cubic(low) * cubic(high) > 0.0:
            with pytest.raises(ValueError, match="no change of sign"):
                root(cubic, low, high, 1e-6)
        else:
            found += 1
            assert root(cubic, low, high, 1e-6) == brentq(cubic, low, high, xtol=1e-6)
    assert found > 50


def test_an_end_may_be_the_root() -> None:
    assert root(lambda x: x, 0.0, 1.0, 1e-9) == 0.0
    assert root(lambda x: x - 1.0, 0.0, 1.0, 1e-9) == 1.0


def test_what_is_no_number_is_no_root() -> None:
    with pytest.raises(ValueError, match=r"no number at 0\.5"):
        root(lambda x: nan if x == 0.5 else x - 0.5, 0.0, 1.0, 1e-9)


def test_near_a_root_three_steps_find_it() -> None:
    asked = []

    def cubic(x: float) -> float:
        asked.append(x)
        return x**3 - 2.0

    found = secant(cubic, 1.26, 4.8, 1e-9)
    assert found == pytest.approx(2.0 ** (1.0 / 3.0), abs=1e-12)
    assert len(asked) == 3


def test_where_steps_do_not_lead_to_a_root_there_is_none() -> None:
    assert secant(lambda x: x**2 + 1.0, 3.0, 6.0, 1e-9) is None
    assert secant(lambda x: 1.0, 3.0, 6.0, 1e-9) is None
