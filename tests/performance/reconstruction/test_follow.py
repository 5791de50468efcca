"""The mixtures that fit a flow, and the path through them."""

from __future__ import annotations

import numpy as np
import pytest

from hfanalysis.arrays import Array
from hfanalysis.performance.reconstruction.follow import follow
from hfanalysis.performance.reconstruction.theory import MIXTURES

STEP = 0.1


def left() -> Array:
    """A curve that falls, rises between 3 and 4.5, and falls again."""
    x = np.log(MIXTURES)
    return np.interp(x, np.log([0.8, 3.0, 4.5, 60.0]), [2400.0, 1780.0, 1850.0, 1200.0])


def followed(mixture: Array, start: int) -> Array:
    rows = np.tile(left(), (mixture.size, 1))
    right = np.interp(np.log(mixture), np.log(MIXTURES), left())[:, None]
    return np.exp(follow(rows, MIXTURES, right, STEP, start).mixture[:, 0])


@pytest.mark.parametrize(("ends", "start"), [((6.0, 11.0), 0), ((3.3, 4.2), 1), ((2.8, 1.5), 2)])
def test_a_mixture_on_each_side_is_found_again(ends: tuple[float, float], start: int) -> None:
    true = np.linspace(*ends, 40)
    assert followed(true, start) == pytest.approx(true, rel=5e-3)


def test_a_path_goes_on_over_the_peak() -> None:
    true = np.linspace(3.4, 6.0, 40)
    assert followed(true, 1) == pytest.approx(true, rel=0.02)


def test_what_a_little_misses_the_peak_is_the_peak_and_what_misses_it_far_is_nothing() -> None:
    rows = np.tile(left(), (3, 1))
    near = np.array([[1800.0], [1855.0], [1800.0]])
    assert np.exp(follow(rows, MIXTURES, near, STEP, 0).mixture[1, 0]) == pytest.approx(4.5, rel=0.02)
    far = np.full((3, 1), 1000.0)
    assert np.isnan(follow(rows, MIXTURES, far, STEP, 0).mixture).all()
