"""A nozzle whose flow leaves the wall."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from hfanalysis.engine.nozzle import expand
from hfanalysis.engine.separation import (
    ONE_DIMENSIONAL,
    SEPARATED,
    expand_by,
    onset,
    separation_pressure,
    thrusts,
)

AMBIENT, GAMMA, RT = 101_325.0, 1.25, 8e5
THROAT, EXIT = pi * 23.3e-3**2, pi * 38.1e-3**2
NOZZLE = (AMBIENT, THROAT, EXIT)


def test_above_the_onset_both_laws_are_one() -> None:
    begins = onset(GAMMA, *NOZZLE)
    assert 5e5 < begins < 7e5
    for pressure in (1.001 * begins, 2.0 * begins, 10.0 * begins):
        assert expand_by(SEPARATED, GAMMA, RT, pressure, *NOZZLE) == expand(GAMMA, RT, pressure, *NOZZLE)


def test_the_wall_s_pressure_is_schmucker_s_where_the_flow_leaves() -> None:
    _, _, mach, wall, _ = expand_by(SEPARATED, GAMMA, RT, 4e5, *NOZZLE)
    assert wall / AMBIENT == pytest.approx(separation_pressure(mach), rel=1e-5)
    assert wall / AMBIENT == pytest.approx((1.88 * mach - 1.0) ** -0.64, rel=1e-5)


@pytest.mark.parametrize("pressure", [2.2e5, 3e5, 4e5, 5e5])
def test_a_separated_flow_thrusts_more_than_a_shock_and_less_than_the_best_nozzle(pressure: float) -> None:
    """The best one ends where its flow is at ambient pressure."""
    found = expand_by(SEPARATED, GAMMA, RT, pressure, *NOZZLE)[1]
    best = max(expand(GAMMA, RT, pressure, AMBIENT, THROAT, r * THROAT)[1] for r in np.linspace(1.0, 2.7, 200))
    assert expand(GAMMA, RT, pressure, *NOZZLE)[1] < found < best


def test_it_is_a_nozzle_that_ends_where_the_flow_leaves() -> None:
    flow, thrust, mach, wall, _ = expand_by(SEPARATED, GAMMA, RT, 4e5, *NOZZLE)
    cut = next(r for r in np.linspace(1.0, 2.7, 20_000) if expand(GAMMA, RT, 4e5, 1e3, THROAT, r * THROAT)[2] >= mach)
    full = expand(GAMMA, RT, 4e5, 1e3, THROAT, cut * THROAT)
    assert thrust == pytest.approx(full[1] - (AMBIENT - 1e3) * cut * THROAT, rel=1e-3)
    assert (flow, wall) == (pytest.approx(full[0], rel=1e-3), pytest.approx(full[3], rel=1e-3))


def test_the_thrust_has_no_jump_that_counts() -> None:
    pressure = np.linspace(1.05e5, 8e5, 3000)
    for law in (ONE_DIMENSIONAL, SEPARATED):
        found = thrusts(law, np.full(pressure.size, GAMMA), pressure, *NOZZLE)
        assert np.abs(np.diff(found)).max() < 3e-3 * found[-1]
