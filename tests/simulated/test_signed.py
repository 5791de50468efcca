"""What is true of a log with all errors is what its sensors would show without them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from benchmarks.coverage import QUANTITIES, page, truths
from simulated.signed import Signed, make_log

from hfanalysis.record.definition import load_definition


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Signed]:
    folder = tmp_path_factory.mktemp("signed") / "V1"
    folder.mkdir()
    return folder, make_log(folder, 1)


def test_test_toml_is_off_by_what_it_states(made: tuple[Path, Signed]) -> None:
    folder, truth = made
    stated = load_definition(folder / "test.toml")
    for key, true in (("tank.volume", truth.stand.volume), ("tank.oxidizer_mass", truth.stand.mass)):
        known = stated.known(key)
        assert known is not None
        assert known.std is not None
        assert 0.0 < abs(known.value - true) < 4.0 * known.std


def test_the_log_is_the_truth_within_its_sensors(made: tuple[Path, Signed]) -> None:
    folder, truth = made
    table = np.genfromtxt(folder / "log.csv", delimiter=",", names=True)
    after = table["time"] - truth.stand.t_open
    for name in ("p_tank", "p_run", "p_chamber"):
        wet = (after > 0.5) & (after < 0.9 * truth.stand.t_v)
        off = np.mean(table[name][wet] - truth.at(name, after[wet]))
        assert abs(off) < 4.0 * 2.0 * 6894.76
    assert truth.expended < truth.stand.mass + truth.engine.fuel_mass


def test_the_page_says_what_covers_and_what_does_not(made: tuple[Path, Signed]) -> None:
    class Phases:
        @staticmethod
        def time(name: str) -> float | None:
            return None

    known = truths(made[1], Phases)
    assert set(QUANTITIES) - set(known) == {"apogee"}
    hit = {"value": 1.0, "std": 0.1, "ci95": [0.8, 1.2], "verdict": "identified"}
    results = [
        {"case": i, "truth": {"C_i": 1.0 + 0.3 * (i < 8), "n": 1.0}, "found": {"C_i": hit, "n": hit}}
        for i in range(100)
    ]
    text = page([*results, {"case": 100, "truth": {}, "found": {}, "failed": "AbsentError: no burn"}])
    assert "| C_i | 100 |" in text
    assert "92.0 %" in text
    assert "Outside 91 to 98 %: n." in text
    assert "1 of the tests gave no answer: AbsentError: no burn" in text
    assert "stopped before its 400 tests" in text
