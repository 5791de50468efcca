"""The reconstruction of burns whose mixture is known."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pytest
from simulated.mixtures import Burn, World, burn
from tests.products.cf import check
from tests.products.filled import filled
from tests.segment.stand import definition

from hfanalysis.errors import AbsentError
from hfanalysis.performance.reconstruction.inputs import Shape
from hfanalysis.performance.reconstruction.reconstruct import Reconstructed, reconstruct
from hfanalysis.performance.reconstruction.written import write_reconstructed
from hfanalysis.products import netcdf
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import CONDITIONAL, Quantity
from hfanalysis.record.sections import Chamber, GrainSection
from hfanalysis.units import Value

LEAN = World(mixture=8.0, erodes=2e-4, noise=0.002)


def inside(found: Reconstructed, name: str, true: Any, made: Burn) -> float:
    _, low, high = found.histories[name]
    at = np.interp(found.time, made.time, true)
    return float(np.mean((at >= low) & (at <= high)))


def test_a_lean_burn_is_found_again_with_its_efficiency_and_exponent() -> None:
    made = burn(LEAN, 5)
    found = reconstruct(made.test)
    product = found.product
    assert product.variant == "d"
    assert product.told is not None
    assert product.told > 0.9
    of_ratio = found.histories["of_ratio"][0]
    assert np.median(np.abs(of_ratio / np.interp(found.time, made.time, made.of_ratio) - 1.0)) < 0.05
    assert inside(found, "of_ratio", made.of_ratio, made) > 0.9
    assert inside(found, "throat_radius", made.throat, made) > 0.9
    assert inside(found, "c_star_efficiency", made.efficiency, made) > 0.9
    assert product.n is not None
    assert product.n.interval is not None
    assert product.n.interval[0] < made.exponent < product.n.interval[1]
    assert product.throat_radius_change is not None
    assert product.throat_radius_change.value == pytest.approx(2e-4, abs=1e-4)


def test_a_rich_burn_near_the_peak_is_marked() -> None:
    found = reconstruct(burn(World(mixture=4.8, noise=0.002), 5).test)
    assert found.product.told is not None
    assert found.product.told < 0.5


def test_without_the_fuel_an_efficiency_is_assumed_and_said() -> None:
    made = burn(replace(LEAN, weighed=False), 5)
    found = reconstruct(made.test)
    assert found.product.variant == "a"
    assert "assumed" in str(found.product.assumption)
    assert found.product.of_ratio_mean is not None
    assert found.product.of_ratio_mean.verdict == CONDITIONAL
    assert inside(found, "of_ratio", made.of_ratio, made) > 0.9


def test_wrong_masses_and_radii_give_a_reason_and_no_curve() -> None:
    made = burn(LEAN, 5)
    observed = made.test.definition.observed
    assert observed is not None
    grain = made.test.definition.grain
    assert grain is not None
    assert grain.mass is not None
    object.__setattr__(observed, "fuel_mass_after", Value(0.97 * grain.mass.value, 1e-3))
    assert "no c* efficiency" in str(reconstruct(made.test).product.reason)
    object.__setattr__(observed, "fuel_mass_after", Value(1.1 * grain.mass.value, 1e-3))
    assert "none burnt" in str(reconstruct(made.test).product.reason)
    again = burn(LEAN, 5)
    object.__setattr__(again.test.definition.observed, "throat_radius_after", Value(0.011, 1e-5))
    assert "cannot shrink" in str(reconstruct(again.test).product.reason)


def test_a_gauge_in_doubt_gives_none() -> None:
    made = burn(LEAN, 5)
    channel = made.test.log["p_chamber"]
    made.test.log.__setitem__("p_chamber", replace(channel, doubt=1e4))  # type: ignore[attr-defined]
    found = reconstruct(made.test)
    assert "in doubt" in str(found.product.reason)
    assert not found.histories


def test_fuel_that_leaves_the_nozzle_after_the_window_is_a_bound_and_an_efficiency_assumed() -> None:
    made = burn(LEAN, 5)
    nitrogen = replace_segments(made.test, t_purge=2.0)
    found = reconstruct(nitrogen)
    assert found.product.variant == "a"
    assert "may have burnt after" in str(found.product.assumption)
    assert found.product.window is not None
    assert found.product.window[1] < 2.0
    assert inside(found, "of_ratio", made.of_ratio, made) > 0.9


def replace_segments(test: Any, **times: float) -> Any:
    known = {"t_feed": 0.1, **times}
    return SimpleNamespace(**{**vars(test), "segments": SimpleNamespace(time=known.get)})


def test_thrust_tells_the_throat_from_its_radius_before_on() -> None:
    made = burn(replace(LEAN, erodes=6e-4, calipered=False), 5)
    found = reconstruct(made.test)
    assert found.product.variant == "d"
    change = found.product.throat_radius_change
    assert change is not None
    assert change.interval is not None
    assert change.interval[0] < 6e-4 < change.interval[1]
    assert change.interval[1] - change.interval[0] < 6e-4
    untold = reconstruct(burn(replace(LEAN, erodes=6e-4, calipered=False, thrust=False), 5).test)
    assert untold.product.variant == "b"
    assert untold.product.throat_radius_change is not None
    assert untold.product.throat_radius_change.value is None
    assert inside(untold, "throat_radius", made.throat, made) > 0.9


def test_a_calibration_without_a_law_is_enough() -> None:
    grain = GrainSection(mass=Value(1.6), length=Value(0.6), density=Value(800.0), outer_radius=Value(0.04))
    stated = definition(grain=grain, chamber=Chamber(pre_volume=Value(2e-4), post_volume=Value(9e-4)))
    calibration = filled(Calibration, {"C_i": Quantity(0.3), "K_loss": Quantity(0.0), "oxidizer_mass": Quantity(8.0)})
    shape = Shape.of_test(stated, calibration, 50e5)
    assert shape.fuel_mass == pytest.approx(1.6)
    assert shape.dead_volume == pytest.approx(1.1e-3)
    with pytest.raises(AbsentError, match="pre_volume"):
        Shape.of_test(definition(grain=grain), calibration, 50e5)


def test_it_is_written_with_its_bands(tmp_path: Any) -> None:
    found = reconstruct(burn(LEAN, 5).test)
    with netcdf.product(tmp_path / "performance.h5", "reconstructed", {"version": "1"}) as file:
        netcdf.axis(file, "time", np.arange(5.0))
        write_reconstructed(file, found)
    check(tmp_path / "performance.h5")
    with h5py.File(tmp_path / "performance.h5") as file:
        group = file["reconstructed"]
        assert group.attrs["variant"] == "d"
        for name in ("of_ratio", "fuel_flow", "regression_rate", "port_radius", "oxidizer_flux", "c_star",
                     "c_star_efficiency", "throat_radius"):  # fmt: skip
            low, value, high = (group[f"{name}{end}"][:] for end in ("_low95", "", "_high95"))
            assert (low <= value).all()
            assert (value <= high).all()
            assert group[name].attrs["units"]


def test_a_gauge_that_reads_no_pressure_within_the_burn_is_said() -> None:
    made = burn(LEAN, 5).test
    time = made.time
    dead = np.where((time > 2.0) & (time < 3.0), -2e5, made.measured["p_chamber"])
    changed: Any = SimpleNamespace(**{**vars(made), "measured": {**made.measured, "p_chamber": dead}})
    found = reconstruct(changed)
    assert found.product.variant is None
    assert "reads no pressure" in str(found.product.reason)
