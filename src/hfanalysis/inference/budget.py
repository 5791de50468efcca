"""Uncertainty budgets of quantities, from the inputs' effects or from draws (GUM, JCGM 100:2008, 5.1; ASME PTC 19.1).

Systematic is what would be the same if the test were repeated on the same stand (sensors, sizes, properties); random
is what would not (noise, times read from it). With both their squares add up to the quantity's variance.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.products.budget import Budget

FEWEST = 20
"""Draws for each input, below which slopes are chance. Evidence: with 400 draws of noise alone 14 inputs explain 3 % of
it (test_budget.py)."""

ROUNDING = 1e-12
"""Of an input [-], within which its draws are one number. Source: double precision."""


@dataclass(frozen=True)
class Input:
    """What one standard deviation of an input, by its ``name``, does to the quantity (``effect``, in its unit, signed).

    Inputs of one name are fully correlated: their effects add up. ``random``: it differs from test to test.
    """

    name: str
    effect: float
    random: bool = False


def by_inputs(inputs: Iterable[Input], std: float | None = None) -> Budget | None:
    """The budget of a quantity whose inputs' effects are known; None where nothing is uncertain.

    Args:
        inputs: standard deviation times slope of every input, in the quantity's unit.
        std: standard deviation that the quantity is stated with; that of the inputs where None.

    >>> found = by_inputs([Input("gain", 3.0), Input("zero", 1.0), Input("zero", 1.0), Input("noise", 1.0, True)])
    >>> {name: round(share, 3) for name, share in found.shares.items()}, round(found.random, 3), found.non_linear
    ({'gain': 0.643, 'zero': 0.286, 'noise': 0.071}, 1.0, 0.0)
    """
    given = list(inputs)
    random = {i.name for i in given if i.random}
    variance = {name: effect**2 for name, effect in _effects(given).items() if effect != 0.0}
    stated = sum(variance.values()) if std is None else std**2
    return _budget(variance, stated, random)


def total(inputs: Iterable[Input]) -> float:
    """Standard deviation that the inputs make together, in the quantity's unit.

    >>> total([Input("gain", 3.0), Input("zero", 4.0)])
    5.0
    """
    return float(np.linalg.norm(list(_effects(inputs).values())))


def relative(inputs: Iterable[Input], level: float) -> tuple[Input, ...]:
    """The inputs' effects over a ``level`` of the quantity, in its unit."""
    return tuple(replace(i, effect=i.effect / level) for i in inputs)


def _effects(inputs: Iterable[Input]) -> dict[str, float]:
    effects: dict[str, float] = {}
    for i in inputs:
        effects[i.name] = effects.get(i.name, 0.0) + i.effect
    return effects


def by_draws(
    values: Array,
    drawn: Mapping[str, Array],
    random: Iterable[str] = (),
    std: float | None = None,
    beside: Mapping[str, float] | None = None,
) -> Budget | None:
    """The budget of a quantity that was found anew with every input drawn; None where the draws are too few.

    Args:
        values: the quantity's draws (k,); those that are not finite are left out.
        drawn: the inputs' draws by name, (k,) each, or (k, m) of m that are correlated and make one row.
        random: names of those that differ from test to test.
        std: standard deviation that the quantity is stated with; that of the draws where None.
        beside: standard deviations by independent inputs that are not among the draws, in the quantity's unit.

    The shares are those of a linear fit to the draws; what it does not explain is non-linear.
    """
    good = np.isfinite(values)
    columns = {n: _columns(x)[good] for n, x in drawn.items()}
    columns = {n: x[:, x.std(axis=0) > ROUNDING * np.abs(x).max(axis=0)] for n, x in columns.items()}
    columns = {n: x for n, x in columns.items() if x.size}
    count = sum(x.shape[1] for x in columns.values())
    if not count or good.sum() < FEWEST * count:
        return None
    y = values[good] - values[good].mean()
    stacked = np.column_stack([(x - x.mean(axis=0)) / x.std(axis=0) for x in columns.values()])
    slopes = np.linalg.lstsq(stacked, y, rcond=None)[0]
    left = y - stacked @ slopes
    total, explained = float(y @ y), float(y @ y - left @ left * (y.size / (y.size - count)))
    variance, start = {}, 0
    for name, x in columns.items():
        part = slice(start, start + x.shape[1])
        variance[name], start = float(np.var(stacked[:, part] @ slopes[part])), part.stop
    # what chance correlations of the draws add is spread over all
    scale = max(explained, 0.0) / y.size / (sum(variance.values()) or 1.0)
    stated = total / y.size if std is None else std**2
    others = {name: more**2 for name, more in (beside or {}).items() if more > 0.0}
    return _budget({n: v * scale for n, v in variance.items()} | others, stated, set(random))


def _columns(drawn: Array) -> Array:
    return drawn[:, np.newaxis] if drawn.ndim == 1 else drawn


def _budget(variance: Mapping[str, float], stated: float, random: set[str]) -> Budget | None:
    """``variance`` by input, in the square of the quantity's unit, as is the ``stated`` one."""
    if stated <= 0.0 or not np.isfinite(stated):
        return None
    total = sum(variance.values())
    by_chance = sum(v for n, v in variance.items() if n in random) / total if total else 0.0
    shares = {n: v / stated for n, v in sorted(variance.items(), key=lambda item: -item[1])}
    return Budget(
        systematic=float(np.sqrt(stated * (1.0 - by_chance))),
        random=float(np.sqrt(stated * by_chance)),
        shares=shares,
        non_linear=1.0 - sum(shares.values()) if abs(1.0 - sum(shares.values())) > 1e-12 else 0.0,
    )
