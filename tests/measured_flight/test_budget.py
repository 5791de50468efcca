"""The apogee's budget, on flights whose apogee is a known function of what was drawn."""

from __future__ import annotations

import numpy as np
import pytest

from hfanalysis.flight.ascent import ANGLE, APOGEE, CROSSWIND, DRAG, MASS, NOMINAL, RESULTS, THRUST_SCALE, WIND
from hfanalysis.measured_flight.budget import CURVE, WIND_AND_ANGLE, apogee_budget
from hfanalysis.performance.load_cell import ROWS

FLIGHTS = 4000


def test_shares_are_those_of_the_function() -> None:
    """3000 m by scale (45 m), mass (30 m), two curves (+/- 20 m) and the square of the wind."""
    rng = np.random.default_rng(3)
    drawn = np.tile(NOMINAL, (FLIGHTS, 1))
    scale, mass, wind, cross, angle = rng.standard_normal((5, FLIGHTS))
    drawn[:, THRUST_SCALE] += 0.01 * scale
    drawn[:, MASS], drawn[:, WIND], drawn[:, CROSSWIND] = 0.3 * mass, 2.0 * wind, 2.0 * cross
    drawn[:, ANGLE] = np.abs(0.1 + 0.02 * angle)
    drawn[:, DRAG] = 1.0
    results = np.ones((FLIGHTS, RESULTS))
    curve = np.where(np.arange(FLIGHTS) % 2 == 1, 20.0, -20.0)
    results[:, APOGEE] = 3000.0 + 45.0 * scale - 30.0 * mass + curve - 10.0 * (wind**2 + cross**2)
    found = apogee_budget(drawn, results, 2)
    assert found is not None
    total = 45.0**2 + 30.0**2 + 20.0**2 + 100.0 * 4.0
    expected = {ROWS["gain"]: 45.0**2, "dry mass": 30.0**2, CURVE: 20.0**2, WIND_AND_ANGLE: 400.0}
    for name, variance in expected.items():
        assert found.shares[name] == pytest.approx(variance / total, abs=0.03), name
    assert found.random == pytest.approx(20.0, rel=0.1)
    assert found.non_linear == pytest.approx(0.0, abs=1e-6)


def test_flights_that_stay_on_the_pad_are_left_out() -> None:
    drawn = np.tile(NOMINAL, (FLIGHTS, 1))
    drawn[:, ANGLE] = 0.1
    drawn[:, MASS] = np.random.default_rng(4).standard_normal(FLIGHTS)
    results = np.ones((FLIGHTS, RESULTS))
    results[:, APOGEE] = np.where(np.arange(FLIGHTS) % 10, 3000.0 - 5.0 * drawn[:, MASS], -1.0)
    found = apogee_budget(drawn, results)
    assert found is not None
    assert found.shares == pytest.approx({"dry mass": 1.0})
