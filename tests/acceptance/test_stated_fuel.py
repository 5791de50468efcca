"""A test burns what its [fuel] says, wherever the burnt gas is asked for."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hfanalysis.assembly import calibrated
from hfanalysis.measured_flight import firing, without_purge
from hfanalysis.performance import efficiency
from hfanalysis.performance.reconstruction import theory
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

ROOT = Path(__file__).parents[2]
ASKED = (
    (calibrated, "combustion_of"), (efficiency, "shifting"), (theory, "combustion_of"), (theory, "shifting"),
    (firing.combustion, "equilibrium"), (without_purge, "combustion_of"),
)  # fmt: skip
STATED = '[fuel]\nname = "mine"\nformula = "C20H42"\nmolar_enthalpy = "-554 kJ/mol"\n\n[grain]'
"""The default under another name: the numbers stay, and who asks for it shows."""


def test_every_stage_asks_for_the_gas_of_the_stated_fuel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "raw_tests" / "HF5"
    folder.mkdir(parents=True)
    lines = (ROOT / "raw_tests" / "HF5" / "log.csv").read_text().splitlines(keepends=True)
    (folder / "log.csv").write_text("".join([lines[0], *lines[1::20]]))
    text = (ROOT / "raw_tests" / "HF5" / "test.toml").read_text()
    (folder / "test.toml").write_text(text.replace("[grain]", STATED))
    fuels: dict[str, set[str]] = {f"{module.__name__}.{name}": set() for module, name in ASKED}

    def watched(place: str, asked: Callable[..., Any]) -> Callable[..., Any]:
        def ask(*given: Any, **named: Any) -> Any:
            found = [one.name for one in (*given, *named.values()) if type(one).__name__ == "Fuel"]
            fuels[place].update(found or ["none is told"])
            return asked(*given, **named)

        return ask

    for module, name in ASKED:
        monkeypatch.setattr(module, name, watched(f"{module.__name__}.{name}", getattr(module, name)))
    settings = {"flight.flights": 10, "flight.gust_seeds": 1, "flight.winds": [2.0], "calibrate.samples": 20}
    run_to("flight", run_to("validate", open_test(tmp_path, "HF5", settings=settings)))
    assert fuels == {place: {"mine"} for place in fuels}
