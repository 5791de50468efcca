"""Pairs of tests of one stand, to predict the second from the first: another load, other holes, another temperature.

The stand's laws, sensors and what is hidden are the same in both. From one test to the next the injector's coefficient
and the regression rate differ by a stand's own scatter, which no test states.
"""

from __future__ import annotations

from dataclasses import replace
from math import exp, log, pi, sqrt
from pathlib import Path

import numpy as np
from simulated.blind import nitrous
from simulated.blind import slots as s
from simulated.blind.effects import EFFECTS, LIBRARY, drawn
from simulated.blind.kernel import STEP
from simulated.blind.plan import Case
from simulated.blind.stand import Stand
from simulated.worlds import engines, laws, loggers
from simulated.worlds.engines import LONGEST, simulated
from simulated.worlds.hidden import sized
from simulated.worlds.laws import World
from simulated.worlds.plan import TARGETS, Test, stands
from simulated.worlds.write import constants, fired, put

SETS = {"scored": 7_000_000, "development": 8_000_000}
"""Where the seeds of each begin: what predictions are made with may be set by those of ``development`` alone."""

SCATTER = (0.01, 0.067)
"""Relative standard deviation of C_i and of the regression rate from test to test, of a stand each, from and to, in
logarithms. Assumed: from a stand that repeats itself well to NFPA 1125's limit on the impulse of a motor's firings."""

LOAD, HOLES, TEMPERATURE, FULLEST = (0.75, 1.15), (0.8, 1.25), (279.0, 299.0), 0.88
"""Of the second test over the first: load and number of holes; its temperature [K]; most of the tank that is liquid."""

KNOWN_TO = 0.5
"""Error of the stated temperature of the second test [K], one standard deviation."""

THRUST_TO_WEIGHT, DRAG = (6.0, 11.0), (0.4, 0.6)
"""Of the rocket that both fly in."""


def tests_of(pair: Test) -> tuple[str, str]:
    """Names of both tests of a pair."""
    return f"{pair.id}-1", f"{pair.id}-2"


def plan(which: str, count: int) -> list[Test]:
    """All pairs, always the same; every other one hides an effect of the library."""
    start = SETS[which]
    rng = np.random.default_rng(start)
    of = [(e, log) for _ in range(-(-count // 16)) for e, log in stands(rng)]
    names = [LIBRARY[i].name for _ in range(-(-count // len(LIBRARY))) for i in rng.permutation(len(LIBRARY))]
    out = []
    for i in range(count):
        hidden = (names[i // 2],) if i % 2 else ()
        end = "late" if "fuel_sliver" in hidden else str(rng.choice(engines.ENDS, p=(0.1, 0.4, 0.2, 0.3)))
        target = exp(rng.uniform(log(TARGETS[0]), log(TARGETS[1])))
        out.append(Test(f"{which[0].upper()}{i:03d}", "pair", hidden, *of[i], end, target, start + i))
    return out


def write_pair(pair: Test, root: Path) -> None:
    """Write both tests."""
    rng = np.random.default_rng(pair.seed)
    world, logger = laws.draw(rng), loggers.LOGGERS[pair.logger]
    first = engines.drawn(rng, pair.engine, pair.end, world)
    with_ = loggers.drawn(rng, logger, first)
    sizes = [sized(first, world, drawn(EFFECTS[n], rng), pair.target, logger, with_) for n in pair.effects]
    hidden = tuple(h for h, _ in sizes)
    spread = {name: exp(rng.uniform(log(SCATTER[0]), log(SCATTER[1]))) for name in ("C_i", "regression rate")}
    second = another(rng, first, pair.end, world, spread)
    rocket = _rocket(rng, first, world)
    for name, stand in zip(tests_of(pair), (first, second), strict=True):
        case = Case(name, "pair", pair.effects, pair.target, pair.logger, pair.seed, pair.seed, stand=pair.id)
        made = fired(rng, case, stand, world, hidden, logger, with_)
        stated = stand.temperature + rng.normal(0.0, KNOWN_TO) - 273.15
        answer = {
            "id": name, "engine": pair.engine, "logger": pair.logger, "end": pair.end, "laws": world.names,
            "effects": {h.effect.name: {"strength": h.strength, "d_prime": d} for h, d in sizes}, "scatter": spread,
            "temperature": f"{stated:.2f} +/- {KNOWN_TO} degC", "t_v": made.true.t_v,
            "truth": constants(stand),
        }  # fmt: skip
        put(made, answer, root, rocket)


def another(rng: np.random.Generator, first: Stand, end: str, world: World, spread: dict[str, float]) -> Stand:
    """The next test of a stand: it burns as well as the first, with the same purge line."""
    while True:
        temperature = rng.uniform(*TEMPERATURE)
        room = FULLEST * first.volume * float(nitrous.saturated(nitrous.table(), nitrous.RHO_L, temperature))
        stand = replace(
            first,
            temperature=temperature,
            mass=min(first.mass * rng.uniform(*LOAD), room),
            holes=max(round(first.holes * rng.uniform(*HOLES)), 3),
            C_i=first.C_i * exp(rng.normal(0.0, spread["C_i"])),
            a=first.a * exp(rng.normal(0.0, spread["regression rate"])),
            closing=LONGEST,
            fuel_mass=100.0,
        )
        base = simulated(stand, world)
        if (closed := engines.closed_in_time(stand, base, 5e5, 0.8)) is not None:
            return replace(engines.loaded(rng, closed, base, end), supply=first.supply)


def _rocket(rng: np.random.Generator, stand: Stand, world: World) -> str:
    """A rocket that the engine lifts well, as test.toml has it."""
    thrust = simulated(stand, world).trace(s.THRUST)
    weight = float(np.max(thrust[: int(1.0 / STEP)])) / rng.uniform(*THRUST_TO_WEIGHT) / 9.81
    dry = max(weight - stand.mass - stand.fuel_mass, 0.3 * weight)
    diameter = 1.15 * 2.0 * max((stand.volume / (12.0 * pi)) ** (1 / 3), stand.outer_radius)
    return f"""
[rocket]
dry_mass = "{dry:.3g} kg"
drag_coefficient = {rng.uniform(*DRAG):.3f}
diameter = "{1e3 * diameter:.1f} mm"
launch_angle = "4 deg"
rail_length = "{1.5 * sqrt(dry / 10.0) + 3.0:.1f} m"
launch_altitude = "{rng.uniform(0.0, 1400.0):.0f} m"
"""
