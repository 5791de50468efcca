"""Do 95 % intervals hold what a test engineer signs for? Simulated tests with systematic errors, through all stages.

Every log is of a whole engine (simulated/signed.py) whose volume, holes, masses, throat, gauges, load cell, rocket and
table of nitrous oxide are off as test.toml states or as the documented defaults have it. Resumable: results are kept in
.cache/recovery-signed-*.jsonl as they come, of one state of the code.

    python -m benchmarks.coverage [--cases 400] [--write docs/coverage.md]
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.recovery import read_folder, run, wilson
from simulated.signed import Signed, make_log

WANTED = (91.0, 98.0)
"""Of coverage [%]."""
LEAST = 400
"""Tests for each quantity, of which the limits of coverage are some 2 % wide."""
QUANTITIES = ("C_i", "total_impulse", "peak_chamber_pressure", "peak_thrust", "specific_impulse",
              "specific_impulse_loaded", "c_star", "apogee", "n")  # fmt: skip
SMOOTHED = 0.1
"""[s] of the running mean of which a peak is the largest value."""
SAMPLES, FLIGHTS = 200, 400
"""Repetitions of the calibration, and drawn flights, of each test. Source: choice; half and a tenth of the defaults."""
TITLE = """# Coverage

Made by `make coverage`, which goes on where it was stopped. {count} simulated tests (simulated/signed.py), each taken
from its log to its flight. Drawn anew for each, as test.toml states it (in half of the tests) or as the documented
defaults have it (in the others): tank volume, loaded mass, the injector's holes, grain, throat, burn time by video,
zero and span of every gauge, the load cell's gain (calibrated in place or not) and a drift of any course, dry mass,
drag, rail and wind. C_i drifts by {drift:.0f} % (one standard deviation) while the liquid lasts, along a straight line,
mostly early or mostly late, and every second log is reduced with another table of nitrous oxide than its own. n counts
where it is called identified. z is (found - truth) / stated standard deviation. {verdict}

"""


def signed_case(seed: int) -> dict[str, Any]:
    """One log, what is true of it and what is found."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / f"V{seed:04d}"
        folder.mkdir()
        truth = make_log(folder, seed)
        try:
            found, known = taken_through(folder, truth)
        except Exception as error:  # a study goes on, and the table counts them
            return {"case": seed, "truth": {}, "found": {}, "failed": f"{type(error).__name__}: {error}"}
    return {"case": seed, "truth": known, "found": found}


def taken_through(folder: Path, truth: Signed) -> tuple[dict[str, Any], dict[str, Any]]:
    """What calibration, validation and flight find, and the truth of it, by name."""
    from hfanalysis.calibrate.fuel_law import regress
    from hfanalysis.calibrate.tank import calibrate
    from hfanalysis.measured_flight.firing import firing
    from hfanalysis.measured_flight.product import fly_measured
    from hfanalysis.segment.phases import find_phases
    from hfanalysis.validate.validation import validate

    log, definition = read_folder(folder)
    segments = find_phases(log, definition)
    tank = calibrate(log, segments, definition, SAMPLES)
    calibration = tank.with_law(regress(log, segments, definition, tank))
    validated = validate(log, segments, definition, calibration, None)
    measured, ratios = validated.product.performance.measured, validated.product.efficiencies
    rocket = definition.rocket
    assert rocket is not None
    flown = firing(log, segments, calibration, definition)
    flights = fly_measured(flown, rocket, FLIGHTS, 1)
    apogee = flights.dispersion.spreads()["apogee"].about(flights.ascent.height, "m")
    told = {
        "C_i": calibration.C_i, "n": calibration.n, "apogee": apogee, **measured.quantities,
        **({} if ratios is None else ratios.quantities),
    }  # fmt: skip
    perfect = firing(without_errors(log, segments, truth), segments, calibration, definition)
    known = truths(truth, segments) | {"apogee": apogee_of(perfect, truth.row)}
    return {name: told[name].to_json() for name in QUANTITIES if name in told}, known


def apogee_of(flown: Any, row: Any = None) -> float:
    """Height [m] of a flight that differs by ``row`` from what is stated."""
    from hfanalysis.flight.ascent import NOMINAL, ascend

    return ascend(flown.curve, flown.vehicle, flown.rail_length, NOMINAL if row is None else row).height


def without_errors(log: Any, segments: Any, truth: Signed) -> Any:
    """The log as sensors without any error would have it."""
    origin = segments.t_open.value
    exact = {
        name: replace(
            channel, values=truth.at(name, channel.time - truth.stand.t_open), raw=None, zero=0.0, zero_std=0.0,
            drift=0.0, flags=np.zeros_like(channel.flags), accuracy=1e-3,
        )
        for name, channel in log.channels.items()
    }  # fmt: skip
    assert abs(origin - truth.stand.t_open) < 0.5
    return replace(log, channels=exact)


def truths(truth: Signed, segments: Any) -> dict[str, float]:
    """By name, as the products define them."""
    weight = 9.80665 * truth.expended
    loaded = 9.80665 * (truth.stand.mass + truth.engine.fuel_mass)
    end = min(truth.stand.t_v, truth.burn_time)
    part = (truth.time > max(segments.time("t_feed") or 0.0, 0.2)) & (truth.time < end)
    chamber = truth.curves["p_chamber"]
    c_star = (chamber * truth.engine.throat_area / np.maximum(truth.flow, 1e-9))[part]
    return {
        "C_i": truth.C_i,
        "n": truth.engine.n,
        "total_impulse": truth.total_impulse,
        "specific_impulse": truth.total_impulse / weight,
        "specific_impulse_loaded": truth.total_impulse / loaded,
        "peak_chamber_pressure": _peak(truth.time, chamber),
        "peak_thrust": _peak(truth.time, truth.curves["thrust"]),
        "c_star": float(np.trapezoid(c_star, truth.time[part]) / np.ptp(truth.time[part])),
    }


def _peak(time: Any, values: Any) -> float:
    """Largest mean over SMOOTHED."""
    clock = np.arange(0.0, float(time[-1]), 1e-3)
    total = np.concatenate(([0.0], np.cumsum(np.interp(clock, time, values))))
    width = round(SMOOTHED / 1e-3)
    return float(((total[width:] - total[:-width]) / width).max())


def answered(results: list[dict[str, Any]], name: str) -> list[tuple[float, dict[str, Any]]]:
    """Truth and answer of every test that has one; of n, where it is called identified."""
    pairs = [(r["truth"][name], r["found"][name]) for r in results if name in r["truth"] and name in r["found"]]
    known = [(t, f) for t, f in pairs if f["value"] is not None and f.get("ci95")]
    return [(t, f) for t, f in known if f.get("verdict") == "identified"] if name == "n" else known


def table(results: list[dict[str, Any]]) -> tuple[str, list[str]]:
    """Rows of the quantities, and the names of those outside of what is wanted."""
    lines = [
        "| quantity | answered | median error | mean z | std z | 95 % interval covers | 95 % limits |",
        "|---|---|---|---|---|---|---|",
    ]
    outside = []
    for name in QUANTITIES:
        pairs = answered(results, name)
        if not pairs:
            continue
        error = np.array([f["value"] - t for t, f in pairs])
        z = error / np.array([f["std"] for _, f in pairs])
        inside = np.array([f["ci95"][0] <= t <= f["ci95"][1] for t, f in pairs])
        share, (low, high) = 100.0 * inside.mean(), wilson(int(inside.sum()), inside.size)
        outside += [] if WANTED[0] <= share <= WANTED[1] else [name]
        size = 100.0 * np.median(np.abs(error) / np.array([abs(t) for t, _ in pairs]))
        lines.append(
            f"| {name} | {len(pairs)} | {size:.2f} % | {z.mean():+.2f} | {z.std():.2f} | {share:.1f} % | "
            f"{100 * low:.1f} to {100 * high:.1f} % |"
        )
    return "\n".join(lines), outside


def page(results: list[dict[str, Any]]) -> str:
    """The whole page."""
    from simulated.signed import DRIFT

    rows, outside = table(results)
    wanted = f"{WANTED[0]:.0f} to {WANTED[1]:.0f} %"
    said = f"All cover {wanted}." if not outside else f"Outside {wanted}: {', '.join(outside)}."
    failed = [r["failed"] for r in results if r.get("failed")]
    lost = f"\n{len(failed)} of the tests gave no answer: {'; '.join(sorted(set(failed)))}.\n" if failed else ""
    few = "" if len(results) >= LEAST else f" The study was stopped before its {LEAST} tests."
    return TITLE.format(count=len(results), drift=100.0 * DRIFT, verdict=said + few) + rows + "\n" + lost


def main() -> None:
    """Run the study, print the page and write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=600)
    parser.add_argument("--first", type=int, default=0, help="first seed; others than the default are a check on it")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    results = run("signed", range(given.first, given.first + given.cases), signed_case, given.processes)
    text = page(results)
    if given.write is not None:
        given.write.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
