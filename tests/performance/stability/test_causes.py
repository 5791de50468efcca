"""What a line can be."""

from __future__ import annotations

import numpy as np
import pytest

from hfanalysis.inference.oscillations.lines import Track
from hfanalysis.performance.stability.causes import (
    DRIVES,
    FEED,
    FOLLOWED,
    FOLLOWS,
    STAND,
    UNTOLD,
    Seen,
    Shown,
    cause,
)
from hfanalysis.performance.stability.modes import Chamber, Mode

MODES = (Mode("the intrinsic low frequency of a hybrid", 20.0, 40.0), Mode("the longitudinal mode", 500.0, 700.0))


def track(frequency: float, rms: float = 1e4) -> Track:
    return Track(frequency, 0.2, 0.0, rms, 0.01 * rms, 1.0, 4.0, 0.0, 0.1)


def seen(channel: str, frequency: float, share: float = 0.01) -> Seen:
    return Seen(channel, track(frequency), share)


def shown(**changes: object) -> Shown:
    usual = {"limits": {"p_chamber": 1e-3, "p_run": 1e-3, "thrust": 1e-3}, "rest": {}, "rest_limits": {},
             "run_line": FOLLOWS, "sampling": 1000.0}  # fmt: skip
    return Shown(**{**usual, **changes})  # type: ignore[arg-type]


def test_run_line_and_chamber_together_are_the_feed() -> None:
    both = [seen("p_chamber", 12.0), seen("p_run", 12.0)]
    assert cause(both, shown(run_line=DRIVES), MODES) == FEED
    assert cause(both, shown(run_line=FOLLOWS), MODES) == f"{UNTOLD}: {FOLLOWED}"
    assert cause([seen("p_run", 12.0)], shown(), MODES) == "the feed"


def test_the_engine_swings_by_itself_where_the_run_line_would_show_the_feed() -> None:
    assert cause([seen("p_chamber", 30.0)], shown(), MODES) == MODES[0].name
    blind = shown(limits={"p_chamber": 1e-3})
    assert cause([seen("p_chamber", 30.0)], blind, MODES).startswith(UNTOLD)
    assert cause([seen("p_chamber", 107.0)], shown(), MODES) == UNTOLD
    assert "not known" in cause([seen("p_chamber", 107.0)], shown(), None)


def test_what_the_rate_folds_is_offered() -> None:
    slow = shown(sampling=100.0)
    assert "faster than this rate shows" in cause([seen("p_chamber", 45.0)], slow, MODES)


def test_thrust_alone_is_the_stand_where_the_chamber_would_show() -> None:
    assert cause([seen("thrust", 80.0)], shown(), MODES) == STAND
    blind = shown(limits={"p_chamber": np.inf, "p_run": 1e-3})
    assert cause([seen("thrust", 80.0)], blind, MODES) == "the stand"


@pytest.mark.parametrize(("frequency", "sampling"), [(50.1, 1000.0), (120.0, 1000.0), (10.0, 60.0), (40.0, 100.0)])
def test_what_is_there_at_rest_is_not_the_engine(frequency: float, sampling: float) -> None:
    resting = shown(sampling=sampling, rest={"p_chamber": [track(frequency, 0.8e4)]})
    found = cause([seen("p_chamber", frequency)], resting, MODES)
    assert "mains" in found
    assert "at rest" in found
    loud = shown(sampling=sampling, rest={"p_chamber": [track(frequency, 1e3)]}, rest_limits={"p_chamber": 1e2})
    assert "at rest" not in cause([seen("p_chamber", frequency)], loud, MODES)


def test_modes_are_those_of_tubes_and_bottles() -> None:
    chamber = Chamber(0.6, 0.04, 2e-4, 9e-4, (0.023, 0.035), (1000.0, 1050.0), (0.01, 0.02))
    intrinsic, helmholtz, longitudinal = chamber.modes()
    assert (intrinsic.lowest, intrinsic.highest) == pytest.approx((24.0, 48.0))
    assert longitudinal.highest == pytest.approx(1050.0 / 2.0 / (0.6 + 1.1e-3 / (np.pi * 0.04**2)))
    area = np.pi * 0.035**2
    assert helmholtz.highest == pytest.approx(1050.0 / 2.0 / np.pi * np.sqrt(area / 0.6 * (1 / 2e-4 + 1 / 9e-4)))
    assert helmholtz.has(helmholtz.highest + 0.5, 1.0)
    assert not helmholtz.has(helmholtz.highest + 1.5, 1.0)
