"""Engines from Python: the numbers of the commands, and what is changed changes them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.cli.run import hfa

import hfanalysis
from hfanalysis.errors import InputError

ENGINE = Path(__file__).parents[2] / "engines" / "maelstrom.toml"


def test_a_simulation_is_the_command_s_with_histories() -> None:
    found = hfanalysis.simulate(ENGINE)
    told = json.loads(hfa("simulate", ENGINE, "--json").out)
    assert found.attrs["result"]["total_impulse"]["value"] == told["total_impulse"]["value"]
    assert found["thrust"].attrs["units"] == "N"
    assert float(found["thrust"].integrate("time")) == pytest.approx(told["total_impulse"]["value"], rel=2e-3)


def test_what_is_changed_is_run() -> None:
    """Less oxidizer, less impulse, in either spelling."""
    whole = hfanalysis.simulate(ENGINE).attrs["result"]["total_impulse"]["value"]
    less = hfanalysis.simulate(ENGINE, tank__oxidizer_mass="5 kg").attrs["result"]["total_impulse"]["value"]
    assert less < whole
    again = hfanalysis.simulate(ENGINE, **{"tank.oxidizer_mass": "5 kg"}).attrs["result"]["total_impulse"]["value"]
    assert again == less


def test_a_change_that_is_none_is_refused() -> None:
    with pytest.raises(InputError, match="expected a section and its key, as oxidizer__KEY"):
        hfanalysis.simulate(ENGINE, oxidizer=3.0)
    with pytest.raises(InputError, match="oxidiser_mass"):
        hfanalysis.simulate(ENGINE, tank__oxidiser_mass="5 kg")


def test_a_design_is_the_command_s() -> None:
    told = json.loads(hfa("design", ENGINE, "--json").out)
    assert hfanalysis.design(ENGINE).thrust.value == told["thrust"]["value"]
