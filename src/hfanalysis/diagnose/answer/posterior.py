"""Probabilities of none, each name and unknown, from log evidences.

Evidences of a real test are too sure of themselves: noise and forms are never quite what they are taken for. They are
divided by a temperature that grows with what the best name leaves open, and shifted by kind; the constants were fitted
to simulated tests (``make blind-calibrate``), and stand in probabilities.json with their number of cases.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.resources import files
from math import sqrt

import numpy as np

from hfanalysis.diagnose.naming.freeform import REST
from hfanalysis.diagnose.naming.naming import Naming
from hfanalysis.inference.candidate import Candidate

SET = 0.9
"""Probability that the stated set of names holds."""


ABOVE_CHANCE = {"named": 5.0, "unknown": 10.0}
"""Log evidence of which, where no label has it, unknown is taken to be no more probable than none. Evidence: of 214
tests of the calibration split that hide nothing (docs/blind.md names the runs) `benchmarks.blind calibrate` prints 7.8,
7.6, 4.8 and 4.1 as the largest of names, and 6.8, 6.4, 6.3 and 6.1 as those of unknown sources. Those need more, for a
source that explains little is what two tables of nitrous oxide differ by: with 8.5 a practice case without an effect
(P03) was claimed."""


LEAST_EVIDENCE = 9.0
"""Log evidence that a label needs itself to be claimed. Evidence: more than any has of those 214 tests."""


POOR_FIT = 2.0
"""Chi-square per observation that the best name leaves, at the model-form error that it asks for, beyond which model
and test are further apart than in any of the tests by which probabilities were fitted. Evidence: none of the 650 tests
of the calibration split leaves more (probabilities.json, docs/diagnosis.md)."""


def poor_fit(leftover: float) -> bool:
    """Whether no model comes near a test of which the best name leaves so much (``leftover``: chi-square per
    observation [-])."""
    return leftover > POOR_FIT


def share_kept(leftover: float) -> float:
    """The part [-] of its probability that a label keeps whose model leaves so much (``leftover``: chi-square per
    observation [-]); the rest is that of unknown.

    >>> share_kept(1.3), share_kept(8.0)
    (1.0, 0.25)
    """
    return POOR_FIT / leftover if poor_fit(leftover) else 1.0


@dataclass(frozen=True)
class EvidenceScale:
    """How log evidences become probabilities: p_k ~ exp(offset of its kind + evidence / T).

    A label of which a score test saw nothing (UNSEEN) is as good as none, but for an offset of its own: that an effect
    is too small to be seen is no evidence against it. What a closure gets wrong of an effect grows with what it
    explains, but less than in proportion: unknown has ``unexplained`` times the root of the best name's evidence less
    than it found, unless its source acts in another equation; and where nothing is ``above_chance`` it is at most as
    probable as none. In a share ``misled`` of the tests the evidence misleads altogether; there the labels have the
    probabilities that they have before a test. Where all evidence is ``unclaimable`` that share is another,
    ``misled_faint``. Of a test that no model comes near unknown has what these do not keep.
    """

    temperature: float = 1.0
    temperature_per_leftover: float = 0.0
    offsets: Mapping[str, float] = field(default_factory=lambda: dict.fromkeys(("none", "named", "unknown"), 0.0))
    misled: float = 0.0
    misled_faint: float = 0.0
    unexplained: float = 0.0

    def probabilities(
        self, evidences: Mapping[str, float], leftover: float, elsewhere: float | None = None
    ) -> dict[str, float]:
        """Of every label of ``evidences`` [natural log]; they sum to one. ``leftover``: chi-square per observation [-].

        ``elsewhere``: log evidence of the best unknown source in another equation than the best name's.

        >>> found = EvidenceScale().probabilities({"none": 0.0, "tank_heat": 12.0, "unknown": 0.0}, 1.0)
        >>> round(found["tank_heat"], 3)
        1.0
        """
        heat, labels = self.heat(leftover), list(evidences)
        kinds, counted = detailed_kinds(evidences), beyond_closures(evidences, self.unexplained, elsewhere)
        logs = np.array([self._log(kinds[label], counted[label], heat) for label in labels])
        if "unknown" in labels and "none" in labels and not above_chance(evidences):
            unknown = labels.index("unknown")
            logs[unknown] = min(logs[unknown], logs[labels.index("none")])
        weights = np.exp(logs - logs.max())
        before = np.array([BEFORE[kind(label)] for label in labels])
        before[[kind(label) == "named" for label in labels]] /= max(sum(kind(k) == "named" for k in labels), 1)
        misled = self.misled_faint if unclaimable(evidences) else self.misled
        mixed = (1.0 - misled) * weights / weights.sum() + misled * before / before.sum()
        if "unknown" in labels:
            mixed = share_kept(leftover) * mixed
            mixed[labels.index("unknown")] += 1.0 - share_kept(leftover)
        return dict(zip(labels, mixed.tolist(), strict=True))

    def heat(self, leftover: float) -> float:
        """The temperature [-] that evidences are divided by; ``leftover``: chi-square per observation [-]."""
        return self.temperature * (1.0 + self.temperature_per_leftover * max(0.0, leftover - 1.0))

    def _log(self, of: str, evidence: float, heat: float) -> float:
        plain = of.split()[-1]
        if of.startswith("unseen") and of in self.offsets:
            return self.offsets[of]
        return self.offsets.get(of, self.offsets[plain]) + evidence / heat


def above_chance(evidences: Mapping[str, float]) -> bool:
    """Whether any label has as much evidence [natural log] as hardly a test shows that hides nothing, that of none
    being 0.

    >>> above_chance({"none": 0.0, "tank_heat": 5.2, "unknown": 9.8})
    True
    >>> above_chance({"none": 0.0, "tank_heat": 4.8, "unknown": 9.8})
    False
    """
    return any(e >= ABOVE_CHANCE[kind(label)] for label, e in evidences.items() if label != "none")


def unclaimable(evidences: Mapping[str, float]) -> bool:
    """Whether no label has the evidence [natural log] that a claim needs (LEAST_EVIDENCE), that of none being 0."""
    return all(e < LEAST_EVIDENCE for label, e in evidences.items() if label != "none")


BEFORE = {"none": 0.25, "named": 0.6, "unknown": 0.15}
"""Probabilities of the kinds of labels before a test."""


def kind(label: str) -> str:
    """none, unknown, or named."""
    return label if label in ("none", "unknown") else "named"


def detailed_kinds(evidences: Mapping[str, float]) -> dict[str, str]:
    """Of every label none, named or unknown, the last two with "unseen" before it where that is so.

    >>> detailed_kinds({"none": 0.0, "tank_heat": 40.0, "n2_purge": -5.0})["n2_purge"]
    'unseen named'
    """
    unseen = {label for label, e in evidences.items() if label != "none" and e <= UNSEEN}
    return {label: f"unseen {kind(label)}" if label in unseen else kind(label) for label in evidences}


def beyond_closures(
    evidences: Mapping[str, float], unexplained: float, elsewhere: float | None = None
) -> dict[str, float]:
    """The evidences [natural log], that of unknown without what closures leave ``unexplained`` [-], by the root of the
    best name's.

    A source ``elsewhere`` keeps all that it has.

    >>> beyond_closures({"none": 0.0, "tank_heat": 100.0, "unknown": 104.0}, 0.5)["unknown"]
    99.0
    >>> beyond_closures({"none": 0.0, "tank_heat": 100.0, "unknown": 104.0}, 0.5, 102.0)["unknown"]
    102.0
    """
    if "unknown" not in evidences:
        return dict(evidences)
    best = max((e for label, e in evidences.items() if kind(label) == "named"), default=0.0)
    less = evidences["unknown"] - unexplained * sqrt(max(best, 0.0))
    return {**evidences, "unknown": less if elsewhere is None else max(less, elsewhere)}


@lru_cache(maxsize=1)
def scale() -> EvidenceScale:
    """The constants that come along; none are applied where there are none."""
    source = files("hfanalysis.diagnose.answer") / "probabilities.json"
    if not source.is_file():
        return EvidenceScale()
    found = json.loads(source.read_text(encoding="utf-8"))
    rest = {name: float(found.get(name, 0.0)) for name in ("misled", "misled_faint", "unexplained")}
    return EvidenceScale(found["temperature"], found["temperature_per_leftover"], found["offsets"], **rest)


def evidences_of(found: Naming) -> dict[str, float]:
    """Log evidence [natural log] of every label, that of none being 0. A set counts for its first name, which explains
    most."""
    zero = found.base.log_evidence
    out = {"none": 0.0}
    for candidate in (*found.singles, *found.sets):
        name = candidate.names[0]
        out[name] = max(out.get(name, -np.inf), candidate.log_evidence - zero)
    unseen = min(UNSEEN, min(out.values()))
    for name in found.equations:
        out.setdefault(name, unseen)
    strange = [c.log_evidence - zero for c in found.unknown if counts_as_unknown(c, found)]
    out["unknown"] = max(strange, default=unseen)
    return out


def partners_of(first: str, found: Naming) -> dict[str, float]:
    """Probability [-] of each further effect if the first is there, by all explanations that it is part of."""
    with_first = [c for c in (*found.singles, *found.sets) if first in c.names]
    out: dict[str, float] = {}
    for candidate, weight in zip(with_first, weights_of(with_first, found), strict=True):
        for name in candidate.names:
            if name != first:
                out[name] = out.get(name, 0.0) + weight
    return out


def weights_of(candidates: Sequence[Candidate], found: Naming) -> list[float]:
    """Probabilities (candidates,) [-] of explanations of which one is taken to be right."""
    logs = np.array([c.log_evidence for c in candidates]) / scale().heat(found.named.leftover)
    weights = np.exp(logs - logs.max())
    return list((weights / weights.sum()).tolist())


UNSEEN = -5.0
"""Log evidence of a label of which a score test saw nothing: what its free parameters cost."""


def counts_as_unknown(candidate: Candidate, found: Naming) -> bool:
    """Whether an unknown source is an answer of its own."""
    if len(candidate.names) == 1:
        return True
    explained = found.named.log_evidence - found.base.log_evidence
    return candidate.log_evidence - found.named.log_evidence > REST * explained


def smallest_set(probabilities: Mapping[str, float], share: float = SET) -> list[str]:
    """The fewest labels that hold a ``share`` [-] of the probability, the most probable first.

    >>> smallest_set({"none": 0.05, "tank_heat": 0.7, "n2_purge": 0.25}, 0.9)
    ['tank_heat', 'n2_purge']
    """
    out, total = [], 0.0
    for label, p in sorted(probabilities.items(), key=lambda item: (-item[1], item[0])):
        out.append(label)
        total += p
        if total >= share:
            break
    return out
