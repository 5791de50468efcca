"""docs/fuzz.md: how the cases came out, and those that came out wrong."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.fuzz.explained import reason
from benchmarks.fuzz.judge import Judged
from benchmarks.studies import percent, put

Row = Mapping[str, Any]
Pair = tuple[Row, Judged]

MOST = 60
"""Silent cases that are listed; of more there is the count."""


def write(page: Path, pairs: Sequence[Pair], seed: int, code: str) -> None:
    """The tables between the page's marks; ``code``: the digest of the present code."""
    put(page, "table", _table(pairs, seed, code))
    put(page, "wrong", _wrong(pairs, seed))


def summary(pairs: Sequence[Pair]) -> str:
    """In one line."""
    ends = Counter(judged.end for _, judged in pairs)
    moved = [judged for _, judged in pairs if judged.moved]
    told = sum(judged.points for judged in moved)
    peak = max((row.get("peak_mb", 0) for row, _ in pairs), default=0)
    listed = ", ".join(f"{end} {count}" for end, count in ends.most_common())
    said = f"moved {len(moved)}, pointed out {told} ({percent(_share(moved))})"
    return f"{len(pairs)} cases: {listed}; {said}; peak {peak} MB"


def _by_code(pairs: Sequence[Pair], code: str) -> str:
    """How many cases the present code has run, and what it made of them."""
    now = [pair for pair in pairs if pair[0].get("code") == code]
    states = {row.get("code") for row, _ in pairs} - {code}
    if not states:
        return f"All by the present code ({code})."
    earlier = f"{len(pairs) - len(now)} are of {len(states)} earlier state{'s' if len(states) > 1 else ''} of the code"
    moved = [judged for _, judged in now if judged.moved]
    own = f"moved {len(moved)}, pointed out {sum(judged.points for judged in moved)} ({percent(_share(moved))})"
    return f"{earlier}, {len(now)} of the present one ({code}): {own}."


def _of_what_can_be_told(pairs: Sequence[Pair], seed: int) -> str:
    moved = [(row, judged) for row, judged in pairs if judged.moved]
    hidden = sum(judged.silent and bool(reason(row, seed)) for row, judged in moved)
    told, left = sum(judged.points for _, judged in moved), len(moved) - hidden
    share = percent(told / left if left else None)
    return (
        f"{hidden} of the {len(moved)} moved by what no log can tell, for the reasons below; of the other {left} "
        f"{told} are pointed out ({share})."
    )


def _share(moved: Sequence[Judged]) -> float | None:
    return sum(judged.points for judged in moved) / len(moved) if moved else None


def _table(pairs: Sequence[Pair], seed: int, code: str) -> Iterator[str]:
    yield f"{summary(pairs)}. Seed {seed}. {_by_code(pairs, code)}"
    yield ""
    yield _of_what_can_be_told(pairs, seed)
    yield ""
    yield "| mutation | cases | answer | refused | traceback | hang or killed | moved | pointed out |"
    yield "|---|---|---|---|---|---|---|---|"
    by_kind: defaultdict[str, list[Judged]] = defaultdict(list)
    for row, judged in pairs:
        by_kind[row["mutators"][0]].append(judged)
    for kind, found in sorted(by_kind.items()):
        ends = Counter(judged.end.split(" ")[0] for judged in found)
        moved = [judged for judged in found if judged.moved]
        counts = (ends["answer"], ends["refused"], ends["traceback"], ends["hang"] + ends["killed"], len(moved))
        yield f"| {kind} | {len(found)} | {' | '.join(map(str, counts))} | {percent(_share(moved))} |"
    by_format: defaultdict[str, list[Judged]] = defaultdict(list)
    for row, judged in pairs:
        by_format[row["format"]].append(judged)
    yield ""
    yield "By format: " + ", ".join(f"{name} {len(found)}" for name, found in sorted(by_format.items())) + "."


def _wrong(pairs: Sequence[Pair], seed: int) -> Iterator[str]:
    defects = [(row, judged) for row, judged in pairs if judged.end in ("traceback", "hang", "killed", "exit 1")]
    for (kind, error), rows in _grouped(defects):
        yield f"- {kind}, {len(rows)} times: `{error}` (cases {_numbers(rows)})"
    silent = [(row, judged) for row, judged in pairs if judged.silent]
    if not defects and not silent:
        yield "None."
    explained = [(reason(row, seed), row, judged) for row, judged in silent]
    for why, rows in _by_reason(explained):
        yield f"- {len(rows)} moved and nothing can tell: {why} (cases {_numbers(rows)})"
    unexplained = [(row, judged) for why, row, judged in explained if not why]
    for row, judged in unexplained[:MOST]:
        values = ", ".join(f"{name} {row['found'][name]['value']:.5g}" for name in judged.moved)
        yield f"- case {row['number']}, {row['stand']} as {row['format']}, {' and '.join(row['mutators'])}: {values}"
    if len(unexplained) > MOST:
        yield f"- and {len(unexplained) - MOST} more"


def _grouped(pairs: Sequence[Pair]) -> list[tuple[tuple[str, str], list[Row]]]:
    found: defaultdict[tuple[str, str], list[Row]] = defaultdict(list)
    for row, judged in pairs:
        found[judged.end, row["error"].partition(": ")[0] or "no word"].append(row)
    return sorted(found.items())


def _by_reason(explained: Sequence[tuple[str, Row, Judged]]) -> list[tuple[str, list[Row]]]:
    found: defaultdict[str, list[Row]] = defaultdict(list)
    for why, row, _ in explained:
        if why:
            found[why].append(row)
    return sorted(found.items())


def _numbers(rows: Sequence[Row]) -> str:
    shown = ", ".join(str(row["number"]) for row in rows[:8])
    return shown + (", ..." if len(rows) > 8 else "")
