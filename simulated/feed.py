"""A tank that empties through an injector by the laws that gases and flashing liquids have, as a log with its truth.

Nothing here is the engine's: the liquid flows as the ``liquid`` law says of the mixture that reaches the injector, the
vapor as a perfect gas that chokes, C_d A p_run sqrt(k/(Z R T)) f(p_c/p_run), from p_run as its stagnation pressure
(Sutton and Biblarz, Rocket Propulsion Elements, chapter 3); both behind a line that loses K_loss mdot^2 / rho.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hfanalysis.engine.tank import along_blowdown
from hfanalysis.products.segments import EVENTS, Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import FileSpec, LogSpec, Test, TestDefinition
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.sections import Injector, Model, Purge, Site, Tank
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.saturation import Saturation
from hfanalysis.thermo.two_phase import equilibrium_flux, incompressible_flux, throttled
from hfanalysis.units import Value

Array = NDArray[np.float64]

HOLES, HOLE_AREA, AMBIENT, OPENING = 22, 3.142e-6, 101_325.0, 20.0
RATE = 200.0
GAMMA = 1.2


@dataclass(frozen=True)
class Feed:
    """What is true [SI]: C_d of the liquid by its law, m of the vapor and its C_d where it chokes; tank and line."""

    name: str
    liquid: str
    C_d: float
    m: float
    vapor_C_d: float
    volume: float = 16.5e-3
    mass: float = 9.0
    temperature: float = 296.0
    K_loss: float = 5e8
    chamber: float = 12e5
    vapor_time: float = 0.8
    accuracy: float = 1.5e4

    @property
    def area(self) -> float:
        """Of all holes [m^2]."""
        return HOLES * HOLE_AREA


CASES = (
    Feed("flashing liquid, vapor of C_i", "hem", 0.80, 1.15, 0.265),
    Feed("flashing liquid, vapor of its own C_d", "hem", 0.92, 1.05, 0.42),
    Feed("half-way (Dyer)", "dyer", 0.60, 1.15, 0.30),
    Feed("incompressible mixture", "spi", 0.45, 1.25, 0.35, K_loss=3e8),
    Feed("hot tank, lossy line", "hem", 0.85, 1.10, 0.33, temperature=301.0, K_loss=8e8, mass=8.5),
)
"""Injectors that flash and choke."""


@dataclass(frozen=True)
class Emptied:
    """Histories [SI] by channel over ``time`` [s after the opening], and its instants [s]."""

    time: Array
    values: dict[str, Array]
    t_v: float
    t_purge: float


def emptied(feed: Feed, step: float = 1.0 / RATE) -> Emptied:
    """Empty it, liquid and then vapor."""
    fluid = saturation("coolprop")
    time, pressure, run = _liquid(feed, fluid, step)
    t_v = float(time[-1])
    after, p_vapor, run_vapor, p_c = _vapor(feed, fluid, float(pressure[-1]), step)
    whole = np.concatenate([time, t_v + after])
    columns = {
        "p_tank": np.concatenate([pressure, p_vapor]),
        "p_run": np.concatenate([run, run_vapor]),
        "p_chamber": np.concatenate([np.full(time.size, feed.chamber), p_c]),
    }
    grid = np.arange(0.0, whole[-1], step)
    values = {n: np.interp(grid, whole, x) for n, x in columns.items()}
    return Emptied(grid, values, t_v, t_v + feed.vapor_time)


def flux(law: str, fluid: Saturation, warm: Array, run: Array, chamber: Array) -> Array:
    """Of a law for what reaches the injector [kg/(m^2 s)], (n,)."""
    inlet = throttled(fluid, warm, run)
    plain, flashing = incompressible_flux(inlet.density, run, chamber), equilibrium_flux(fluid, inlet, chamber)
    return {"spi": plain, "hem": flashing, "dyer": 0.5 * (plain + flashing)}[law]


def _liquid(feed: Feed, fluid: Saturation, step: float) -> tuple[Array, Array, Array]:
    """Time, p_tank and p_run until the liquid is gone; the flow follows from the tank's temperature alone."""
    warm = np.linspace(feed.temperature - 40.0, feed.temperature, 60)
    tank, density = fluid.pressure(warm), fluid.liquid_density(warm)
    low, high = np.full(warm.size, feed.chamber), tank.copy()
    for _ in range(40):
        run = 0.5 * (low + high)
        flow = feed.C_d * feed.area * flux(feed.liquid, fluid, warm, run, np.full(warm.size, feed.chamber))
        above = tank - feed.K_loss * flow**2 / density > run
        low, high = np.where(above, run, low), np.where(above, high, run)
    mass, temperature, time, rows = feed.mass, feed.temperature, 0.0, []
    while True:
        rows.append((time, float(fluid.pressure(temperature)), float(np.interp(temperature, warm, run))))
        mdot = float(np.interp(temperature, warm, flow))
        slope = along_blowdown(fluid.kernel_table, feed.volume, mass, temperature)
        middle = temperature - 0.5 * step * mdot / slope
        mdot = float(np.interp(middle, warm, flow))
        slope = along_blowdown(fluid.kernel_table, feed.volume, mass - 0.5 * step * mdot, middle)
        after, cooler = mass - step * mdot, temperature - step * mdot / slope
        vapor = feed.volume * float(fluid.vapor_density(cooler))
        if after <= vapor:
            share = (mass - feed.volume * float(fluid.vapor_density(temperature))) / (mass - after)
            end = temperature + share * (cooler - temperature)
            rows.append((time + share * step, float(fluid.pressure(end)), float(np.interp(end, warm, run))))
            break
        mass, temperature, time = after, cooler, time + step
    found = np.array(rows).T
    return found[0], found[1], found[2]


def _vapor(feed: Feed, fluid: Saturation, start: float, step: float) -> tuple[Array, Array, Array, Array]:
    """Time since t_v, p_tank, p_run and p_c until nitrogen would enter, and a second of what follows."""
    mass = first = feed.volume * float(fluid.vapor_density(fluid.temperature(start)))
    rows, fine = [], 0.2 * step
    for time in np.arange(fine, feed.vapor_time + 1.0, fine):
        p_c = AMBIENT + (feed.chamber - AMBIENT) * (0.3 + 0.7 * np.exp(-time / 0.02)) * np.exp(-time / 0.9)
        p, density = start * (mass / first) ** feed.m, mass / feed.volume
        run, flow = _choked(feed, p, density, p_c)
        mass -= fine * flow
        rows.append((time, p, run, p_c))
    time, p, run, p_c = np.array(rows).T
    fed = np.maximum(time - feed.vapor_time, 0.0)
    held = np.where(fed > 0.0, np.interp(feed.vapor_time, time, p) * np.exp(-fed / 6.0), p)
    return time, held, np.minimum(run, held), p_c


def _choked(feed: Feed, tank: float, density: float, chamber: float) -> tuple[float, float]:
    """p_run [Pa] and the flow [kg/s] of a perfect gas; what it loses in the line does not change its temperature."""
    low, high, flow = chamber, tank, 0.0
    k = GAMMA
    for _ in range(25):
        run = 0.5 * (low + high)
        ratio = max(chamber / run, (2.0 / (k + 1.0)) ** (k / (k - 1.0)))
        expansion = np.sqrt(2.0 / (k - 1.0) * (ratio ** (2.0 / k) - ratio ** ((k + 1.0) / k)))
        flow = feed.vapor_C_d * feed.area * run * np.sqrt(k * density / tank) * expansion
        if tank - feed.K_loss * flow**2 / density > run:
            low = run
        else:
            high = run
    return run, float(flow)


def log_of(feed: Feed, true: Emptied, seed: int = 0) -> TestLog:
    """What sensors of its accuracy, which are off by that much, have logged of it: noise of a tenth of it."""
    generator = np.random.default_rng(seed)
    quiet = np.arange(-3.0, -0.5 / RATE, 1.0 / RATE)
    rest = {"p_tank": true.values["p_tank"][0], "p_run": AMBIENT, "p_chamber": AMBIENT}
    channels = {}
    for name, value in true.values.items():
        whole = np.concatenate([np.full(quiet.size, rest[name]), value])
        bias = feed.accuracy * generator.standard_normal()
        seen = whole + bias + 0.1 * feed.accuracy * generator.standard_normal(whole.size)
        time = np.concatenate([quiet, true.time]) + OPENING
        flags = np.zeros(time.size, dtype=np.uint8)
        channels[name] = Channel(name, "Pa", time, seen, flags, feed.accuracy, True, name)
    return TestLog(channels)


def segments_of(true: Emptied) -> Segments:
    """Its phases, known to milliseconds."""
    absent = {n: Quantity.absent("this test does not have it") for n in EVENTS if n != "t_fuel_gone"}
    known = {"t_v": Quantity(true.t_v, "s", 1e-3), "t_purge": Quantity(true.t_purge, "s", 1e-3)}
    return Segments.of(Quantity(OPENING, "s", 1e-6), absent | known, kind="cold_flow")


def definition_of(feed: Feed, properties: str = "coolprop", area: float | None = 0.0) -> TestDefinition:
    """What an engineer states of it, weighed and drilled as ``area`` [relative] says: None, the default."""
    one = Value(HOLE_AREA, None if area is None else area * HOLE_AREA)
    sections = {
        "model": Model("corrected", properties),  # type: ignore[arg-type]
        "tank": Tank(Value(feed.volume, 0.002 * feed.volume), Value(feed.mass, 0.02)),
        "injector": Injector(HOLES, one),
        "purge": Purge(Value(4.2e5)),
        "site": Site(ambient_pressure=Value(AMBIENT, 0.0)),
    }
    log, path = LogSpec((FileSpec("log.csv"),)), Path("T/test.toml")
    return TestDefinition(Test("T", "cold_flow"), log, {}, **sections, path=path, sha256="0" * 64)  # type: ignore[arg-type]
