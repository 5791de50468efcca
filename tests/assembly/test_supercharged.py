"""A tank on which nitrogen presses before the valve opens, in an engine file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.cli.shaped import MAELSTROM

from hfanalysis.assembly.engine import engine
from hfanalysis.assembly.tank import saturated, tank
from hfanalysis.errors import InputError
from hfanalysis.record.document import read_toml
from hfanalysis.record.engine_file import Needs, engine_of
from hfanalysis.simulation.unsteady_run import simulate


def needs(pressure: str | None) -> Needs:
    """The report's engine, its tank at 25 degC under nitrogen at ``pressure``."""
    content = read_toml(MAELSTROM)[1]
    own = {"nitrogen_pressure": pressure} if pressure else {}
    return Needs(engine_of({**content, "tank": {**content["tank"], **own}}, Path("engine.toml"), b""), "hfa simulate")


def test_the_tank_starts_at_the_stated_pressure_and_pushes_the_liquid_out_sooner() -> None:
    plain, under = (simulate(needs(p).file).burnt for p in (None, "70 bar"))
    assert under.output("tank_pressure")[0] == pytest.approx(70e5, rel=1e-3)
    assert plain.output("tank_pressure")[0] < 60e5
    assert under.liquid_out < plain.liquid_out  # type: ignore[operator]
    assert under.output("thrust").max() > 1.03 * plain.output("thrust").max()
    nitrogen = under.state("tank_nitrogen")
    liquid = under.time < under.liquid_out
    assert np.ptp(nitrogen[liquid]) < 1e-12  # it leaves with the vapor, not with the liquid
    assert 0.0 < nitrogen[-1] < nitrogen[0]


def test_a_design_counts_on_it() -> None:
    assert saturated(needs("70 bar")).pressure == pytest.approx(70e5)
    made = engine(needs("70 bar"), tank(needs("70 bar")))
    assert made.tank_pressure == pytest.approx(70e5, rel=1e-9)


def test_less_than_the_nitrous_oxide_has_itself_is_refused() -> None:
    under = needs("40 bar")
    with pytest.raises(InputError, match=r"nitrogen_pressure: found 40 bar; expected more than the 5\d\.\d+ bar"):
        engine(under, tank(under))
