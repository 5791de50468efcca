"""hfa diff: which numbers changed between two folders of products, and by how many standard deviations."""

from __future__ import annotations

from pathlib import Path

from rich.text import Text

from hfanalysis.campaign.differences import Difference, beyond, differences, made_with, other_inputs, pairs
from hfanalysis.cli.exit_status import put
from hfanalysis.cli.paper import new_table, paper, soft
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products.disk import to_json
from hfanalysis.wording.numbers import listed

MOST_ROWS = 20
"""Rows shown of a test, those that changed most."""


def differ(old: Path, new: Path, least: float, as_json: bool) -> None:
    """Print what changed of every test that is in both folders; ``least`` [standard deviations] counts.

    Raises InputError where a folder is none, AbsentError where no test is in both.
    """
    for folder in (old, new):
        if not folder.is_dir():
            raise InputError(f"{folder}: found no folder; expected one with products, such as processed/")
    both, gone, come = pairs(old, new)
    if not both:
        raise AbsentError(f"{old} and {new} have no test in common that has products")
    found = {test: beyond(differences(was, now), least) for test, was, now in both}
    inputs = {test: other_inputs(was, now) for test, was, now in both}
    versions = {test: [made_with(was), made_with(now)] for test, was, now in both}
    if as_json:
        tests = {
            test: {
                "made_with": versions[test],
                "other": inputs[test],
                "changed": [one.to_json() for one in found[test]],
            }
            for test in found
        }
        put(to_json({"tests": tests, "gone": gone, "come": come}))
        return
    for test in found:
        _show(test, found[test], versions[test], inputs[test])
    console = paper()
    for names, words in ((gone, f"only in {old}"), (come, f"only in {new}")):
        if names:
            console.print(Text(f"{words}: {listed(names)}"), soft_wrap=soft(console))


def _show(test: str, found: list[Difference], versions: list[str], inputs: list[str]) -> None:
    console = paper()
    made = f"made with {versions[0]}, then {versions[1]}" if versions[0] != versions[1] else f"made with {versions[0]}"
    other = f"; {listed(inputs)} changed, too" if inputs else ""
    count = f"{len(found)} {'quantity' if len(found) == 1 else 'quantities'}"
    console.print(Text(f"{test}: {count} changed; {made}{other}"), soft_wrap=soft(console))
    if not found:
        return
    table = new_table("product", "quantity", "old", "new", "unit", "deviations", "part", "verdict", title="")
    for one in found[:MOST_ROWS]:
        deviations = "" if one.deviations is None else f"{one.deviations:.2g}"
        part = "" if one.relative is None else f"{100.0 * one.relative:+.2g} %"
        unit = "" if one.unit == "1" else one.unit
        table.add_row(one.product, one.name, _number(one.old), _number(one.new), unit, deviations, part, one.verdict)
    console.print(table)
    if len(found) > MOST_ROWS:
        console.print(Text(f"  and {len(found) - MOST_ROWS} more that changed less: --json has all"))


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.6g}"
