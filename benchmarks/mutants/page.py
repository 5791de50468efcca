"""docs/mutants.md: what was tried, what noticed it, and why the rest is still there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from benchmarks.mutants.explained import EXPLAINED

Result = Mapping[str, Any]

HEAD = """# Small errors, and the tests that notice them

Written by `make mutants`. A small error is put into a copy of the source, in compiled code as well, and the tests of
its own room are run on it. Each of the errors by hand is one that no reader of the numbers would see. Those by rule
are a sample: numbers at the top of modules and in comparisons twice or a tenth as large, standard deviations and
derived columns twice as large.
"""


def page(results: Sequence[Result]) -> str:
    """The whole page."""
    by_hand = [r for r in results if r["kind"] == "by hand"]
    by_rule = [r for r in results if r["kind"] != "by hand"]
    return "\n".join([HEAD, *_by_hand(by_hand), "", *_by_rule(by_rule), "", *_survivors(results), ""])


def _by_hand(results: Sequence[Result]) -> Iterator[str]:
    yield "## By hand"
    yield ""
    yield "| error | where | instead of | noticed by |"
    yield "|---|---|---|---|"
    for r in sorted(results, key=lambda r: str(r["name"])):
        yield f"| {r['name']} | {r['file']} | `{_code(r['old'])}`: `{_code(r['new'])}` | {_noticed(r)} |"


def _by_rule(results: Sequence[Result]) -> Iterator[str]:
    yield "## By rule"
    yield ""
    yield "| room | kind | tried | noticed |"
    yield "|---|---|---|---|"
    tried = Counter((r["room"], r["kind"]) for r in results)
    killed = Counter((r["room"], r["kind"]) for r in results if r["verdict"] == "killed")
    for room, kind in sorted(tried):
        yield f"| {room} | {kind} | {tried[room, kind]} | {killed[room, kind]} |"
    yield f"| all | | {len(results)} | {sum(killed.values())} |"


def _survivors(results: Sequence[Result]) -> Iterator[str]:
    left = [r for r in results if r["verdict"] != "killed"]
    yield "## What nothing notices"
    yield ""
    if not left:
        yield "Nothing of what was tried."
        return
    yield "| error | why it is left |"
    yield "|---|---|"
    for r in left:
        yield f"| {_code(r['name'])} | {why(str(r['name']))} |"


def why(name: str) -> str:
    """The explanation of the first pattern that a survivor's name holds."""
    return next((reason for pattern, reason in EXPLAINED.items() if pattern in name), "not explained yet")


def _noticed(result: Result) -> str:
    return f"`{result['by'].rpartition('/')[2]}`" if result["verdict"] == "killed" else "**nothing**"


def _code(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
