"""A family of student-size hybrids around the report's Hot Fire 4 and 5, and one test of one of them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import exp, log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from . import combustion, kernel, nitrous
from . import slots as s

Array = NDArray[np.float64]

SHORTEST, LONGEST = 11.5, 20.0
"""When the valve is closed [s]."""
RESIDUAL = 0.6e5
"""Pressure above ambient that is left in the tank at least when its valve is closed [Pa]."""
SPEED = 1550.0
"""c* [m/s] from which the throat is sized."""


@dataclass(frozen=True)
class Stand:
    """What is true of a stand and one test on it; SI."""

    volume: float
    mass: float
    temperature: float
    holes: int
    hole_area: float
    C_i: float
    K_loss: float
    m: float
    a: float
    n: float
    grain_length: float
    port_radius: float
    fuel_density: float
    fuel_mass: float
    pre_volume: float
    post_volume: float
    throat_radius: float
    exit_radius: float
    ambient: float
    cracking: float
    supply: float | None
    closing: float
    lead: float
    tail: float

    @property
    def outer_radius(self) -> float:
        """Outer radius of the grain [m]."""
        return sqrt(self.port_radius**2 + self.fuel_mass / (pi * self.fuel_density * self.grain_length))

    def constants(self) -> Array:
        """As compiled code reads them."""
        c = np.zeros(s.CONSTANTS)
        c[s.VOLUME], c[s.AREA], c[s.K_LOSS] = self.volume, self.C_i * self.holes * self.hole_area, self.K_loss
        c[s.POLYTROPE], c[s.REGRESSION_A], c[s.REGRESSION_N] = self.m, self.a, self.n
        c[s.LENGTH], c[s.PORT], c[s.OUTER] = self.grain_length, self.port_radius, self.outer_radius
        c[s.FUEL_DENSITY], c[s.DEAD_VOLUME] = self.fuel_density, self.pre_volume + self.post_volume
        c[s.THROAT_RADIUS], c[s.EXIT_AREA] = self.throat_radius, pi * self.exit_radius**2
        c[s.AMBIENT], c[s.CRACKING], c[s.SUPPLY] = self.ambient, self.cracking, self.supply or 0.0
        c[s.CLOSING], c[s.MASS], c[s.TEMPERATURE], c[s.FORMATION] = (
            self.closing,
            self.mass,
            self.temperature,
            nitrous.formation_offset(),
        )
        return c


@dataclass(frozen=True)
class Histories:
    """What is true over time, from the opening on, in steps of a millisecond; instants [s], nan where there is none."""

    traces: Array
    t_v: float
    t_purge: float
    t_fuel_out: float
    time: Array = field(repr=False)

    def trace(self, which: int) -> Array:
        """One column."""
        return self.traces[:, which]


def simulate(stand: Stand, effects: Array | None = None) -> Histories:
    """Run a test to the end of its log."""
    e = np.zeros(s.SLOTS) if effects is None else effects
    count = round((stand.closing + stand.tail) / kernel.STEP) + 1
    traces, events = kernel.run(stand.constants(), e, nitrous.table(), combustion.table(), count)
    return Histories(traces, *(float(v) for v in events), time=np.arange(count) * kernel.STEP)


def _between(rng: np.random.Generator, low: float, high: float) -> float:
    return float(rng.uniform(low, high))


def _log_between(rng: np.random.Generator, low: float, high: float) -> float:
    return exp(_between(rng, log(low), log(high)))


def _tank(rng: np.random.Generator, scale: float) -> dict[str, float]:
    volume = 16.5e-3 * scale
    temperature = _between(rng, 278.0, 300.0)
    rho = float(nitrous.saturated(nitrous.table(), nitrous.RHO_L, temperature))
    return {"volume": volume, "temperature": temperature, "mass": _between(rng, 0.5, 0.8) * volume * rho}


def _pressure(temperature: float) -> float:
    return float(nitrous.saturated(nitrous.table(), nitrous.P, temperature))


def _injector(rng: np.random.Generator, mass: float, temperature: float, p_c: float) -> dict[str, float]:
    """Holes such that the liquid lasts 3 to 8 s, with a feed loss of 1.5 to 9 bar behind the tank."""
    flow = 0.85 * mass / _between(rng, 3.2, 7.5)
    rho = float(nitrous.saturated(nitrous.table(), nitrous.RHO_L, temperature - 6.0))
    p_t = _pressure(temperature - 6.0)
    loss = min(_between(rng, 1.5e5, 9e5), 0.4 * (p_t - p_c))
    hole_area = pi / 4.0 * (1e-3 * round(_between(rng, 1.4, 2.2), 1)) ** 2
    drop = p_t - loss - p_c
    area = flow / sqrt(2.0 * rho * drop)
    holes = max(round(area / (_between(rng, 0.25, 0.6) * hole_area)), 4)
    return {"holes": holes, "hole_area": hole_area, "C_i": area / (holes * hole_area), "K_loss": loss * rho / flow**2,
            "flow": flow}  # fmt: skip


def _grain(rng: np.random.Generator, flow: float, p_c: float) -> dict[str, float]:
    """Port for a flux of 150 to 450 kg/(m^2 s), regression for an O/F of 4 to 9 and a speed of 0.8 to 3 mm/s."""
    density = _between(rng, 780.0, 930.0)
    ratio, n = _between(rng, 4.0, 9.0), _between(rng, 0.15, 0.6)
    port = sqrt(flow / (pi * _between(rng, 150.0, 450.0)))
    speed = _between(rng, 0.8e-3, 2.5e-3)
    length = flow / ratio / (density * 2.0 * pi * (port + 2.0 * speed) * speed)
    flux = flow / (pi * (port + 2.0 * speed) ** 2)
    throat = sqrt(flow * (1.0 + 1.0 / ratio) * SPEED / p_c / pi)
    return {"fuel_density": density, "a": speed / flux**n, "n": n, "grain_length": length, "port_radius": port,
            "throat_radius": throat, "exit_radius": throat * sqrt(_between(rng, 2.2, 4.2))}  # fmt: skip


def draw(rng: np.random.Generator, burns_out: bool = False, purge: bool | None = None) -> Stand:
    """A stand and a test that are plausible: liquid 3 to 8 s, then vapour, nitrogen at the line or none, 12 to 20 s."""
    while True:
        stand = _draw_once(rng, burns_out, purge)
        base = simulate(stand)
        if 3.0 <= base.t_v <= 8.0 and plausible(base, stand):
            return finish(rng, closed(rng, stand, base), base, burns_out)


def plausible(base: Histories, stand: Stand) -> bool:
    """A chamber well above ambient and well below p_run, empty long before LONGEST, and a tank that is so only late."""
    p_c = float(base.trace(s.P_CHAMBER)[1000])
    if base.trace(s.P_TANK)[int(SHORTEST / kernel.STEP)] < stand.ambient + RESIDUAL:
        return False
    return 6e5 < p_c < 0.75 * float(base.trace(s.P_RUN)[1000]) and _cold_from(base, stand) + 2.0 < LONGEST


def _cold_from(base: Histories, stand: Stand) -> float:
    """When the chamber has fallen to 1.6 times ambient [s]: about where its throat unchokes."""
    return float(base.time[np.flatnonzero(base.trace(s.P_CHAMBER) > 1.6 * stand.ambient)[-1]])


def closed(rng: np.random.Generator, stand: Stand, base: Histories) -> Stand:
    """With the valve closed when nothing is to be seen of it in the chamber any more, and the tank is not yet empty."""
    cold = _cold_from(base, stand)
    empty = base.time[np.flatnonzero(base.trace(s.P_TANK) > stand.ambient + RESIDUAL)[-1]]
    late = max(_between(rng, 12.0, 17.0), cold + _between(rng, 0.5, 1.5))
    return replace(stand, closing=round(max(min(late, float(empty)), cold + 0.3), 3))


def _draw_once(rng: np.random.Generator, burns_out: bool, purge: bool | None) -> Stand:
    tank = _tank(rng, _log_between(rng, 0.5, 1.8))
    p_c = _between(rng, 8e5, min(24e5, 0.55 * _pressure(tank["temperature"] - 10.0)))
    feed = _injector(rng, tank["mass"], tank["temperature"], p_c)
    grain = _grain(rng, feed.pop("flow"), p_c)
    with_purge = rng.uniform() < 0.9 if purge is None else purge
    room = pi * grain["port_radius"] ** 2 * grain["grain_length"]
    return Stand(
        **tank, **feed, **grain,  # type: ignore[arg-type]
        m=_between(rng, 1.02, 1.28), fuel_mass=20.0, pre_volume=room * _between(rng, 0.1, 0.4),
        post_volume=room * _between(rng, 0.4, 1.2), ambient=1e5 * round(_between(rng, 0.82, 1.02), 3),
        cracking=1e5 * round(_between(rng, 1.0, 5.0), 2), supply=1e5 if with_purge else None,
        closing=LONGEST, lead=round(_between(rng, 2.0, 6.0), 3),
        tail=round(_between(rng, 1.0, 3.0), 3),
    )  # fmt: skip


def finish(rng: np.random.Generator, stand: Stand, base: Histories, burns_out: bool) -> Stand:
    """Set what follows from the burn: the fuel that is loaded and the purge line's pressure."""
    fuel = base.trace(s.FUEL)
    burnt = float(fuel[: int(stand.closing / kernel.STEP)].sum()) * kernel.STEP
    if burns_out:
        # late in the liquid phase or early in the vapour phase, and well apart from the end of the liquid
        share = _between(rng, 0.7, 1.45)
        out = (share if share < 0.88 else share + 0.24) * base.t_v
        loaded = float(fuel[: int(out / kernel.STEP)].sum()) * kernel.STEP
    else:
        loaded = burnt * _between(rng, 1.08, 1.5)
    supply = stand.supply
    if supply is not None:
        share = _between(rng, 0.55, 0.95) if rng.uniform() < 0.9 else _between(rng, 1.02, 1.08)
        p_v = float(base.trace(s.P_TANK)[int(base.t_v / kernel.STEP)])
        supply = stand.cracking + share * p_v
    return replace(stand, fuel_mass=round(loaded, 3), supply=supply)


def other_load(rng: np.random.Generator, stand: Stand) -> Stand:
    """Another test on the same stand: another load, temperature and purge pressure; the hardware is the same."""
    rho = nitrous.saturated(nitrous.table(), nitrous.RHO_L, stand.temperature)
    fill = stand.mass / (stand.volume * float(rho))
    while True:
        temperature = stand.temperature + _between(rng, -7.0, 7.0)
        if not 277.0 <= temperature <= 301.0:
            continue
        rho_new = float(nitrous.saturated(nitrous.table(), nitrous.RHO_L, temperature))
        mass = min(max(fill * _between(rng, 0.75, 1.2), 0.42), 0.82) * stand.volume * rho_new
        supply = None if stand.supply is None else stand.supply * _pressure(temperature) / _pressure(stand.temperature)
        new = replace(stand, temperature=temperature, mass=mass, supply=supply, closing=LONGEST)
        base = simulate(new)
        if 2.5 <= base.t_v <= 9.0 and plausible(base, new):
            return replace(closed(rng, new, base), fuel_mass=round(stand.fuel_mass * _between(rng, 0.98, 1.04), 3))
