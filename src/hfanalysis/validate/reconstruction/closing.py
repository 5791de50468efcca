"""One efficiency for the window, such that the fuel burnt comes out; the histories with it, and their bands."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.quantity import NORMAL_95
from hfanalysis.validate.reconstruction.follow import follow
from hfanalysis.validate.reconstruction.inputs import Inputs
from hfanalysis.validate.reconstruction.theory import MIXTURES, Theory

EFFICIENCIES = np.linspace(0.6, 1.1, 201)
"""Of c* [-] that are tried. Source: below 0.6 the fire is out, above 1 by more than errors nothing burns."""

NEAR = np.linspace(-0.08, 0.08, 65)
"""About the burn's own efficiency, relative [-], where an error's one is looked for. Source: errors of some per cent."""

FAINT = 10.0
"""Per cent of OF that go with one of p_c, from which on a mixture is not told. Source: the technique's own measure: at
ten a sensor of 1 % tells OF no better than by 10 %."""


SAME = 0.05
"""Difference of the logarithm of OF from which two paths are two. Source: below it they are one within what a sensor of
1 % tells."""


UNLIKELY = 12.0
"""Difference of cost from which a path is not possible beside another. Source: twice a logarithm of odds, of 400."""

STARTS = (0, 1, 2)
"""Mixtures that fit, from the leanest on, from which paths begin."""


@dataclass(frozen=True)
class Closed:
    """Histories (n, lanes): the burn as it is, and with each error moved.

    ``efficiency`` (lanes,) of c* [-]; ``of_ratio`` [-], ``fuel`` flow [kg/s]; ``stiffness`` (n,): per cent of OF for
    one of the pressure; ``cost`` [-] of how OF moves; ``other``: another path that closes as well, from a richer or
    a leaner side.
    """

    efficiency: Array
    of_ratio: Array
    fuel: Array
    stiffness: Array
    cost: float
    other: Closed | None = None

    @property
    def told(self) -> NDArray[np.bool_]:
        """Where OF is told (n,): it does not hang on the last per cent of the pressure, and there is no other."""
        told = self.stiffness < FAINT
        return np.asarray(told if self.other is None else told & (self._apart(self.other) < SAME))

    def _apart(self, other: Closed) -> Array:
        return np.abs(np.log(other.of_ratio[:, 0] / self.of_ratio[:, 0]))


def close(inputs: Inputs, theory: Theory) -> Closed | str:
    """The reconstruction; or why there is none."""
    if inputs.fuel is None:
        return "nobody says how much fuel burnt"
    left = (1.0 + 1.0 / MIXTURES) * theory.rows(inputs.pressure)
    starts = {start: _efficiency(inputs, "", left, start, EFFICIENCIES) for start in STARTS}
    found = [
        one
        for start, at in starts.items()
        if at is not None and (one := _closed(inputs, left, start, at)) is not None
    ]
    if not found:
        return _why_not(inputs, left)
    best = min(found, key=lambda one: one.cost)
    near = [one for one in found if one is not best and one.cost - best.cost < UNLIKELY]
    others = [one for one in near if np.max(best._apart(one)) > SAME]
    return replace(best, other=others[0]) if others else best


def _closed(inputs: Inputs, left: Array, start: int, at: float) -> Closed | None:
    """On the path of one start, which closes ``at`` an efficiency [-]; None where it has a gap."""
    near = at * (1.0 + NEAR)
    found = [at, *(_efficiency(inputs, name, left, start, near) for name in inputs.lanes[1:])]
    # an error that lets nothing close stays unmoved here: it is larger than what the burn allows
    efficiency = np.array([at if value is None else value for value in found])
    right = np.column_stack([inputs.lane(name)[0] for name in inputs.lanes])
    path = follow(left, MIXTURES, right / efficiency, inputs.step, start)
    mixture = np.exp(path.mixture)
    if not np.isfinite(mixture[:, 0]).all():
        return None
    mixture = np.where(np.isfinite(mixture).all(axis=0), mixture, mixture[:, :1])
    oxidizer = np.column_stack([inputs.oxidizer_of(name) for name in inputs.lanes])
    return Closed(efficiency, mixture, oxidizer / mixture, _stiffness(left, mixture[:, 0]), float(path.cost[0]))


def _burnt(inputs: Inputs, name: str, left: Array, start: int, tried: Array) -> tuple[Array, Array]:
    """Fuel [kg] by each efficiency, with an error moved, NaN where no mixture fits; and the paths' cost."""
    right = inputs.lane(name)[0][:, None] / tried
    path = follow(left, MIXTURES, right, inputs.step, start)
    flow = inputs.oxidizer_of(name)[:, None] / np.exp(path.mixture)
    return np.asarray(np.trapezoid(flow, inputs.time, axis=0)), path.cost


def _efficiency(inputs: Inputs, name: str, left: Array, start: int, tried: Array) -> float | None:
    """Of those ``tried`` the efficiency at which the fuel burnt comes out, with the path that moves least; None where
    none does."""
    burnt, cost = _burnt(inputs, name, left, start, tried)
    over = burnt - (inputs.lane(name)[1] or 0.0)
    known = np.flatnonzero(np.isfinite(over))
    passes = [(a, b) for a, b in pairwise(known) if (over[a] >= 0.0) != (over[b] >= 0.0)]
    if not passes:
        return None
    a, b = min(passes, key=lambda pair: float(cost[pair[0]] + cost[pair[1]]))
    part = over[a] / (over[a] - over[b])
    return float(tried[a] + part * (tried[b] - tried[a]))


def _stiffness(left: Array, mixture: Array) -> Array:
    """|d ln OF / d ln p| (n,)."""
    slope = np.gradient(np.log(left), np.log(MIXTURES), axis=1)
    x = np.log(MIXTURES)
    at = np.array([np.interp(np.log(m), x, row) for m, row in zip(mixture, slope, strict=True)])
    return np.asarray(1.0 / np.maximum(np.abs(at), 1e-6))


def _why_not(inputs: Inputs, left: Array) -> str:
    """In words, from what the ends of the efficiencies make of the fuel."""
    burnt = np.concatenate([_burnt(inputs, "", left, start, EFFICIENCIES)[0] for start in STARTS])
    known = burnt[np.isfinite(burnt)]
    if not known.size:
        return "no mixture of the propellants takes the flow away: pressure, throat or oxidizer flow is off"
    return (
        f"no c* efficiency from {EFFICIENCIES[0]:.1f} to {EFFICIENCIES[-1]:.1f} makes {inputs.fuel:.3g} kg of fuel "
        f"burn: {known.min():.3g} to {known.max():.3g} kg; pressure, throat, oxidizer flow or the fuel's mass is off"
    )


def band(histories: Array, white: Array | float = 0.0) -> tuple[Array, Array]:
    """The 95 % interval (n,) each of a positive history (n, lanes): all errors, and the noise of each sample
    (``white``, relative) [-]."""
    size = np.log(histories)
    std = np.sqrt(np.sum((size[:, 1:] - size[:, :1]) ** 2, axis=1) + np.asarray(white) ** 2)
    return histories[:, 0] * np.exp(-NORMAL_95 * std), histories[:, 0] * np.exp(NORMAL_95 * std)
