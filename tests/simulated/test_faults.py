"""The generator of faulty logs, and that what it makes is found: a few of what benchmarks/health_rates.py counts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from benchmarks import health_rates
from simulated.faults import healthy
from simulated.faults.kinds import FAULTS, suits

SLOW = 8
"""Seed of the first log that is looked at."""


@pytest.mark.parametrize("kind", FAULTS)
def test_a_fault_is_in_the_channels_that_it_names_and_in_no_other(kind: str) -> None:
    clean = next(log for log in map(healthy.draw, range(SLOW, 200)) if suits(log, kind))
    faulty = FAULTS[kind](np.random.default_rng(1), clean)
    moved = {
        name for name, value in faulty.log.values.items()
        if name not in clean.values or not np.array_equal(value, clean.values[name], equal_nan=True)
    }  # fmt: skip
    if kind in ("unit", "clock"):
        assert moved == set()
    elif kind == "gauge_or_absolute":
        assert set(faulty.channels) <= moved
    else:
        assert moved == set(faulty.channels)


def test_a_healthy_log_is_blamed_for_nothing(tmp_path: Path) -> None:
    assert health_rates.healthy_case(SLOW, tmp_path).findings == ()


@pytest.mark.parametrize("kind", ["dead", "sign", "swapped"])
def test_a_fault_is_told_by_its_kind(kind: str, tmp_path: Path) -> None:
    seeds = (seed for seed in range(1, 100) if (log := healthy.draw(10_000 + seed)).rate <= 50.0 and suits(log, kind))
    case = health_rates.faulty_case(kind, next(seeds), tmp_path)
    assert case is not None
    assert case.outcome == health_rates.FOUND
