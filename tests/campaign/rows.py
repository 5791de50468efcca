"""Products of made-up tests of one stand, as the stages write them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tests.products.filled import filled

from hfanalysis.campaign.product import row_of, stand_row
from hfanalysis.campaign.side_by_side import Ended
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.campaign import Campaign
from hfanalysis.products.diagnosis import Diagnosis
from hfanalysis.products.disk import write_json
from hfanalysis.products.flight import Flight
from hfanalysis.products.validation import Validation
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition, load_definition


def quantity(value: float, std: float, unit: str = "", verdict: str | None = "identified") -> dict[str, Any]:
    return Quantity(value, unit, std, verdict=verdict).to_json()


def definition(root: Path, test: str, stand: str | None = "cell 3") -> TestDefinition:
    folder = root / "raw_tests" / test
    folder.mkdir(parents=True)
    (folder / "log.csv").write_text("time,p\n0,1\n", encoding="utf-8")
    named = f'stand = "{stand}"\n' if stand else ""
    (folder / "test.toml").write_text(
        f'schema = 1\n[test]\nid = "{test}"\nkind = "hot_fire"\nsource = "synthetic"\n{named}'
        '[log]\nfiles = ["log.csv"]\ntime = { column = "time", unit = "s" }\n'
        '[channels]\np_tank = { column = "p", unit = "bar" }\n',
        encoding="utf-8",
    )
    return load_definition(folder / "test.toml")


def products(folder: Path, c_i: float, m: dict[str, Any], heat: float | None) -> None:
    """What the stages leave of a test; ``heat`` is what its diagnosis names, None for a test without one."""
    folder.mkdir(parents=True)
    calibration = {"C_i": quantity(c_i, 0.002), "K_loss": quantity(5.6e8, 1e7, "1/m^4"), "m": m}
    performance = {"total_impulse": quantity(2.0e4, 150.0, "N s", None), "burn_time": quantity(5.2, 0.05, "s", None)}
    effects = []
    if heat is not None:
        power = {"power": quantity(heat, 150.0, "W", None)}
        effects = [{"name": "tank_heat", "probability": 0.93, "equation": "tank_energy", "parameters": power}]
    diagnosis = {
        "verdict": "named" if effects else "none",
        "effects": effects,
        "posterior": {"tank_heat": 0.93 if effects else 0.004, "none": 0.07 if effects else 0.9},
        "partners": {},
        "gap": {},
    }
    for kind, product in (
        (Calibration, calibration),
        (Validation, {"performance": {"measured": performance}}),
        (Flight, {"apogee": quantity(2900.0, 60.0, "m", None)}),
        (Diagnosis, diagnosis),
    ):
        write_json(folder / kind.file, filled(kind, product))
    (folder / "report.html").write_text("", encoding="utf-8")


def made(root: Path) -> Campaign:
    """A campaign of three tests of a stand and one whose definition is at fault."""
    processed = root / "processed"
    free = quantity(0.75, 0.01, verdict="unphysical")
    products(processed / "A", 0.300, quantity(1.03, 0.02), 900.0)
    products(processed / "B", 0.303, quantity(1.05, 0.02), 1100.0)
    products(processed / "C", 0.380, free, None)
    rows = {test: row_of(definition(root, test), processed / test, Ended(0, "")) for test in "ABC"}
    stand = stand_row(rows, processed)
    broken = row_of(None, processed / "D", Ended(2, "raw_tests/D/test.toml: <b>found nothing</b>"))
    return Campaign(tests={**rows, "D": broken}, stands={"cell 3": stand})
