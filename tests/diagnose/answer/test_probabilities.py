"""The constants of the probabilities are fitted to the probabilities that are stated."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.blind.fit import PRIOR_STD, Constants, Sample, _loss, _table, _vector

from hfanalysis.diagnose.answer.posterior import above_chance


@pytest.mark.parametrize("unknown", [12.0, 7.0, -6.0])
@pytest.mark.parametrize("name", [20.0, 5.1, 4.0, -8.0])
def test_the_fit_counts_the_probabilities_that_are_stated(name: float, unknown: float) -> None:
    """Also where nothing is seen, and unknown is at most as probable as none, and where all evidence is faint."""
    at = Constants(1.5, 0.4, -1.0, 2.0, 0.05, -2.5, -1.5, 0.2, 0.3)
    evidences = {"none": 0.0, "tank_heat": name, "n2_purge": -1.0, "unknown": unknown}
    stated = at.probabilities(evidences, 1.8)
    penalty = 0.5 * float(np.sum((_vector(at) / PRIOR_STD) ** 2))
    for label, p in stated.items():
        assert _loss(_vector(at), _table([Sample(evidences, 1.8, label, "g")])) - penalty == pytest.approx(-np.log(p))
    assert above_chance(evidences) or stated["unknown"] <= stated["none"]
