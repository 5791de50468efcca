"""Whether a constant of the stand goes with a condition of its tests, or with their order."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from scipy.stats import kendalltau, theilslopes

from hfanalysis.products.campaign import TestRow, Trend
from hfanalysis.quantity import NORMAL_95, Quantity

FEWEST = 5
"""Tests from which on something can be seen to go with their order. Source: of four one order in twelve is a steady
one."""

STEADY = 0.02
"""Probability of so steady a change by chance below which it is told. Source: five that only rise or fall are one in
sixty."""

CONSTANTS = ("C_i", "K_loss", "m")
CONDITIONS = {"subcooling": "K", "back_pressure": "", "tank_temperature": "K"}
"""What may act on them, with its unit: how far below saturation the liquid reaches the injector, what is behind it of
the pressure before it, and how warm the tank is."""


def by_chance(over: Sequence[float], values: Sequence[float]) -> float | None:
    """Probability [-] that numbers in a random order go as steadily with others (Kendall, Biometrika 30, 1938, 81);
    None for too few of them that differ.

    >>> round(by_chance(range(5), [1.0, 1.2, 1.3, 1.7, 2.0]), 3), by_chance(range(2), [1.0, 2.0])
    (0.017, None)
    """
    if min(len(set(values)), len(set(over))) < FEWEST:
        return None
    return float(kendalltau(over, values).pvalue)


def trends(rows: Mapping[str, TestRow], found: Mapping[str, Mapping[str, Quantity]]) -> tuple[Trend, ...]:
    """Every constant over every condition that enough tests know, by the constants ``found`` in them."""
    out = []
    for name in CONSTANTS:
        able = _of_one_injector(rows, found[name]) if name == "C_i" else found[name]
        for condition, unit in CONDITIONS.items():
            both = {t: (c.value, q.value) for t, q in able.items() if (c := rows[t].conditions.get(condition))}
            known = {t: (c, v) for t, (c, v) in both.items() if c is not None and v is not None}
            over, values = [c for c, _ in known.values()], [v for _, v in known.values()]
            if (chance := by_chance(over, values)) is None:
                continue
            slope, _, low, high = theilslopes(values, over)
            own = next(iter(able.values())).unit
            per = " ".join(filter(None, (own, f"1/{unit}" if unit else "")))
            steep = Quantity(float(slope), per, float(high - low) / (2.0 * NORMAL_95), (float(low), float(high)))
            out.append(Trend(of=name, over=condition, tests=tuple(known), slope=steep, probability=chance))
    return tuple(one.but(probability=min(1.0, len(out) * one.probability)) for one in out)


def _of_one_injector(rows: Mapping[str, TestRow], found: Mapping[str, Quantity]) -> dict[str, Quantity]:
    """Those of the injector that most tests have: with another one C_i may change for that alone."""
    areas = Counter(rows[test].injector_area for test in found)
    most = max(areas, key=areas.__getitem__, default=None)
    return {test: quantity for test, quantity in found.items() if rows[test].injector_area == most}
