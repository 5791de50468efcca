"""How long the engine takes: the first call of a fresh process, a run, tangents of 20 parameters, many runs at once.

Usage: engine_speed.py [--cold]  (--cold: also from nothing compiled, which takes its time)
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter

from simulated.engines import engine_on_stand

from hfanalysis.effects import effect
from hfanalysis.engine.batch import burn_many
from hfanalysis.engine.sensitivity import ENGINE_PARAMETERS, run_with_tangents
from hfanalysis.engine.unsteady import Engine, burn
from hfanalysis.record.document import read_toml
from hfanalysis.record.engine_file import engine_of
from hfanalysis.simulation.unsteady_run import simulate

ROOT = Path(__file__).resolve().parent.parent
SECONDS = 17.0
OF_EFFECTS = ("tank_heat.power", "n2_purge.area", "n2_purge.supply_pressure", "n2_purge.cracking_pressure")
PARAMETERS = (*ENGINE_PARAMETERS, *OF_EFFECTS)

FIRST = """
from time import perf_counter
from hfanalysis.engine.unsteady import burn
from hfanalysis.engine.sensitivity import run_with_tangents
from simulated.engines import engine_on_stand
engine = engine_on_stand()
start = perf_counter()
burn(engine, 17.0, run_on=True)
middle = perf_counter()
run_with_tangents(engine, ["a", "n"], 17.0, run_on=True)
print(middle - start, perf_counter() - middle)
"""


def first_calls(cache: str | None = None) -> tuple[float, float]:
    """Seconds of the first run and of the first tangents in a fresh process, after its imports."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "src"), str(ROOT)])}
    if cache is not None:
        environment["NUMBA_CACHE_DIR"] = cache
    found = subprocess.run(
        [sys.executable, "-c", FIRST], check=True, capture_output=True, text=True, cwd=ROOT, env=environment
    )
    run, tangents = found.stdout.split()[-2:]
    return float(run), float(tangents)


def seconds(call: object, repeats: int) -> float:
    """Median wall time [s]."""
    times = []
    for _ in range(repeats + 1):
        start = perf_counter()
        call()  # type: ignore[operator]
        times.append(perf_counter() - start)
    return median(times[1:])


def purged() -> Engine:
    """HF5's engine with heat and nitrogen in its tank."""
    return engine_on_stand(
        effects=(effect("tank_heat").at(power=500.0), effect("n2_purge").at(area=4e-6, supply_pressure=35e5))
    )


def draws_to_the_ground() -> str:
    """A thousand engines drawn over what their file states with a +/-, burnt and flown to the ground, with bands."""
    content = read_toml(ROOT / "engines" / "maelstrom.toml")[1]
    content["grain"] |= {"a": "1.32e-4 +/- 1e-5", "n": "0.555 +/- 0.01"}
    content["rocket"] |= {"drag_coefficient": "0.529 +/- 0.04"}
    content["tank"] |= {"temperature": "25 +/- 2 degC"}
    loose = engine_of(content, Path("engine.toml"), b"")
    simulate(loose, None, 20)
    one = seconds(lambda: simulate(loose), 10)
    many = seconds(lambda: simulate(loose, None, 1000), 3)
    return f"1000 draws to the ground, with bands{many:9.2f} s: {many / one / 1000:.2f} single runs each"


def main() -> int:
    """Print the times."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cold", action="store_true")
    parser.add_argument("--repeats", type=int, default=30)
    options = parser.parse_args()
    if options.cold:
        with tempfile.TemporaryDirectory() as nothing:
            run, tangents = first_calls(nothing)
        print(f"first run with nothing compiled     {run:9.2f} s, then tangents {tangents:.2f} s")
    run, tangents = first_calls()
    run, tangents = first_calls()
    print(f"first run of a fresh process        {run:9.3f} s, then tangents {tangents:.3f} s")
    engine, active = engine_on_stand(), purged()
    plain = seconds(lambda: burn(engine, SECONDS, run_on=True), options.repeats)
    with_effects = seconds(lambda: burn(active, SECONDS, run_on=True), options.repeats)
    slopes = seconds(lambda: run_with_tangents(active, PARAMETERS, SECONDS, run_on=True), options.repeats)
    print(
        f"a run of {SECONDS:.0f} s                       {1e3 * plain:9.2f} ms, two effects {1e3 * with_effects:.2f} ms"
    )
    print(
        f"tangents of {len(PARAMETERS)} parameters           {1e3 * slopes:9.2f} ms: {slopes / with_effects:.1f} runs"
    )
    batch = [engine] * 64
    one = seconds(lambda: burn_many(batch, workers=1, longest=SECONDS, run_on=True), 5)
    many = seconds(lambda: burn_many(batch, longest=SECONDS, run_on=True), 5)
    print(f"64 runs on all cores                {1e3 * many:9.1f} ms: {one / many:.2f} times as fast as on one")
    print(draws_to_the_ground())
    return 0


if __name__ == "__main__":
    sys.exit(main())
