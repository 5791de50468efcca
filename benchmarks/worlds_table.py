"""What was asked of names in worlds that nothing was fitted to, with limits, over all worlds and in the worst one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import sqrt
from statistics import median
from typing import Any

import numpy as np
from benchmarks.practice import EQUATIONS
from benchmarks.worlds import SURE, Scored
from simulated.blind.figures import NOTHING, Figure, share
from simulated.blind.judged import Case
from simulated.blind.score import reliability

from hfanalysis.diagnose.answer.posterior import BEFORE

SEEN, APART = 8.0, 4.0
"""d' of what is hidden, and to the rival most like it, from which on it can be asked for."""


def table(cases: Sequence[Scored]) -> list[str]:
    """The figures that are asked for, then those of every world, in Markdown."""
    none = [c for c in cases if not c.hidden]
    single = [c for c in cases if c.answer["kind"] == "single" and apart(c)]
    outside = [c for c in cases if c.answer["kind"] == "outside" and seen(c)]
    claims, wrong = share(c.claims for c in none), share(bool(c.wrong) for c in cases)
    seconds = [c.seconds for c in cases] or [0.0]
    rows = [
        ("claim where nothing is hidden, all worlds", claims, "0.03", "0.01"),
        ("the same in the worst world (its lower limit)", worst(none), "0.08", "0.01"),
        (f"stated > {SURE} and wrong, names beside the first included", wrong, "0.02", "0.005"),
        (f"exact set of names, d' >= {SEEN:.0f} and >= {APART:.0f} to every rival",
         share(c.exact for c in single), "0.85", "0.95"),
        ("right set, or right within declared twins", share(within_twins(c) for c in single), "0.92", "0.98"),
        (f"outsiders at d' >= {SEEN:.0f}: unknown, and in the right equation",
         share(c.exact and placed(c) for c in outside), "0.75", "0.90"),
        ("calibration error (debiased)", error_of(cases), "0.06", "0.03"),
        (f"the same, {BEFORE['none']:.0%} of tests hiding nothing and {BEFORE['unknown']:.0%} what no name is for",
         error_by_odds(cases), "-", "-"),
    ]  # fmt: skip
    return [
        "| figure | found | 95 % limits | tests | must | aim |",
        "|---|---|---|---|---|---|",
        *(f"| {name} | {shown(f)} | {f.n} | {must} | {aim} |" for name, f, must, aim in rows),
        "",
        f"A diagnosis takes {median(seconds):.0f} s (median), {max(seconds):.0f} s at most, two at a time.",
        "",
        *by_world(cases),
    ]  # fmt: skip


def shown(figure: Figure) -> str:
    """A figure and its limits as cells of a table."""
    return f"{figure.value:.3f} | {figure.low:.3f} to {figure.high:.3f}" if figure.n else "- | -"


def by_world(cases: Sequence[Scored]) -> list[str]:
    """Every world on its own."""
    lines = [
        "| world | engine | logger | tests | claims where nothing is hidden (95 %) | stated > 0.9 and wrong "
        "| exact, of those that can be asked for | outsiders | calibration error | mean probability, share right |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name in dict.fromkeys(c.answer["world"] for c in cases):
        own = [c for c in cases if c.answer["world"] == name]
        claims = share(c.claims for c in own if not c.hidden)
        asked = [c for c in own if c.answer["kind"] == "single" and apart(c)]
        outside = [c for c in own if c.answer["kind"] == "outside" and seen(c)]
        stated = [(c.probability, c.stated == c.truth) for c in map(as_case, own) if c.posterior and c.kind != "pair"]
        mean, right = (sum(x) / max(len(stated), 1) for x in zip(*stated, strict=True)) if stated else (0.0, 0.0)
        lines.append(
            f"| {name} | {own[0].answer['engine']} | {own[0].answer['logger']} | {len(own)} "
            f"| {claims.k} of {claims.n} ({claims.low:.2f} to {claims.high:.2f}) "
            f"| {sum(bool(c.wrong) for c in own)} | {sum(c.exact for c in asked)} of {len(asked)} "
            f"| {sum(c.exact and placed(c) for c in outside)} of {len(outside)} | {shown(error_of(own)).split(' ')[0]} "
            f"| {mean:.2f}, {right:.2f} |"
        )
    return lines


def seen(case: Scored) -> bool:
    """Whether what is hidden can be seen at all."""
    return min(e["d_prime"] for e in case.answer["effects"].values()) >= SEEN


def apart(case: Scored) -> bool:
    """Whether it can be told from every rival, too."""
    return seen(case) and min(e["to_rivals"] for e in case.answer["effects"].values()) >= APART


def worst(none: Sequence[Scored]) -> Figure:
    """Claims in the world that has most of them; its value is the lower limit of their rate."""
    worlds = dict.fromkeys(c.answer["world"] for c in none)
    found = [share(c.claims for c in none if c.answer["world"] == name) for name in worlds]
    of = max(found, key=lambda f: f.low, default=share(()))
    return Figure(of.low, of.low, of.high, of.n)


def within_twins(case: Scored) -> bool:
    """Whether the names stated, or the set that holds 90 %, are what is hidden or its declared twins."""
    if case.exact:
        return True
    twins = [set(group) for group in case.product.get("twins", ())]
    allowed = {name for group in twins if group & case.hidden for name in group} | case.hidden
    held = set(case.named) or set(case.product.get("set90", ()))
    return case.claims and bool(held & allowed) and held <= allowed


def placed(case: Scored) -> bool:
    """Whether the most significant place is in an equation in which what is hidden acts."""
    right = {q for e in case.answer["effects"].values() for q in e["equations"]}
    right |= {q for name in case.hidden for q in EQUATIONS.get(name, ())}
    return bool(case.product.get("localisation")) and as_case(case).first_place["equation"] in right


def as_case(case: Scored) -> Case:
    """The same as the blind benchmark's scoring takes it."""
    effects = [{"name": name, **e} for name, e in case.answer["effects"].items()]
    answer: dict[str, Any] = {"kind": case.answer["kind"], "effects": effects}
    return Case(answer, case.product)


def error_of(cases: Sequence[Scored]) -> Figure:
    """How far stated probabilities are from the shares that are right."""
    return reliability([as_case(c) for c in cases])[0]


ODDS = {"none": BEFORE["none"], "single": BEFORE["named"], "outside": BEFORE["unknown"]}
"""What is hidden before a test, as probabilities are stated for; the tests here are of another mix, by which how often
nothing is hidden is known well."""

BINS = 10
"""As for the other calibration errors."""


def error_by_odds(cases: Sequence[Scored]) -> Figure:
    """As :func:`error_of`, each test with a weight by which all kinds are as frequent as before a test (ODDS).

    A share of weighted outcomes is as noisy as one of ``(sum w)^2 / sum w^2`` tests (Kish: Survey Sampling, 1965).
    """
    stated = sorted(
        ((c.probability, float(c.stated == c.truth), c.kind) for c in map(as_case, cases) if c.posterior),
        key=lambda row: row[0],
    )
    stated = [row for row in stated if row[2] in ODDS]
    if len(stated) < 2:
        return NOTHING
    number = Counter(kind for _, _, kind in stated)
    weight = np.array([ODDS[kind] / number[kind] for _, _, kind in stated])
    weight /= weight.sum()
    value = np.array([row[:2] for row in stated])
    bins = np.minimum((BINS * (np.cumsum(weight) - 0.5 * weight)).astype(int), BINS - 1)
    square = spread = 0.0
    for k in np.unique(bins):
        w, v = weight[bins == k], value[bins == k]
        mean, right = np.average(v, axis=0, weights=w)
        noise = right * (1.0 - right) / max(w.sum() ** 2 / (w**2).sum() - 1.0, 1.0)
        excess = (mean - right) ** 2 - noise
        square += w.sum() * excess
        spread += w.sum() ** 2 * (4.0 * max(excess, 0.0) * noise + 2.0 * noise**2)
    found, low, high = (sqrt(max(square + z * sqrt(spread), 0.0)) for z in (0.0, -1.96, 1.96))
    return Figure(found, low, high, len(stated))
