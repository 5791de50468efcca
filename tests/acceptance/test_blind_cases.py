"""The blind generator and the package, each without the other, agree on tests without an effect."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulated.blind import combustion
from simulated.blind import slots as s
from simulated.blind import stand as st
from simulated.blind.plan import Case
from simulated.blind.write import write_case
from tests.cli import run

from hfanalysis.thermo.combustion import equilibrium


def test_a_test_without_an_effect_is_accepted_and_calibrates_to_its_truth(tmp_path: Path) -> None:
    answer = json.loads(
        write_case(Case("NONE", "none", (), 0.0, "flicker", 77, 77), tmp_path).read_text(encoding="utf-8")
    )
    done = run.hfa("calibrate", "NONE", "--root", tmp_path)
    assert done.status == 0, done.err
    product = tmp_path / "processed" / "NONE"
    found = json.loads((product / "calibration.json").read_text(encoding="utf-8"))
    segments = json.loads((product / "segments.json").read_text(encoding="utf-8"))
    truth = answer["truth"]
    assert found["C_i"]["value"] == pytest.approx(truth["C_i"], rel=0.02)
    assert found["m"]["value"] == pytest.approx(truth["m"], rel=0.05)
    assert found["K_loss"]["value"] == pytest.approx(truth["K_loss"], rel=0.1)
    assert segments["t_v"]["value"] == pytest.approx(truth["t_v"], abs=0.01)
    assert segments["t_purge"]["value"] == pytest.approx(truth["t_purge"], abs=0.05)


def engine_file(x: st.Stand) -> str:
    """A stand of the generator as an engine file, on a rocket too heavy to fly."""
    return f"""schema = 1
[engine]
id = "stand"
[tank]
oxidizer_mass = "{x.mass} kg"
temperature = "{x.temperature} K"
volume = "{x.volume} m^3"
polytropic_exponent = {x.m}
[feed]
K_loss = "{x.K_loss} 1/m^4"
[injector]
holes = {x.holes}
hole_area = "{x.hole_area} m^2"
C_i = {x.C_i}
[grain]
mass = "{x.fuel_mass} kg"
length = "{x.grain_length} m"
density = "{x.fuel_density} kg/m^3"
outer_radius = "{x.outer_radius} m"
a = {x.a}
n = {x.n}
[chamber]
pre_volume = "{x.pre_volume} m^3"
post_volume = "{x.post_volume} m^3"
[nozzle]
throat_radius = "{x.throat_radius} m"
exit_radius = "{x.exit_radius} m"
[site]
altitude = "0 m"
[rocket]
dry_mass = "1e7 kg"
drag_coefficient = 0.5
diameter = "157 mm"
launch_angle = "6 deg"
rail_length = "6.05 m"
launch_altitude = "0 m"
"""


@pytest.mark.parametrize("seed", [1, 5])
def test_two_independent_engines_agree_on_a_test_without_an_effect(seed: int, tmp_path: Path) -> None:
    stand = replace(st.draw(np.random.default_rng(seed)), ambient=101_496.0)
    (tmp_path / "stand.toml").write_text(engine_file(stand))
    done = run.hfa("simulate", tmp_path / "stand.toml", "--json")
    assert done.status == 0, done.err
    theirs, ours = json.loads(done.out), st.simulate(stand)
    assert theirs["liquid_depletion_time"]["value"] == pytest.approx(ours.t_v, abs=1e-3)
    assert theirs["peak_chamber_pressure"]["value"] == pytest.approx(ours.trace(s.P_CHAMBER).max(), rel=1e-3)
    assert theirs["peak_thrust"]["value"] == pytest.approx(ours.trace(s.THRUST).max(), rel=1e-3)
    assert theirs["total_impulse"]["value"] == pytest.approx(ours.trace(s.THRUST).sum() * 1e-3, rel=3e-3)


@pytest.mark.parametrize("ratio", [0.09, 0.15, 0.3, 0.5, 2.0, 6.0, 40.0])
@pytest.mark.parametrize("pressure", [1.1e5, 20e5])
def test_their_gases_agree_down_to_where_fuel_burns_on_with_hardly_any_oxidizer(ratio: float, pressure: float) -> None:
    ours = equilibrium(pressure, ratio, 1.7e6, 0.0)
    rt, gamma = combustion.gas(combustion.table(), 1.7e6, 0.0, pressure, ratio)
    assert rt == pytest.approx(ours.gas_constant * ours.temperature, rel=0.01)
    assert gamma == pytest.approx(ours.gamma, rel=0.01)
