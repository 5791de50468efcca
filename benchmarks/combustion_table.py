"""How far the combustion table is from direct equilibrium: ``docs/combustion.md``.

Random mixtures, log-uniform in pressure and in oxidizer to fuel, uniform in the oxidizer's enthalpy and the nitrogen
share; shares of nitrogen leave the ratio of nitrous oxide to fuel as stated.
"""

from __future__ import annotations

import argparse
from math import log
from pathlib import Path
from time import perf_counter

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY, equilibrium
from hfanalysis.thermo.combustion_table import Grid, Nodes, build, chamber_pressure, gas_at, temperatures

Array = NDArray[np.float64]

PAGE = Path(__file__).resolve().parent.parent / "docs" / "combustion.md"

CASES = (
    ("all mixtures", (0.5, 200.0), (0.0, 0.0)),
    ("mixtures of a burn", (0.7, 60.0), (0.0, 0.0)),
    ("around the carbon edge", (2.9, 3.4), (0.0, 0.0)),
    ("around stoichiometry", (8.5, 10.5), (0.0, 0.0)),
    ("nitrogen up to a half", (0.7, 60.0), (0.0, 0.5)),
    ("nitrogen 50 to 85 %", (0.7, 60.0), (0.5, 0.85)),
    ("nitrogen 85 to 98 %", (0.7, 60.0), (0.85, 0.98)),
)

HEAD = """# Combustion: the table and the equilibrium it stands for

Written by `python -m benchmarks.combustion_table`.

The chamber gas is NASA CEA's equilibrium of nitrous oxide, paraffin and the nitrogen of a pressurant or purge, frozen
in the nozzle. Engines read it from a table over pressure (0.2 to 120 bar), mixture, the enthalpy with which the nitrous
oxide enters, and the share of nitrogen in what comes through the injector. It is built once, in some seconds, and kept
in the user's cache (`$HFA_CACHE`, else `~/.cache/hfanalysis`).

Two kinks are on nodes of the table. Richer than the *carbon edge*, an O/F of about 3.06 at 27 bar, graphite condenses
and the slope of the temperature breaks; the edge moves with pressure, enthalpy and nitrogen, and mixtures are counted
from it. *Stoichiometry*, an O/F of 9.50, is a hilltop that dilution sharpens to a kink.

## Against direct equilibrium

Random mixtures between 0.3 and 100 bar and between 1.39 and 1.86 MJ/kg of oxidizer enthalpy (liquid at 185 K to the
ideal gas that PROPEP takes). O/F is that of nitrous oxide to fuel. Errors of ln(R T), of gamma, and of ln T:

| mixtures | O/F | points | ln(R T): median | 99 % | worst | gamma: 99 % | worst | ln T: 99 % | worst |
|---|---|---|---|---|---|---|---|---|---|
"""


def mixtures(count: int, ratios: tuple[float, float], nitrogen: tuple[float, float]) -> Array:
    """Pressure, nitrous oxide to fuel, enthalpy and share: shape (count, 4)."""
    rng = np.random.default_rng(11)
    p = np.exp(rng.uniform(log(0.3e5), log(100e5), count))
    r = np.exp(rng.uniform(log(ratios[0]), log(ratios[1]), count))
    h = rng.uniform(1.39e6, PROPEP_OXIDIZER_ENTHALPY, count)
    return np.column_stack([p, r, h, rng.uniform(*nitrogen, count)])


def errors(table: Grid, points: Array) -> Array:
    """Absolute errors of ln(R T), gamma and ln T: shape (count, 3)."""
    out = np.empty((len(points), 3))
    for row, (p, r, h, s) in zip(out, points, strict=True):
        ratio = r / (1.0 - s)
        gas = equilibrium(float(p), float(ratio), float(h), float(s))
        rt, gamma = gas_at(table, np.log(p), np.log(ratio), h, s)
        hot = temperatures(table, *(np.array([v]) for v in (np.log(p), np.log(ratio), h, s)))[0]
        row[:] = np.log(rt / (gas.gas_constant * gas.temperature)), gamma - gas.gamma, np.log(hot / gas.temperature)
    return np.abs(out)


def line(table: Grid, name: str, ratios: tuple[float, float], nitrogen: tuple[float, float], count: int) -> str:
    """One row of the page's table."""
    found = errors(table, mixtures(count, ratios, nitrogen))
    high, worst = np.quantile(found, 0.99, axis=0), found.max(axis=0)
    shown = [np.median(found[:, 0]), high[0], worst[0], high[1], worst[1], high[2], worst[2]]
    return f"| {name} | {ratios[0]:g} to {ratios[1]:g} | {count} | " + " | ".join(f"{v:.1e}" for v in shown) + " |"


@njit
def _many(table: Grid, count: int, share: float, guess: float) -> float:
    total = 0.0
    for i in range(count):
        total += chamber_pressure(table, 2.8e-3 * (1.0 + 1e-7 * i), 1e-3, 1.6 + 1e-6 * i, 1.6e6, share, guess)[0]
    return total


def nanoseconds(table: Grid, share: float, guess: float) -> float:
    """Of one chamber pressure from a guess [Pa]."""
    count, times = 20_000, []
    for _ in range(20):
        start = perf_counter()
        _many(table, count, share, guess)
        times.append(perf_counter() - start)
    return min(times[1:]) / count * 1e9


def main() -> None:
    """Write the page and print what a chamber pressure costs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=10_000)
    count = parser.parse_args().points
    table = build().kernel
    lines = [line(table, *case, count) for case in CASES]
    nodes = Nodes()
    size = (
        f"{nodes.pressures} pressures, {4 * nodes.mixtures} mixtures, 4 enthalpies and {nodes.shares} nitrogen shares"
    )
    tail = f"""
The table has {size}.
Beyond 85 % of nitrogen the gas is below about 1100 K, and where oxidizer is scarce it is below 500 K: the last row's
worst are there. Mixtures below 0.1 of nitrous oxide to fuel, cold fuel vapor for which CEA has no answer, are given
the values at 0.1.
"""
    PAGE.write_text(HEAD + "\n".join(lines) + "\n" + tail, encoding="utf-8")
    print(PAGE.read_text(encoding="utf-8"))
    for share in (0.0, 0.2):
        pressure = _many(table, 1, share, 27e5)
        near, far = nanoseconds(table, share, 1.001 * pressure), nanoseconds(table, share, 1e5)
        print(
            f"chamber pressure at a nitrogen share of {share:g}: {near:.0f} ns from 0.1 % off, {far:.0f} ns from 1 bar"
        )


if __name__ == "__main__":
    main()
