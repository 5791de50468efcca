"""Score diagnoses against answers: every figure of the benchmark's table with its number of cases and limits.

A product is a ``diagnosis.json``; a case without one is counted as missing and leaves the figures to the others, one
whose diagnosis failed counts as one that found nothing.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from math import nan, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from . import targets
from .figures import Figure, mean, middle, quantile, share
from .judged import Case, Groups, load, of_kind, twins
from .outcomes import GAPS, NAMING, PLACES, SEEN, Judge, band_shares, placed, runtime


def outcomes(judge: Judge, cases: Sequence[Case], groups: Groups) -> list[Any]:
    """What the cases that the figure asks contribute to it."""
    return [x for x in (judge(c, groups) for c in cases) if x is not None]


def naming(cases: Sequence[Case], groups: Groups) -> dict[str, Figure]:
    """Names: exact, in the group, sets, sure and wrong, false alarms, outsiders, pairs."""
    return {
        name: (mean if name == "set90_size" else share)(outcomes(judge, cases, groups))
        for name, judge in NAMING.items()
    }


def localisation(cases: Sequence[Case]) -> dict[str, Figure]:
    """Where, when and how much, before any name."""
    samples = [x for c in cases if placed(c) for x in band_shares(c)]
    return {
        **{name: share(outcomes(judge, cases, {})) for name, judge in PLACES.items()},
        "source_in_90_band": share(samples),
    }


def gaps(cases: Sequence[Case]) -> dict[str, Figure]:
    """Median share of the gap that closes where an effect in plain view was named."""
    return {name: middle(outcomes(judge, cases, {})) for name, judge in GAPS.items()}


def reliability(cases: Sequence[Case], bins: int = 10) -> tuple[Figure, list[dict[str, float]]]:
    """Debiased calibration error (Kumar, Liang and Ma 2019) of the label stated, and its diagram in equal counts.

    The limits are those of the squared error, normal, with the variance 4 g^2 v + 2 v^2 of each bin (g its gap, v the
    variance of the share that is right).
    """
    one = [(c.probability, c.stated == c.truth) for c in of_kind(cases, "single", "none", "outside") if c.posterior]
    one.sort(key=lambda pair: pair[0])  # and nothing else: among equals the right ones must not come last
    if len(one) < 2:
        return Figure(nan, nan, nan, len(one)), []
    parts = [p for p in np.array_split(np.array(one, dtype=float), min(bins, max(len(one) // 10, 1))) if len(p) > 1]
    square, spread, rows = 0.0, 0.0, []
    for part in parts:
        stated, right = part.mean(axis=0)
        limits, weight = share(bool(x) for x in part[:, 1]), len(part) / len(one)
        noise = right * (1.0 - right) / (len(part) - 1)
        excess = (stated - right) ** 2 - noise
        square += weight * excess
        spread += weight**2 * (4.0 * max(excess, 0.0) * noise + 2.0 * noise**2)
        rows.append(
            {"stated": float(stated), "right": float(right), "low": limits.low, "high": limits.high, "n": len(part)}
        )
    value, low, high = (sqrt(max(square + z * sqrt(spread), 0.0)) for z in (0.0, -1.96, 1.96))
    return Figure(value, low, high, len(one)), rows


def times(cases: Sequence[Case]) -> dict[str, Figure]:
    """Seconds per diagnosis: median, 90 %, the longest."""
    seconds = [runtime(c) for c in cases]
    return {"runtime": middle(seconds), "runtime_90": quantile(seconds, 0.9), "runtime_max": quantile(seconds, 1.0)}


def by_d_prime(cases: Sequence[Case], groups: Groups) -> list[dict[str, Any]]:
    """Share named, in the group, and claimed at all, by the d' that was asked for."""
    rows, singles = [], of_kind(cases, "single")
    for target in sorted({c.answer["target_d_prime"] for c in singles}):
        here = [c for c in singles if c.answer["target_d_prime"] == target]
        rows.append({"d_prime": target, "exact": share(c.stated == c.truth for c in here).to_json(),
                     "group": share(c.stated in groups[c.truth] for c in here).to_json(),
                     "claimed": share(c.claims for c in here).to_json()})  # fmt: skip
    return rows


def confusion(cases: Sequence[Case], least: float = SEEN) -> dict[str, dict[str, int]]:
    """Truth -> stated -> cases, effects at least so visible, outsiders under their own names."""
    table: dict[str, Counter[str]] = {}
    for c in of_kind(cases, "single", "none", "outside"):
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


def baselines(cases: Sequence[Case], groups: Groups) -> dict[str, dict[str, Any]]:
    """Always none, always unknown, and the shares of the plan as a prior."""
    frequency = Counter(c.truth for c in of_kind(cases, "single", "none", "outside"))
    total = sum(frequency.values()) or 1
    methods = {"always_none": {"none": 1.0}, "always_unknown": {"unknown": 1.0},
               "prior_only": {k: v / total for k, v in frequency.items()} or {"none": 1.0}}  # fmt: skip
    out = {}
    for name, posterior in methods.items():
        same = baseline(cases, posterior)
        out[name] = {k: f.to_json() for k, f in naming(same, groups).items()}
        out[name]["label"] = label(same).to_json()
    return out


def label(cases: Sequence[Case]) -> Figure:
    """The right label, whatever d'; pairs have none."""
    return share(c.stated == c.truth for c in of_kind(cases, "single", "none", "outside"))


def false_alarms(cases: Sequence[Case]) -> dict[str, dict[str, Any]]:
    """False alarms in each family of noise."""
    none = of_kind(cases, "none")
    families = sorted({c.answer["noise"]["family"] for c in none})
    return {f: share(c.claims for c in none if c.answer["noise"]["family"] == f).to_json() for f in families}


def score(cases: Sequence[Case], missing: Sequence[str] = (), groups: Groups | None = None) -> dict[str, Any]:
    """All figures as JSON."""
    groups = groups or twins(c.answer for c in cases)
    error, diagram = reliability(cases)
    figures = {**naming(cases, groups), **localisation(cases), "calibration_error": error, **gaps(cases),
               **times(cases)}  # fmt: skip
    return {
        "cases": len(cases),
        "missing": list(missing),
        "failed": sum(c.failed for c in cases),
        "label": label(cases).to_json(),
        "figures": {k: f.to_json() for k, f in figures.items()},
        "twins": sorted(sorted(g) for g in {frozenset(v) for v in groups.values()} if len(g) > 1),
        "mean_group_size": float(np.mean([len(v) for v in groups.values()])),
        "false_alarm_by_noise": false_alarms(cases),
        "by_d_prime": by_d_prime(cases, groups),
        "confusion": confusion(cases),
        "reliability": diagram,
        "baselines": baselines(cases, groups),
    }


def table(result: dict[str, Any]) -> str:
    """The figures for people."""
    lines = [f"{result['cases']} cases, {len(result['missing'])} without a diagnosis, {result['failed']} failed", "",
             "| figure | value | 95 % limits | cases | must | aim | |", "|---|---|---|---|---|---|---|"]  # fmt: skip
    return "\n".join([*lines, *(targets.row(name, figure) for name, figure in result["figures"].items())])


def main(answers: Path, products: Path, out: Path | None = None) -> int:
    """Print the table; write all figures where asked to."""
    cases, missing = load(answers, products)
    result = score(cases, missing)
    print(table(result))
    if out is not None:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(json.dumps(result, indent=1), encoding="utf-8")
    return 0
