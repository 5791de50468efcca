"""The log that stages get: without what is unusable, its zeros taken without it, as accurate as what is suspect."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.health import fire
from tests.health.test_judge import finding
from tests.segment import stand

from hfanalysis.errors import AbsentError
from hfanalysis.health.usable import as_accurate, marked, of_firing, usable, widened, zeros_of_firing
from hfanalysis.products.health import ChannelHealth, Health
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.logspec import ChannelSpec


def health_of(name: str, verdict: Any, **about: Any) -> Health:
    """A channel with one finding."""
    channel = ChannelHealth(verdict=verdict, findings=(finding(verdict, name, **about),))
    return Health(channels={name: channel}, between=(), warnings=())


def test_an_unusable_stretch_is_not_good(tmp_path: Path) -> None:
    log, definition = fire.ingested(tmp_path, fire.columns())
    found = usable(log, health_of("p_run", "unusable", start=2.0, end=3.0), definition)
    lost = log["p_run"].good & ~found["p_run"].good
    assert log["p_run"].time[lost].min() == 2.0
    assert log["p_run"].time[lost].max() == 3.0
    assert found["p_tank"] is log["p_tank"]


def test_a_channel_without_any_other_samples_is_absent_with_its_reason(tmp_path: Path) -> None:
    log, definition = fire.ingested(tmp_path, fire.columns())
    found = usable(log, health_of("thrust", "unusable"), definition)
    assert "thrust" not in found
    assert found.get("thrust") is None
    with pytest.raises(AbsentError, match="no usable thrust: zero: it reads 76 N"):
        found["thrust"]
    assert "thrust" in marked(log, health_of("thrust", "unusable"), definition)


def test_of_a_channel_that_is_gone_what_holds_throughout_is_said_alone(tmp_path: Path) -> None:
    log, definition = fire.ingested(tmp_path, fire.columns())
    rows = finding("unusable", "thrust", start=2.0, end=2.1, evidence="20 rows repeat the one before them")
    channel = ChannelHealth(verdict="unusable", findings=(rows, finding("unusable", "thrust")))
    reason = usable(log, Health(channels={"thrust": channel}, between=(), warnings=()), definition).lacks("thrust")
    assert reason.endswith("no usable thrust: zero: it reads 76 N")


def test_what_the_engineer_trusts_is_used(tmp_path: Path) -> None:
    log, definition = fire.ingested(tmp_path, fire.columns())
    assert usable(log, health_of("thrust", "unusable", overruled=True), definition) is not log
    assert "thrust" in usable(log, health_of("thrust", "unusable", overruled=True), definition)


def test_a_healthy_log_is_as_it_was(tmp_path: Path) -> None:
    log, definition = fire.ingested(tmp_path, fire.columns())
    health = Health(channels={}, between=(), warnings=())
    found = widened(usable(log, health, definition), health)
    assert all(found[name] is log[name] for name in fire.CHANNELS)
    assert as_accurate(definition, found).channels == definition.channels


def test_a_tare_is_taken_anew_without_the_noise_after_a_cell_has_died(tmp_path: Path) -> None:
    columns = fire.columns()
    died = columns["time"] > 2.0
    columns["thrust"][died] = np.random.default_rng(9).normal(-5000.0, 10.0, int(died.sum()))
    log, definition = fire.ingested(tmp_path, columns)
    assert log["thrust"].drift < -1000.0
    found = usable(log, health_of("thrust", "unusable", start=2.0), definition)["thrust"]
    assert found.drift == 0.0
    assert found.zero == pytest.approx(12.0, abs=2.0)
    burning = found.good & (found.time > 0.5)
    assert found.values[burning].mean() == pytest.approx(2000.0 * np.exp(-1.25 / 20.0), rel=0.01)


def test_zeros_are_taken_anew_where_the_channel_that_dated_the_firing_is_gone(tmp_path: Path) -> None:
    columns = fire.columns()
    columns["p_chamber"] = np.where(columns["time"] > -4.0, 20.0, 1.0) + 0.01 * fire.columns(3)["p_run"]
    log, definition = fire.ingested(tmp_path, columns)
    found = usable(log, health_of("p_chamber", "unusable"), definition)
    assert found["thrust"].zero == pytest.approx(12.0, abs=1.0)
    assert found["thrust"].zero_std != log["thrust"].zero_std


def test_accuracy_is_as_wide_as_what_is_found_may_mean(tmp_path: Path) -> None:
    log, definition = fire.ingested(tmp_path, fire.columns())
    found = widened(log, health_of("thrust", "suspect", bias=30.0))
    assert found["thrust"].accuracy == pytest.approx(np.hypot(7.0, 30.0))
    assert found["thrust"].doubt == 30.0
    zero_std = log["thrust"].zero_std
    assert zero_std is not None
    assert found["thrust"].zero_std == pytest.approx(np.hypot(zero_std, 30.0))
    accuracy = as_accurate(definition, found).channels["thrust"].accuracy
    assert accuracy is not None
    assert accuracy.value == found["thrust"].accuracy
    assert definition.channels["thrust"].accuracy != accuracy


def test_a_factor_counts_as_an_offset_at_the_plateau(tmp_path: Path) -> None:
    log, _ = fire.ingested(tmp_path, fire.columns())
    found = widened(log, health_of("thrust", "suspect", gain=0.1))
    assert found["thrust"].zero_std == pytest.approx(200.0, rel=0.1)


def two_firings(pause: float) -> TestLog:
    """A cell that rests at 10 N before the first firing and at 60 N before the second, ``pause`` seconds apart."""
    time = np.arange(0.0, 20.0 + pause, 0.01)
    second = 10.0 + pause
    lit = ((time > 5.0) & (time < 10.0)) | ((time > second) & (time < second + 5.0))
    rng = np.random.default_rng(3)
    thrust = np.where(lit, 2000.0, 0.0) + np.where(time > 7.0, 60.0, 10.0) + rng.standard_normal(time.size)
    chamber = 1e5 + np.where(lit, 20e5, 0.0) + 1e3 * rng.standard_normal(time.size)
    flags = np.zeros(time.size, dtype=np.uint8)
    read = {
        "thrust": Channel("thrust", "N", time, thrust - 10.0, flags, 1.0, True, "F", 10.0, 0.1, raw=thrust),
        "p_chamber": Channel("p_chamber", "Pa", time, chamber, flags, 1e3, True, "P"),
    }
    return TestLog(read)


@pytest.mark.parametrize(("pause", "tare"), [(5.0, 60.0), (0.2, 10.0)], ids=["a rest between", "no rest between"])
def test_a_tare_is_of_the_rest_before_the_firing_taken(pause: float, tare: float) -> None:
    log = two_firings(pause)
    spec = ChannelSpec(column="F", unit="N", tare="before", name="thrust")
    definition = replace(stand.definition(), channels={"thrust": spec})
    part = of_firing(log, 10.0 + 0.5 * pause, None, definition)
    assert part["thrust"].zero == pytest.approx(tare, abs=0.5)
    assert np.median(part["thrust"].values[-200:]) == pytest.approx(60.0 - tare, abs=1.0)
    (told,) = zeros_of_firing(log, part)
    assert told.startswith("thrust: ")
    assert ("that of the log's first firing is used" in told) is (pause < 1.0)
    assert of_firing(log, None, None, definition) is log
    assert zeros_of_firing(log, log) == ()
