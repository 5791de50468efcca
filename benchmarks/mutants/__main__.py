"""Small errors in the source, and whether the tests of their own room notice them.

python -m benchmarks.mutants [--list] [--only NAME] [--rooms calibrate,validate] [--each 20] [--seed 1] [--again]
                             [--write docs/mutants.md]  (`make mutants`)

Errors by hand first, then a sample by rule of each room. Goes on where it stopped: what was found is kept, a noticed
error as long as the definition that it is in is the same, one that was not as long as the tests of its room are, too.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmarks.mutants.catalogue import catalogue
from benchmarks.mutants.generated import generated, of_room
from benchmarks.mutants.mutant import ROOT, Mutant
from benchmarks.mutants.page import page
from benchmarks.mutants.workshop import Ran, Workshop, room_tests, state

ROOMS = "calibrate,performance,validate,measured_flight,flight,segment,effects,diagnose/answer"
FOUND = Path(__file__).parent / "found.jsonl"


def read(path: Path) -> dict[str, dict[str, Any]]:
    """What was found, by name: the last result of each."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return {row["name"]: row for row in map(json.loads, lines)}


def tells(row: dict[str, Any] | None, mutant: Mutant) -> bool:
    """Whether a result is of this error in this definition; other tests may have come since."""
    return row is not None and row["state"] == state(mutant, False)


def known(row: dict[str, Any] | None, mutant: Mutant) -> bool:
    """Whether a result still holds."""
    if row is None or not tells(row, mutant):
        return False
    return bool(row["verdict"] == "killed" or row["tests"] == state(mutant, True))


def result(mutant: Mutant, ran: Ran) -> dict[str, Any]:
    """A line of what was found."""
    return {
        "name": mutant.name, "kind": mutant.kind, "room": mutant.room, "file": mutant.edit.file.as_posix(),
        "line": mutant.edit.line, "old": mutant.edit.old, "new": mutant.edit.new,
        "verdict": "survived" if ran.passed else "killed", "by": ran.failed if not ran.passed else "",
        "seconds": round(ran.seconds, 1), "state": state(mutant, False), "tests": state(mutant, True),
    }  # fmt: skip


def asked_for(asked: argparse.Namespace, before: Mapping[str, Any]) -> list[Mutant]:
    """The errors to try: by hand, a sample by rule, and what was tried ``before`` in these rooms."""
    every = {m.name: m for m in catalogue()} if asked.hand else {}
    for room in filter(None, asked.rooms.split(",")):
        sample = {m.name for m in generated(room, asked.each, asked.seed)} | set(before)
        every |= {m.name: m for m in of_room(room) if m.name in sample}
    return [m for m in every.values() if re.search(asked.only, m.name)]


def tried(mutants: list[Mutant], found: Path, scratch: Path, again: bool) -> None:
    """Try what is not known, and keep what is found."""
    before = read(found)
    open_ = [m for m in mutants if again or not known(before.get(m.name), m)]
    print(f"{len(mutants)} errors, {len(open_)} of them to try", file=sys.stderr)
    workshop, clean = Workshop(scratch) if open_ else None, set[Path]()
    for mutant in open_:
        assert workshop is not None
        folder = room_tests(mutant)
        if folder not in clean:
            ran = workshop.clean(folder)
            if not ran.passed:
                raise SystemExit(f"{folder} fails without any error: {ran.failed}")
            clean.add(folder)
        row = result(mutant, workshop.tried(mutant))
        with found.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row, ensure_ascii=False) + "\n")
        print(f"{row['verdict']:8} {row['seconds']:6.1f} s  {mutant.name}  {row['by']}", file=sys.stderr, flush=True)


def main() -> int:
    """Try errors; write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", action="store_true", help="only name them")
    parser.add_argument("--only", default="", help="those whose names this regular expression is in")
    parser.add_argument("--rooms", default=ROOMS, help="of which errors are made by rule")
    parser.add_argument("--no-hand", dest="hand", action="store_false", help="none of those by hand")
    parser.add_argument(
        "--each", type=int, default=12, help="errors by rule in each room, beside those that were tried before"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--known", action="store_true", help="try none: the page of what is known")
    parser.add_argument("--again", action="store_true", help="also what is known")
    parser.add_argument("--write", type=Path)
    parser.add_argument("--found", type=Path, default=FOUND)
    parser.add_argument("--scratch", type=Path, default=ROOT / ".cache" / "mutants")
    asked = parser.parse_args()
    mutants = asked_for(asked, read(asked.found))
    if asked.list:
        print("\n".join(f"{m.name} ({m.kind}, {m.edit.file}:{m.edit.line})" for m in mutants))
        return 0
    if not asked.known:
        tried(mutants, asked.found, asked.scratch, asked.again)
    rows = read(asked.found)
    results = [{**rows[m.name], "file": m.edit.file.as_posix()} for m in mutants if tells(rows.get(m.name), m)]
    if asked.write:
        asked.write.write_text(page(results), encoding="utf-8")
    return int(any(r["verdict"] != "killed" and r["kind"] == "by hand" for r in results))


if __name__ == "__main__":
    sys.exit(main())
