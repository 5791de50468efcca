"""Flights of firings whose thrust holds nitrogen or a separated flow: corrected, uncorrected, and true.

python -m benchmarks.flown_thrust [--n 100] [--write docs/flight.md] (`make flown-thrust`)

``--n``: as many firings with random truths, whose constants are found as wrongly as they say; how many intervals hold.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from benchmarks.studies import put
from simulated.purged import ROCKET, Fired, Truth, fired

from hfanalysis.measured_flight.product import fly_measured, product
from hfanalysis.products.flight import Flight
from hfanalysis.quantity import Quantity

TRUTHS = {
    "nitrogen, vapor as if incompressible": Truth(),
    "nitrogen, vapor that chokes": Truth(choked=True),
    "nitrogen, other exponents (m 1.05, n 0.35)": Truth(m=1.05, n=0.35),
    "nitrogen, and a flow that separates": Truth(nozzle="separated"),
    "a flow that separates, no nitrogen": Truth(nozzle="separated", purge=False),
}
"""What is in the firings of the table."""

FLIGHTS = 600
"""Flights drawn of each: an interval's ends are known to a tenth of it."""


def flights(test: Fired) -> tuple[Flight, Flight]:
    """Corrected, and as it was flown before: purge gas and all, by the one-dimensional nozzle."""
    found, before = test.flown(), test.flown(nozzle="one-dimensional").as_measured[0]
    old = replace(found, curve=before, curves=(before,), as_measured=(before,))
    both = [product(fly_measured(each, ROCKET, FLIGHTS, 1), ROCKET, "no geometry") for each in (found, old)]
    return both[0], both[1]


def holds(quantity: Quantity, truth: float) -> bool:
    """Whether the 95 % interval holds the truth [any unit]."""
    low, high = quantity.interval or (np.nan, np.nan)
    return bool(low <= truth <= high)


def said(quantity: Quantity, truth: float) -> str:
    """Value and interval, and whether it holds the ``truth`` [any unit]."""
    low, high = quantity.interval or (np.nan, np.nan)
    return f"{quantity.value:.0f} ({low:.0f} to {high:.0f}){'' if holds(quantity, truth) else ', **not held**'}"


def row(name: str, test: Fired) -> str:
    """A line of the table."""
    up, impulse = test.flight()
    new, old = flights(test)
    cells = [f"{up.height:.0f}", said(new.apogee, up.height), said(old.apogee, up.height)]
    cells += [f"{impulse:.0f}", said(new.impulse_flown, impulse), said(old.impulse_flown, impulse)]
    return f"| {name} | {' | '.join(cells)} |"


def random_truth(rng: np.random.Generator) -> Truth:
    """Exponents as gases and paraffin have them, both laws of vapor and nozzle."""
    m, n = rng.uniform(1.0, 1.3), rng.uniform(0.3, 0.6)
    return Truth(m, bool(rng.random() < 0.5), n, "separated" if rng.random() < 0.5 else "one-dimensional")


def coverage(number: int) -> list[str]:
    """How many of so many firings' intervals hold the truth."""
    rng, held = np.random.default_rng(5), []
    for seed in range(1, number + 1):
        test = fired.__wrapped__(random_truth(rng), seed)
        up, impulse = test.flight()
        found, old = flights(test)
        held.append([
            holds(found.apogee, up.height), holds(found.impulse_flown, impulse),
            holds(old.apogee, up.height), holds(old.impulse_flown, impulse),
        ])  # fmt: skip
    new, impulse_new, before, impulse_old = np.mean(held, axis=0) * 100.0
    return [
        f"Of {number} firings with random truths, all with nitrogen, the corrected 95 % intervals hold {new:.0f} % of "
        f"the apogees and {impulse_new:.0f} % of the impulses, the uncorrected ones {before:.0f} % and "
        f"{impulse_old:.0f} %."
    ]


def main() -> None:
    """Print the table, or write it into a page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--n", type=int, default=100)
    parser.add_argument("--write", type=Path)
    asked = parser.parse_args()
    lines = [
        "| what the firing has | apogee, m | corrected | uncorrected | impulse, N s | corrected | uncorrected |",
        "|---|---|---|---|---|---|---|",
        *(row(name, fired(truth)) for name, truth in TRUTHS.items()),
        "",
        *(coverage(asked.n) if asked.n else []),
    ]
    print("\n".join(lines))
    if asked.write:
        put(asked.write, "flown-thrust", lines)


if __name__ == "__main__":
    main()
