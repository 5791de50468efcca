"""Where a fit ends is an answer: it hangs neither on the last digits of the data nor on where the fit came from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.inference import made

from hfanalysis.diagnose.naming.catalogue import Catalogue
from hfanalysis.diagnose.naming.naming import name_effects
from hfanalysis.effects import effect
from hfanalysis.inference.candidate import Bench, candidate
from hfanalysis.inference.fitting.fit import ENDED, Fit, fit
from hfanalysis.inference.fitting.form import FINEST
from hfanalysis.inference.fitting.trust import learnt
from hfanalysis.inference.observations.observed import Observed

Array = NDArray[np.float64]

ALLOWED = 0.02
"""Of its standard deviation, by which a number may move."""

HIDDEN = effect("tank_heat").at(power=3000.0)
CATALOGUE = Catalogue({name: effect(name) for name in ("nozzle_throat_erosion", "tank_heat")}, {})


def nudged(test: Observed, seed: int) -> Observed:
    """The observations with other last digits."""
    rng = np.random.default_rng(seed)
    return replace(
        test,
        channels=tuple(
            replace(c, value=c.value * (1.0 + 1e-10 * rng.standard_normal(c.value.size))) for c in test.channels
        ),
    )


def moved(one: Fit, other: Fit) -> float:
    """How far a fit's numbers are from another's, in their standard deviations: the farthest of them."""
    return max(abs(other.values[name] - value) / one.stds[name] for name, value in one.values.items())


def test_a_naming_does_not_hang_on_last_digits() -> None:
    test = made.observed(HIDDEN)
    first, second = (name_effects(made.hypothesis(), nudged(test, seed), CATALOGUE) for seed in (1, 2))
    assert first.named.names == second.named.names == ("tank_heat",)
    assert moved(first.named.fit, second.named.fit) < ALLOWED


@pytest.mark.parametrize("start", [None, made.truth()])
@pytest.mark.parametrize("seed", [1, 2])
def test_fits_from_elsewhere_end_at_the_same_place(start: Array | None, seed: int) -> None:
    """Also those that began 0.3 deviations of their priors away; of a model that lacks nothing."""
    test = made.observed()
    bench, rng = Bench(test), np.random.default_rng(seed)
    told = bench.told(candidate((), fit(made.hypothesis(), test), FINEST)).fit
    begun = (np.zeros(told.x.size) if start is None else start) + 0.3 * rng.standard_normal(told.x.size)
    again = bench.told(candidate((), fit(made.hypothesis(), test, begun), FINEST)).fit
    assert told.within == again.within == ENDED
    assert moved(told, again) < ALLOWED


def test_curvature_is_learnt_from_how_the_gradient_changes() -> None:
    rng = np.random.default_rng(0)
    true = np.diag([1.0, 4.0, 100.0])
    step = rng.standard_normal(3)
    found = learnt(3.0 * true + 0.1, step, true @ step)
    assert found @ step == pytest.approx(true @ step)
    assert found == pytest.approx(found.T)
    assert (np.linalg.eigvalsh(found) > 0.0).all()
    assert (learnt(true, np.ones(3), -np.ones(3)) == true).all()  # a hilltop is no valley's floor
