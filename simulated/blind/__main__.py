"""python -m simulated.blind write|plan|score: see docs/blind.md."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

CASES = Path(".cache") / "blind" / "cases"


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m simulated.blind", description="Blind cases: write them, score what was found."
    )
    commands = parser.add_subparsers(dest="command", required=True)
    for name, text in (("plan", "list the cases"), ("write", "write those that are not there yet")):
        p = commands.add_parser(name, help=text)
        p.add_argument("--n", type=int, default=20, help="number of cases (1500 is the full benchmark)")
        p.add_argument("--split", choices=("development", "calibration", "scored"), default="development")
        p.add_argument("--seed", type=int, default=0)
        p.add_argument("--out", type=Path, help="folder for raw_tests/ and answers/")
        p.add_argument("--jobs", type=int, default=1)
    p = commands.add_parser("score", help="score diagnosis.json against the answers")
    p.add_argument("answers", type=Path)
    p.add_argument("products", type=Path, help="folder with ID/diagnosis.json")
    p.add_argument("--json", type=Path, help="write the figures here as well")
    return parser.parse_args()


def main() -> int:
    """0, or 1 where a case could not be written."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    a = _arguments()
    if a.command == "score":
        from .score import main as score

        return score(a.answers, a.products, a.json)
    from .plan import plan

    cases = plan(a.n, a.split, a.seed)
    if a.command == "plan":
        for c in cases:
            print(c.id, c.kind, c.family, f"d'={c.target:g}", *c.effects)
        return 0
    from .write import write_all

    failed = write_all(cases, a.out or CASES / a.split, a.jobs)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
