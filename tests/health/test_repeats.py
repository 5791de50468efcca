"""Readings and rows that are those of before: a stuck channel, a logger that stood still, a buffer written twice."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.health import fire

from hfanalysis.health.judge import judge
from hfanalysis.products.health import Health

NAMES = tuple(fire.CHANNELS)


def judged(root: Path, columns: fire.Columns) -> Health:
    return judge(*fire.ingested(root, columns))


def kinds(health: Health, name: str) -> list[tuple[str, str]]:
    return [(f.kind, f.verdict) for f in health.of(name).findings]


def span_of(health: Health, name: str) -> tuple[float, float]:
    (found,) = health.of(name).findings
    return found.span


@pytest.mark.parametrize("rows", [20, 43, 59, 150])
@pytest.mark.parametrize("at", [1.0, 4.0])
def test_a_buffer_written_twice_is_found_to_the_row(tmp_path: Path, rows: int, at: float) -> None:
    columns = fire.columns(rows)
    first = int(np.searchsorted(columns["time"], at))
    for name in NAMES:
        columns[name][first + rows : first + 2 * rows] = columns[name][first : first + rows]
    health = judged(tmp_path, columns)
    for name in NAMES:
        assert kinds(health, name) == [("repeated", "unusable")]
    assert span_of(health, "p_tank") == pytest.approx((at + rows * 0.01 - 0.005, at + 2 * rows * 0.01 - 0.005))


def test_a_buffer_written_twice_with_coarse_readings_is_found(tmp_path: Path) -> None:
    """Readings in steps as large as their noise repeat by chance now and then, but not sixty rows of them."""
    columns = fire.columns()
    steps = {"p_tank": 0.1, "p_run": 0.1, "p_chamber": 0.1, "thrust": 10.0}
    for name, step in steps.items():
        columns[name] = np.round(columns[name] / step) * step
    assert judged(tmp_path / "before", columns).warnings == ()
    for name in NAMES:
        columns[name][800:860] = columns[name][740:800]
    assert kinds(judged(tmp_path / "after", columns), "p_run") == [("repeated", "unusable")]


def test_quiet_time_that_was_pasted_is_no_buffer(tmp_path: Path) -> None:
    columns = fire.columns()
    for name in NAMES:
        columns[name][100:200] = columns[name][:100]
    assert judged(tmp_path, columns).warnings == ()


def test_quiet_rows_written_over_an_opening_are_a_buffer(tmp_path: Path) -> None:
    """The fire would begin where they end, and every time would count from there."""
    columns = fire.columns()
    first = int(np.searchsorted(columns["time"], -0.5))
    for name in NAMES:
        columns[name][first : first + 150] = columns[name][first - 150 : first]
    assert ("repeated", "unusable") in kinds(judged(tmp_path, columns), "p_tank")


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("samples", [17, 400, None])
def test_a_channel_that_freezes_in_the_burn_is_stuck(tmp_path: Path, name: str, samples: int | None) -> None:
    columns = fire.columns()
    end = None if samples is None else 800 + samples
    columns[name][800:end] = columns[name][800]
    health = judged(tmp_path, columns)
    assert ("stuck", "unusable") in kinds(health, name)
    start, stop = next(f.span for f in health.of(name).findings if f.kind == "stuck")
    assert start == pytest.approx(3.005)
    assert stop == pytest.approx(columns["time"][-1] if end is None else columns["time"][end - 1] + 0.005)


def test_all_channels_held_at_once_are_stuck(tmp_path: Path) -> None:
    columns = fire.columns()
    for name in NAMES:
        columns[name][900:917] = columns[name][900]
    health = judged(tmp_path, columns)
    for name in NAMES:
        assert kinds(health, name) == [("stuck", "unusable")]


def test_coarse_channels_held_at_once_are_stuck_by_their_rows(tmp_path: Path) -> None:
    """One of them alone may stand still for that long; all of them together do not."""
    columns = fire.columns()
    steps = {"p_tank": 0.2, "p_run": 0.2, "p_chamber": 0.2, "thrust": 20.0}
    for name, step in steps.items():
        columns[name] = np.round(columns[name] / step) * step
    assert judged(tmp_path / "before", columns).warnings == ()
    for name in NAMES:
        columns[name][900:930] = columns[name][900]
    health = judged(tmp_path / "after", columns)
    assert {kind for name in NAMES for kind in kinds(health, name)} == {("stuck", "unusable")}


def test_a_quiet_sensor_of_coarse_resolution_is_not_stuck(tmp_path: Path) -> None:
    columns = fire.columns()
    columns["p_run"] = np.round(columns["p_run"])
    columns["p_tank"] = np.round(columns["p_tank"] * 2.0) / 2.0
    assert {finding.kind for finding in judged(tmp_path, columns).findings} <= {"coarse"}


def test_a_stretch_that_was_excluded_is_not_found_again(tmp_path: Path) -> None:
    columns = fire.columns()
    for name in NAMES:
        columns[name][800:860] = columns[name][740:800]
    before = judged(tmp_path / "before", columns)
    cure = before.of("thrust").findings[0].cure
    assert cure is not None
    after = judge(*fire.ingested(tmp_path / "after", columns, fire.toml() + "\n" + cure))
    assert after.warnings == ()
