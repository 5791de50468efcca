"""One efficiency for the window, such that the fuel burnt comes out; the histories with it, and their bands."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.performance.reconstruction.follow import follow
from hfanalysis.performance.reconstruction.inputs import Inputs
from hfanalysis.performance.reconstruction.theory import MIXTURES, Theory
from hfanalysis.quantity import NORMAL_95

EFFICIENCIES = np.linspace(0.6, 1.1, 201)
"""Of c* [-] that are tried. Source: below 0.6 the fire is out, above 1 by more than errors nothing burns."""

NEAR = np.linspace(-0.08, 0.08, 65)
"""About the burn's own efficiency, relative [-], where that with an error is looked for. Source: errors of some per
cent."""

FAINT = 10.0
"""Per cent of OF that go with one of p_c, from which on a mixture is not told. Source: the technique's own measure: at
ten a sensor of 1 % tells OF no better than by 10 %."""


SAME = 0.05
"""Difference of the logarithm of OF from which two paths are two. Source: below it they are one within what a sensor of
1 % tells."""


EITHER_WAY = 2 * 3
"""Paths of an error: up and down, each from all starts."""

UNLIKELY = 12.0
"""Difference of cost from which a path is not possible beside another. Source: twice a logarithm of odds, of 400."""

WITHIN = 1.5
"""Factor within which OF is told. Source: by choice; c* moves by some per cent over it."""

FARTHEST = float(np.log(20.0))
"""Logarithm of a factor beyond which a band says nothing more."""

STARTS = (0, 1, 2)
"""Mixtures that fit, from the leanest on, from which paths begin."""


@dataclass(frozen=True)
class Closed:
    """Histories (n, paths): the burn as it is, then all that it may be by an error, moved either way.

    ``efficiency`` (paths,) of c* [-]; ``of_ratio`` [-], ``fuel`` flow [kg/s]; ``lane`` (paths,) of the inputs that each
    is of; ``stiffness`` (n,): per cent of OF for
    one of the pressure; ``other``: OF (n,) of another path that closes as well, and its efficiency; None where there is
    none.
    """

    efficiency: Array
    of_ratio: Array
    fuel: Array
    lane: NDArray[np.int64]
    stiffness: Array
    other: tuple[Array, float] | None

    @property
    def told(self) -> NDArray[np.bool_]:
        """Where OF is told (n,): it does not hang on the last per cent of the pressure, its errors leave it within
        WITHIN, and there is no other."""
        low, high = band(self.of_ratio)
        told = (self.stiffness < FAINT) & (high < WITHIN * self.of_ratio[:, 0]) & (low > self.of_ratio[:, 0] / WITHIN)
        if self.other is not None:
            told = told & (np.abs(np.log(self.other[0] / self.of_ratio[:, 0])) < SAME)
        return np.asarray(told)


def close(inputs: Inputs, theory: Theory, assumed: float) -> Closed | str:
    """The reconstruction; or why there is none. ``assumed``: efficiency [-] where nobody says how much fuel burnt."""
    left = (1.0 + 1.0 / MIXTURES) * theory.rows(inputs.pressure)
    tried = [_started(inputs, left, start, assumed) for start in STARTS]
    efficiency, mixture, cost = (np.array(part) for part in zip(*tried, strict=True))
    if not np.isfinite(cost[:, 0]).any():
        return _why_not(inputs, left)
    which, start = _likely(cost)
    ratio = np.exp(mixture[start, :, which]).T
    return Closed(
        efficiency[start, which], ratio, inputs.along("oxidizer", which) / ratio, which, _stiffness(left, ratio[:, 0]),
        _other(np.exp(mixture[:, :, 0]), efficiency[:, 0], cost[:, 0]),
    )  # fmt: skip


def _likely(cost: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of ``cost`` (starts, lanes): lane and start of the burn itself, then for the burn and each error either way of
    all paths that are about as likely as the best, (1 + 2 * starts * (1 + errors),).

    An error that lets nothing close stays unmoved: it is larger than what the burn allows.
    """
    starts, lanes = cost.shape
    which, start = [0], [int(cost[:, 0].argmin())]
    for lane in (0, 0, *range(1, lanes)):
        moved = lane if np.isfinite(cost[:, lane].min()) else 0
        best = int(cost[:, moved].argmin())
        near = cost[:, moved] - cost[best, moved] < UNLIKELY
        which += [moved] * starts
        start += [i if near[i] else best for i in range(starts)]
    return np.array(which), np.array(start)


def _other(paths: Array, efficiency: Array, cost: Array) -> tuple[Array, float] | None:
    """Of the ``paths`` (starts, n) one that is not the best and about as likely."""
    best = int(cost.argmin())
    for i in np.argsort(cost):
        if cost[i] - cost[best] < UNLIKELY and np.max(np.abs(np.log(paths[i] / paths[best]))) > SAME:
            return paths[i], float(efficiency[i])
    return None


def _started(inputs: Inputs, left: Array, start: int, assumed: float) -> tuple[Array, Array, Array]:
    """Efficiency (lanes,), ln OF (n, lanes) and cost (lanes,) of the paths of one start; infinite where none closes."""
    at = _efficiency(inputs, "", left, start, EFFICIENCIES, assumed)
    shape = (inputs.time.size, len(inputs.lanes))
    if at is None:
        return np.full(shape[1], np.nan), np.full(shape, np.nan), np.full(shape[1], np.inf)
    near = at * (1.0 + NEAR)
    found = [at, *(_efficiency(inputs, name, left, start, near, assumed) for name in inputs.lanes[1:])]
    efficiency = np.array([np.nan if value is None else value for value in found])
    right = np.column_stack([inputs.lane(name)[0] for name in inputs.lanes])
    path = follow(left, MIXTURES, right / np.where(np.isfinite(efficiency), efficiency, at), inputs.step, start)
    closes = np.isfinite(efficiency) & np.isfinite(path.mixture).all(axis=0)
    return efficiency, path.mixture, np.where(closes, path.cost, np.inf)


def _burnt(inputs: Inputs, name: str, left: Array, start: int, tried: Array) -> tuple[Array, Array]:
    """Fuel [kg] by each efficiency, with an error moved, NaN where no mixture fits; and the paths' cost."""
    right = inputs.lane(name)[0][:, None] / tried
    path = follow(left, MIXTURES, right, inputs.step, start)
    flow = inputs.along("oxidizer", [inputs.lanes.index(name)]) / np.exp(path.mixture)
    return np.asarray(np.trapezoid(flow, inputs.time, axis=0)), path.cost


def _efficiency(inputs: Inputs, name: str, left: Array, start: int, tried: Array, assumed: float) -> float | None:
    """Of those ``tried`` the efficiency at which the fuel burnt comes out, with the path that moves least; None where
    none does."""
    fuel = inputs.lane(name)[1]
    if fuel is None:
        return assumed
    burnt, cost = _burnt(inputs, name, left, start, tried)
    over = burnt - fuel
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
    fuel = "no" if inputs.fuel is None else f"{inputs.fuel:.3g} kg of"
    return (
        f"no c* efficiency from {EFFICIENCIES[0]:.1f} to {EFFICIENCIES[-1]:.1f} makes {fuel} fuel "
        f"burn: {known.min():.3g} to {known.max():.3g} kg; pressure, throat, oxidizer flow or the fuel's mass is off"
    )


def band(histories: Array, white: Array | float = 0.0) -> tuple[Array, Array]:
    """The 95 % interval (n,) each of a positive history (n, paths), and the noise of each sample (``white``, relative,
    one standard deviation) [-].

    Each error was moved by two deviations either way; what it does on one side need not be what it does on the other.
    """
    moved = np.log(histories[:, 1:] / histories[:, :1]).reshape(histories.shape[0], -1, EITHER_WAY)
    low, high = np.minimum(moved.min(axis=2), 0.0), np.maximum(moved.max(axis=2), 0.0)
    noise = (NORMAL_95 * np.asarray(white)) ** 2
    down, up = (np.minimum(np.sqrt(np.sum(x**2, axis=1) + noise), FARTHEST) for x in (low, high))
    return histories[:, 0] * np.exp(-down), histories[:, 0] * np.exp(up)
