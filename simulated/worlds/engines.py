"""Engines and their tests: from 0.3 kN with a tank of 2 L to 15 kN with 60 L, and two of the report's class."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi, sqrt

import numpy as np
from simulated.blind import nitrous
from simulated.blind import slots as s
from simulated.blind.kernel import STEP
from simulated.blind.stand import Histories, Stand
from simulated.worlds import kernel
from simulated.worlds.laws import Array, World

LONGEST, AFTER = 10.0, 1.2
"""Seconds after which a valve is closed at the latest, and of the log after that."""
SPEED = 1550.0
"""c* [m/s] from which the throat is sized."""
HOLES = (3.1, 2.5, 2.0, 1.8)
"""Areas of a hole [mm^2]."""


@dataclass(frozen=True)
class Class:
    """An engine: volume [m^3] of its tank, and from and to: seconds of liquid, chamber [Pa], flux [kg/(m^2 s)]."""

    volume: float
    liquid: tuple[float, float]
    chamber: tuple[float, float]
    flux: tuple[float, float]


ENGINES = {
    "1 kN": Class(3e-3, (2.4, 3.6), (12e5, 24e5), (200.0, 400.0)),
    "2 kN": Class(11e-3, (3.5, 5.0), (9e5, 18e5), (180.0, 350.0)),
    "4 kN": Class(18e-3, (3.0, 4.5), (10e5, 22e5), (200.0, 420.0)),
    "9 kN": Class(42e-3, (3.2, 4.8), (15e5, 28e5), (250.0, 450.0)),
    "0.3 kN": Class(2e-3, (4.5, 7.0), (10e5, 22e5), (150.0, 350.0)),
    "15 kN": Class(60e-3, (2.6, 3.6), (18e5, 32e5), (250.0, 480.0)),
}
QUICK = ("1 kN", "2 kN", "4 kN", "9 kN")
"""The engines of the first sets."""

ENDS = ("left", "early", "together", "late")
"""How the fuel ends: some is left, or it ends well before the liquid, within 0.06 s of it, or well after."""


def simulated(
    stand: Stand, world: World, effects: Array | None = None, tables: tuple[Array, Array] | None = None
) -> Histories:
    """Run a test to the end of its log; ``tables`` of tank and gas, where they are known."""
    e = np.zeros(s.SLOTS) if effects is None else effects
    tab, gas = tables or (world.tank_table(), world.gas_table())
    count = round((stand.closing + stand.tail) / STEP) + 1
    traces, events = kernel.run(stand.constants(), e, world.laws, tab, gas, count)
    return Histories(traces, *(float(v) for v in events), time=np.arange(count) * STEP)


def drawn(rng: np.random.Generator, engine: str, end: str, world: World) -> Stand:
    """A stand and a test of it, plausible: the chamber well above ambient and below the injector's pressure."""
    while True:
        stand = _draw_once(rng, ENGINES[engine])
        base = simulated(stand, world)
        if (closed := closed_in_time(stand, base, 6e5, 0.75)) is not None:
            return loaded(rng, closed, base, end)


def closed_in_time(stand: Stand, base: Histories, least: float, most: float) -> Stand | None:
    """A stand with the instant at which its valve is closed; None where its burn is no plausible one: the chamber below
    ``least`` [Pa], or above the part ``most`` of the injector's pressure, or the liquid gone too soon or too late."""
    p_c = float(base.trace(s.P_CHAMBER)[700])
    if not (base.t_v > 1.5 and least < p_c < most * float(base.trace(s.P_RUN)[700])):
        return None
    empty = base.time[np.flatnonzero(base.trace(s.P_TANK) > stand.ambient + 0.6e5)[-1]]
    closed = replace(stand, closing=round(min(LONGEST, float(empty)), 3))
    return closed if base.t_v < closed.closing - 0.7 else None


def _draw_once(rng: np.random.Generator, of: Class) -> Stand:
    between = rng.uniform
    temperature, p_c = between(281.0, 298.0), between(*of.chamber)
    table = nitrous.table()
    rho = float(nitrous.saturated(table, nitrous.RHO_L, temperature - 5.0))
    p_t = float(nitrous.saturated(table, nitrous.P, temperature - 5.0))
    mass = between(0.55, 0.82) * of.volume * rho
    flow, loss = 0.85 * mass / between(*of.liquid), between(0.03, 0.16) * p_t
    area = flow / sqrt(2.0 * rho * max(p_t - loss - p_c, 0.2 * p_t))
    hole = 1e-6 * float(rng.choice(HOLES))
    holes = max(round(area / (between(0.25, 0.7) * hole)), 3)
    ratio, n, speed = between(4.5, 8.0), between(0.3, 0.7), between(1.0e-3, 2.5e-3)
    density, port = between(860.0, 930.0), sqrt(flow / (pi * between(*of.flux)))
    length = flow / ratio / (density * 2.0 * pi * (port + 1.5 * speed) * speed)
    throat = sqrt(flow * (1.0 + 1.0 / ratio) * SPEED / p_c / pi)
    room = pi * port**2 * length
    return Stand(
        volume=of.volume, mass=mass, temperature=temperature, holes=holes, hole_area=hole, C_i=area / (holes * hole),
        K_loss=loss * rho / flow**2, m=between(1.03, 1.22), a=speed / (flow / (pi * (port + 1.5 * speed) ** 2)) ** n,
        n=n, grain_length=length, port_radius=port, fuel_density=density, fuel_mass=100.0,
        pre_volume=room * between(0.1, 0.3), post_volume=room * between(0.3, 0.8), throat_radius=throat,
        exit_radius=throat * sqrt(between(2.4, 4.0)), ambient=1e5 * round(between(0.9, 1.02), 3),
        cracking=1e5 * round(between(1.0, 5.0), 2), supply=1e5, closing=LONGEST, lead=1.0, tail=AFTER,
    )  # fmt: skip


def loaded(rng: np.random.Generator, stand: Stand, base: Histories, end: str) -> Stand:
    """Set what follows from the burn: the fuel that is loaded, and the purge line's pressure."""
    fuel = base.trace(s.FUEL)
    until = {
        "early": base.t_v * rng.uniform(0.75, 0.93),
        "together": base.t_v + rng.uniform(-0.06, 0.06),
        "late": base.t_v + rng.uniform(0.3, 0.6) * (stand.closing - base.t_v),
        "left": stand.closing,
    }[end]
    loaded = float(fuel[: int(until / STEP)].sum()) * STEP * (rng.uniform(1.1, 1.4) if end == "left" else 1.0)
    p_v = float(base.trace(s.P_TANK)[int(base.t_v / STEP)])
    supply = stand.cracking + p_v * (rng.uniform(0.55, 0.9) if rng.uniform() < 0.85 else 1.05)
    return replace(stand, fuel_mass=round(loaded, 4), supply=supply)
