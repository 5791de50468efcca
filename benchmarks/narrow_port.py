"""A gauge at the head of a port as wide as the throat, with and without what that means: ``docs/narrow-port.md``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

from simulated.narrow_port import fired, judged

from hfanalysis.engine.port import head_over_nozzle
from hfanalysis.quantity import Quantity

PAGE = Path(__file__).resolve().parent.parent / "docs" / "narrow-port.md"
NAMES = ("c_star", "c_star_efficiency_frozen", "thrust_coefficient", "thrust_coefficient_efficiency_frozen")
RECOVERIES = (0.15, 0.5, 0.85)

HEAD = """# A port as wide as the throat

Written by `make narrow-port`. The hot fires' engine is simulated with a port that has the throat's area at ignition
and 2.3 times that after 4.4 s. Its gauge sits at the head. What it reads is found by following the flow along the port,
with the fuel and the heat that come in and with friction, and over the step behind the grain, which gives back a part
of the port's momentum (`simulated/narrow_port.py`); the analysis knows the port's two ends only. Means from 0.4 to
4.4 s, with their 95 % intervals. *Stated*: `[channels.p_chamber] tap = "head"`. *Unknown*: no such key; the value is as
read, the interval reaches to one side. *As read*: the same value with the interval of gauge, throat, flow and cell
alone. Bold: the truth lies outside.

| recovered | quantity | truth | stated | unknown | as read |
|---|---|---|---|---|---|
"""


def cell(quantity: Quantity, truth: float) -> str:
    """Value and interval; bold where the truth lies outside."""
    assert quantity.value is not None
    assert quantity.interval is not None
    low, high = quantity.interval
    digits = 0 if quantity.unit else 3
    words = f"{quantity.value:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"
    return words if low <= truth <= high else f"**{words}**"


def rows(recovery: float) -> Iterator[str]:
    """A line per quantity."""
    test = fired(recovery)
    truth, stated, unknown = (judged(test, *given)[0] for given in ((None, "nozzle"), ("head", "head"), (None, "head")))
    for name in NAMES:
        true, told, reading = (getattr(found, name) for found in (truth, stated, unknown))
        alone = Quantity(reading.value, reading.unit, reading.std)
        said = f"{true.value:.0f}" if true.unit else f"{true.value:.3f}"
        cells = " | ".join(cell(q, true.value) for q in (told, reading, alone))
        yield f"| {100.0 * recovery:.0f} % | `{name}` | {said} | {cells} |"


def heads() -> str:
    """How far the head stands above the nozzle, by the port's area."""
    lines = ["", "Head over the stagnation pressure before the nozzle (gamma 1.24, chamber 2.87 throats), less 1:",
             "", "| port over throat | all recovered | none |", "|---|---|---|"]  # fmt: skip
    for area in (0.8, 0.93, 1.0, 1.3, 2.0, 2.87):
        most, least = (100.0 * (head_over_nozzle(1.24, area, 2.87, r) - 1.0) for r in (0.0, 1.0))
        lines.append(f"| {area:.2f} | {least:.1f} % | {most:.1f} % |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the page, or print its table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    page = HEAD + "\n".join(line for r in RECOVERIES for line in rows(r)) + "\n" + heads()
    if parser.parse_args().write:
        PAGE.write_text(page, encoding="utf-8")
    print(page)


if __name__ == "__main__":
    main()
