"""Logs of whole engines: the project's own unsteady model with random constants, and what a stand adds to it.

As simulated/stand.py, but the chamber pressure is that of a fire: the fuel regresses with a and n that are
drawn, and the log goes on after it is gone. No nitrogen enters the tank; the purge line follows it from t_purge on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi, sqrt
from pathlib import Path

import numpy as np
from simulated.stand import AMBIENT, PSI, Array, Truth, _definition, _save, draw_truth, noise

from hfanalysis.assembly.engine import combustion_of
from hfanalysis.engine.blowdown import TankRun, blow_down
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.thermo.combustion import FORMATION_OFFSET, equilibrium
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.saturation import Property

STEP = 2e-3
Law = Callable[[np.random.Generator, float], tuple[float, float]]
COLD = 620.0
"""[m/s]: chamber pressure times throat over flow, of oxidizer that no longer burns."""


@dataclass(frozen=True)
class EngineTruth:
    """What is in a log; the stand's own truth, the regression, and when the fuel was gone [s]."""

    stand: Truth
    engine: Engine
    burn_time: float

    @property
    def a(self) -> float:
        """[m/s (kg/m^2/s)^-n]."""
        return self.engine.a

    @property
    def n(self) -> float:
        """[-]."""
        return self.engine.n


def any_law(generator: np.random.Generator, flux: float) -> tuple[float, float]:
    """A rate [m/s] at a ``flux`` [kg/m^2/s], and n [-], of whatever fuel."""
    return generator.uniform(0.8e-3, 2.0e-3), generator.uniform(0.2, 0.75)


def draw_engine(generator: np.random.Generator, law: Law = any_law, early: float = 0.4) -> tuple[Truth, Engine, Burn]:
    """An engine at 12 to 28 bar that burns for 0.6 to 1.6 times as long as its liquid lasts.

    Within a tenth of that the two ends would fall together, which is a matter of finding the phases. ``law``: draws the
    fuel's rate and n; ``early``: how many of the engines run out of fuel before the liquid.
    """
    u = generator.uniform
    stand = draw_truth(generator)
    source = saturation("coolprop")
    stand = replace(stand, holes=max(stand.holes, 6))
    feed = FeedSystem(stand.volume, stand.area, stand.K_loss)
    pressure = u(12e5, 28e5)
    drop = float(source.pressure(stand.temperature)) - pressure
    density = float(source.liquid_density(stand.temperature))
    flow = sqrt(density * drop / (stand.K_loss + 0.5 / stand.area**2))
    flux, ratio = u(180.0, 500.0), u(4.0, 11.0)
    rate, n = law(generator, flux)
    port = sqrt(flow / (pi * flux))
    length = flow / ratio / (900.0 * 2.0 * pi * port * rate)
    enthalpy = FORMATION_OFFSET + float(source.energy(Property.LIQUID_ENTHALPY, stand.temperature)[0])
    gas = equilibrium(pressure, ratio, enthalpy)
    throat = flow * (1.0 + 1.0 / ratio) * gas.characteristic_velocity / pressure
    wide = 12.0 * port
    engine = Engine(
        saturation=source, combustion=combustion_of(), feed=feed, oxidizer_mass=stand.mass,
        temperature=stand.temperature, polytropic_exponent=stand.m,
        fuel_mass=900.0 * pi * (wide**2 - port**2) * length, grain_length=length, outer_radius=wide,
        fuel_density=900.0, a=rate / flux**n, n=n, dead_volume=u(0.5e-3, 2e-3), throat_area=throat,
        exit_area=throat * u(2.0, 5.0), ambient_pressure=AMBIENT, oxidizer_enthalpy=enthalpy,
    )  # fmt: skip
    return stand, *_with_web(engine, u(0.6, 0.9) if u() < early else u(1.1, 1.6))


def _with_web(engine: Engine, part: float) -> tuple[Engine, Burn]:
    """The grain cut so that it is gone after ``part`` of the liquid's time."""
    endless = burn(engine, longest=40.0)
    if endless.liquid_out is None:
        raise ValueError("the liquid does not run out")
    outer = float(np.interp(part * endless.liquid_out, endless.time, endless.state("port_radius")))
    fuel = 900.0 * pi * (outer**2 - engine.port_radius**2) * engine.grain_length
    cut = replace(engine, outer_radius=outer, fuel_mass=fuel)
    done = burn(cut)
    if not done.fuel_out:
        raise ValueError("the fuel does not burn out")
    return cut, done


def possible(generator: np.random.Generator, law: Law = any_law, early: float = 0.4) -> tuple[Truth, Engine, Burn]:
    """The first engine drawn that runs."""
    while True:
        try:
            return draw_engine(generator, law, early)
        except (ValueError, ArithmeticError):
            continue


def made(seed: int) -> tuple[Truth, Engine, Burn, Histories]:
    """A random engine on its stand and what really happens, before any sensor."""
    generator = np.random.default_rng([20220305, seed])
    stand, engine, done = possible(generator)
    stand, tank, chamber = _ran(stand, engine, done, generator)
    return stand, engine, done, histories(stand, engine, done, tank, chamber)


def _ran(stand: Truth, engine: Engine, done: Burn, generator: np.random.Generator) -> tuple[Truth, TankRun, Array]:
    """The tank's run and the chamber pressure, and the stand with its phase times."""
    tank, chamber = _tank(engine, done, np.arange(0.0, 30.0, STEP))
    t_purge = tank.t_v + generator.uniform(0.25, 1.0)
    at_purge = float(np.interp(t_purge, tank.time, tank.pressure))
    return replace(stand, t_v=tank.t_v, t_purge=t_purge, purge_pressure=at_purge + stand.cracking), tank, chamber


def make_log(folder: Path, seed: int) -> EngineTruth:
    """Write ``folder``/log.csv and ``folder``/test.toml for a random engine; returns the truth."""
    generator = np.random.default_rng([20220305, seed])
    stand, engine, done = possible(generator)
    stand, tank, chamber = _ran(stand, engine, done, generator)
    _write_log(folder / "log.csv", stand, engine, done, tank, chamber, generator)
    (folder / "test.toml").write_text(_stated(folder.name, stand, engine, done, generator), encoding="utf-8")
    return EngineTruth(stand, engine, done.burn_time)


def _tank(engine: Engine, done: Burn, time: Array) -> tuple[TankRun, Array]:
    """Tank and chamber pressure over the whole log: fire first, cold flow after it."""
    fire = np.interp(time, done.time, done.output("chamber_pressure"))
    gone = time > done.burn_time
    cold = np.full(time.size, AMBIENT)
    for _ in range(6):
        chamber = np.where(gone, cold + (fire - cold) * np.exp(-np.maximum(time - done.burn_time, 0.0) / 0.02), fire)
        tank = blow_down(
            engine.saturation, engine.feed, engine.oxidizer_mass, engine.temperature, time, chamber,
            engine.polytropic_exponent or 1.0,
        )  # fmt: skip
        cold = AMBIENT + np.maximum(tank.flow * COLD / engine.throat_area - 0.3 * AMBIENT, 0.0)
    return tank, chamber


@dataclass(frozen=True)
class Histories:
    """What really happens [SI], channel by channel: at rest, and on ``time`` [s] after the opening."""

    time: Array
    rest: dict[str, float]
    curves: dict[str, Array]


def histories(stand: Truth, engine: Engine, done: Burn, tank: TankRun, chamber: Array) -> Histories:
    """The channels before a sensor sees them."""
    time = tank.time
    density = np.where(
        time < stand.t_v, engine.saturation.liquid_density(np.minimum(tank.temperature, engine.temperature)),
        tank.mass / stand.volume,
    )  # fmt: skip
    at_purge = np.interp(stand.t_purge, time, tank.pressure)
    curves = {
        "p_tank": tank.pressure,
        "p_run": chamber + 0.5 * tank.flow**2 / (density * stand.area**2),
        "p_chamber": chamber,
        "p_purge": stand.purge_pressure - np.where(time > stand.t_purge, at_purge - tank.pressure, 0.0),
        "thrust": np.interp(time, done.time, done.output("thrust"), right=0.0),
        "m_tank": tank.mass,
    }
    rest = {"p_run": AMBIENT, "p_chamber": AMBIENT, "thrust": 0.0, "m_tank": stand.mass}
    return Histories(time, {name: rest.get(name, float(curve[0])) for name, curve in curves.items()}, curves)


def _write_log(
    path: Path, stand: Truth, engine: Engine, done: Burn, tank: TankRun, chamber: Array, generator: np.random.Generator
) -> None:
    before = generator.uniform(1.5, 4.0)
    last = max(stand.t_purge, done.burn_time) + 3.0
    time = np.arange(stand.t_open - before, stand.t_open + last, 1.0 / stand.rate)
    after, true = time - stand.t_open, histories(stand, engine, done, tank, chamber)
    p_t, p_r, p_c, purge, force, mass = (
        np.where(after < 0.0, true.rest[name], np.interp(after, true.time, curve))
        for name, curve in true.curves.items()
    )
    frequency = generator.uniform(20.0, 80.0) + 5.0 * generator.standard_normal(time.size)
    ringing = stand.oscillation * np.sin(2.0 * pi * np.cumsum(frequency) / stand.rate)
    p_c, force = p_c + ringing * (p_c - AMBIENT), force * (1.0 + ringing)
    columns = [time]
    for value, bias in zip((p_t, p_r, p_c, purge), 2.0 * PSI * generator.standard_normal(4), strict=True):
        columns.append((value + bias + noise(generator, time.size, stand.rate, stand.white, stand.flicker)) / PSI)
    shaking = 0.02 + 0.15 * (after > 0.0)
    columns += [
        force + 5.0 * generator.standard_normal(time.size),
        mass + shaking * generator.standard_normal(time.size),
    ]
    _save(path, columns, generator)


def _stated(name: str, stand: Truth, engine: Engine, done: Burn, generator: np.random.Generator) -> str:
    """What the engineer knows: masses and sizes with their errors; in two of three tests the burn time from a video."""
    draw = generator.standard_normal
    grain_std, throat = 0.003 * engine.fuel_mass, sqrt(engine.throat_area / pi)
    grain = engine.fuel_mass + grain_std * draw()
    measured_throat = throat * (1.0 + 0.002 * draw())
    nozzle = f"""[nozzle]
throat_radius = "{1e3 * measured_throat:.5f} +/- {2.0 * throat:.5f} mm"
exit_radius = "{1e3 * sqrt(engine.exit_area / pi):.5f} mm"
[grain]
mass = "{1e3 * grain:.4f} +/- {1e3 * grain_std:.4f} g"
length = "{1e3 * engine.grain_length:.5f} mm"
density = "900 kg/m^3"
outer_radius = "{1e3 * engine.outer_radius:.6f} mm"
[chamber]
pre_volume = "{0.3 * engine.dead_volume * 1e3:.6f} L"
post_volume = "{0.7 * engine.dead_volume * 1e3:.6f} L"
"""
    seen = done.burn_time + 0.1 * draw()
    if generator.random() < 2.0 / 3.0:
        nozzle += f'[observed]\nburn_time = "{seen:.4f} +/- 0.1 s"\n'
    tank = _definition(name, stand, generator)
    start, end = tank.index("[nozzle]"), tank.index("[site]")
    return tank[:start] + nozzle + tank[end:]
