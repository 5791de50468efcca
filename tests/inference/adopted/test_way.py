"""An adopted effect is part of the model from the calibration on, and leaves no trace when it is removed."""

from __future__ import annotations

import hashlib
import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from tests.engine.stand import engine_on_stand
from tests.inference.adopted.firing import NOISE, make_root

from hfanalysis.effects import effect
from hfanalysis.engine.effect import Active
from hfanalysis.errors import InputError
from hfanalysis.stages.base import Context
from hfanalysis.stages.calibrate import STAGE, _calibration
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

ALL = "all"
"""Every stage that has adopted effects in it."""

HEAT = 4000.0
"""[W] that the log's tank received and the base model does not know of."""

SHAPE = {"lag": 0.1, "fade": 20.0, "begun": 0.0}
"""Of that heat: lag and fade [s], and the share that is there at once."""

HEATED = f'[tank_heat]\npower = "{HEAT} W"\nlag = "0.1 s"\nfade = "20 s"\nbegun = 0\n'
"""All of it, as it is adopted."""

C_I = 0.2926
"""Of the stand's injector."""

SETTINGS = {"calibrate.samples": 40, "flight.flights": 10, "flight.gust_seeds": 1, "flight.winds": [4.5]}


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log with heat into the tank and a drift of the thrust cell."""
    hidden = (effect("tank_heat").at(power=HEAT, **SHAPE), effect("load_cell_drift").at(drift=80.0, time=3.0))
    return make_root(tmp_path_factory.mktemp("root"), *hidden)


def opened(root: Path) -> Context:
    return open_test(root, "T1", settings=SETTINGS)


def done(root: Path, stage: str, adopted: str = "") -> dict[str, dict[str, Any]]:
    """JSON products after bringing a stage up to date with this file of adopted effects ("": none)."""
    path = root / "engines" / "T1.effects.toml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(adopted, encoding="utf-8") if adopted else path.unlink(missing_ok=True)
    for name in ("validate", "flight") if stage == ALL else (stage,):
        out = run_to(name, opened(root)).out
    return {p.stem: json.loads(p.read_text(encoding="utf-8")) for p in out.glob("*.json")}


def hashes(root: Path, *names: str) -> dict[str, str]:
    out = root / "processed" / "T1"
    found = names or [p.name for p in out.iterdir() if p.is_file() and p.name != "run.log"]
    return {name: hashlib.sha256((out / name).read_bytes()).hexdigest() for name in sorted(found)}


def stages_run(root: Path) -> list[str]:
    lines = (root / "processed" / "T1" / "run.log").read_text(encoding="utf-8").splitlines()
    return [json.loads(line)["stage"] for line in lines]


def numbers(product: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in product.items() if name not in ("effects", "provenance")}


def gap(products: dict[str, dict[str, Any]], mode: str) -> float:
    """Of the tank's pressure while there is liquid [Pa]."""
    return float(products["validation"]["gap"][mode]["p_tank"]["liquid"]["rms"])


@pytest.fixture(scope="module")
def base(root: Path) -> dict[str, dict[str, Any]]:
    return done(root, ALL)


def test_the_hidden_heat_is_in_the_model_once_adopted_and_out_again_once_removed(
    root: Path, base: dict[str, dict[str, Any]]
) -> None:
    before = hashes(root)
    found = done(root, ALL, HEATED.replace(f"{HEAT} W", "4 +/- 0.3 kW"))
    # what the tank lacked is there: its pressure is explained to a fraction of what it was off by
    for mode in ("full", "tank_free"):
        assert gap(base, mode) > 0.5e5
        assert gap(found, mode) < 0.3 * gap(base, mode)
    for name in ("calibration", "validation", "flight"):
        stated = found[name]["effects"]
        assert [(e["name"], e["file"]) for e in stated] == [("tank_heat", "T1.effects.toml")]
        assert stated[0]["parameters"]["power"]["value"] == HEAT
        assert stated[0]["parameters"]["power"]["std"] == 300.0
        assert base[name]["effects"] == []
    assert numbers(done(root, ALL)["validation"]) == numbers(base["validation"])
    assert hashes(root) == before


def test_m_returns_to_what_it_is_once_the_heat_is_known(root: Path, base: dict[str, dict[str, Any]]) -> None:
    found = done(root, "calibrate", HEATED)["calibration"]
    swallowed, back = base["calibration"]["m"], found["m"]
    assert abs(back["value"] - 1.1) < 0.5 * abs(swallowed["value"] - 1.1)
    assert back["value"] == pytest.approx(1.1, abs=0.03)
    assert any("fitted together" in note for note in found["notes"])


def test_what_is_fitted_together_is_true_and_the_engine_meets_every_channel(root: Path) -> None:
    """Load and temperature are those of the stand, the liquid ends when it did, and nothing is left in the chamber."""
    adopted = HEATED + '[load_cell_drift]\ndrift = "80 N"\ntime = "3 s"\n'
    found = done(root, ALL, adopted)
    calibration, stand = found["calibration"], engine_on_stand()
    true = {
        "C_i": C_I, "m": stand.polytropic_exponent, "oxidizer_mass_fitted": stand.oxidizer_mass,
        "tank_temperature": stand.temperature, "a": stand.a, "n": stand.n,
    }  # fmt: skip
    for name, value in true.items():
        assert abs(calibration[name]["value"] - value) < 4.0 * calibration[name]["std"], name
        assert calibration[name]["std"] < (0.4 if name == "a" else 0.15) * value, name  # a trades against n
    assert calibration["oxidizer_mass"]["value"] == 8.35  # as weighed
    rate = calibration["regression_rate_reference"]
    flux = calibration["regression"]["reference_flux"]["value"]
    assert rate["value"] == pytest.approx(stand.a * flux**stand.n, rel=0.01)
    assert rate["std"] < 0.03 * rate["value"]
    events = [found["segments"][name] for name in ("t_v", "t_fuel_out")]
    with h5py.File(opened(root).out / "residuals.h5") as file:
        for channel in found["validation"]["gap"]["full"]:
            group = file[f"full/{channel}"]
            time, phases, residual = (group[name][:] for name in ("time", "phase", "residual"))
            # chamber and thrust fall by a hundred times their noise within what these instants are known to
            apart = np.all([np.abs(time - event["value"]) > 3.0 * event["std"] for event in events], axis=0)
            for phase in np.unique(phases[apart]):
                left = residual[apart & (phases == phase)]
                assert np.sqrt(np.nanmean(left**2)) < 4.0 * NOISE[channel], (channel, phase)


def test_constants_found_one_by_one_are_kept_beside(root: Path) -> None:
    found = done(root, "calibrate", HEATED)["calibration"]
    assert {"C_i", "K_loss", "m", "a", "n"} <= set(found["one_by_one"])
    assert found["one_by_one"]["m"]["value"] == pytest.approx(1.1, abs=0.03)
    assert "oxidizer_mass_fitted" not in found["one_by_one"]


def test_a_sensors_effect_alone_leaves_the_constants_one_by_one(root: Path) -> None:
    found = done(root, "calibrate", '[load_cell_drift]\ndrift = "80 N"\ntime = "3 s"\n')["calibration"]
    assert "one_by_one" not in found


@pytest.mark.parametrize(
    "adopted",
    [
        '[tank_heat]\npower = "1e-6 W"\n',
        '[tank_wall_heat_capacity]\ncapacity = "1 J/K"\n',
        '[chamber_heat_loss]\nloss = "1 W"\n',
    ],
    ids=["heat", "wall", "loss"],
)
def test_an_effect_that_no_channel_would_show_changes_nothing(
    root: Path, base: dict[str, dict[str, Any]], adopted: str
) -> None:
    found = done(root, "calibrate", adopted)["calibration"]
    *_, note = found["notes"]
    assert note.endswith("no channel would show it, and it changes nothing")
    plain = {name: value for name, value in numbers(base["calibration"]).items() if name != "notes"}
    assert {name: value for name, value in numbers(found).items() if name != "notes"} == plain
    assert len(found["effects"]) == 1


def test_one_by_one_next_to_no_heat_is_next_to_no_change(root: Path, base: dict[str, dict[str, Any]]) -> None:
    """The vapor phase on the engine's equations is the report's, but for the order of its steps."""
    context = replace(opened(root), stage=STAGE)
    done(root, "segment")
    found = _calibration(context, *context.believed(), [effect("tank_heat").at(power=1e-6)]).quantities
    for name, off in (("m", 2e-3), ("C_i", 1e-6), ("K_loss", 1e-6)):
        assert found[name].value == pytest.approx(base["calibration"][name]["value"], rel=off)
    # this burn tells little of n: its fit ends within a hundredth of n's deviation, and starts elsewhere as m differs
    assert abs(found["n"].value - base["calibration"]["n"]["value"]) < 0.03 * base["calibration"]["n"]["std"]
    for name in ("m", "C_i", "K_loss"):
        assert found[name].std == pytest.approx(base["calibration"][name]["std"], rel=0.1)
    # n's is taken from what is left in p_chamber, of which four or five values are independent: itself known to a half
    assert found["n"].verdict == base["calibration"]["n"]["verdict"] == "not identifiable"
    assert found["n"].std == pytest.approx(base["calibration"]["n"]["std"], rel=0.5)


@pytest.mark.parametrize(
    ("hidden", "adopted"),
    [
        (effect("injector_two_phase").at(weight=0.5), "[injector_two_phase]\nweight = 0.5\n"),
        (
            effect("pressure_transducer_offset").at(p_run=1e5, p_chamber=-1e5),
            '[pressure_transducer_offset]\np_run = "1 bar"\np_chamber = "-1 bar"\n',
        ),
    ],
    ids=["injector", "offsets"],
)
def test_the_injectors_coefficient_is_its_own_again(tmp_path: Path, hidden: Active, adopted: str) -> None:
    make_root(tmp_path, hidden)
    off, back = (abs(done(tmp_path, "calibrate", a)["calibration"]["C_i"]["value"] - C_I) for a in ("", adopted))
    assert off > 0.006
    assert back < 0.002
    found = done(tmp_path, "calibrate", adopted)["calibration"]["C_i"]
    # a chamber gauge that rests at vacuum after the firing is suspect, and its interval the wider
    assert found["std"] < (0.006 if found["verdict"] == "doubted" else 0.002)


def test_strength_nothing_is_no_file(root: Path, base: dict[str, dict[str, Any]]) -> None:
    found = done(root, ALL, '[tank_heat]\npower = "0 W"\n[chamber_tap_lag]\nlag = "0 s"\n')
    for name in ("calibration", "validation", "flight"):
        assert numbers(found[name]) == numbers(base[name])
        assert len(found[name]["effects"]) == 2


def test_a_sensors_drift_is_taken_off_the_thrust_that_flies(root: Path, base: dict[str, dict[str, Any]]) -> None:
    found = done(root, ALL, '[load_cell_drift]\ndrift = "80 N"\ntime = "3 s"\n')
    impulse = [p["validation"]["performance"]["measured"]["total_impulse"]["value"] for p in (base, found)]
    assert impulse[1] < impulse[0]
    assert found["flight"]["apogee"]["value"] < base["flight"]["apogee"]["value"]
    # physics is in the measured thrust already
    with_nozzle = done(root, ALL, '[nozzle_divergence]\nloss = "10 %"\n')["flight"]["apogee"]["value"]
    assert with_nozzle == pytest.approx(base["flight"]["apogee"]["value"], rel=1e-4)


def test_a_nozzles_effect_acts_under_the_measured_chamber_pressure(root: Path, base: dict[str, dict[str, Any]]) -> None:
    found = done(root, "validate", '[nozzle_divergence]\nloss = "10 %"\n')
    bias = [p["validation"]["gap"]["chamber_forced"]["thrust"]["liquid"]["bias"] for p in (base, found)]
    thrust = base["validation"]["performance"]["measured"]["average_thrust"]["value"]
    assert bias[1] - bias[0] > 0.05 * thrust


def test_only_what_has_the_effect_in_it_is_redone(root: Path) -> None:
    done(root, ALL)
    for adopted in ('[tank_heat]\npower = "1 kW"\n', ""):
        ran = len(stages_run(root))
        done(root, ALL, adopted)
        assert stages_run(root)[ran:] == ["calibrate", "validate", "flight"]
        done(root, ALL, adopted)
        assert len(stages_run(root)) == ran + 3


def test_the_base_model_is_what_a_diagnosis_starts_from(root: Path, base: dict[str, dict[str, Any]]) -> None:
    done(root, "calibrate")
    before = hashes(root, "base_calibration.json", "ingest.h5", "segments.json")
    found = done(root, "calibrate", HEATED)
    assert hashes(root, *before) == before
    assert numbers(found["base_calibration"]) == numbers(base["calibration"])
    assert found["calibration"]["m"] != found["base_calibration"]["m"]


@pytest.mark.parametrize("tap", ["aft", "head"])
def test_the_base_model_takes_the_chambers_gauge_as_it_reads(
    root: Path, base: dict[str, dict[str, Any]], tmp_path: Path, tap: str
) -> None:
    """Where it is stated to sit moves what is calibrated, and not what a diagnosis starts from."""
    shutil.copytree(root / "raw_tests", tmp_path / "raw_tests")
    definition = tmp_path / "raw_tests" / "T1" / "test.toml"
    stated = definition.read_text(encoding="utf-8").replace(
        'column = "p_chamber",', f'column = "p_chamber", tap = "{tap}",'
    )
    definition.write_text(stated, encoding="utf-8")
    found = done(tmp_path, "calibrate")
    assert numbers(found["base_calibration"]) == numbers(base["calibration"])
    assert found["calibration"]["n"]["value"] != found["base_calibration"]["n"]["value"]


def test_a_file_that_is_at_fault_stops_what_would_have_it(root: Path) -> None:
    with pytest.raises(InputError, match=r"T1\.effects\.toml, tank_heat\.power: found '1'"):
        done(root, "validate", '[tank_heat]\npower = "1"\n')
    assert done(root, "segment", '[tank_heat]\npower = "1"\n')["segments"]["t_v"]["value"] > 0.0
