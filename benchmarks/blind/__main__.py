"""python -m benchmarks.blind run|table|calibrate|against: see docs/blind.md."""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path
from typing import Any

SPLITS = ("development", "calibration", "scored")
KINDS = ("single", "outside", "none", "pair", "stand")


def _arguments(given: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.blind", description="The blind benchmark at full size.")
    commands = parser.add_subparsers(dest="command", required=True)
    about = {"run": "diagnose every case that is not done", "table": "write the figures",
             "calibrate": "fit the constants of the stated probabilities",
             "against": "the figures beside those of an earlier version, on the same cases"}  # fmt: skip
    parsers = {name: commands.add_parser(name, help=text, description=text) for name, text in about.items()}
    for p in parsers.values():
        p.add_argument("--split", choices=SPLITS, required=True)
        p.add_argument("--out", type=Path, help="folder of the cases (.cache/blind/cases/SPLIT)")
    _run_arguments(parsers["run"])
    parsers["table"].add_argument("--write", type=Path, help="the page to write; a picture goes beside it")
    parsers["table"].add_argument("--none", action="store_true", help="of tests without an effect: what was claimed")
    parsers["table"].add_argument("--json", type=Path, help="write all figures here as well")
    parsers["against"].add_argument("--earlier", type=Path, metavar="FILE", required=True, help="what it found")
    parsers["against"].add_argument("--write", type=Path, help="the page whose table to write")
    parsers["calibrate"].add_argument(
        "--write", type=Path, help="instead of src/hfanalysis/diagnose/answer/probabilities.json"
    )
    parsers["calibrate"].add_argument("--only", metavar="CONSTANT", help="fit this one alone and hold the others")
    parsers["calibrate"].add_argument(
        "--pool", type=Path, metavar="FILE", help="with the constants of another fit, by their standard errors"
    )
    parsers["calibrate"].add_argument("--mixed", action="store_true", help="even if several versions of the code ran")
    return parser.parse_args(given)


def _run_arguments(p: argparse.ArgumentParser) -> None:
    p.add_argument("--n", type=int, default=1500, help="cases of the plan (1500 is the full benchmark)")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--jobs", type=int, default=1, help="processes")
    p.add_argument("--limit", type=int, help="only the first so many of the plan")
    p.add_argument("--kind", choices=KINDS, help="only the tests of one kind")
    p.add_argument("--targets", type=_numbers, default=(), metavar="D,D", help="only tests with these d' asked for")
    p.add_argument("--each", type=int, help="only the first so many of every effect and d'")
    p.add_argument("--variant", help="write to processed-NAME/; the diagnosis gets its parameter variant, or --set")
    p.add_argument("--set", action="append", default=[], metavar="diagnose.NAME=VALUE", help="parameter of a variant")
    p.add_argument("--keep", action="store_true", help="keep what another version of the code found")
    p.add_argument("--retry", action="store_true", help="try again what failed")
    p.add_argument("--seconds", type=float, default=300.0, help="longest time for one case")
    p.add_argument("--archive", type=Path, metavar="FILE", help="go on from what this file holds; add what is found")
    p.add_argument("--every", type=int, default=10, help="cases between two lines of progress")


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(float(part) for part in text.split(","))


def _value(text: str) -> Any:
    """A number or a truth value where it reads as one."""
    try:
        return json.loads(text)
    except ValueError:
        return text


def _run(a: argparse.Namespace, folder: Any) -> int:
    from .run import REFUSED, Refused, Request, run

    settings = {key: _value(text) for key, _, text in (s.partition("=") for s in a.set)}
    request = Request(
        a.split, a.n, folder, a.jobs, a.seed, a.limit, settings, a.keep, a.retry, a.seconds, a.every, a.kind,
        a.targets, a.each, a.archive,
    )  # fmt: skip
    try:
        return run(request)
    except Refused as error:
        print(error, file=sys.stderr)
        return REFUSED


def _table(a: argparse.Namespace, folder: Any) -> int:
    from .document import document, without_effect, write
    from .folder import write_json
    from .results import WrongSplit, results

    try:
        found = results(folder, a.split)
    except WrongSplit as error:
        print(error, file=sys.stderr)
        return 2
    if a.none:
        text, result = without_effect(found, a.split)
        print(text) if a.write is None else a.write.write_text(text, encoding="utf-8")
    elif a.write:
        result = write(found, a.split, a.write)
        print(f"{a.write}: {len(found.cases)} cases")
    else:
        text, result = document(found, a.split, None)
        print(text)
    if a.json:
        write_json(a.json, result)
    return 0


def _against(a: argparse.Namespace, folder: Any) -> int:
    from benchmarks.studies import put

    from .archive import cases_of
    from .results import WrongSplit, results
    from .variants import comparison
    from .wrong import no_longer_named

    try:
        found = results(folder, a.split)
    except WrongSplit as error:
        print(error, file=sys.stderr)
        return 2
    earlier = cases_of(a.earlier, found.cases)
    lines = comparison(found.cases, earlier, found.groups, ("now", "earlier"))
    lines += ["", "Single effects in plain view that were named then and are not now:", ""]
    lines += no_longer_named({i: c for i, c in found.cases.items() if i in earlier}, earlier)
    print("\n".join(lines)) if a.write is None else put(a.write, "against", lines)
    return 0


def _calibrate(a: argparse.Namespace, folder: Any) -> int:
    from .calibrate import Unfit, calibrate, calibrate_only, pooled, save
    from .folder import PROBABILITIES
    from .results import WrongSplit, results

    if a.split == "scored":
        print("nothing is fitted to the scored split", file=sys.stderr)
        return 2
    try:
        found = results(folder, a.split)
        if a.only:
            lines, data = calibrate_only(found, a.only, json.loads(PROBABILITIES.read_text(encoding="utf-8")))
        else:
            lines, data = calibrate(found, a.split, a.mixed)
        if a.pool:
            data = pooled(data, json.loads(a.pool.read_text(encoding="utf-8")))
            lines += ["", f"pooled with {a.pool}: T0 = {data['temperature']:.4g}, {data['offsets']}"]
        print("\n".join(lines))
        save(data, a.write) if a.write else save(data)
    except (Unfit, WrongSplit) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def main(given: list[str] | None = None) -> int:
    """0; 1 where cases failed; 2 where what was asked is refused; 130 where a run was interrupted."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ[name] = "1"  # one case per core: threads of its own would only be in each other's way
    from .folder import Folder

    a = _arguments(given)
    root = a.out or Path(".cache") / "blind" / "cases" / a.split
    folder = Folder(root.resolve(), getattr(a, "variant", None))
    return {"run": _run, "table": _table, "calibrate": _calibrate, "against": _against}[a.command](a, folder)


if __name__ == "__main__":
    sys.exit(main())
