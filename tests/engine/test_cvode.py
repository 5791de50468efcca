"""The own integrator against CVODE on the same equations."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.cvode import burn_by_cvode
from tests.engine.stand import engine_on_stand

from hfanalysis.effects import effect
from hfanalysis.engine.equations import IMPULSE, TANK
from hfanalysis.engine.phases import FUEL_OUT, LIQUID_OUT
from hfanalysis.engine.unsteady import Engine, burn


@pytest.mark.parametrize(
    "engine",
    [
        engine_on_stand(),
        engine_on_stand(
            effects=(effect("tank_heat").at(power=900.0), effect("n2_purge").at(area=4e-6, supply_pressure=35e5))
        ),
    ],
    ids=["plain", "heated and purged"],
)
def test_cvode_comes_to_the_same(engine: Engine) -> None:
    pytest.importorskip("sksundae", reason="scikit-sundae has no wheel for this platform")
    theirs = burn_by_cvode(engine, 10.0, run_on=True)
    ours = burn(engine, 10.0, run_on=True, times=theirs.time)
    assert ours.liquid_out == pytest.approx(theirs.events[LIQUID_OUT], abs=1e-5)
    assert ours.burn_time == pytest.approx(theirs.events[FUEL_OUT], abs=1e-5)
    for state in (TANK, IMPULSE):
        span = np.ptp(theirs.states[:, state])
        assert np.abs(ours.states[:, state] - theirs.states[:, state]).max() < 1e-5 * span
