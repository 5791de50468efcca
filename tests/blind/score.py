"""Score diagnoses against answers: every figure of the benchmark's table with its number of cases and Wilson limits.

A product is a ``diagnosis.json``; a case without one is counted as missing and leaves the figures to the others. The
labels are the library's names, ``none`` and ``unknown``; the label stated is the most probable one.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import nan, sqrt
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from .effects import LIBRARY

NAMES = tuple(e.name for e in LIBRARY)
LABELS = (*NAMES, "none", "unknown")
SEEN = 6.0
"""d' from which an effect is to be named."""
APART, WELL_APART = 4.0, 6.0
"""d' against every rival from which the exact name is asked."""
NOMINAL, TWINS_BELOW = 10.0, 4.0
SURE = 0.9
OUTSIDE_SEEN, PAIR_SEEN = 8.0, 8.0
Z90 = 1.6448536269514722


@dataclass(frozen=True)
class Figure:
    """A share or a median with 95 % limits; ``n`` cases, ``k`` of them successes where it is a share."""

    value: float
    low: float
    high: float
    n: int
    k: int | None = None

    def to_json(self) -> dict[str, Any]:
        """None where there is nothing to count."""
        return {k: (None if isinstance(v, float) and np.isnan(v) else v) for k, v in vars(self).items()}


def share(outcomes: Iterable[bool]) -> Figure:
    """A share with Wilson limits.

    >>> f = share([True] * 9 + [False])
    >>> round(f.low, 3), f.value, round(f.high, 3)
    (0.596, 0.9, 0.982)
    """
    values = [bool(x) for x in outcomes]
    n, k, z = len(values), sum(values), 1.959963984540054
    if n == 0:
        return Figure(nan, nan, nan, 0, 0)
    p = k / n
    middle, half = p + z * z / (2 * n), z * sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    low, high = ((middle + sign * half) / (1 + z * z / n) for sign in (-1, 1))
    return Figure(p, max(low, 0.0), min(high, 1.0), n, k)


def middle(values: Iterable[float]) -> Figure:
    """Median with limits from the order statistics (normal approximation to the binomial)."""
    x = sorted(v for v in values if v is not None and np.isfinite(v))
    n = len(x)
    if n == 0:
        return Figure(nan, nan, nan, 0)
    half = 0.98 * sqrt(n)
    low, high = max(int(np.floor(n / 2 - half)), 0), min(int(np.ceil(n / 2 + half)), n - 1)
    return Figure(median(x), x[low], x[high], n)


@dataclass(frozen=True)
class Case:
    """An answer and what was found."""

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
        return self.posterior.get(self.stated, 1.0)

    @property
    def found(self) -> set[str]:
        """Names of the effects that were added to the model."""
        return {str(e["name"]) for e in self.product.get("effects") or []}

    @property
    def claims(self) -> bool:
        """Whether anything is said to be there."""
        return bool(self.found) or self.product.get("verdict", "none") != "none"

    @property
    def places(self) -> list[dict[str, Any]]:
        """Localisation, the most significant first."""
        return sorted(self.product.get("localisation") or [], key=lambda r: -_number(r.get("significance"), 0.0))


def _number(x: Any, default: float = nan) -> float:
    """A number or a quantity's value."""
    if isinstance(x, dict):
        x = x.get("value")
    return default if x is None else float(x)


def load(answers: Path, products: Path) -> tuple[list[Case], list[str]]:
    """Cases that have a product, and the ids of those that have none (or one that cannot be read)."""
    cases, missing = [], []
    for path in sorted(answers.glob("*.json")):
        answer = json.loads(path.read_text(encoding="utf-8"))
        try:
            product = json.loads((products / path.stem / "diagnosis.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            missing.append(path.stem)
            continue
        cases.append(Case(answer, product))
    return cases, missing


def twins(answers: Iterable[dict[str, Any]]) -> dict[str, set[str]]:
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


def singles(cases: Sequence[Case], least: float = 0.0) -> list[Case]:
    """Tests with one effect of the library that is at least so visible."""
    return [c for c in cases if c.kind == "single" and c.d_prime >= least]


def _kind(cases: Sequence[Case], *kinds: str) -> list[Case]:
    return [c for c in cases if c.kind in kinds]


def naming(cases: Sequence[Case], groups: dict[str, set[str]]) -> dict[str, Figure]:
    """Names: exact, in the group, sets, sure and wrong, false alarms, outsiders, pairs."""
    seen = singles(cases, SEEN)
    one = _kind(cases, "single", "none", "outside")
    known = _kind(cases, "single", "none")
    out = {
        "exact_name": share(c.stated == c.truth for c in seen if c.nearest >= APART),
        "exact_name_well_apart": share(c.stated == c.truth for c in seen if c.nearest >= WELL_APART),
        "exact_name_no_twin_allowance": share(c.stated == c.truth for c in seen),
        "twin_group": share(c.stated in groups[c.truth] for c in seen),
        "set90_coverage": share(c.truth in set(c.product.get("set90", ())) for c in known),
        "set90_coverage_outside": share("unknown" in c.product.get("set90", ()) for c in _kind(cases, "outside")),
        "set90_size": mean(len(c.product.get("set90", ())) for c in seen),
        "sure_and_wrong": share(_sure_and_wrong(c, groups) for c in one),
        "false_alarm": share(c.claims for c in _kind(cases, "none")),
        "pair_both": share(
            c.names <= c.found for c in _kind(cases, "pair") if min(c.answer["given_others"].values()) >= PAIR_SEEN
        ),
    }
    strange = [c for c in _kind(cases, "outside") if (c.answer["after_best_of_library"] or 0.0) >= OUTSIDE_SEEN]
    out["outside_unknown"] = share(c.stated == "unknown" for c in strange)
    out["outside_unknown_and_equation"] = share(c.stated == "unknown" and right_equation(c) for c in strange)
    return out


def _sure_and_wrong(c: Case, groups: dict[str, set[str]]) -> bool:
    """More than 90 % for an effect that is not there and no twin of what is, or for none with one in plain view."""
    if c.probability <= SURE:
        return False
    if c.kind == "outside" and c.stated in NAMES:
        # what an outsider cannot be told from is no error
        return float(c.answer["against"].get(c.stated, c.d_prime)) >= APART
    if c.stated in NAMES:
        return c.stated not in groups.get(c.truth, {c.truth})
    return c.stated != c.truth and c.d_prime >= SEEN


def mean(values: Iterable[float]) -> Figure:
    """Mean with normal limits."""
    x = np.array(list(values), dtype=float)
    if len(x) == 0:
        return Figure(nan, nan, nan, 0)
    half = 1.96 * x.std(ddof=1) / sqrt(len(x)) if len(x) > 1 else nan
    return Figure(float(x.mean()), float(x.mean() - half), float(x.mean() + half), len(x))


def right_equation(c: Case) -> bool:
    """The first place found is in an equation of something that is hidden."""
    return bool(c.places) and any(c.places[0].get("equation") in e["equations_accepted"] for e in c.answer["effects"])


def right_phase(c: Case) -> bool:
    """The first place found is in a phase in which the source acts."""
    return bool(c.places) and any(c.places[0].get("phase") in e["phases"] for e in c.answer["effects"])


def onset_covered(c: Case) -> bool | None:
    """The onset inside the stated 95 % band; None where no band is stated or the source does not begin with a step."""
    effect = c.answer["effects"][0]
    start = c.places[0].get("t_start") if c.places else None
    if effect["onset_kind"] != "step" or effect["onset"] is None or not isinstance(start, dict):
        return None
    band = start.get("ci95")
    if band is None and start.get("std") is not None:
        band = [_number(start) - 1.96 * start["std"], _number(start) + 1.96 * start["std"]]
    return None if band is None else bool(band[0] <= effect["onset"] <= band[1])


def _true_source(effect: dict[str, Any], time: Any) -> Any:
    source = effect["source"]
    there = source["start"] + source["step"] * np.arange(len(source["values"]))
    return np.interp(time, there, source["values"])


def size_covered(c: Case) -> bool | None:
    """The mean true source over the stated stretch inside the 90 % interval; None where equation or unit differ."""
    if not c.places:
        return None
    row, effect = c.places[0], c.answer["effects"][0]
    found = row.get("source")
    if row.get("equation") != effect["equation"] or not isinstance(found, dict):
        return None
    if found.get("unit") != effect["source"]["unit"] or found.get("std") is None or found.get("value") is None:
        return None
    lo, hi = _number(row.get("t_start")), _number(row.get("t_end"))
    if not hi > lo:
        return None
    true = float(np.mean(_true_source(effect, np.linspace(lo, hi, 200))))
    return abs(found["value"] - true) <= Z90 * found["std"]


def band_shares(c: Case) -> list[bool]:
    """Sample by sample, whether the true source lies in the 90 % band (``history`` of the first place)."""
    row, effect = (c.places[0] if c.places else {}), c.answer["effects"][0]
    h = row.get("history")
    if not h or row.get("equation") != effect["equation"] or h.get("unit") != effect["source"]["unit"]:
        return []
    true = _true_source(effect, h["time"])
    return [bool(lo <= x <= hi) for lo, x, hi in zip(h["low90"], true, h["high90"], strict=True)]


def localisation(cases: Sequence[Case]) -> dict[str, Figure]:
    """Where, when and how much, before any name."""
    seen = [c for c in _kind(cases, "single", "outside") if c.d_prime >= SEEN]
    onset = [x for x in map(onset_covered, seen) if x is not None]
    samples = [x for c in seen for x in band_shares(c)]
    return {
        "equation_first": share(right_equation(c) for c in seen),
        "phase": share(right_phase(c) for c in seen),
        "onset_in_95_band": share(onset),
        "no_source_on_none": share(not c.places for c in _kind(cases, "none")),
        "source_in_90_band": share(samples),
        "size_in_90_interval": share(x for x in map(size_covered, seen) if x is not None),
    }


def reliability(cases: Sequence[Case], bins: int = 10) -> tuple[Figure, list[dict[str, float]]]:
    """Debiased calibration error (Kumar, Liang and Ma 2019) of the label stated, and its diagram in equal counts."""
    one = [(c.probability, c.stated == c.truth) for c in _kind(cases, "single", "none", "outside") if c.posterior]
    one.sort(key=lambda pair: pair[0])  # and nothing else: among equals the right ones must not come last
    if len(one) < 2:
        return Figure(nan, nan, nan, len(one)), []
    parts = [p for p in np.array_split(np.array(one, dtype=float), min(bins, max(len(one) // 10, 1))) if len(p) > 1]
    square, rows = 0.0, []
    for part in parts:
        stated, right = part.mean(axis=0)
        limits = share(bool(x) for x in part[:, 1])
        square += len(part) / len(one) * ((stated - right) ** 2 - right * (1.0 - right) / (len(part) - 1))
        rows.append(
            {"stated": float(stated), "right": float(right), "low": limits.low, "high": limits.high, "n": len(part)}
        )
    return Figure(sqrt(max(square, 0.0)), nan, nan, len(one)), rows


def gaps(cases: Sequence[Case]) -> dict[str, Figure]:
    """Median share of the gap that closes where an effect in plain view was named."""
    seen = [c for c in _kind(cases, "single", "pair") if c.d_prime >= SEEN and c.found]

    def closed(arm: str) -> Figure:
        found = ((c.product.get("gap") or {}).get("closed_fraction") or {} for c in seen)
        return middle(_number(f.get(arm)) for f in found)

    return {f"gap_closed_{arm}": closed(arm) for arm in ("same", "held_out", "other_test", "placebo")}


def by_d_prime(cases: Sequence[Case], groups: dict[str, set[str]]) -> list[dict[str, Any]]:
    """Share named, in the group, and claimed at all, by the d' that was asked for."""
    rows = []
    for target in sorted({c.answer["target_d_prime"] for c in singles(cases)}):
        here = [c for c in singles(cases) if c.answer["target_d_prime"] == target]
        rows.append({"d_prime": target, "exact": share(c.stated == c.truth for c in here).to_json(),
                     "group": share(c.stated in groups[c.truth] for c in here).to_json(),
                     "claimed": share(c.claims for c in here).to_json()})  # fmt: skip
    return rows


def confusion(cases: Sequence[Case], least: float = SEEN) -> dict[str, dict[str, int]]:
    """Truth -> stated -> cases, effects at least so visible, outsiders under their own names."""
    table: dict[str, Counter[str]] = {}
    for c in _kind(cases, "single", "none", "outside"):
        if c.d_prime >= least or c.kind == "none":
            table.setdefault(next(iter(c.names), "none"), Counter())[c.stated] += 1
    return {truth: dict(row) for truth, row in sorted(table.items())}


def baseline(cases: Sequence[Case], posterior: dict[str, float]) -> list[Case]:
    """The same tests under a method that always says the same."""
    order = sorted(posterior, key=lambda k: -posterior[k])
    total, chosen = 0.0, []
    for name in order:
        chosen.append(name)
        total += posterior[name]
        if total >= 0.9:
            break
    verdict = order[0] if order[0] in ("none", "unknown") else "named"
    product = {"verdict": verdict, "posterior": posterior, "set90": chosen, "effects": [], "localisation": []}
    return [Case(c.answer, product) for c in cases]


def baselines(cases: Sequence[Case], groups: dict[str, set[str]]) -> dict[str, dict[str, Any]]:
    """Always none, always unknown, and the shares of the plan as a prior."""
    frequency = Counter(c.truth for c in _kind(cases, "single", "none", "outside"))
    total = sum(frequency.values()) or 1
    methods = {"always_none": {"none": 1.0}, "always_unknown": {"unknown": 1.0},
               "prior_only": {k: v / total for k, v in frequency.items()} or {"none": 1.0}}  # fmt: skip
    out = {}
    for name, posterior in methods.items():
        same = baseline(cases, posterior)
        out[name] = {k: f.to_json() for k, f in naming(same, groups).items()}
        out[name]["label"] = share(c.stated == c.truth for c in _kind(same, "single", "none", "outside")).to_json()
    return out


MUST: dict[str, tuple[Callable[[float], bool], str, str]] = {
    "exact_name": (lambda x: x >= 0.95, ">= 0.95", "-"),
    "exact_name_well_apart": (lambda x: True, "-", ">= 0.99"),
    "twin_group": (lambda x: x >= 0.97, ">= 0.97", ">= 0.99"),
    "set90_coverage": (lambda x: x >= 0.88, ">= 0.88", ">= 0.90"),
    "set90_size": (lambda x: x <= 1.5, "<= 1.5", "<= 1.2"),
    "sure_and_wrong": (lambda x: x <= 0.01, "<= 0.01", "<= 0.003"),
    "false_alarm": (lambda x: x <= 0.02, "<= 0.02", "<= 0.01"),
    "outside_unknown_and_equation": (lambda x: x >= 0.85, ">= 0.85", ">= 0.95"),
    "pair_both": (lambda x: x >= 0.80, ">= 0.80", ">= 0.92"),
    "calibration_error": (lambda x: x <= 0.05, "<= 0.05", "<= 0.02"),
    "size_in_90_interval": (lambda x: 0.85 <= x <= 0.95, "0.85-0.95", "0.88-0.92"),
    "gap_closed_same": (lambda x: x >= 0.95, ">= 0.95", ">= 0.99"),
    "gap_closed_held_out": (lambda x: x >= 0.9, ">= 0.9", ">= 0.97"),
    "gap_closed_other_test": (lambda x: x >= 0.8, ">= 0.8", ">= 0.95"),
    "equation_first": (lambda x: x >= 0.95, ">= 0.95", "-"),
    "phase": (lambda x: x >= 0.95, ">= 0.95", "-"),
    "onset_in_95_band": (lambda x: 0.90 <= x <= 0.98, "0.90-0.98", "-"),
    "no_source_on_none": (lambda x: x >= 0.98, ">= 0.98", "-"),
    "source_in_90_band": (lambda x: 0.85 <= x <= 0.95, "0.85-0.95", "-"),
    "runtime": (lambda x: x < 60.0, "< 60 s", "< 15 s"),
}


def score(
    cases: Sequence[Case], missing: Sequence[str] = (), groups: dict[str, set[str]] | None = None
) -> dict[str, Any]:
    """All figures as JSON."""
    groups = groups or twins(c.answer for c in cases)
    error, diagram = reliability(cases)
    figures = {**naming(cases, groups), **localisation(cases), "calibration_error": error, **gaps(cases),
               "runtime": middle(_number(c.product.get("runtime_s")) for c in cases)}  # fmt: skip
    families = sorted({c.answer["noise"]["family"] for c in _kind(cases, "none")})
    return {
        "cases": len(cases),
        "missing": list(missing),
        "figures": {k: f.to_json() for k, f in figures.items()},
        "twins": sorted(sorted(g) for g in {frozenset(v) for v in groups.values()} if len(g) > 1),
        "mean_group_size": float(np.mean([len(v) for v in groups.values()])),
        "false_alarm_by_noise": {
            f: share(c.claims for c in _kind(cases, "none") if c.answer["noise"]["family"] == f).to_json()
            for f in families
        },
        "by_d_prime": by_d_prime(cases, groups),
        "confusion": confusion(cases),
        "reliability": diagram,
        "baselines": baselines(cases, groups),
    }


def table(result: dict[str, Any]) -> str:
    """The figures for people."""
    lines = [f"{result['cases']} cases, {len(result['missing'])} without a diagnosis", "",
             "| figure | value | 95 % limits | cases | must | aim | |", "|---|---|---|---|---|---|---|"]  # fmt: skip
    for name, f in result["figures"].items():
        good, must, aim = MUST.get(name, (lambda x: True, "-", "-"))
        if f["value"] is None:
            lines.append(f"| {name} | - | - | {f['n']} | {must} | {aim} | |")
            continue
        limits = "-" if f["low"] is None else f"{f['low']:.3f} to {f['high']:.3f}"
        verdict = "" if must == "-" else ("met" if good(f["value"]) else "missed")
        lines.append(f"| {name} | {f['value']:.3f} | {limits} | {f['n']} | {must} | {aim} | {verdict} |")
    return "\n".join(lines)


def main(answers: Path, products: Path, out: Path | None = None) -> int:
    """Print the table; write all figures where asked to."""
    cases, missing = load(answers, products)
    result = score(cases, missing)
    print(table(result))
    if out is not None:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(json.dumps(result, indent=1), encoding="utf-8")
    return 0
