"""flight.json and flight.h5 of a rocket on a made-up firing."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.products.cf import check
from tests.segment.stand import definition, fire, log_of, segments_of

from hfanalysis.measured_flight.firing import firing
from hfanalysis.measured_flight.product import MeasuredFlight, fly_measured, product, write_histories
from hfanalysis.record.rocket import MainParachute, ParachuteSection, Rocket
from hfanalysis.record.sections import GrainSection
from hfanalysis.units import Value

GROUND = 1402.0
ROCKET = Rocket(
    dry_mass=Value(40.0, 0.3),
    drag_coefficient=0.5,
    frontal_area=Value(0.02),
    launch_angle=Value(np.radians(5.0)),
    rail_length=Value(6.0),
    launch_altitude=Value(GROUND),
    drogue=ParachuteSection(drag_coefficient=1.5, area=Value(1.2)),
    main=MainParachute(drag_coefficient=2.2, area=Value(10.0), deploy_altitude=Value(450.0)),
)


@cache
def flown() -> MeasuredFlight:
    test = fire(rate=200.0)
    stated = definition(mass=Value(10.0, 0.04), grain=GrainSection(mass=Value(1.6, 0.03)), rocket=ROCKET)
    return fly_measured(firing(log_of(test, accuracy=20.0), segments_of(test), None, stated), ROCKET, 400, 1)


def test_the_wet_mass_is_as_well_known_as_its_parts_together() -> None:
    """40 kg to 0.3, 10 kg of oxidizer to 0.04 and 1.6 kg of fuel to 0.03."""
    found = product(flown(), ROCKET, "no geometry").wet_mass
    assert found.value == pytest.approx(51.6)
    assert found.std == pytest.approx(np.sqrt(0.3**2 + 0.04**2 + 0.03**2))


def test_thrust_to_weight_and_means_are_those_of_the_curve() -> None:
    found = product(flown(), ROCKET, "no geometry").quantities
    curve = flown().firing.curve
    weight = 51.6 * 9.80665 * (6_371_000.0 / (6_371_000.0 + GROUND)) ** 2
    assert found["pad_thrust_to_weight"].value == pytest.approx(
        float(flown().ascent.column("thrust").max()) / weight, rel=1e-4
    )
    impulse = float(np.trapezoid(curve.thrust, curve.time))
    assert found["total_impulse"].value == pytest.approx(impulse, rel=1e-3)
    assert found["average_thrust"].value == pytest.approx(impulse / curve.time[-1], rel=1e-3)


def test_stated_deviations_are_those_of_the_drawn_flights() -> None:
    """By the one law by which it flies; the other that may hold is left aside."""
    alone = replace(flown().firing, curves=(flown().firing.curve,))
    launched = fly_measured(alone, ROCKET, 400, 1)
    found, drawn = product(launched, ROCKET, "no geometry").apogee, launched.dispersion.results
    assert found.std == pytest.approx(drawn[:, 0].std(), rel=0.01)
    low, high = found.ci95
    assert np.mean((drawn[:, 0] >= low) & (drawn[:, 0] <= high)) == pytest.approx(0.95, abs=0.01)


def test_heights_count_from_the_ground(tmp_path: Path) -> None:
    write_histories(tmp_path / "flight.h5", flown(), "no geometry", {})
    apogee = product(flown(), ROCKET, "no geometry").apogee.value
    check(tmp_path / "flight.h5")
    with h5py.File(tmp_path / "flight.h5") as file:
        assert file["ascent/height"][0] == pytest.approx(0.0, abs=0.1)
        assert np.max(file["ascent/height"]) == pytest.approx(apogee, rel=1e-3)
        for leg, lands in (("drogue", 450.0), ("main", 0.0), ("ballistic", 0.0)):
            assert file[f"{leg}/height"][-1] == pytest.approx(lands, abs=1.0), leg
        assert file["drogue/height"][0] == pytest.approx(apogee, rel=1e-3)
        middle = np.interp(5.0, file["bands/time"], file["bands/height_median"])
        assert middle == pytest.approx(np.interp(5.0, file["ascent/time"], file["ascent/height"]), rel=0.02)
