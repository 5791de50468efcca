"""Weak-form residuals as diagnosis.json states them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hfanalysis.diagnose.weak_form.weak import WeakResidual
from hfanalysis.products.diagnosis import ChiSquare, Lacking
from hfanalysis.quantity import Quantity

Z90 = 1.6449
"""Half-width of the 90 % interval of a normal distribution, in standard deviations. Source: its quantile of 95 %."""

SEEN = 2.0
"""Standard deviations from which on something counts as lacking."""

SAME = 1e-8
"""Variance, relative to that of a single residual, below which a combination of residuals counts as known already."""

NOTHING = Quantity.absent("nowhere beyond two standard deviations")


def weak_product(residuals: Sequence[WeakResidual]) -> dict[str, Lacking]:
    """Every equation's residual by its name.

    ``value``, ``low90``, ``high90`` and ``explained`` over ``time``; where what the engine with its effects leaves
    (value less explained) is beyond two standard deviations: from ``t_start`` to ``t_end``, its ``mean`` there and the
    ``phase`` that holds most of it. ``significance``: chi-square of all of it against zero, with its degrees of
    freedom; it counts the stated noise alone, so that a verdict needs the bootstrap of the base model. ``reason`` where
    channels are missing.
    """
    return {r.equation: _entry(r) for r in residuals}


def _entry(residual: WeakResidual) -> Lacking:
    if residual.reason is not None:
        return Lacking(unit=residual.unit, reason=residual.reason)
    half = Z90 * residual.std
    found = {
        "unit": residual.unit,
        "time": residual.time.tolist(),
        "value": residual.value.tolist(),
        "low90": (residual.value - half).tolist(),
        "high90": (residual.value + half).tolist(),
        "explained": residual.explained.tolist(),
        **_where(residual),
        "significance": significance(residual),
    }
    if residual.closing is not None:
        found["closing_mass"] = Quantity(residual.closing[0], "kg", residual.closing[1])
    return Lacking.from_json(found)


def _where(residual: WeakResidual) -> dict[str, Quantity | str | None]:
    """Where something is lacking, and how much on average."""
    left = residual.left
    seen = np.flatnonzero(np.abs(left) > SEEN * residual.std)
    if not seen.size:
        return {"phase": None, "t_start": NOTHING, "t_end": NOTHING, "mean": NOTHING}
    inside = slice(int(seen[0]), int(seen[-1]) + 1)
    count = inside.stop - inside.start
    std = float(np.sqrt(residual.covariance[inside, inside].sum())) / count
    apart = float(np.median(np.diff(residual.time))) / 2.0 if residual.time.size > 1 else 0.0
    weight = dict.fromkeys(residual.phases, 0.0)
    for phase, z in zip(residual.phases, left / residual.std, strict=True):
        weight[phase] += float(z) ** 2
    return {
        "phase": max(weight, key=lambda phase: weight[phase]),
        "t_start": Quantity(float(residual.time[seen[0]]), "s", apart),
        "t_end": Quantity(float(residual.time[seen[-1]]), "s", apart),
        "mean": Quantity(float(left[inside].mean()), residual.unit, std),
    }


def significance(residual: WeakResidual) -> ChiSquare:
    """Chi-square [-] of what is left against zero, with its degrees of freedom; directions of no variance of their own
    are left out."""
    scaled = residual.covariance / np.outer(residual.std, residual.std)
    values, vectors = np.linalg.eigh(scaled)
    new = values > SAME
    along = vectors[:, new].T @ (residual.left / residual.std)
    return ChiSquare(chi_square=float((along**2 / values[new]).sum()), degrees_of_freedom=int(new.sum()))
