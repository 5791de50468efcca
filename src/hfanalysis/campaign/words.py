"""What a campaign found, in words."""

from __future__ import annotations

from collections.abc import Collection

from hfanalysis.campaign.pooling import DISAGREE
from hfanalysis.products.campaign import CommonLaw, Diagnosed, NoLaw, Together
from hfanalysis.quantity import IDENTIFIED
from hfanalysis.report.names import called
from hfanalysis.wording.numbers import listed, shown

HIDDEN = 0.01
"""Probability below which its number is not given."""

NAMED = 6
"""Tests that a sentence names; of more it says how many they are. Source: by choice, what is read at a glance."""


def tests_named(tests: Collection[str], of: int) -> str:
    """Tests by name, or how many of how many they are.

    >>> tests_named(("A", "B"), 3), tests_named([f"T{i}" for i in range(40)], 50)
    ('A and B', '40 of 50 tests')
    """
    if len(tests) <= NAMED:
        return listed(list(tests))
    return f"all {of} tests" if len(tests) == of else f"{len(tests)} of {of} tests"


def by_chance(probability: float) -> str:
    """How probable something is by chance.

    >>> by_chance(0.0123), by_chance(1e-6)
    ('0.012', 'less than 0.001')
    """
    return "less than 0.001" if probability < 1e-3 else f"{probability:.2g}"


def agreement(together: Together | CommonLaw) -> str:
    """Whether tests agree on a number, and how probable so large a scatter is; why there is none together."""
    found = together.agreement
    if found is None:
        return (together.mean.reason or "") if isinstance(together, Together) else ""
    chance, verdict = found.probability, found.verdict.partition(":")[0]
    said = "p < 0.001" if chance < 1e-3 else f"p = {chance:.2g}"
    return f"{verdict} ({said}; below {DISAGREE:g} they do not)"


def diagnosed(diagnosis: Diagnosed | None) -> str:
    """What a test's diagnosis says, in a few words."""
    if diagnosis is None:
        return "not diagnosed"
    if diagnosis.effects:
        return listed([f"{called(row.name)} ({row.probability:.2f})" for row in diagnosis.effects])
    if diagnosis.verdict == "none":
        return "nothing that can be claimed"
    return "something without a name" if diagnosis.verdict == "unknown" else "something whose name is open"


def alone(test: str) -> str:
    """Of a stand with one test in the campaign."""
    return f"{test} is the only test of this stand here: there is nothing to compare it with."


def regression_sentence(product: CommonLaw | NoLaw) -> str:
    """a and n of all tests of a stand, and whether one law does."""
    if isinstance(product, NoLaw):
        return f"No common regression law: {product.reason}."
    a, n = map(shown, (product.a, product.n))
    law = f"a = ({a.value} ± {a.std}) {a.unit}, n = {n.value} ± {n.std}"
    if product.n.verdict != IDENTIFIED:
        law += f", {product.n.verdict}: {product.n.why}"
    of = tests_named(product.tests, len(product.tests))
    return f"One regression law for {of}: {law}. The tests {agreement(product)}."
