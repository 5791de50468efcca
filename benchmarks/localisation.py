"""How long it takes to search for the place where model and measurement disagree, beside the whole diagnosis.

After loading: the base model is fitted, an unknown source is tried at every site, linear about that fit, and the
channels' own balances are taken. Not in it is what a diagnosis goes on with: the best sources, fitted with the whole
model. Medians, in one process whose compiled code is warm.

Usage: localisation.py [--test HF5] [--repeat 3]
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from hfanalysis.diagnose.diagnosis import diagnose
from hfanalysis.diagnose.naming.base_model import base_model
from hfanalysis.diagnose.weak_form.spread import Spread
from hfanalysis.diagnose.weak_form.weak import weak_residuals
from hfanalysis.effects import library
from hfanalysis.inference.candidate import Bench
from hfanalysis.inference.subject import Subject
from hfanalysis.inference.unknown import LinearUnknown
from hfanalysis.inference.unknowns import in_slopes
from hfanalysis.stages.base import load_stage
from hfanalysis.stages.diagnose import subject_of
from hfanalysis.stages.open_test import open_test
from hfanalysis.stages.runner import run_to

Made = TypeVar("Made")
ROOT = Path(__file__).resolve().parent.parent


def localise(subject: Subject, times: dict[str, float]) -> list[LinearUnknown]:
    """Unknown sources of a test, the best first; ``times`` [s] by step."""

    def timed(step: str, made: Callable[[], Made]) -> Made:
        start = time.perf_counter()
        out = made()
        times[step] = time.perf_counter() - start
        return out

    hypothesis, observed = timed("what is compared", subject.compared)
    bench = Bench(observed)
    base, _ = timed("base model", lambda: base_model(hypothesis, bench))
    found = timed("a source at every site", lambda: in_slopes(base.fit, bench.at(base.form)))
    engine = base.fit.burnt.steps.engine
    timed("balances of the channels", lambda: weak_residuals(observed, engine, Spread.of_fit(base.fit)))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--test", default="HF5")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    for name in ("ingest", "segment", "calibrate"):
        load_stage(name)
    with tempfile.TemporaryDirectory() as out:
        subject = subject_of(run_to("calibrate", open_test(ROOT, options.test, Path(out))))
        runs: list[dict[str, float]] = []
        wholes = []
        for _ in range(options.repeat + 1):
            runs.append({})
            found = localise(subject, runs[-1])
            start = time.perf_counter()
            diagnose(subject, library())
            wholes.append(time.perf_counter() - start)
    print(f"linear localisation of {options.test} after loading, median of {options.repeat}")
    for step in runs[0]:
        print(f"  {step:<28} {statistics.median(run[step] for run in runs[1:]):7.2f} s")
    total = statistics.median(sum(run.values()) for run in runs[1:])
    whole = statistics.median(wholes[1:])
    print(f"  {'in all':<28} {total:7.2f} s, {total / whole:.2f} of a whole diagnosis ({whole:.1f} s)")
    print("  most probable places: " + ", ".join(dict.fromkeys(source.place.name for source in found[:5])))


if __name__ == "__main__":
    main()
