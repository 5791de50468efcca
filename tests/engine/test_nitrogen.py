"""Nitrogen in the tank, against its equation of state."""

from __future__ import annotations

import pytest
from CoolProp.CoolProp import PropsSI

from hfanalysis.engine.closure import NITROGEN_CV, SPECIFIC_NITROGEN


@pytest.mark.parametrize("temperature", [220.0, 260.0, 300.0])
def test_its_heat_capacity_and_gas_constant_are_those_of_the_thin_gas(temperature: float) -> None:
    capacity = PropsSI("CVMASS", "T", temperature, "P", 1e4, "Nitrogen")
    constant = 1e4 / (PropsSI("DMASS", "T", temperature, "P", 1e4, "Nitrogen") * temperature)
    assert pytest.approx(capacity, rel=3e-3) == NITROGEN_CV
    assert pytest.approx(constant, rel=1e-3) == SPECIFIC_NITROGEN
