"""Real logs through ``hfa new`` and ``hfa run``: the page docs/real-logs.md.

python -m benchmarks.real_logs --logs FOLDER [--root .cache/real-logs] [--only NAME ...] [--write docs/real-logs.md]

The logs stay where they are; scratch copies go to the root, and so does what came of each, which ``--only`` takes from
there for all others. A log that is not there is left out.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.real_logs.facts import all_facts
from benchmarks.real_logs.page import page
from benchmarks.real_logs.trial import Outcome, keep, kept, tried


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--logs", type=Path, default=Path("../shared/real_tests"), help="folder with a folder per log")
    parser.add_argument("--root", type=Path, default=Path(".cache/real-logs"), help="where the scratch copies go")
    parser.add_argument("--only", nargs="*", default=None, help="those to run; of the others what is kept")
    parser.add_argument("--write", type=Path, default=None, help="the page; else it is printed")
    asked = parser.parse_args()
    outcomes = []
    for facts in all_facts():
        outcome = kept(facts, asked.root)
        if (asked.only is None or facts.name in asked.only) and (asked.logs / facts.name).is_dir():
            outcome = tried(facts, asked.logs, asked.root)
            keep(outcome, asked.root)
            print(_line(outcome), file=sys.stderr, flush=True)
        outcomes += [outcome] if outcome else []
    if not outcomes:
        sys.exit(f"{asked.logs}: holds none of the logs; nothing was written")
    if asked.write:
        asked.write.write_text(page(outcomes), encoding="utf-8")
    else:
        print(page(outcomes))
    if any(outcome.status not in (0, 2, 3) for outcome in outcomes):
        sys.exit("a run ended in a defect")


def _line(outcome: Outcome) -> str:
    return f"{outcome.facts.name}: exit {outcome.status}; {outcome.drafted}; {' / '.join(outcome.said)[:300]}"


if __name__ == "__main__":
    main()
