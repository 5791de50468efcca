"""The zeros of sensors from test to test."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.campaign.rows import definition, made
from tests.products.filled import filled

from hfanalysis.campaign.conclusions import conclusions
from hfanalysis.campaign.page import page
from hfanalysis.campaign.sensors import courses, drifts, readings_of, sensors_of
from hfanalysis.campaign.trends import by_chance
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.campaign import Campaign, Reading, SensorRow, TestRow
from hfanalysis.products.ingest import ChannelSummary, Ingest
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import load_definition


@pytest.fixture
def product(tmp_path: Path) -> Campaign:
    return made(tmp_path)


def row(product: Campaign, day: int, bar: float, sensor: str | None = "PT-3") -> TestRow:
    reading = Reading(sensor=sensor, zero=Quantity(1e5 * bar, "Pa", 300.0))
    return product.tests["A"].but(date=f"2026-03-{day:02d}", sensors={"p_chamber": reading})


def rows(product: Campaign, bars: list[float]) -> dict[str, TestRow]:
    return {f"T{i}": row(product, i + 1, bar) for i, bar in enumerate(bars)}


def drifting(sensors: dict[str, SensorRow]) -> list[str]:
    return [name for name, _, course in courses(sensors) if drifts(course)]


def test_a_zero_that_creeps_drifts_and_is_said(product: Campaign) -> None:
    tests = rows(product, [0.01, 0.05, 0.06, 0.11, 0.19, 0.20])
    sensors = sensors_of(tests)
    assert drifting(sensors) == ["PT-3"]
    stand = product.stands["cell 3"].but(tests=tuple(tests), sensors=sensors, constants={}, effects={})
    assert conclusions(stand, tests) == [
        "The zero of PT-3 (chamber pressure) drifts, from 0.01 bar in T0 to 0.2 bar in T5: have it checked."
    ]
    text = page(product.but(tests={**product.tests, **tests}, stands={"cell 3": stand}))
    assert 'aria-label="Sensors: table"' in text
    assert "PT-3" in text


def test_zeros_that_wander_do_not(product: Campaign) -> None:
    """Of a thousand orders by chance as many as it says."""
    rng = np.random.default_rng(5)
    found = [by_chance(range(7), list(rng.standard_normal(7))) for _ in range(1000)]
    assert 5 <= sum(p is not None and p < 0.02 for p in found) <= 35
    assert by_chance(range(8), [0.0] * 8) is None
    assert not drifting(sensors_of(rows(product, [0.1, 0.0, 0.1, 0.05, 0.0, 0.08])))


def test_a_test_in_which_a_zero_was_off_is_named(product: Campaign) -> None:
    tests = rows(product, [0.01, 0.02, 0.01, 0.03, 0.9, 0.02, 0.01, 0.03])
    (found,) = sensors_of(tests).values()
    assert found.zero is not None
    assert found.zero.left == ("T4",)
    stand = product.stands["cell 3"].but(tests=tuple(tests), sensors=sensors_of(tests), constants={}, effects={})
    assert "The zero of PT-3 (chamber pressure) was off in T4: 0.9 bar." in conclusions(stand, tests)


def test_another_serial_number_is_another_sensor(product: Campaign) -> None:
    tests = rows(product, [0.0, 0.01, 0.02, 0.03]) | {
        f"U{i}": row(product, 10 + i, 1.0 + 0.01 * i, "PT-4") for i in range(3)
    }
    found = sensors_of(tests)
    assert list(found) == ["PT-3", "PT-4"]
    assert found["PT-4"].zero is not None
    assert list(found["PT-4"].zero.by_test) == ["U0", "U1", "U2"]
    unstated = sensors_of({name: row(product, i + 1, 0.0, None) for i, name in enumerate("AB")})
    assert list(unstated) == ["p_chamber"]
    assert sensors_of({"A": row(product, 1, 0.0)}) == {}


def test_zeros_are_those_that_were_taken(tmp_path: Path) -> None:
    stated = definition(tmp_path, "T1")
    path = stated.path
    text = path.read_text(encoding="utf-8").replace('unit = "bar" }', 'unit = "bar", sensor = "PT-9" }')
    path.write_text(text, encoding="utf-8")
    summary = ChannelSummary(
        label="p", unit="Pa", samples=2, good=2, rate=1.0, start=0.0, end=1.0, least=0.0, largest=1.0, flags={},
        accuracy=1e3, accuracy_stated=True, zero=2e3, zero_std=100.0, drift=0.0, history=(),
    )  # fmt: skip
    not_taken = summary.but(zero=0.0, zero_std=None)
    ingest = Ingest.model_construct(channels={"p_tank": summary, "thrust": not_taken})
    zero = Quantity(2e3, "Pa", 100.0)
    assert readings_of(load_definition(path), ingest, None) == {"p_tank": Reading(sensor="PT-9", zero=zero)}


def test_a_cell_that_shows_half_of_what_was_weighed_in_is_named(product: Campaign, tmp_path: Path) -> None:
    """0.52 of the load in each test: by the cell's reading at rest over what test.toml states."""
    path = definition(tmp_path / "weighed", "T1").path
    stated = '[tank]\nvolume = "16.5 L"\noxidizer_mass = "10 kg +/- 0.05"\n'
    path.write_text(path.read_text(encoding="utf-8") + stated, encoding="utf-8")
    calibration = filled(Calibration, {"rest": {"load_cell_mass": Quantity(5.2, "kg", 0.02).to_json()}})
    (reading,) = readings_of(load_definition(path), None, calibration).values()
    assert reading.gain is not None
    assert reading.gain.value == pytest.approx(0.52)
    assert reading.gain.std == pytest.approx(0.52 * (0.005**2 + (0.02 / 5.2) ** 2) ** 0.5, rel=1e-3)
    tests = {test: product.tests["A"].but(sensors={"m_tank": reading}) for test in ("T1", "T2", "T3")}
    stand = product.stands["cell 3"].but(tests=tuple(tests), sensors=sensors_of(tests), constants={}, effects={})
    (said,) = conclusions(stand, tests)
    assert said.startswith("The gain of tank mass is 0.52 (")
    assert said.endswith("it shows another load than the one stated.")
