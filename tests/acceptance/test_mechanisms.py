"""What used to mislead the diagnosis, each on a simulated log that has it: other engines, loggers and laws than those
that it was built on (docs/worlds.md, development set)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from benchmarks.practice import diagnosed
from benchmarks.worlds import SURE
from simulated.worlds.plan import plan
from simulated.worlds.write import write_test


@dataclass(frozen=True)
class Found:
    """What was stated of a log."""

    product: dict[str, Any]

    @property
    def sure(self) -> set[str]:
        """What is stated surely: names, and unknown where that is the verdict."""
        stated = {row["name"]: row["probability"] for row in self.product["effects"]}
        if self.product["verdict"] == "unknown":
            stated["unknown"] = self.product["posterior"]["unknown"]
        return {name for name, p in stated.items() if p > SURE}

    @property
    def verdict(self) -> str:
        return str(self.product["verdict"])


def found(name: str, folder: Path, fade: tuple[float, float] | None = None) -> Found:
    """One test of the development set, written and diagnosed."""
    (test,) = (t for t in plan("development") if t.id == name)
    write_test(test, folder, fade)
    outcome = diagnosed(folder, name, folder / "out")
    assert outcome.failure == ""
    return Found(outcome.product)


def test_fuel_and_liquid_that_end_together_at_50_hz_with_jitter_are_no_effect(tmp_path: Path) -> None:
    assert found("D001", tmp_path).verdict == "none"


def test_where_the_fuel_ends_first_liquid_that_runs_on_through_a_cold_chamber_is_no_effect(tmp_path: Path) -> None:
    """A thrust cell that drifts is all that is hidden there."""
    one = found("D011", tmp_path)
    assert (one.verdict, one.sure) == ("named", {"load_cell_drift"})


@pytest.mark.parametrize("seconds", [0.03, 1.0])
def test_a_fade_is_no_name(seconds: float, tmp_path: Path) -> None:
    """The fuel ends before the liquid; what is left of it burns on, and the chamber turns cold, within this."""
    one = found("D043", tmp_path, (seconds, seconds))
    assert one.verdict == "none"
    assert set(one.product["too_small"]) <= {"fuel_sliver"}


def test_an_effect_of_another_law_keeps_its_name_and_twins_are_stated_together(tmp_path: Path) -> None:
    """A layered tank whose vapor follows late, by another table: layers, or boiling that comes late; nothing else."""
    one = found("D015", tmp_path)
    assert one.product["effects"][0]["name"] == "tank_stratification"
    assert set(one.product["set90"]) <= {"tank_stratification", "tank_nonequilibrium"}
    assert one.sure <= {"tank_stratification"}
