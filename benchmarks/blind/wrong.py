"""What is wrong, case by case: names, sizes by effect, and the diagnoses that took longest."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

from simulated.blind.figures import share
from simulated.blind.judged import NAMES, Case, Groups
from simulated.blind.outcomes import placed, seen, size_covered, strange, sure_and_wrong

from .folder import Note

LONGEST = 5
"""Diagnoses that are listed for having taken longest."""


def wrong_names(cases: Iterable[Case], groups: Groups) -> list[str]:
    """Every effect in plain view of which another label is stated, and every label that is sure and wrong."""
    lines = ["| case | hidden | d' | nearest rival | log evidence | stated | log evidence | probability | sure |",
             "|---|---|---|---|---|---|---|---|---|"]  # fmt: skip
    found = [c for c in cases if _is_wrong(c) or sure_and_wrong(c, groups)]
    return [*lines, *(_row(c, groups) for c in sorted(found, key=lambda c: (_hidden(c), str(c.answer["id"]))))]


def no_longer_named(cases: Mapping[str, Case], earlier: Mapping[str, Case]) -> list[str]:
    """Every single effect in plain view that was named by an earlier version and is not now, with what is said instead.

    ``too small``: the part of what goes through its equation, where that is said to be too small to matter.
    """
    lines = ["| case | hidden | d' | stated now | probability of the truth | log evidence: now, then | too small |",
             "|---|---|---|---|---|---|---|"]  # fmt: skip
    lost = [c for i, c in cases.items() if seen(c) and c.stated != c.truth and earlier[i].stated == earlier[i].truth]
    for c in sorted(lost, key=lambda c: (_hidden(c), str(c.answer["id"]))):
        evidences = [of.product.get("evidences", {}).get(c.truth, 0.0) for of in (c, earlier[str(c.answer["id"])])]
        part = c.product.get("too_small", {}).get(c.truth)
        small = "-" if part is None else f"{100.0 * part:.1f} %"
        probability = c.product.get("posterior", {}).get(c.truth, 0.0)
        lines.append(
            f"| {c.answer['id']} | {_hidden(c)} | {c.d_prime:.1f} | {c.stated} | {probability:.2f} | "
            f"{evidences[0]:.1f}, {evidences[1]:.1f} | {small} |"
        )
    return lines


def _is_wrong(c: Case) -> bool:
    return (seen(c) or strange(c)) and c.stated != c.truth


def _hidden(c: Case) -> str:
    return next(iter(c.names), "none")


def _row(c: Case, groups: Groups) -> str:
    evidences = c.product.get("evidences", {})
    rivals = {name: d for name, d in c.answer["against"].items() if name in NAMES}
    nearest = min(rivals, key=lambda name: rivals[name], default=None)
    rival = "-" if nearest is None else f"{nearest} {rivals[nearest]:.1f}"
    right, stated = (f"{evidences[name]:.1f}" if name in evidences else "-" for name in (c.truth, c.stated))
    sure = "yes" if sure_and_wrong(c, groups) else ""
    cells = [
        c.answer["id"],
        _hidden(c),
        f"{c.d_prime:.1f}",
        rival,
        right,
        c.stated,
        stated,
        f"{c.probability:.2f}",
        sure,
    ]
    return f"| {' | '.join(cells)} |"


def sizes_by_effect(cases: Iterable[Case]) -> list[str]:
    """How often the 90 % interval of a source's size holds it, effect by effect, the rarest first."""
    held: dict[str, list[bool]] = defaultdict(list)
    for c in cases:
        if placed(c) and (covers := size_covered(c)) is not None:
            held[_hidden(c)].append(covers)
    shares = {name: share(of) for name, of in held.items()}
    lines = ["| hidden | size in its 90 % interval | 95 % limits | cases |", "|---|---|---|---|"]
    return lines + [
        f"| {name} | {found.value:.2f} | {found.low:.2f} to {found.high:.2f} | {found.n} |"
        for name, found in sorted(shares.items(), key=lambda item: (item[1].value, item[0]))
    ]


def longest(notes: Mapping[str, Note]) -> list[str]:
    """The diagnoses that took longest, with what the processor took of it."""
    timed: Sequence[Note] = [n for n in notes.values() if n.seconds is not None and not n.first]
    lines = ["| case | on the clock [s] | processor time [s] |", "|---|---|---|"]
    for note in sorted(timed, key=lambda n: -(n.seconds or 0.0))[:LONGEST]:
        used = "-" if note.processor_seconds is None else f"{note.processor_seconds:.1f}"
        lines.append(f"| {note.id} | {note.seconds:.1f} | {used} |")
    return lines
