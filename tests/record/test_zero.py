"""Zeros come from the quiet time around the firing, and are refused where there is none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.record import make

from hfanalysis.record.log import TestLog

T = np.arange(0.0, 12.0, 0.005)
ON = (T > 4.0) & (T < 8.0)
SITE = '[site]\nambient_pressure = "1.000 +/- 0.005 bar"\n'


def ingested(
    root: Path,
    *,
    bias: float = 0.1,
    drift: float = 0.0,
    tare: str = "auto",
    tail: float = 0.0,
    shift: float = 0.0,
    more: str = "",
) -> TestLog:
    """A firing from 4 s to 8 s: chamber pressure ``bias`` [bar] off, ``shift`` [bar] more from ignition on, and
    a cell that drifts [N]."""
    rng = np.random.default_rng(5)
    p = 1.0 + bias + shift * (T > 4.0) + 20.0 * ON + rng.normal(scale=0.02, size=len(T))
    rest = 30.0 + drift * np.clip((T - 4.0) / 4.0, 0.0, 1.0)
    f = rest + 2000.0 * ON + tail * np.exp(-(T - 8.0) / 3.0) * (T >= 8.0) + rng.normal(scale=2.0, size=len(T))
    toml = make.LOG + SITE + make.channel("p_chamber", "bar", 'zero = "ambient"', 'accuracy = "0.05 bar"')
    toml += make.channel("thrust", "N", f'tare = "{tare}"') + more
    return make.read(root, toml, {"log.csv": make.csv(time=T, p_chamber=p, thrust=f)})


def test_a_pressure_is_zeroed_to_ambient(tmp_path: Path) -> None:
    channel = ingested(tmp_path)["p_chamber"]
    assert channel.zero == pytest.approx(0.1e5, abs=300)
    assert np.median(channel.values[T < 3.5]) == pytest.approx(1e5, abs=300)
    assert channel.zero_std == pytest.approx(500, rel=0.1)
    np.testing.assert_allclose(channel.raw - channel.values, channel.zero)


@pytest.mark.parametrize("shift", [-6.0, -1.5, 0.5, 3.0])
def test_a_transducer_that_ignition_shifts_is_zeroed_before_it(tmp_path: Path, shift: float) -> None:
    """Down: it rests lower in the end than in the beginning, which is no firing."""
    log = ingested(tmp_path, shift=shift)
    assert log["p_chamber"].zero == pytest.approx(0.1e5, abs=300)
    assert log["thrust"].zero == pytest.approx(30.0, abs=0.5)
    assert np.median(log["p_chamber"].values[T > 9.0]) == pytest.approx(1e5 + 1e5 * shift, abs=600)


def test_a_zero_far_from_ambient_is_refused_with_a_warning(tmp_path: Path) -> None:
    log = ingested(tmp_path, bias=3.0)
    assert log["p_chamber"].zero_std is None
    assert log["p_chamber"].raw is None
    assert any("p_chamber: zero not taken" in warning for warning in log.warnings)


def test_a_cell_at_rest_on_both_sides_loses_its_drift(tmp_path: Path) -> None:
    channel = ingested(tmp_path, drift=15.0)["thrust"]
    assert channel.zero == pytest.approx(30.0, abs=0.5)
    assert channel.drift == pytest.approx(15.0, abs=0.7)
    assert abs(np.mean(channel.values[T > 10.0])) < 0.5
    assert 0.01 < channel.zero_std < 0.5


def test_a_level_that_still_decays_is_not_taken(tmp_path: Path) -> None:
    channel = ingested(tmp_path, tail=400.0)["thrust"]
    assert channel.drift == 0.0
    assert channel.zero == pytest.approx(30.0, abs=0.5)
    assert any("no settled level" in line for line in channel.history)


def test_tare_before_leaves_the_drift_in(tmp_path: Path) -> None:
    channel = ingested(tmp_path, drift=15.0, tare="before")["thrust"]
    assert channel.drift == 0.0
    assert np.mean(channel.values[T > 10.0]) == pytest.approx(15.0, abs=0.5)


def test_no_tare_keeps_the_readings(tmp_path: Path) -> None:
    channel = ingested(tmp_path, tare="none")["thrust"]
    assert channel.zero_std is None
    assert np.mean(channel.values[T < 3.5]) == pytest.approx(30.0, abs=0.5)


def test_the_stated_opening_bounds_the_quiet_time(tmp_path: Path) -> None:
    channel = ingested(tmp_path, more='[segments]\nt_open = "2 s"\n')["thrust"]
    assert "at 0.8" in channel.history[-1]


def test_a_log_without_a_firing_has_no_zero(tmp_path: Path) -> None:
    flat = np.full(len(T), 1.1) + np.random.default_rng(1).normal(scale=0.01, size=len(T))
    toml = make.LOG + SITE + make.channel("p_chamber", "bar", 'zero = "ambient"')
    log = make.read(tmp_path, toml, {"log.csv": make.csv(time=T, p_chamber=flat)})
    assert log["p_chamber"].zero_std is None
    assert any("no firing found" in warning for warning in log.warnings)
