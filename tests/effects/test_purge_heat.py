"""What nitrogen brings into the tank as it enters, against its equation of state."""

from __future__ import annotations

import numpy as np
import pytest
from CoolProp.CoolProp import PropsSI
from tests.effects.runs import with_effects

from hfanalysis.effects import effect
from hfanalysis.inference.full_run import FullRun


def test_it_brings_the_enthalpy_of_its_line_beyond_the_energy_that_it_has_in_the_tank() -> None:
    """The tank is a vessel that is filled: dU/dt = mdot h, and what is not u(T) of the tank warms it."""
    warm = 310.0
    run = with_effects(effect("n2_purge").at(area=4e-6, supply_pressure=35e5, temperature=warm))
    flow = run.output("nitrogen_inflow")
    heat = FullRun(run.steps.engine, run).factor("tank_heat", run.time)
    flowing = np.flatnonzero(flow > 0.2 * flow.max())
    assert flowing.size > 20
    for i in flowing[:: flowing.size // 10]:
        temperature = float(run.state("tank_temperature")[i])
        enthalpy = PropsSI("HMASS", "T", warm, "P", 1e4, "Nitrogen")
        energy = PropsSI("UMASS", "T", temperature, "P", 1e4, "Nitrogen")
        assert heat[i] / flow[i] == pytest.approx(enthalpy - energy, rel=0.01)
