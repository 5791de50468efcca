"""From raw log evidences to stated probabilities: p_k proportional to exp(b_class(k) + e_k / T).

In a share ``misled`` of the cases the evidence misleads altogether, and the labels have the probabilities from before;
that share is ``misled_faint`` of those in which no label has what a claim needs. T = T0 (1 + t1 max(0, leftover - 1))
with the chi-square per degree of freedom that the best named model leaves; one offset b for the names and one for
``unknown``, that of ``none`` is 0. A label of which nothing was seen has an offset of its kind instead, and no
evidence. e of ``unknown`` is without ``unexplained`` times the root of the best name's, which closures get wrong;
``unknown`` is at most as probable as none where nothing is seen. Fitted by penalised likelihood of the right label
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

from hfanalysis.diagnose.answer.posterior import (
    BEFORE,
    EvidenceScale,
    above_chance,
    detailed_kinds,
    share_kept,
    unclaimable,
)

Array = NDArray[np.float64]

OFFSETS = ("named", "unknown", "unseen named", "unseen unknown")
"""Kinds of labels that have an offset; that of none is 0."""
REST = ("unexplained", "misled", "misled_faint")
"""What there is beside temperature and offsets."""
NAMES = ("ln_temperature", *OFFSETS, "per_leftover", *REST)
PRIOR_STD = np.array([3.0, 10.0, 10.0, 10.0, 10.0, 10.0, 2.0, 0.1, 0.1])
"""Of NAMES (the temperature is T0, per_leftover t1): wide, so that only what the cases leave open feels it."""
BOUNDS = ((-5.0, 12.0), *[(-200.0, 200.0)] * len(OFFSETS), (0.0, 50.0), (0.0, 5.0))
"""Of NAMES but the shares that are misled."""

MOST_MISLED = 0.5
"""The largest share; the least is one in so many cases as there are, and two: that none was misled does not say that
none ever is (Laplace's rule of succession)."""


@dataclass(frozen=True)
class Sample:
    """One case: log evidences by label, the misfit left, the right label; samples of one group share a fold.

    ``weight``: for how many cases it counts; ``elsewhere``: log evidence of an unknown source in another equation than
    the best name's.
    """

    evidences: dict[str, float]
    leftover: float
    truth: str
    group: str
    weight: float = 1.0
    elsewhere: float | None = None


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
    unexplained: float = 0.0
    misled_faint: float = 0.0

    def probabilities(
        self, evidences: Mapping[str, float], leftover: float, elsewhere: float | None = None
    ) -> dict[str, float]:
        """The stated probabilities.

        >>> p = Constants(temperature=2.0).probabilities({"none": 0.0, "tank_heat": 2.0}, 1.0)
        >>> round(p["tank_heat"], 3)
        0.731
        """
        return self.scale.probabilities(evidences, leftover, elsewhere)

    @property
    def scale(self) -> EvidenceScale:
        """The constants as the diagnosis takes them."""
        offsets = {"none": 0.0, "named": self.named, "unknown": self.unknown}
        special = {name: getattr(self, name.replace(" ", "_")) for name in OFFSETS[2:]}
        offsets |= {k: v for k, v in special.items() if v is not None}
        rest = {name: getattr(self, name) for name in REST}
        return EvidenceScale(self.temperature, self.per_leftover, offsets, **rest)


def sample(product: Mapping[str, Any], truth: str, group: str) -> Sample | None:
    """A sample of a product; None where it states no evidence, or none for the right label."""
    evidences = {k: float(e) for k, e in (product.get("evidences") or {}).items() if e is not None}
    evidences = {k: e for k, e in evidences.items() if np.isfinite(e)}
    leftover = product.get("leftover")
    if truth not in evidences or len(evidences) < 2:
        return None
    elsewhere = product.get("unknown_elsewhere")
    return Sample(evidences, 1.0 if leftover is None else float(leftover), truth, group, elsewhere=elsewhere)


@dataclass(frozen=True)
class _Table:
    """Samples as arrays: ``evidence`` [case, label] (-inf where not stated), its kind (0 for none, else the number in
    OFFSETS and 1), the truth; ``imitated`` [case, label]: the root of what the best name explains where the label is
    unknown, 0 elsewhere; ``apart`` [case]: evidence of an unknown source in another equation than that name's (-inf:
    none); ``capped`` [case, label]: whether a label is at most as probable as ``none``, the place of that label;
    ``described`` [case]: the part that all labels keep, and the truth where it is ``strange``, unknown, is given the
    rest; ``faint`` [case]: whether no label has what a claim needs."""

    evidence: Array
    imitated: Array
    apart: Array
    capped: NDArray[np.bool_]
    none: int
    kind: NDArray[np.int64]
    truth: NDArray[np.int64]
    excess: Array
    described: Array
    strange: NDArray[np.bool_]
    faint: NDArray[np.bool_]
    before: Array
    weight: Array


def _table(samples: Sequence[Sample]) -> _Table:
    labels = sorted({k for s in samples for k in s.evidences})
    evidence = np.array([[s.evidences.get(k, -inf) for k in labels] for s in samples])
    kind = np.array([{"none": 0, "unknown": 2}.get(k, 1) for k in labels])
    before = np.array([list(BEFORE.values())[k] / np.sum(kind == k) for k in kind])
    number = {"none": 0} | {name: i for i, name in enumerate(OFFSETS, 1)}
    detailed = [detailed_kinds(s.evidences) for s in samples]
    kinds = np.array([[number[of.get(label, "none")] for label in labels] for of in detailed])
    unseen = np.array([[of.get(label, "").startswith("unseen") for label in labels] for of in detailed])
    best = np.max(np.where(kind == 1, evidence, 0.0), axis=1, initial=0.0)
    imitated = np.where(kinds == 2, np.sqrt(best)[:, None], 0.0)
    capped = (kind == 2) & ~np.array([above_chance(s.evidences) for s in samples])[:, None]
    apart = np.array([-inf if s.elsewhere is None else s.elsewhere for s in samples])
    none = labels.index("none") if "none" in labels else 0
    evidence[unseen] = 0.0
    excess = np.maximum([s.leftover - 1.0 for s in samples], 0.0)
    kept = np.array([share_kept(s.leftover) if "unknown" in s.evidences else 1.0 for s in samples])
    strange = np.array([s.truth == "unknown" for s in samples])
    truth = np.array([labels.index(s.truth) for s in samples])
    weak = np.array([unclaimable(s.evidences) for s in samples])
    weight = np.array([s.weight for s in samples])
    of_labels = (evidence, imitated, apart, capped, none, kinds, truth)
    return _Table(*of_labels, excess, kept, strange, weak, before / before.sum(), weight)


def _loss(x: Array, t: _Table) -> float:
    """Negative penalised log likelihood at NAMES."""
    per_leftover, unexplained, plain, weak = x[-4:]
    misled = np.where(t.faint, weak, plain)
    temperature = exp(x[0]) * (1.0 + per_leftover * t.excess)
    evidence = t.evidence - unexplained * t.imitated
    evidence = np.where(t.kind == 2, np.maximum(evidence, t.apart[:, None]), evidence)
    logits = np.array([0.0, *x[1:-4]])[t.kind] + evidence / temperature[:, None]
    logits = np.minimum(logits, np.where(t.capped, logits[:, t.none, None], inf))
    shares = np.exp(logits[np.arange(len(t.truth)), t.truth] - logsumexp(logits, axis=1))
    stated = (1.0 - misled) * shares + misled * t.before[t.truth]
    right = np.log(t.described * stated + (1.0 - t.described) * t.strange)
    return float(-(t.weight @ right) + 0.5 * np.sum((x / PRIOR_STD) ** 2))


@dataclass(frozen=True)
class Fitted:
    """Constants and their standard errors (of ln T0 for the temperature; None at a bound)."""

    constants: Constants
    errors: dict[str, float | None]


def fit(samples: Sequence[Sample], with_leftover: bool, held: Constants | None = None, only: str = "") -> Fitted:
    """The most probable constants; from several starts, for far-off evidences make the likelihood flat.

    ``held``: constants of which ``only`` one of NAMES is fitted. Raises ValueError where there is nothing to fit.
    """
    if not samples:
        raise ValueError("no case has evidences for its right label: nothing can be fitted")
    t = _table(samples)
    shares = [
        (1.0 / (len(of) + 2.0), MOST_MISLED) for of in (samples, [s for s in samples if unclaimable(s.evidences)])
    ]
    bounds = [*BOUNDS, *shares]
    if not with_leftover:
        bounds[NAMES.index("per_leftover")] = (0.0, 0.0)
    if held is not None:
        at = _vector(held)
        bounds = [bounds[i] if name == only else (at[i], at[i]) for i, name in enumerate(NAMES)]
    first = {"unseen named": -3.0, "unseen unknown": -3.0, "unexplained": 0.3, "misled": 0.05, "misled_faint": 0.05}
    first["per_leftover"] = 0.1 if with_leftover else 0.0
    starts = [[ln_t, *(first.get(name, 0.0) for name in NAMES[1:])] for ln_t in (0.0, 2.0, 4.0)]
    low, high = np.array(bounds).T
    found = [
        minimize(_loss, np.clip(x, low, high), (t,), method="L-BFGS-B", bounds=bounds, options={"ftol": 1e-13})
        for x in starts
    ]
    x = np.asarray(min(found, key=lambda r: r.fun).x, dtype=float)
    of = dict(zip(NAMES, x.tolist(), strict=True))
    constants = Constants(
        exp(of.pop("ln_temperature")), **{name.replace(" ", "_"): value for name, value in of.items()}
    )
    return Fitted(constants, _errors(x, t, bounds))


def constants_of(data: Mapping[str, Any]) -> Constants:
    """Constants as the data file holds them."""
    offsets = {name.replace(" ", "_"): value for name, value in data["offsets"].items() if name != "none"}
    rest = {name: data[name] for name in REST}
    return Constants(data["temperature"], data["temperature_per_leftover"], **rest, **offsets)


def _vector(constants: Constants) -> Array:
    """Constants in the order of NAMES; an offset that there is not yet is that of its kind."""
    offsets = constants.scale.offsets
    own = [offsets.get(name, offsets[name.split()[-1]]) for name in OFFSETS]
    rest = (getattr(constants, name) for name in REST)
    return np.array([np.log(constants.temperature), *own, constants.per_leftover, *rest])


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
