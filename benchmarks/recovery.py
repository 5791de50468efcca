"""Does the calibration find what is in a log, and do its intervals hold it? Four studies, each resumable.

``own``: 400 logs of the virtual stand (random truth, noise, declared biases, line filling, purge), each taken through
ingest, segment and calibrate. ``sensors``: the like by poor and good loggers (noise 0.2 to 10 times the usual, 50 to
1000 Hz, converters of 8 to 14 bits). ``engine``: logs of whole engines (simulated/engine.py), for a and n.
``blind``: the cases without an effect of another generator, where its folder is given.
Results are written as they come to .cache/recovery-*.jsonl; the table goes to docs/recovery.md.

    python -m benchmarks.recovery --cases 400 [--blind FOLDER]
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
CACHE = ROOT / ".cache"
TABLE = ROOT / "docs" / "recovery.md"
TITLE = """# Recovery

Made by `make recovery` (the second table, if there is one, with `FLAGS='--blind FOLDER'`). z is (found - truth) /
stated standard deviation.
"""
LOGGERS = """White noise 0.2 to 10 times that of the logs above, 50, 200 or 1000 Hz, pressures in steps of a converter
over 1000 psi. In how many of the logs that have an answer its 95 % interval holds the truth."""
QUANTITIES = ("C_i", "m", "K_loss", "t_v", "t_purge", "t_open")
RATES, BITS = (50.0, 200.0, 1000.0), (0, 8, 10, 12, 14)
REGRESSION = ("regression_rate_reference", "a", "n", "C_i")


def recover(folder: Path) -> dict[str, Any]:
    """Take one test folder through ingest, segment and calibrate: value, std and interval by name."""
    from hfanalysis.calibrate.tank import calibrate
    from hfanalysis.segment.phases import find_phases

    log, definition = read_folder(folder)
    segments = find_phases(log, definition)
    calibration = calibrate(log, segments, definition, 400)
    found = {**calibration.constants.quantities, **segments.events, "t_open": segments.t_open}
    return {n: found[n].to_json() for n in QUANTITIES}


def read_folder(folder: Path) -> tuple[Any, Any]:
    """Log and definition of a test folder."""
    from hfanalysis.record.definition import load_definition
    from hfanalysis.record.ingest import ingest
    from hfanalysis.record.log import read_log

    definition = load_definition(folder / "test.toml")
    with tempfile.TemporaryDirectory() as scratch:
        product = Path(scratch) / "ingest.h5"
        ingest(definition, product)
        return read_log(product), definition


def own_case(seed: int, sensors: Any = None) -> dict[str, Any]:
    """One log of the virtual stand, by its ``sensors``, and what is found in it."""
    from simulated.stand import Sensors, make_log

    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / f"S{seed:04d}"
        folder.mkdir()
        truth = make_log(folder, seed, sensors or Sensors())
        found = recover(folder)
    return {"case": seed, "truth": {n: getattr(truth, n) for n in QUANTITIES}, "found": found}


def sensors_case(seed: int) -> dict[str, Any]:
    """The like by another logger."""
    from simulated.stand import Sensors

    from hfanalysis.errors import AbsentError
    from hfanalysis.quantity import Quantity

    draw = np.random.default_rng([20261128, seed])
    noise = float(np.exp(draw.uniform(np.log(0.2), np.log(10.0))))
    sensors = Sensors(noise, float(draw.choice(RATES)), int(draw.choice(BITS)))
    try:
        case = own_case(seed, sensors)
    except AbsentError as missing:
        absent = Quantity.absent(str(missing)).to_json()
        case = {"case": seed, "truth": {}, "found": dict.fromkeys(QUANTITIES, absent)}
    return {**case, "sensors": [sensors.noise, sensors.rate, sensors.bits]}


def engine_case(seed: int) -> dict[str, Any]:
    """One log of a whole engine, and what is found of its regression."""
    from simulated.engine import make_log

    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / f"E{seed:04d}"
        folder.mkdir()
        truth = make_log(folder, seed)
        found = recover_regression(folder)
    flux = found.pop("reference_flux")
    known = {"a": truth.a, "n": truth.n, "C_i": truth.stand.C_i}
    known["regression_rate_reference"] = None if flux is None else truth.a * flux**truth.n
    return {"case": seed, "truth": known, "found": found}


def recover_regression(folder: Path) -> dict[str, Any]:
    """Take one test folder through to its regression."""
    from hfanalysis.calibrate.fuel_law import regress
    from hfanalysis.calibrate.tank import calibrate
    from hfanalysis.segment.phases import find_phases

    log, definition = read_folder(folder)
    segments = find_phases(log, definition)
    tank = calibrate(log, segments, definition, 400)
    found = regress(log, segments, definition, tank)
    out = {n: found.quantities[n].to_json() for n in ("a", "n", "regression_rate_reference")}
    flux = found.regression.reference_flux and found.regression.reference_flux.value
    return {**out, "C_i": tank.constants.C_i.to_json(), "reference_flux": flux}


def blind_case(folder: Path) -> dict[str, Any]:
    """One practice case of another generator, scored against its answer."""
    answer = json.loads((folder.parent.parent / "answers" / f"{folder.name}.json").read_text())
    truth = {"C_i": answer["C_i"], "m": answer["m"], "t_v": answer["t_v"], "t_purge": answer["t_purge"], "t_open": 0.0}
    return {"case": folder.name, "truth": truth, "found": recover(folder)}


@dataclass(frozen=True)
class Study:
    """Cases by name, and what is done with each."""

    root: Path
    cases: Mapping[str, Any]
    work: Callable[[Any], dict[str, Any]]
    out: Path | None = None


def run_one(name: str, study: Study) -> dict[str, Any]:
    """What is found in one case."""
    return study.work(study.cases[name])


def run(name: str, cases: Iterable[Any], work: Any, processes: int) -> list[dict[str, Any]]:
    """Work through the cases that have no result yet; every result is written as soon as it is there."""
    from hfanalysis.campaign.cluster import Cluster

    CACHE.mkdir(exist_ok=True)
    path = CACHE / f"recovery-{name}-{_code()}.jsonl"
    done = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    asked = {str(c if isinstance(c, int) else c.name): c for c in cases}
    done = [r for r in done if str(r["case"]) in asked]
    known = {str(r["case"]) for r in done}
    todo = {name: c for name, c in asked.items() if name not in known}
    if not todo:
        return done
    with path.open("a") as file, Cluster(processes) as cluster:
        found = cluster.each(run_one, list(todo), Study(CACHE, todo, work))
        for test, result in track(found, f"{name} logs", len(todo), console=Console(stderr=True)):
            if isinstance(result, str):
                raise SystemExit(f"{test}: {result}")
            file.write(json.dumps(result) + "\n")
            file.flush()
            done.append(result)
    return done


def _code() -> str:
    """Results are of one state of the code: any change to it starts the study anew."""
    digest = hashlib.sha256()
    for path in sorted([*ROOT.glob("src/**/*.py"), *ROOT.glob("simulated/*.py")]):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def by_noise(results: list[dict[str, Any]]) -> str:
    """Coverage of each interval by the sensor's noise and by the converter's bits."""
    noises = [(f"noise {low:g} to {high:g} times", [r for r in results if low <= r["sensors"][0] < high])
              for low, high in ((0.2, 0.7), (0.7, 2.5), (2.5, 10.1))]  # fmt: skip
    bits = [(f"{n} bits" if n else "no steps", [r for r in results if r["sensors"][2] == n]) for n in BITS]
    rows = [f"| logs | cases | {' | '.join(QUANTITIES[:-1])} |", "|---|---|" + "---|" * len(QUANTITIES[:-1])]
    for words, some in [("all", results), *noises, *bits]:
        rows.append(f"| {words} | {len(some)} | {' | '.join(covered(some, name) for name in QUANTITIES[:-1])} |")
    return "\n".join(rows)


def covered(results: list[dict[str, Any]], name: str) -> str:
    """In how many of those that answer the interval holds the truth."""
    answered = [(r["truth"][name], r["found"][name]) for r in results if r["found"][name]["value"] is not None]
    held = sum(f["ci95"][0] <= t <= f["ci95"][1] for t, f in answered)
    return f"{held} of {len(answered)}" + (f" ({100.0 * held / len(answered):.0f} %)" if answered else "")


def separable(results: list[dict[str, Any]]) -> str:
    """How many tests tell a and n apart, and how far off n is where they do not."""
    found = [(r["truth"]["n"], r["found"]["n"]) for r in results]
    blurred = [abs(f["value"] - t) for t, f in found if f["value"] is not None and f["verdict"] == "not identifiable"]
    absent = sum(f["value"] is None for _, f in found)
    error = f"; there n is off by {np.median(blurred):.2f} in the median" if blurred else ""
    told = len(found) - len(blurred) - absent
    return (
        f"a and n are called identified in {told} of {len(found)} logs, not told apart in {len(blurred)}{error};\n"
        f"{absent} give no answer. Rows a and n count the identified ones. The rate at the reference flux is the\n"
        "combination ln a + n ln G_ref."
    )


def identified(results: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The same results without values that are called not identifiable."""

    def kept(found: dict[str, Any]) -> dict[str, Any]:
        return {"value": None} if found.get("verdict") == "not identifiable" else found

    return [{**r, "found": {n: kept(f) for n, f in r["found"].items()}} for r in results]


def table(results: list[dict[str, Any]], quantities: tuple[str, ...] = QUANTITIES) -> str:
    """Per quantity: cases, mean and scatter of (found - truth)/std, relative bias, coverage with its 95 % limits."""
    rows = [
        "| quantity | cases | answered | median relative or absolute error | mean z | std z "
        "| 95 % interval covers | 95 % limits |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name in quantities:
        pairs = [(r["truth"][name], r["found"][name]) for r in results if name in r["truth"]]
        answered = [(t, f) for t, f in pairs if f["value"] is not None]
        if not answered:
            continue
        error = np.array([f["value"] - t for t, f in answered])
        z = error / np.array([f["std"] for _, f in answered])
        inside = np.array([f["ci95"][0] <= t <= f["ci95"][1] for t, f in answered])
        low, high = wilson(int(inside.sum()), inside.size)
        size = f"{1e3 * np.median(error):+.2f} ms" if name.startswith("t_") else _percent(error, answered)
        rows.append(
            f"| {name} | {len(pairs)} | {len(answered)} | {size} | {z.mean():+.2f} | {z.std():.2f} | "
            f"{100 * inside.mean():.1f} % | {100 * low:.1f} to {100 * high:.1f} % |"
        )
    return "\n".join(rows)


def _percent(error: np.ndarray, answered: list[Any]) -> str:
    return f"{100 * np.median(error / np.array([t for t, _ in answered])):+.2f} %"


def wilson(k: int, n: int) -> tuple[float, float]:
    z, p = 1.96, k / n
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z * np.sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return middle - half, middle + half


def blind_folders(root: Path) -> list[Path]:
    """The practice cases in which nothing is hidden."""
    answers = sorted((root / "answers").glob("*.json"))
    none = [a.stem for a in answers if json.loads(a.read_text()).get("effect") == "none"]
    return [root / "raw_tests" / name for name in none]


def main() -> None:
    """Run the studies and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=400)
    parser.add_argument("--first", type=int, default=0, help="first seed; others than the default are a check on it")
    parser.add_argument("--sensors", type=int, default=400, help="logs of poor and good loggers")
    parser.add_argument("--engines", type=int, default=400, help="logs of whole engines")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--blind", type=Path)
    arguments = parser.parse_args()
    text = TITLE
    own = run("own", range(arguments.first, arguments.first + arguments.cases), own_case, arguments.processes)
    text += f"\n## {len(own)} logs of the project's own tank model\n\n{table(own)}\n"
    logs = range(arguments.first, arguments.first + arguments.sensors)
    sensors = run("sensors", logs, sensors_case, arguments.processes)
    text += f"\n## {len(sensors)} of them by poor and good loggers\n\n{LOGGERS}\n\n{by_noise(sensors)}\n"
    engines = run(
        "engine", range(arguments.first, arguments.first + arguments.engines), engine_case, arguments.processes
    )
    text += f"\n## {len(engines)} logs of whole engines\n\n{separable(engines)}\n\n"
    text += f"{table(identified(engines), REGRESSION)}\n"
    if arguments.blind is not None and arguments.blind.is_dir():
        blind = run("blind", blind_folders(arguments.blind), blind_case, arguments.processes)
        text += f"\n## {len(blind)} cases without an effect from another generator\n\n{table(blind)}\n"
    TABLE.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
