"""Random engines, most of them absurd: each runs or is refused with a reason, in bounded time, and never pulls.

python -m benchmarks.random_engines [NUMBER] [--write]
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from dataclasses import dataclass
from math import pi
from pathlib import Path
from time import perf_counter

import numpy as np

from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY
from hfanalysis.thermo.combustion_table import CombustionTable, build
from hfanalysis.thermo.nitrous import saturation

PAGE = Path(__file__).resolve().parent.parent / "docs" / "random-engines.md"


@dataclass(frozen=True)
class Outcome:
    """What became of an engine: a burn or the reason of its refusal, and how long that took [s]."""

    engine: Engine
    burn: Burn | None
    reason: str
    seconds: float


def random_engine(rng: np.random.Generator, combustion: CombustionTable) -> Engine:
    """Every size over one to two orders of magnitude, about one engine in three impossible."""

    def span(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    source = saturation(str(rng.choice(["report", "coolprop"])))
    volume, temperature = span(1e-3, 1e-1), float(rng.uniform(240.0, 312.0))
    fill = float(rng.uniform(0.05, 1.05))
    density = float(np.nan_to_num(source.liquid_density(temperature), nan=500.0))
    radius, length, throat = span(0.015, 0.15), span(0.1, 3.0), span(3e-3, 8e-2)
    constant = (float(rng.uniform(0.0, 10e5)),) * 2 if rng.random() < 0.5 else None
    return Engine(
        saturation=source,
        combustion=combustion,
        feed=FeedSystem(volume, span(1e-6, 5e-4), 0.0 if constant else span(1e6, 1e10), constant),
        oxidizer_mass=fill * volume * density,
        temperature=temperature,
        polytropic_exponent=None if rng.random() < 0.5 else float(rng.uniform(0.5, 1.5)),
        fuel_mass=float(rng.uniform(0.05, 1.05)) * pi * radius**2 * length * 900.0,
        grain_length=length,
        outer_radius=radius,
        fuel_density=900.0,
        a=span(1e-5, 1e-3),
        n=float(rng.uniform(0.2, 0.9)),
        dead_volume=span(1e-5, 1e-2),
        throat_area=pi * throat**2,
        exit_area=pi * (throat * float(rng.uniform(0.98, 4.0))) ** 2,
        vehicle=Vehicle(
            span(5.0, 500.0), 0.5, span(5e-3, 0.2), float(rng.uniform(0.0, 0.2)), float(rng.uniform(0, 3e3))
        ),
        oxidizer_enthalpy=PROPEP_OXIDIZER_ENTHALPY if rng.random() < 0.5 else None,
    )


def attempt(engine: Engine) -> Outcome:
    """Burn an engine; what is refused has its reason, anything else is a defect and raises."""
    started = perf_counter()
    try:
        done = burn(engine)
    except (ValueError, ArithmeticError) as error:
        return Outcome(engine, None, str(error), perf_counter() - started)
    return Outcome(engine, done, "", perf_counter() - started)


def faults(outcome: Outcome) -> list[str]:
    """What is wrong with an outcome; empty where nothing is."""
    found = [] if outcome.seconds < 10.0 else [f"took {outcome.seconds:.1f} s"]
    if outcome.burn is None:
        return found if len(outcome.reason) > 20 else [*found, f"no reason: {outcome.reason!r}"]
    states, outputs = outcome.burn.states, outcome.burn.outputs
    if not (np.isfinite(states).all() and np.isfinite(outputs).all()):
        found.append("not finite")
    for name in ("thrust", "oxidizer_flow", "fuel_flow", "nozzle_flow"):
        if outcome.burn.output(name).min() < 0.0:
            found.append(f"negative {name}")
    if outcome.burn.state("altitude").min() < outcome.engine.vehicle.launch_altitude - 0.1:
        found.append("below ground")
    return found


def kind(reason: str) -> str:
    """A reason without its numbers."""
    return " ".join(word for word in reason.split() if not any(c.isdigit() for c in word))


def summary(outcomes: list[Outcome]) -> str:
    """The outcomes as a page."""
    number, seconds = len(outcomes), np.array([o.seconds for o in outcomes])
    ran = sum(o.burn is not None for o in outcomes)
    lines = [
        "# Random engines\n",
        "Written by `make random-engines`. Every size over one to two orders of magnitude, most of them absurd: each",
        "runs or is refused with a reason, in bounded time, with finite numbers, no negative flow or thrust, and no",
        "rocket below ground.\n",
        f"| of {number} engines | |",
        "|---|---|",
        f"| ran | {ran} |",
    ]
    reasons = Counter(kind(o.reason) for o in outcomes if o.burn is None)
    lines += [f"| refused: {reason} | {count} |" for reason, count in reasons.most_common()]
    lines += [f"| with a fault | {sum(bool(faults(o)) for o in outcomes)} |"]
    lines += [
        f"\nMedian {1e3 * np.median(seconds):.1f} ms, 99 % below {1e3 * np.quantile(seconds, 0.99):.0f} ms, longest "
    ]
    lines[-1] += f"{seconds.max():.2f} s."
    return "\n".join(lines) + "\n"


def main() -> int:
    """Attempt them all and print a summary; 1 where any has a fault."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("number", nargs="?", type=int, default=10_000)
    parser.add_argument("--write", action="store_true", help="docs/random-engines.md")
    options = parser.parse_args()
    rng, table = np.random.default_rng(1), build()
    attempt(random_engine(np.random.default_rng(2), table))  # compiles
    outcomes = [attempt(random_engine(rng, table)) for _ in range(options.number)]
    print(summary(outcomes))
    if options.write:
        PAGE.write_text(summary(outcomes), encoding="utf-8")
    wrong = [(i, f) for i, o in enumerate(outcomes) if (f := faults(o))]
    for i, what in wrong[:20]:
        print(f"engine {i}: {', '.join(what)}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
