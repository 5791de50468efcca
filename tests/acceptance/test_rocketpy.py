"""RocketPy flies the exported motor as high as we do, and has the rocket's balance where we have it.

It runs in a process of its own, in which a warning is an error: with the Python of the environment variable
HFA_ROCKETPY, or of .venv-rocketpy, which `make test` sets up. Without one these tests skip, unless
HFA_REQUIRE_ROCKETPY is set: then its absence is a failure.
"""

from __future__ import annotations

import csv
import json
import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.cli.run import hfa
from tests.cli.shaped import GEOMETRY, engine

from hfanalysis.flight.ascent import RAIL, SPEED, Ascent, ascend
from hfanalysis.measured_flight.firing import firing
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.record.log import read_log
from hfanalysis.rocket.aerodynamics import Fins, Nose, Shape, Tail, center_of_pressure, components
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

ROOT = Path(__file__).resolve().parents[2]


def interpreter() -> str:
    """Of a Python that has RocketPy."""
    own = ROOT / ".venv-rocketpy"
    stated = os.environ.get("HFA_ROCKETPY") or (str(own / "bin" / "python") if (own / ".set-up").exists() else None)
    if stated is None:
        missing = pytest.fail if os.environ.get("HFA_REQUIRE_ROCKETPY") else pytest.skip
        missing("no RocketPy: make rocketpy installs it, or HFA_ROCKETPY names a Python that has it")
    return stated


def asked(code: str) -> list[float]:
    """What a Python with RocketPy answers with a list of numbers."""
    ended = subprocess.run([interpreter(), "-W", "error", "-c", code], capture_output=True, text=True, check=True)
    found: list[float] = json.loads(ended.stdout.splitlines()[-1])
    return found


@pytest.fixture(scope="module", params=["", GEOMETRY], ids=["bare", "with its geometry"])
def exported(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Ascent]:
    """The script of a replica, and our flight of it straight up."""
    interpreter()
    root = tmp_path_factory.mktemp("exported")
    folder = root / "raw_tests" / "HF5"
    shutil.copytree(ROOT / "raw_tests" / "HF5", folder)
    volume = 'volume = "16.5 L"\n'
    text = (folder / "test.toml").read_text().replace(volume, f'{volume}inner_diameter = "128 mm"\n')
    (folder / "test.toml").write_text(text + request.param)
    context = run_to("flight", open_test(root, "HF5", settings={"flight.flights": 100, "flight.gust_seeds": 2}))
    segments = context.read(Segments)
    log, calibration = read_log(context.product("ingest.h5")), context.read(Calibration)
    found = firing(log, segments, calibration, context.definition)
    upright = replace(found.vehicle, launch_angle=0.0)
    return context.out / "HF5_rocketpy.py", ascend(found.curve, upright, found.rail_length)


def test_it_reaches_the_same_apogee_straight_up_without_wind(exported: tuple[Path, Ascent]) -> None:
    script, ours = exported
    code = (
        f"import runpy, json; s = runpy.run_path({str(script)!r}); f = s['fly'](90.0); "
        "print(json.dumps([f.apogee - s['ELEVATION'], f.apogee_time, f.out_of_rail_velocity, f.max_speed]))"
    )
    apogee, time, rail, peak = asked(code)
    assert apogee == pytest.approx(ours.height, rel=0.01)
    assert time == pytest.approx(ours.end[0], rel=0.01)
    assert rail == pytest.approx(ours.results[RAIL], rel=0.01)
    assert peak == pytest.approx(ours.results[SPEED], rel=0.01)


def test_the_script_runs_by_itself(exported: tuple[Path, Ascent]) -> None:
    ended = subprocess.run([interpreter(), "-W", "error", str(exported[0])], capture_output=True, text=True, check=True)
    assert "apogee above ground" in ended.stdout


def test_it_reads_the_engine_files(exported: tuple[Path, Ascent]) -> None:
    folder = exported[0].parent
    code = (
        "import json; from rocketpy import GenericMotor as G; "
        f"m = G.load_from_eng_file({str(folder / 'HF5.eng')!r}, nozzle_radius=0.0381); "
        f"n = G.load_from_rse_file({str(folder / 'HF5.rse')!r}, nozzle_radius=0.0381); "
        "print(json.dumps([float(m.total_impulse), float(n.total_impulse), float(m.propellant_initial_mass)]))"
    )
    eng, rse, propellant = asked(code)
    ours = exported[1]
    impulse = float(np.trapezoid(ours.column("thrust"), ours.column("time")))
    assert [eng, rse] == pytest.approx([impulse, impulse], rel=5e-3)
    assert propellant == pytest.approx(9.944, rel=1e-3)


def test_slopes_and_margin_are_rocketpy_s() -> None:
    """Halcyon's shape at Mach 0.3; both are to agree within 2 %."""
    code = (
        "import json; from rocketpy import Rocket; "
        "r = Rocket(radius=0.0762, mass=14.613, inertia=(9, 9, 0.05), power_off_drag=0.4, power_on_drag=0.4, "
        "center_of_mass_without_motor=2.344, coordinate_system_orientation='tail_to_nose'); "
        "r.add_nose(length=0.46, kind='von karman', position=3.556); "
        "r.add_trapezoidal_fins(n=4, root_chord=0.247, tip_chord=0.045, span=0.125, position=0.263); "
        "r.add_tail(top_radius=0.0762, bottom_radius=0.0496, length=0.254, position=0.254); "
        "print(json.dumps([float(r.total_lift_coeff_der(0.3)), float(r.static_margin(0))]))"
    )
    slope, margin = asked(code)
    shape = Shape(0.1524, Nose("von_karman", 0.46), 2.842, Fins(4, 0.247, 0.045, 0.125, 0.202, 3.293),
                  Tail(0.254, 0.0992, 3.302))  # fmt: skip
    assert center_of_pressure(components(shape, 0.3))[0] == pytest.approx(slope, rel=0.02)
    still = center_of_pressure(components(shape, 0.0))[1]
    assert (still - (3.556 - 2.344)) / 0.1524 == pytest.approx(margin, rel=0.02)


BALANCE = """
import csv, json, sys
import numpy as np
from rocketpy import CylindricalTank, Fluid, HybridMotor, MassBasedTank, Rocket

rows = list(csv.DictReader(sys.stdin))
column = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
once = np.diff(column["time [s]"], prepend=-1.0) > 1e-6
time = column["time [s]"][once]
points = lambda values: np.column_stack([time, values[once]]).tolist()
liquid, held = column["liquid_mass [kg]"], column["tank_mass [kg]"]
LENGTH, HEIGHT, BORE = 4.24, float(sys.argv[1]), 0.039497
aft = lambda place: LENGTH - place  # from the tail
tank = MassBasedTank(
    name="tank", geometry=CylindricalTank(0.064097, HEIGHT), flux_time=float(time[-1]),
    liquid=Fluid("liquid", 743.0), gas=Fluid("vapor", 260.0),  # saturated at 25 degC
    liquid_mass=points(liquid), gas_mass=points(np.maximum(held - liquid, 0.0)),
)
motor = HybridMotor(
    thrust_source=points(column["thrust [N]"]), burn_time=float(time[-1]), dry_mass=12.5, dry_inertia=(0, 0, 0),
    nozzle_radius=0.0381, throat_radius=0.0233, nozzle_position=0.0, center_of_dry_mass_position=aft(3.1),
    grain_number=1, grain_separation=0.0, grain_outer_radius=BORE, grain_initial_height=0.61, grain_density=900.0,
    grain_initial_inner_radius=float(column["port_radius [m]"][0]),
    grains_center_of_mass_position=aft(3.4 + 0.218e-3 / (np.pi * BORE**2) + 0.305),
    coordinate_system_orientation="nozzle_to_combustion_chamber",
)
motor.add_tank(tank, position=aft(2.1 + 0.5 * HEIGHT))
rocket = Rocket(
    radius=0.07874, mass=40.0, inertia=(50, 50, 1), power_off_drag=0.5, power_on_drag=0.5,
    center_of_mass_without_motor=aft(1.75), coordinate_system_orientation="tail_to_nose",
)
rocket.add_motor(motor, position=0.0)
rocket.add_nose(length=0.6, kind="ogive", position=LENGTH)
rocket.add_trapezoidal_fins(n=4, root_chord=0.30, tip_chord=0.12, span=0.16, position=aft(3.94))
asked = np.linspace(0.0, time[-1], 9)
print(json.dumps([[LENGTH - float(rocket.center_of_mass(t)), float(rocket.static_margin(t))] for t in asked]))
"""
"""The rocket of tests/cli/shaped.py as RocketPy has hybrids: tank, grain and empty engine, each where it is."""


def test_balance_and_margin_of_a_simulated_engine_are_rocketpy_s_within_2_percent(tmp_path: Path) -> None:
    interpreter()
    assert hfa("simulate", engine(tmp_path), "--out", tmp_path / "out", "--quiet").status == 0
    table = (tmp_path / "out" / "histories.csv").read_text()
    found = json.loads((tmp_path / "out" / "simulate.json").read_text())
    call = [interpreter(), "-c", BALANCE, repr(found["tank_length"]["value"])]
    said = subprocess.run(call, input=table, capture_output=True, text=True, check=True).stdout
    theirs = np.array(json.loads(said.splitlines()[-1]))
    rows = list(csv.DictReader(table.splitlines()))
    time = np.array([float(row["time [s]"]) for row in rows])
    asked = np.linspace(0.0, time[-1], 9)
    for name, column in (("center_of_gravity [m]", theirs[:, 0]), ("static_margin [calibers]", theirs[:, 1])):
        ours = np.interp(asked, time, [float(row[name]) for row in rows])
        assert ours == pytest.approx(column, rel=0.02), name
