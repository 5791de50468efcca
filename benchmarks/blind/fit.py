"""From raw log evidences to stated probabilities: p_k proportional to exp(b_class(k) + e_k / T).

In a share ``misled`` of the cases the evidence misleads altogether, and the labels have the probabilities from before.
T = T0 (1 + t1 max(0, leftover - 1)) with the chi-square per degree of freedom that the best named model leaves; one
offset b for the names and one for ``unknown``, that of ``none`` is 0. A label of which nothing was seen has an offset
of its kind instead, and no evidence. Fitted by penalised likelihood of the right label
(temperature scaling: Guo, Pleiss, Sun, Weinberger: On Calibration of Modern Neural Networks, 2017).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, inf
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import logsumexp

from hfanalysis.diagnose.answer.posterior import BEFORE, UNSEEN, Scale

Array = NDArray[np.float64]

NAMES = ("ln_temperature", "named", "unknown", "unseen named", "unseen unknown", "per_leftover", "misled")
PRIOR_STD = np.array([3.0, 10.0, 10.0, 10.0, 10.0, 10.0, 0.1])
"""Of NAMES (the temperature is T0, per_leftover t1): wide, so that only what the cases leave open feels it."""
BOUNDS = ((-5.0, 12.0), *[(-200.0, 200.0)] * 4, (0.0, 50.0))

MOST_MISLED = 0.5
"""The largest share; the least is one in so many cases as there are, and two: that none was misled does not say that
none ever is (Laplace's rule of succession)."""


@dataclass(frozen=True)
class Sample:
    """One case: log evidences by label, the misfit left, the right label; samples of one group share a fold."""

    evidences: dict[str, float]
    leftover: float
    truth: str
    group: str


@dataclass(frozen=True)
class Constants:
    """The constants of the stated probabilities; as they are here, the evidences are believed."""

    temperature: float = 1.0
    per_leftover: float = 0.0
    named: float = 0.0
    unknown: float = 0.0
    misled: float = 0.0
    unseen_named: float | None = None
    unseen_unknown: float | None = None

    def probabilities(self, evidences: Mapping[str, float], leftover: float) -> dict[str, float]:
        """The stated probabilities.

        >>> p = Constants(temperature=2.0).probabilities({"none": 0.0, "tank_heat": 2.0}, 1.0)
        >>> round(p["tank_heat"], 3)
        0.731
        """
        return self.scale.probabilities(evidences, leftover)

    @property
    def scale(self) -> Scale:
        """The constants as the diagnosis takes them."""
        offsets = {"none": 0.0, "named": self.named, "unknown": self.unknown}
        unseen = {"unseen named": self.unseen_named, "unseen unknown": self.unseen_unknown}
        offsets |= {k: v for k, v in unseen.items() if v is not None}
        return Scale(self.temperature, self.per_leftover, offsets, self.misled)


def sample(product: Mapping[str, Any], truth: str, group: str) -> Sample | None:
    """A sample of a product; None where it states no evidence, or none for the right label."""
    evidences = {k: float(e) for k, e in (product.get("evidences") or {}).items() if e is not None}
    evidences = {k: e for k, e in evidences.items() if np.isfinite(e)}
    leftover = product.get("leftover")
    if truth not in evidences or len(evidences) < 2:
        return None
    return Sample(evidences, 1.0 if leftover is None else float(leftover), truth, group)


@dataclass(frozen=True)
class _Table:
    """Samples as arrays: ``evidence`` [case, label] (-inf where not stated), its class (none, named, unknown, and those
    unseen), the truth."""

    evidence: Array
    kind: NDArray[np.int64]
    truth: NDArray[np.int64]
    excess: Array
    before: Array


def _table(samples: Sequence[Sample]) -> _Table:
    labels = sorted({k for s in samples for k in s.evidences})
    evidence = np.array([[s.evidences.get(k, -inf) for k in labels] for s in samples])
    kind = np.array([{"none": 0, "unknown": 2}.get(k, 1) for k in labels])
    unseen = np.isfinite(evidence) & (evidence <= UNSEEN) & (kind > 0)
    evidence[unseen] = 0.0
    excess = np.maximum([s.leftover - 1.0 for s in samples], 0.0)
    before = np.array([list(BEFORE.values())[k] / np.sum(kind == k) for k in kind])
    kinds = np.where(unseen, kind + 2, kind)
    return _Table(evidence, kinds, np.array([labels.index(s.truth) for s in samples]), excess, before / before.sum())


def _loss(x: Array, t: _Table) -> float:
    """Negative penalised log likelihood at NAMES."""
    temperature = exp(x[0]) * (1.0 + x[5] * t.excess)
    logits = np.array([0.0, *x[1:5]])[t.kind] + t.evidence / temperature[:, None]
    shares = np.exp(logits[np.arange(len(t.truth)), t.truth] - logsumexp(logits, axis=1))
    right = np.log((1.0 - x[6]) * shares + x[6] * t.before[t.truth])
    return float(-right.sum() + 0.5 * np.sum((x / PRIOR_STD) ** 2))


@dataclass(frozen=True)
class Fitted:
    """Constants and their standard errors (of ln T0 for the temperature; None at a bound)."""

    constants: Constants
    errors: dict[str, float | None]


def fit(samples: Sequence[Sample], with_leftover: bool) -> Fitted:
    """The most probable constants; from several starts, for far-off evidences make the likelihood flat.

    Raises ValueError where there is nothing to fit.
    """
    if not samples:
        raise ValueError("no case has evidences for its right label: nothing can be fitted")
    t = _table(samples)
    bounds = (*BOUNDS[:5], BOUNDS[5] if with_leftover else (0.0, 0.0), (1.0 / (len(samples) + 2.0), MOST_MISLED))
    starts = [np.array([ln_t, 0.0, 0.0, -3.0, -3.0, 0.1 if with_leftover else 0.0, 0.05]) for ln_t in (0.0, 2.0, 4.0)]
    found = [minimize(_loss, x, (t,), method="L-BFGS-B", bounds=bounds, options={"ftol": 1e-13}) for x in starts]
    best = min(found, key=lambda r: r.fun)
    x = np.asarray(best.x, dtype=float)
    temperature, named, unknown, unseen_named, unseen_unknown, per_leftover, misled = x.tolist()
    constants = Constants(exp(temperature), per_leftover, named, unknown, misled, unseen_named, unseen_unknown)
    return Fitted(constants, _errors(x, t, bounds))


def _errors(x: Array, t: _Table, bounds: Sequence[tuple[float, float]]) -> dict[str, float | None]:
    """From the curvature at the optimum, over the constants that are not at a bound."""
    free = [i for i, (low, high) in enumerate(bounds) if low + 1e-6 < x[i] < high - 1e-6]
    step = 1e-3 * np.maximum(1.0, np.abs(x))
    curvature = np.empty((len(free), len(free)))
    for a, i in enumerate(free):
        for b, j in enumerate(free):
            total = 0.0
            for si, sj in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
                y = x.copy()
                y[i] += si * step[i]
                y[j] += sj * step[j]
                total += si * sj * _loss(y, t)
            curvature[a, b] = total / (4.0 * step[i] * step[j])
    std = np.sqrt(np.maximum(np.diag(np.linalg.pinv(curvature)), 0.0)) if free else []
    out: dict[str, float | None] = dict.fromkeys(NAMES)
    return out | {NAMES[i]: float(s) for i, s in zip(free, std, strict=True)}


def folds(samples: Sequence[Sample], number: int = 5) -> NDArray[np.int64]:
    """The fold of each sample; tests of one stand stay together."""
    groups = sorted({s.group for s in samples})
    order = np.random.default_rng(0).permutation(len(groups))
    fold = {group: int(order[i]) % number for i, group in enumerate(groups)}
    return np.array([fold[s.group] for s in samples])


def out_of_fold(samples: Sequence[Sample], with_leftover: bool) -> list[Constants]:
    """For each sample the constants that the other folds give."""
    fold = folds(samples)
    by_fold = {
        int(f): fit([s for s, g in zip(samples, fold, strict=True) if g != f], with_leftover).constants
        for f in np.unique(fold)
    }
    return [by_fold[int(f)] for f in fold]
