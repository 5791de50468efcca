"""Tests on other engines, by other loggers and laws, diagnosed and scored: sixty at once, or nine worlds in an evening.

python -m benchmarks.worlds [--set quick] [--limit 60] [--jobs 2] [--write docs/worlds.md] [--tried FILE]

Tests and what was found lie under .cache/worlds/SET; a run goes on where it was stopped, and what another version of
the package found is found anew. Answers are read only to score.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

from benchmarks.blind.folder import PACKAGE
from benchmarks.blind.folder import digest as digest_of
from benchmarks.practice import diagnosed
from benchmarks.studies import one_thread, percent, put
from simulated.worlds.plan import OF_WORLDS, SETS, Test, plan

CACHE = Path(__file__).resolve().parents[1] / ".cache" / "worlds"
SURE = 0.9
"""Probability from which on a statement counts as sure."""
VISIBLE = 6.0
"""d' from which on what is hidden can be asked for; it is rough (simulated/worlds/hidden.py)."""


@dataclass(frozen=True)
class Scored:
    """A test, its answer, and what was found."""

    answer: dict[str, Any]
    product: dict[str, Any]
    seconds: float
    failure: str

    @property
    def hidden(self) -> set[str]:
        """Names of all that is hidden."""
        return set(self.answer["effects"])

    @property
    def named(self) -> dict[str, float]:
        """What was added to the model, with its probability."""
        return {row["name"]: float(row["probability"]) for row in self.product.get("effects", ())}

    @property
    def claims(self) -> bool:
        """Whether anything is said to be there."""
        return self.product.get("verdict", "none") != "none"

    @property
    def visible(self) -> bool:
        """Whether what is hidden can be asked for."""
        return bool(self.hidden) and min(e["d_prime"] for e in self.answer["effects"].values()) >= VISIBLE

    @property
    def stated(self) -> dict[str, float]:
        """Everything that is claimed, with its probability: names, and ``unknown`` where that is the verdict."""
        unknown = {"unknown": float(self.product["posterior"]["unknown"])} if self._unknown else {}
        return self.named | unknown

    @property
    def _unknown(self) -> bool:
        return self.product.get("verdict") == "unknown"

    @property
    def wrong(self) -> list[str]:
        """What is stated surely and is not hidden; of what is outside the library ``unknown`` is right."""
        right = self.hidden | ({"unknown"} if self.answer["kind"] == "outside" else set())
        return [label for label, p in self.stated.items() if p > SURE and label not in right]

    @property
    def exact(self) -> bool:
        """Whether just what is hidden was named; of what is outside the library, that it is unknown."""
        if self.failure:
            return False
        if self.answer["kind"] == "none":
            return not self.claims
        return self._unknown if self.answer["kind"] == "outside" else set(self.named) == self.hidden


def found_path(test: Test, root: Path) -> Path:
    """Where what was found in a test lies."""
    return root / "found" / f"{test.id}.json"


@dataclass(frozen=True)
class Study:
    """Where tests lie, which they are, and of which version what is found is."""

    root: Path
    tests: tuple[Test, ...]
    digest: str
    out: Path | None = None


def run_one(name: str, study: Study) -> float | str:
    """Write a test if it is not there, diagnose it, and keep what was found; returns seconds, or what went wrong, which
    stops no other test."""
    try:
        return _run(name, study)
    except Exception as error:
        return f"{type(error).__name__}: {error}"


def _run(name: str, study: Study) -> float:
    from simulated.worlds.write import answer_path, write_test

    started, root = perf_counter(), study.root
    (test,) = (test for test in study.tests if test.id == name)
    if not answer_path(test.id, root).is_file():
        write_test(test, root)
    with tempfile.TemporaryDirectory() as scratch:
        outcome = diagnosed(root, test.id, Path(scratch))
    path = found_path(test, root)
    path.parent.mkdir(parents=True, exist_ok=True)
    kept = {"digest": study.digest, "seconds": outcome.seconds, "failure": outcome.failure, "product": outcome.product}
    path.write_text(json.dumps(kept), encoding="utf-8")
    return perf_counter() - started


def fresh(test: Test, root: Path, digest: str) -> bool:
    """Whether a test was diagnosed by this version of the package."""
    path = found_path(test, root)
    return path.is_file() and json.loads(path.read_text(encoding="utf-8"))["digest"] == digest


def scored(tests: Iterable[Test], root: Path, digest: str) -> list[Scored]:
    """All tests that this version of the package has diagnosed."""
    out = []
    for test in tests:
        if fresh(test, root, digest):
            kept = json.loads(found_path(test, root).read_text(encoding="utf-8"))
            answer = json.loads((root / "answers" / f"{test.id}.json").read_text(encoding="utf-8"))
            out.append(Scored(answer, kept["product"], kept["seconds"], kept["failure"]))
    return out


def _row(label: str, cases: Sequence[Scored]) -> str:
    """A row of counts."""
    none, single = ([c for c in cases if c.answer["kind"] == kind] for kind in ("none", "single"))
    outside, pair = ([c for c in cases if c.answer["kind"] == kind] for kind in ("outside", "pair"))
    return (
        f"| {label} | {len(cases)} | {sum(c.claims for c in none)} of {len(none)} "
        f"| {sum(bool(c.wrong) for c in cases)} of {len(cases)} "
        + "".join(f"| {sum(c.exact for c in kind)} of {len(kind)} " for kind in (single, outside, pair))
        + f"| {sum(c.visible and not c.claims for c in cases)} |"
    )


def figures(cases: Sequence[Scored]) -> list[str]:
    """Counts over all, by logger, by engine and by how the fuel ended, in Markdown."""
    lines = [
        "| | tests | claims where nothing is hidden | stated > 0.9 and wrong | one effect, exact "
        "| outside the library: unknown | two, exact | visible, not seen |",
        "|---|---|---|---|---|---|---|---|",
        _row("all", cases),
    ]
    for what in ("logger", "engine", "end"):
        for value in sorted({c.answer[what] for c in cases}):
            lines.append(_row(f"{what}: {value}", [c for c in cases if c.answer[what] == value]))
    seconds = [c.seconds for c in cases]
    if seconds:
        lines += ["", f"A diagnosis takes {median(seconds):.0f} s (median), {max(seconds):.0f} s at most."]
    return [*lines, *forms(cases), *unsettled(cases)]


def forms(cases: Sequence[Scored]) -> list[str]:
    """The model-form error that the model asks for where nothing is hidden and nothing was claimed."""
    asked = [c.product["compared"]["model_form_error"] for c in cases if not c.hidden and c.product and not c.claims]
    if not asked:
        return []
    sides = (f"{side} {median(a[side] for a in asked):.2g} ({max(a[side] for a in asked):.2g})" for side in asked[0])
    said = ", ".join(sides)
    return ["", f"Model-form error where nothing is hidden, as parts of ranges, the median (the largest): {said}."]


def unsettled(cases: Sequence[Scored]) -> list[str]:
    """Tests in which the base model was found deeper after all had been compared with it: there should be none."""
    ids = [c.answer["id"] for c in cases if any("search did not converge" in w for w in c.product.get("warnings", ()))]
    return ["", f"The search did not converge in {', '.join(ids)}."] if ids else []


def refused(cases: Sequence[Scored], tests: Sequence[Test]) -> list[str]:
    """Tests that came to no diagnosis, which are in no figure, with the reason; nothing where all did."""
    reasons = [f"- {c.answer['id']}: {c.failure.strip().splitlines()[-1]}" for c in cases if c.failure]
    there = {c.answer["id"] for c in cases}
    reasons += [f"- {test.id}: not diagnosed by this version" for test in tests if test.id not in there]
    said = f"{len(reasons)} of {len(tests)} came to no diagnosis and are in no figure:"
    return ["", said, "", *reasons] if reasons else []


def listing(cases: Sequence[Scored]) -> list[str]:
    """Every test that is not exact, in Markdown."""
    lines = ["| test | engine | logger | fuel | hidden (d') | stated | gap closed: same, held out | |",
             "|---|---|---|---|---|---|---|---|"]  # fmt: skip
    for c in cases:
        if c.exact and not c.wrong:
            continue
        hidden = ", ".join(f"{n} ({e['d_prime']:.0f})" for n, e in c.answer["effects"].items()) or "nothing"
        stated = ", ".join(f"{n} {p:.2f}" for n, p in c.stated.items()) or c.failure[:50] or "none"
        closed = c.product.get("gap", {}).get("closed_fraction", {})
        arms = ", ".join(percent(closed.get(arm)) for arm in ("same", "held_out"))
        verdict = "**wrong and sure**" if c.wrong else ("claim" if not c.hidden else "")
        a = c.answer
        lines.append(
            f"| {a['id']} | {a['engine']} | {a['logger']} | {a['end']} | {hidden} | {stated} | {arms} | {verdict} |"
        )
    return lines


def tried(cases: Sequence[Scored]) -> list[dict[str, Any]]:
    """Under which conditions each test was taken, what was stated of it most surely, and whether that was right."""
    from hfanalysis.diagnose.answer.tried_on import CHANNELS, WORDS

    out = []
    for c in cases:
        if (found := c.product.get("tried_on")) is not None:
            lacks = [name for name in CHANNELS if name not in c.product["compared"]["channels"]]
            stated = round(max(c.stated.values(), default=0.0), 4)
            numbers = {name: float(f"{found[name]:.4g}") for name in WORDS}
            out.append({"world": c.answer["logger"], **numbers, "lacks": lacks, "stated": stated, "right": not c.wrong})
    return out


def main() -> int:
    """Diagnose all tests, two at a time, and say after each how far it is."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--set", choices=sorted(SETS), default="quick")
    parser.add_argument("--limit", type=int, default=60)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="ids, with commas")
    parser.add_argument("--write", type=Path)
    parser.add_argument("--tried", type=Path, help="where the diagnosis keeps what became of it in these tests")
    asked = parser.parse_args()
    one_thread()
    root, digest = CACHE / asked.set, digest_of(PACKAGE)
    tests = plan(asked.set, max(asked.limit, 60))[: asked.limit]
    tests = [t for t in tests if not asked.only or t.id in asked.only.split(",")]
    todo = [t for t in tests if not fresh(t, root, digest)]
    started, broken = perf_counter(), 0
    from benchmarks.worlds_table import table

    from hfanalysis.campaign.cluster import Cluster

    with Cluster(asked.jobs) as cluster:
        found = cluster.each(run_one, [test.id for test in todo], Study(root, tuple(todo), digest))
        for done, (name, seconds) in enumerate(found, 1):
            if isinstance(seconds, str):
                broken += 1
                print(f"{done}/{len(todo)} {name}: {seconds}", file=sys.stderr, flush=True)
                continue
            (one,) = scored([t for t in todo if t.id == name], root, digest)
            said = ", ".join(f"{n} {p:.2f}" for n, p in one.stated.items()) or one.failure or "none"
            mark = "WRONG" if one.wrong else ("ok" if one.exact else "-")
            print(f"{done}/{len(todo)} {name} {seconds:.0f} s {mark}: {'+'.join(one.hidden) or 'nothing'} -> {said}",
                  file=sys.stderr, flush=True)  # fmt: skip
    cases = scored(tests, root, digest)
    whole = [c for c in cases if not c.failure]
    lines = [*(table(whole) if asked.set in OF_WORLDS else figures(whole)), *refused(cases, tests), "", *listing(cases)]
    print("\n".join(lines))
    if todo:
        print(f"\n{len(todo)} tests in {(perf_counter() - started) / 60.0:.1f} minutes", file=sys.stderr)
    if asked.write:
        put(asked.write, f"worlds {asked.set}" if asked.set in OF_WORLDS else "worlds", lines)
    if asked.tried:
        asked.tried.write_text(json.dumps({"set": asked.set, "tests": tried(whole)}, indent=1) + "\n", encoding="utf-8")
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(main())
