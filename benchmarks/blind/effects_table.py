"""Effect by effect: how often it is named, and what is said in its place; and the whole confusion matrix."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from simulated.blind.figures import share
from simulated.blind.judged import Case, Groups
from simulated.blind.outcomes import SEEN, right_equation, strange


def effects_table(cases: Sequence[Case], groups: Groups) -> list[str]:
    """A row per effect in plain view, outsiders and pairs included, the worst first."""
    rows: list[tuple[float, str]] = []
    for name, here in sorted(_by_truth(cases).items()):
        right = share(_right(c) for c in here)
        twins = sum(c.stated in groups.get(c.truth, ()) for c in here) if here[0].kind == "single" else None
        place = sum(right_equation(c, c.first_place) for c in here)
        said = Counter(_said(c) for c in here if not _right(c)).most_common(3)
        limits = f"{right.low:.2f} to {right.high:.2f}"
        stated = ", ".join(f"{what} {k}" for what, k in said) or "-"
        cells = [name, str(right.n), f"{right.value:.2f}", limits, "-" if twins is None else str(twins),
                 "-" if not here[0].names else str(place), stated]  # fmt: skip
        rows.append((right.value, f"| {' | '.join(cells)} |"))
    head = ["| hidden | cases | right | 95 % limits | in the twin group | right equation | stated instead |",
            "|---|---|---|---|---|---|---|"]  # fmt: skip
    return [*head, *(line for _, line in sorted(rows, key=lambda row: row[0]))]


def _by_truth(cases: Sequence[Case]) -> dict[str, list[Case]]:
    out: dict[str, list[Case]] = {}
    for c in cases:
        if c.kind == "single" and c.d_prime >= SEEN:
            out.setdefault(c.truth, []).append(c)
        elif strange(c):
            out.setdefault(f"{next(iter(c.names))} (outside)", []).append(c)
        elif c.kind in ("none", "pair"):
            out.setdefault("none" if c.kind == "none" else "two effects", []).append(c)
    return out


def _right(c: Case) -> bool:
    return c.names <= c.found if c.kind == "pair" else c.stated == c.truth


def _said(c: Case) -> str:
    if c.kind != "pair":
        return c.stated
    both = c.names & c.found
    return "one of the two only" if both else (c.stated if c.stated in ("none", "unknown") else "neither")


def confusion_table(confusion: dict[str, dict[str, int]], labels: Sequence[str]) -> list[str]:
    """Truths in rows, what was stated in numbered columns."""
    stated = [*labels, *sorted({s for row in confusion.values() for s in row} - set(labels))]
    used = [s for s in stated if s in confusion or any(s in row for row in confusion.values())]
    number = {name: str(i) for i, name in enumerate(used, 1)}
    lines = ["| | hidden \\ stated | " + " | ".join(number[s] for s in used) + " |", "|---" * (len(used) + 2) + "|"]
    outside = sorted(set(confusion) - set(number))
    for name in [*(s for s in used if s in confusion), *outside]:
        cells = [str(confusion[name].get(s, "")) for s in used]
        lines.append(f"| {number.get(name, '')} | {name} | {' | '.join(cells)} |")
    lines += [f"| {number[s]} | ({s}) |" + " |" * len(used) for s in used if s not in confusion]
    return lines
