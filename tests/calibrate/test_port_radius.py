"""A port measured while the fuel burns, or after a burn that was cut short, enters a and n."""

from __future__ import annotations

from math import log
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from benchmarks.recovery import recover_regression
from simulated.engine import made, make_log

from hfanalysis.errors import InputError
from hfanalysis.record.definition import load_definition

GRAIN = '[grain]\nmass = "1.6 kg"\nlength = "0.6 m"\ndensity = "900 kg/m^3"\nouter_radius = "40 mm"\n'
"""Its port has 20.7 mm."""


def measured(folder: Path, seed: int, bias: float) -> dict[str, Any]:
    """The truth of a simulated engine's log, to which an ultrasonic sensor is added that is off by ``bias`` [m]."""
    folder.mkdir()
    truth = make_log(folder, seed)
    stand, _, burnt, _ = made(seed)
    frame = pd.read_csv(folder / "log.csv")
    after = frame.iloc[:, 0].to_numpy() - stand.t_open
    radius = np.interp(after, burnt.time, burnt.state("port_radius"))
    noise = 1e-4 * np.random.default_rng(seed).standard_normal(after.size)
    frame["WEB (mm)"] = 1e3 * (radius + bias + noise)
    frame.to_csv(folder / "log.csv", index=False)
    return {"a": truth.a, "n": truth.n}


@pytest.mark.parametrize("seed", [3, 8])
def test_a_port_measured_over_time_narrows_the_law_and_its_interval_holds_the_truth(seed: int, tmp_path: Path) -> None:
    folder = tmp_path / "E"
    truth = measured(folder, seed, 3e-4)
    without = recover_regression(folder)
    with (folder / "test.toml").open("a", encoding="utf-8") as file:
        file.write('\n[channels.port_radius]\ncolumn = "WEB (mm)"\nunit = "mm"\naccuracy = "0.3 mm"\n')
    told = recover_regression(folder)
    assert told["n"]["std"] < 0.5 * without["n"]["std"]
    assert abs(told["n"]["value"] - truth["n"]) < 2.0 * told["n"]["std"]
    flux, rate = told["reference_flux"], told["regression_rate_reference"]
    assert abs(log(rate["value"] / (truth["a"] * flux ** truth["n"]))) < 2.5 * rate["std"] / rate["value"]


@pytest.mark.parametrize("factor", [2.0, 0.5])
def test_a_reading_that_is_not_the_grain_s_port_is_not_used(factor: float, tmp_path: Path) -> None:
    folder = tmp_path / "E"
    measured(folder, 3, 0.0)
    without = recover_regression(folder)["n"]
    frame = pd.read_csv(folder / "log.csv")
    frame["WEB (mm)"] *= factor
    frame.to_csv(folder / "log.csv", index=False)
    with (folder / "test.toml").open("a", encoding="utf-8") as file:
        file.write('\n[channels.port_radius]\ncolumn = "WEB (mm)"\nunit = "mm"\naccuracy = "0.3 mm"\n')
    assert recover_regression(folder)["n"]["value"] == pytest.approx(without["value"])


def stated(folder: Path, observed: str, grain: str = GRAIN) -> Path:
    folder.mkdir()
    (folder / "log.csv").write_text("t\n0\n")
    head = f'schema = 1\n[test]\nid = "{folder.name}"\nkind = "hot_fire"\n[log]\nfiles = ["log.csv"]\n'
    channels = 'time = { column = "t", unit = "s" }\n[channels.p_tank]\ncolumn = "p"\nunit = "bar"\n'
    (folder / "test.toml").write_text(f"{head}{channels}{grain}[observed]\n{observed}\n")
    return folder / "test.toml"


def test_a_port_measured_after_the_test_is_the_fuel_that_is_left(tmp_path: Path) -> None:
    found = load_definition(stated(tmp_path / "T", 'port_radius_after = "30 +/- 0.2 mm"')).observed
    assert found is not None
    left = found.fuel_mass_after
    assert left is not None
    assert left.value == pytest.approx(900.0 * np.pi * 0.6 * (0.04**2 - 0.03**2))
    assert left.std == pytest.approx(900.0 * np.pi * 0.6 * 2.0 * 0.03 * 0.2e-3)


@pytest.mark.parametrize(
    ("observed", "grain", "words"),
    [
        ('port_radius_after = "45 mm"', GRAIN, "expected one from the port's to the grain's radius"),
        ('port_radius_after = "20 mm"', GRAIN, "expected one from the port's to the grain's radius"),
        ('port_radius_after = "30 mm"\nfuel_mass_after = "1 kg"', GRAIN, "each tells the other"),
        ('port_radius_after = "30 mm"', GRAIN.replace('length = "0.6 m"\n', ""), "length, density and outer_radius"),
    ],
)
def test_a_port_that_cannot_be_is_refused(observed: str, grain: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=rf"observed\.port_radius_after: .*{words}"):
        load_definition(stated(tmp_path / "T", observed, grain))
