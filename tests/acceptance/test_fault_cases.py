"""Whole logs that once went wrong: the answers of the unspoilt log come out, or what is wrong is named. Those that are
not there are skipped; what readers and single detectors make of others is in test_fault_files.py and
tests/health/test_given_logs.py."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from hfanalysis.drafting.new import new_test
from hfanalysis.errors import InputError
from hfanalysis.health.judge import judge
from hfanalysis.health.usable import as_accurate, usable, widened
from hfanalysis.performance.quick import quick_look
from hfanalysis.products.health import Health
from hfanalysis.products.quick import QuickLook
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import DOUBTED, IDENTIFIED, Quantity
from hfanalysis.record.definition import load_definition
from hfanalysis.record.ingest import ingest
from hfanalysis.record.log import read_log
from hfanalysis.segment.phases import find_phases

FAULTS = Path(__file__).parents[3] / "shared" / "faults"
C_I, T_V, IMPULSE = 0.2915, 5.264, 16.13e3
"""Of the unspoilt log."""
pytestmark = pytest.mark.skipif(not FAULTS.is_dir(), reason="needs ../shared/faults beside the repository")


@dataclass(frozen=True)
class Seen:
    """What a log gives."""

    health: Health
    segments: Segments
    quick: QuickLook

    @property
    def found(self) -> set[tuple[str, str]]:
        """Kind and channel of all findings."""
        return {(f.kind, name) for f in self.health.findings for name in f.channels}

    @property
    def impulse(self) -> Quantity:
        """Total [N s]."""
        return self.quick.performance["total_impulse"]


def seen(case: str, scratch: Path) -> Seen:
    """A case's health, phases and first numbers, as ``hfa run --quick`` has them."""
    folder = FAULTS / case
    definition = load_definition(next((folder / "raw_tests").iterdir(), folder) / "test.toml"
                                 if (folder / "raw_tests").is_dir() else folder / "test.toml")  # fmt: skip
    ingest(definition, scratch / "ingest.h5")
    log = read_log(scratch / "ingest.h5")
    health = judge(log, definition)
    used = widened(usable(log, health, definition), health)
    stated = as_accurate(definition, used)
    segments = find_phases(used, stated)
    cut = used if segments.taken is None else used.between(segments.taken.start, segments.taken.end)
    return Seen(health, segments, quick_look(cut, segments.fired, stated, health, (), 10))


def holds(quantity: Quantity, right: float) -> bool:
    """Whether its interval does."""
    return quantity.interval is not None and quantity.interval[0] <= right <= quantity.interval[1]


def doubted_by(quantity: Quantity, channel: str) -> bool:
    """Whether a number is doubted for a channel."""
    return quantity.verdict == DOUBTED and channel in (quantity.why or "")


def as_unspoilt(s: Seen) -> bool:
    """C_i and the end of the liquid are those of the unspoilt log."""
    return s.quick.C_i.value == pytest.approx(C_I, abs=0.002) and s.segments.t_v.value == pytest.approx(T_V, abs=0.02)


LOGS: dict[str, Callable[[Seen], bool]] = {
    "logs/crash_low_chamber_gauge": lambda s: doubted_by(s.quick.C_i, "p_chamber"),
    "logs/hf5_chamber_gauge_low": lambda s: doubted_by(s.quick.C_i, "p_chamber") and holds(s.quick.C_i, C_I),
    "logs/tv_slow_valve": lambda s: s.segments.t_v.value == pytest.approx(8.57, abs=0.06),
    "logs/purge_pulse_after_burn": lambda s: s.segments.t_end.value == pytest.approx(11.2, abs=0.1),
    "logs/thrust_only": lambda s: s.impulse.value == pytest.approx(979.0, rel=0.01),
    "logs/water_flow_step_not_seen": lambda s: s.segments.kind == "water_flow"
    and {("dead", "p_tank"), ("dead", "thrust")} <= s.found,
    **{
        f"files/K07_two_firings_in_one_log/{name}": lambda s: len(s.segments.firings) == 2 and as_unspoilt(s)
        for name in (
            "burst0.8s_gap5s", "burst1.0s_gap20s", "cold_then_hot", "misfire_then_fire", "two_fires", "two_fires_same",
        )
    },
    "files/K08_gauge_or_absolute/G_zero_ambient_saves": lambda s: doubted_by(s.quick.C_i, "p_chamber"),
    "files/K21_ends_of_a_log/hx711_glitch": lambda s: as_unspoilt(s) and holds(s.impulse, IMPULSE),
    "fuzz/silent_3560": lambda s: s.segments.t_v.value == pytest.approx(T_V, abs=0.02)
    and {("stuck", name) for name in ("p_tank", "p_run", "p_chamber", "thrust")} <= s.found,
    "fuzz/silent_3871": lambda s: ("repeated", "p_run") in s.found and s.quick.C_i.value is None,
    "fuzz/silent_frozen_p_chamber": lambda s: ("stuck", "p_chamber") in s.found and s.quick.C_i.value is None,
    "fuzz/silent_frozen_p_run": lambda s: ("stuck", "p_run") in s.found and s.quick.C_i.value is None,
    "fuzz/silent_frozen_thrust": lambda s: ("stuck", "thrust") in s.found and s.impulse.value is None,
    "fuzz/silent_2348": lambda s: ("clock", "p_run") in s.found and s.quick.C_i.verdict != IDENTIFIED,
    "fuzz/silent_961": lambda s: doubted_by(s.quick.C_i, "p_run (lag)")
    and s.segments.t_v.value == pytest.approx(T_V, abs=0.02),
    "fuzz/tb_exit_radius": as_unspoilt,
    "fuzz/tb_second_file_ends_early": lambda s: "says nothing after the opening" in (s.quick.C_i.reason or ""),
}  # fmt: skip


@pytest.mark.parametrize("case", LOGS)
def test_a_log_that_went_wrong_gives_its_right_answer(case: str, tmp_path: Path) -> None:
    if not (FAULTS / case).is_dir():
        pytest.skip(f"no {case}")
    assert LOGS[case](seen(case, tmp_path))


def test_a_fuel_mass_after_that_is_more_than_the_grain_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"fuel_mass_after: found 2 kg; expected no more than the 1.594 kg"):
        seen("fuzz/tb_fuel_after", tmp_path)


def test_a_json_log_in_one_line_is_drafted(tmp_path: Path) -> None:
    (path,) = (FAULTS / "fuzz" / "json_one_line").glob("*.json")
    made = new_test(tmp_path, "J", [path])
    assert load_definition(made.path).channels


@pytest.mark.parametrize("name", ["lfs_pointer.csv", "arrays.json"])
def test_what_is_no_log_is_refused_by_name_or_drafted_with_its_channels(name: str, tmp_path: Path) -> None:
    path = FAULTS / "files" / "K22_hfa_new" / name
    if name == "lfs_pointer.csv":
        with pytest.raises(InputError, match="LFS"):
            new_test(tmp_path, "L", [path])
    else:
        assert load_definition(new_test(tmp_path, "L", [path]).path).channels


def test_columns_are_drafted_in_the_fields_sense_and_all_logs_are_in_the_draft(tmp_path: Path) -> None:
    """In P_RUN_TANK the tank is meant, N2O is not N2, and the first of two logs stays."""
    folder = FAULTS / "files" / "K22_hfa_new"
    drafted = load_definition(new_test(tmp_path, "D", [folder / "one.csv"]).path)
    by_column = {spec.column: name for name, spec in drafted.channels.items()}
    assert by_column["P_RUN_TANK"] == "p_tank"
    assert by_column.get("P_N2O_FLOW") != "p_purge"
    assert by_column["T_RUN_TANK"] == "T_tank"
    both = load_definition(new_test(tmp_path, "B", [folder / "press.csv", folder / "force.csv"]).path)
    assert len(both.log.files) == 2
