"""The zeros of a stand's sensors from test to test: which one drifts, and in which test one was off."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from scipy.stats import kendalltau

from hfanalysis.campaign.family import left_the_family
from hfanalysis.products.campaign import SensorRow, TestRow, Zero
from hfanalysis.products.ingest import Ingest
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition

FEWEST = 5
"""Tests from which on a zero can be seen to drift. Source: of four in a row one order in twelve is a steady one."""

DRIFTS = 0.02
"""Probability of so steady a change by chance below which a zero drifts. Source: five that only rise or fall are one in
sixty."""


def zeros_of(definition: TestDefinition, ingest: Ingest) -> dict[str, Zero]:
    """The zeros [SI] that were taken in a test, by channel, with the serial numbers that are stated."""
    return {
        name: Zero(
            sensor=spec.sensor if (spec := definition.channels.get(name)) is not None else None,
            value=Quantity(found.zero, found.unit, found.zero_std),
        )
        for name, found in ingest.channels.items()
        if found.zero_std is not None
    }


def sensors_of(rows: Mapping[str, TestRow]) -> dict[str, SensorRow]:
    """The sensors of a stand's tests that were in two of them at least; another serial number is another sensor."""
    by_sensor: dict[str, list[tuple[str, str, Quantity]]] = {}
    for test in sorted(rows, key=lambda test: (rows[test].date or "", test)):
        for channel, zero in rows[test].zeros.items():
            by_sensor.setdefault(zero.sensor or channel, []).append((test, channel, zero.value))
    return {sensor: _row(found) for sensor, found in sorted(by_sensor.items()) if len(found) > 1}


def _row(found: list[tuple[str, str, Quantity]]) -> SensorRow:
    values = [quantity.value or 0.0 for *_, quantity in found]
    beyond = left_the_family(values)
    return SensorRow(
        channel=found[-1][1],
        zeros={test: quantity for test, _, quantity in found},
        drifts=drift(values),
        left=tuple(found[i][0] for i in beyond),
    )


def drift(in_order: list[float]) -> float | None:
    """Probability [-] that numbers in a random order rise or fall as steadily (Kendall, Biometrika 30, 1938, 81); None
    for too few of them, or where all are the same.

    >>> round(drift([1.0, 1.2, 1.3, 1.7, 2.0]), 3), drift([1.0, 2.0])
    (0.017, None)
    """
    if len(in_order) < FEWEST or len(set(in_order)) < FEWEST:
        return None
    return float(kendalltau(range(len(in_order)), in_order).pvalue)


def drifting(sensors: Mapping[str, SensorRow]) -> Iterator[str]:
    """The sensors whose zero drifts."""
    yield from (name for name, row in sensors.items() if row.drifts is not None and row.drifts < DRIFTS)
