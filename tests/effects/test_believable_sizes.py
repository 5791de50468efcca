"""How large an effect may be before it is hard to believe, by what is on stands."""

from __future__ import annotations

import pytest

from hfanalysis.diagnose.answer.plausible import judged, size_of
from hfanalysis.effects import effect, library

SIZES = {
    "tank_heat": ("power", 5e3, 20e3),  # 10 kg of aluminum give 11 K away in 20 s; 45 kg of it do
    "tank_wall_heat_capacity": ("capacity", 12 * 900.0, 60 * 900.0),  # 12 kg of aluminum; 60 kg of it round 20 L
    "tank_nonequilibrium": ("depth", 5e5, 20e5),  # Zimmerman's cold flows; half of the tank's pressure
    "tank_stratification": ("excess", 6.0, 25.0),  # a tank in the sun; from a cool cellar to beyond the critical point
    "n2_purge": ("area", 12e-6, 80e-6),  # a bore of 4 mm; of 10 mm, wider than any check valve of a purge line
    "feed_line_fill": ("volume", 0.4e-3, 3e-3),  # 3 m of 13 mm; 23 m of it
    "injector_two_phase": ("weight", 0.6, 1.5),  # between liquid and equilibrium; more than in equilibrium
    "injector_choked_vapor": ("weight", 0.8, 1.5),
    "combustion_efficiency": ("deficit", 0.12, 0.4),  # a usual hybrid; one in which hardly half of the heat comes out
    "chamber_heat_loss": ("loss", 1e5, 1.5e6),  # a tenth of a megawatt; as much as the engine burns
    "grain_pressure_regression": ("exponent", 0.3, 1.0),  # classical fuels of radiating flames; a solid propellant
    "ignition_transient": ("mass", 0.05, 0.5),  # a charge of 50 g; as much as a third of the grain
    "fuel_sliver": ("depth", 0.6, 1.5),
    "head_end_pressure": ("weight", 0.9, 1.5),  # a port of the throat's area; more than momentum has
    "nozzle_throat_erosion": ("rate", 1.5e-4, 1e-3),  # graphite; a millimeter a second
    "nozzle_divergence": ("loss", 0.017, 0.3),  # a cone of 15 degrees loses (1 - cos 15)/2; none of 60 degrees is built
    "load_cell_drift": ("drift", 150.0, 1500.0),  # some per cent of 3 kN; half of it
    "pressure_transducer_offset": ("p_tank", 0.7e5, 10e5),  # 1 % of 70 bar; 10 bar with the tank empty
    "chamber_tap_lag": ("lag", 0.05, 1.5),  # a meter of tube; longer than the start takes
}
"""A strength [SI] that stands have had or have by what is on them, and one that none has."""


def test_every_effect_of_the_library_has_both() -> None:
    assert set(SIZES) == set(library())


ONE_SIGN = ("combustion_efficiency", "nozzle_divergence")
"""Losses that can be no gain, though their parameters may be negative: beyond what tables know."""


@pytest.mark.parametrize("name", SIZES)
def test_sizes_that_stands_have_are_believed_and_those_that_none_has_are_not(name: str) -> None:
    parameter, possible, impossible = SIZES[name]
    assert parameter in [p.name for p in effect(name).parameters]
    for sign in (1.0, -1.0):
        can_be = sign > 0.0 or name not in ONE_SIGN
        assert judged(size_of(effect(name).at(**{parameter: sign * possible}))).plausible is can_be
        assert (size_of(effect(name).at(**{parameter: sign * possible})).lost == 0.0) is can_be
        assert judged(size_of(effect(name).at(**{parameter: sign * impossible}))).plausible is False
        assert size_of(effect(name).at(**{parameter: sign * impossible})).lost > 1.0


def test_a_size_of_ten_times_the_believable_is_as_good_as_excluded() -> None:
    """The odds are a million to one against it, and no size costs more than some millions to one."""
    assert 13.0 < size_of(effect("nozzle_throat_erosion").at(rate=4e-3)).lost < 17.0
    assert size_of(effect("nozzle_throat_erosion").at(rate=4.0)).lost < 17.0
