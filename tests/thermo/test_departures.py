"""Another table of nitrous oxide: what departs, by how much, and that nothing else does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hfanalysis.thermo.departures import DEPARTURES, MIDDLE, OVER, Departure, departed
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.saturation import Property, Saturation

TEMPERATURES = np.linspace(235.0, 300.0, 14)


def parts(source: Saturation) -> dict[str, np.ndarray]:
    """What departures are of, and the liquid's energy, of which none is."""
    u_l, h_l, h_v = (
        source.energy(p, TEMPERATURES)[0]
        for p in (Property.LIQUID_ENERGY, Property.LIQUID_ENTHALPY, Property.VAPOR_ENTHALPY)
    )
    return {
        "pressure": source.pressure(TEMPERATURES),
        "liquid": source.liquid_volume(TEMPERATURES)[0],
        "vapor": source.vapor_volume(TEMPERATURES)[0],
        "latent heat": h_v - h_l,
        "liquid's energy": u_l,
    }


@pytest.mark.parametrize("source", ["coolprop", "report"])
def test_a_table_made_of_its_samples_is_the_same(source: str) -> None:
    table = saturation(source)
    theta, values = table.samples()
    again = Saturation.from_samples(table.source, theta, values, table.critical_temperature)
    inner = slice(5, -5)  # the ends of a table may have been made with other conditions
    assert again.coefficients[:, inner, 0] == pytest.approx(table.coefficients[:, inner, 0], rel=1e-12)
    for name, value in parts(again).items():
        assert value == pytest.approx(parts(table)[name], rel=1e-8)


@pytest.mark.parametrize("by", DEPARTURES, ids=lambda by: by.name)
def test_one_property_departs_by_its_size_and_no_other(by: Departure) -> None:
    before, after = parts(saturation()), parts(departed(saturation(), by))
    expected = by.level + by.slope * (TEMPERATURES - MIDDLE) / OVER
    for name, value in after.items():
        relative = value / before[name] - 1.0
        assert relative == pytest.approx(expected if name == by.of else np.zeros_like(expected), abs=2e-8), name


def test_a_departure_of_none_is_none() -> None:
    before, after = parts(saturation()), parts(departed(saturation(), replace(DEPARTURES[0], level=0.0)))
    assert all(after[name] == pytest.approx(value, rel=1e-9) for name, value in before.items())
