"""One case: what was hidden beside what was found. Labels are the library's names, ``none`` and ``unknown``."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path
from statistics import median
from typing import Any

from .effects import LIBRARY

NAMES = tuple(e.name for e in LIBRARY)
NOMINAL, TWINS_BELOW = 10.0, 4.0
FAILED = "failed"
"""What is stated where the diagnosis itself failed."""

Groups = dict[str, set[str]]


@dataclass(frozen=True)
class Case:
    """An answer and what was found; the label stated is the most probable one."""

    answer: dict[str, Any]
    product: dict[str, Any]

    @property
    def truth(self) -> str:
        """The right label of a test with one effect or none."""
        effects = self.answer["effects"]
        if not effects:
            return "none"
        return str(effects[0]["name"]) if effects[0]["inside_library"] else "unknown"

    @property
    def names(self) -> set[str]:
        """Names of all that is hidden."""
        return {e["name"] for e in self.answer["effects"]}

    @property
    def kind(self) -> str:
        """none, single, outside or pair; a test of a pair of tests has a single effect."""
        kind = str(self.answer["kind"])
        return "single" if kind == "stand" else kind

    @property
    def d_prime(self) -> float:
        """Against none."""
        return float(self.answer["d_prime"])

    @property
    def nearest(self) -> float:
        """d' against the nearest rival of the library."""
        return min((v for k, v in self.answer["against"].items() if k in NAMES), default=self.d_prime)

    @property
    def failed(self) -> bool:
        """No diagnosis came of it: wrong wherever something should have been found, and no claim either."""
        return self.product.get("verdict") == FAILED

    @property
    def posterior(self) -> dict[str, float]:
        """Probability of each label; a pair's hypotheses are not labels and are left out."""
        return {k: float(v) for k, v in self.product.get("posterior", {}).items() if v is not None}

    @property
    def stated(self) -> str:
        """The most probable label; with no posterior, what the verdict says."""
        if self.posterior:
            return max(self.posterior, key=lambda k: (self.posterior[k], k))
        effects = self.product.get("effects") or []
        return str(effects[0]["name"]) if effects else str(self.product.get("verdict", "none"))

    @property
    def probability(self) -> float:
        """Of the label stated."""
        return 0.0 if self.failed else self.posterior.get(self.stated, 1.0)

    @property
    def found(self) -> set[str]:
        """Names of the effects that were added to the model."""
        return {str(e["name"]) for e in self.product.get("effects") or []}

    @property
    def claims(self) -> bool:
        """Whether anything is said to be there."""
        return not self.failed and (bool(self.found) or self.product.get("verdict", "none") != "none")

    @property
    def places(self) -> list[dict[str, Any]]:
        """Localisation, the most significant first."""
        return by_significance(self.product.get("localisation") or [])

    @property
    def first_place(self) -> dict[str, Any]:
        """The first place of all: where nothing is claimed, where the product says that it most likely would be."""
        return self.places[0] if self.places else self.product.get("likeliest_place") or {}


def by_significance(places: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of a localisation, the most significant first."""
    return sorted(places, key=lambda row: -number(row.get("significance"), 0.0))


def number(x: Any, default: float = nan) -> float:
    """A number or a quantity's value."""
    if isinstance(x, dict):
        x = x.get("value")
    return default if x is None else float(x)


def load(answers: Path, products: Path, failures: Mapping[str, str] | None = None) -> tuple[list[Case], list[str]]:
    """Cases that were diagnosed, and the ids of those that have no product (or one that cannot be read).

    Args:
        answers: folder of ``ID.json``.
        products: folder of ``ID/diagnosis.json``.
        failures: why a diagnosis failed, by id: such a case counts, as one that found nothing.
    """
    cases, missing = [], []
    for path in sorted(answers.glob("*.json")):
        answer = json.loads(path.read_text(encoding="utf-8"))
        if path.stem in (failures or {}):
            cases.append(Case(answer, {"verdict": FAILED}))
            continue
        try:
            product = json.loads((products / path.stem / "diagnosis.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            missing.append(path.stem)
            continue
        cases.append(Case(answer, product))
    return cases, missing


def twins(answers: Iterable[dict[str, Any]]) -> Groups:
    """Names that a test of d' = 10 leaves closer than 4, by the median over tests and both directions; and itself."""
    ratios: dict[frozenset[str], list[float]] = {}
    for a in answers:
        effects = a["effects"]
        if len(effects) != 1 or not effects[0]["inside_library"] or a["d_prime"] < 2.0:
            continue
        for rival, d in a["against"].items():
            if rival in NAMES:
                ratios.setdefault(frozenset((effects[0]["name"], rival)), []).append(d / a["d_prime"])
    groups = {name: {name} for name in NAMES}
    for pair, values in ratios.items():
        if NOMINAL * median(values) < TWINS_BELOW:
            a, b = pair
            groups[a].add(b)
            groups[b].add(a)
    return groups


def of_kind(cases: Sequence[Case], *kinds: str) -> list[Case]:
    """The cases of some kinds."""
    return [c for c in cases if c.kind in kinds]
