"""A test stand on paper: a known tank emptied by the engine's own model, with what its sensors would say.

The chamber pressure is given, not computed, so that every event has an instant that is known exactly.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from simulated.stand import noise

from hfanalysis.arrays import Array
from hfanalysis.engine.blowdown import blow_down
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.products.segments import EVENTS, Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.default_deviations import Deviation, Deviations
from hfanalysis.record.definition import FileSpec, LogSpec, Test, TestDefinition
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.sections import Injector, Model, NozzleSection, Purge, Site, Tank
from hfanalysis.record.signals import Signal, sample_noise
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.units import Value

AMBIENT = 101_325.0
HOLES, HOLE_AREA = 22, 3.142e-6
THROAT = 23.3e-3
EXACT = Deviations(line_volume=Deviation(), properties=Deviation())
"""No line beside the tank, and its table of nitrous oxide."""
UNITS = {"thrust": "N", "m_tank": "kg", "valve": ""}


@dataclass(frozen=True)
class Stand:
    """What is true of a test [SI]; ``t_fuel_out`` [s], where the fuel goes before the liquid."""

    C_i: float = 0.35
    m: float = 1.1
    K_loss: float = 2.0e8
    volume: float = 16.5e-3
    mass: float = 10.0
    temperature: float = 293.15
    vapor_time: float = 0.6
    chamber: float = 14e5
    t_fuel_out: float | None = None
    source: str = "coolprop"

    @property
    def area(self) -> float:
        """Effective injector area [m^2]."""
        return self.C_i * HOLES * HOLE_AREA


@dataclass(frozen=True)
class Trial:
    """Histories by channel over ``time`` [s after the opening], and what is true of them: instants, p at t_v.

    ``flow`` [kg/s] and tank ``mass`` [kg] count from the opening.
    """

    stand: Stand
    time: Array
    values: dict[str, Array]
    t_v: float
    t_purge: float
    p_v: float
    flow: Array = field(repr=False)
    mass: Array = field(repr=False)


def fire(stand: Stand | None = None, rate: float = 1000.0, before: float = 3.0, after: float = 3.0) -> Trial:
    """A test of this stand, without noise: quiet for ``before`` seconds and logged ``after`` seconds past t_purge."""
    s = stand or Stand()
    feed = FeedSystem(s.volume, s.area, s.K_loss)
    nitrous = saturation(s.source)
    t = np.arange(0.0, 25.0, 1.0 / rate)
    first = blow_down(nitrous, feed, s.mass, s.temperature, t, _chamber(s, t, np.inf), s.m)
    p_c = _chamber(s, t, first.t_v)
    run = blow_down(nitrous, feed, s.mass, s.temperature, t, p_c, s.m)
    t_purge = run.t_v + s.vapor_time
    keep = t < t_purge + after
    t, p_c, tank, flow, mass = (x[keep] for x in (t, p_c, run.pressure, run.flow, run.mass))
    density = np.where(t < run.t_v, nitrous.liquid_density(run.temperature[keep]), mass / s.volume)
    line = tank - s.K_loss * flow**2 / density
    at_purge = float(np.interp(t_purge, t, tank))
    fed = np.maximum(t - t_purge, 0.0)
    tank = np.where(fed > 0.0, at_purge * np.exp(-fed / 6.0), tank)
    line = np.where(fed > 0.0, np.minimum(line, tank), line)
    purge = (at_purge + 4.2e5) * (1.0 - 0.25 * (1.0 - np.exp(-fed / 1.5)))
    quiet = np.arange(-before, -0.5 / rate, 1.0 / rate)
    to_dry = np.append(t[t < run.t_v], run.t_v)
    p_v = float(blow_down(nitrous, feed, s.mass, s.temperature, to_dry, np.interp(to_dry, t, p_c), s.m).pressure[-1])
    rest = {"p_tank": run.pressure[0], "p_run": AMBIENT, "p_chamber": AMBIENT, "p_purge": purge[0], "thrust": 0.0}
    found = {"p_tank": tank, "p_run": line, "p_chamber": p_c, "p_purge": purge}
    found["thrust"] = 1.4 * np.pi * THROAT**2 * (p_c - AMBIENT)
    values = {n: np.concatenate((np.full(quiet.size, rest[n]), x)) for n, x in found.items()}
    return Trial(s, np.concatenate((quiet, t)), values, run.t_v, t_purge, p_v, flow, mass)


def _chamber(s: Stand, t: Array, t_v: float) -> Array:
    """Fire up within 50 ms, a slow decline, a fall where the fuel goes, another where the liquid goes."""
    excess = s.chamber * (1.0 - np.exp(-t / 0.05)) * (1.0 - 0.03 * t)
    if s.t_fuel_out is not None:
        excess *= 1.0 - 0.6 * (1.0 - np.exp(-np.maximum(t - s.t_fuel_out, 0.0) / 0.005))
    gone = np.maximum(t - t_v, 0.0)
    share = 0.35 + 0.65 * np.exp(-gone / 0.004)
    return np.asarray(AMBIENT + excess * share * np.exp(-gone / 0.9))


def log_of(
    test: Trial,
    t_open: float = 100.0,
    white: float = 0.0,
    flicker: float = 0.0,
    seed: int = 0,
    without: tuple[str, ...] = (),
    accuracy: float = 1e4,
    more: Mapping[str, tuple[Array, Array]] | None = None,
) -> TestLog:
    """The log of a test with its opening at ``t_open``; noise [Pa] on the pressures, the like on the thrust."""
    generator = np.random.default_rng(seed)
    rate = 1.0 / float(np.median(np.diff(test.time)))
    columns = {}
    for name, value in test.values.items():
        if name not in without:
            scale = 2e-3 if name == "thrust" else 1.0
            columns[name] = (test.time, value + scale * noise(generator, value.size, rate, white, scale**2 * flicker))
    columns.update(more or {})
    return TestLog({n: channel(n, time + t_open, value, accuracy) for n, (time, value) in columns.items()})


def channel(name: str, time: Array, value: Array, accuracy: float = 1e4) -> Channel:
    """A channel without a flag."""
    flags = np.zeros(time.size, dtype=np.uint8)
    return Channel(name, UNITS.get(name, "Pa"), time, value, flags, accuracy, True, name)


def signal(name: str, time: Array, value: Array) -> Signal:
    """A signal as the searches see it."""
    return Signal(name, time, value, sample_noise(value), float(np.median(np.diff(time))))


def definition(stand: Stand | None = None, **change: Any) -> TestDefinition:
    """What an engineer states of a test, all of it exact; ``kind``, ``mass``, ``volume`` and sections may be given."""
    s = stand or Stand()
    kind, conventions = change.pop("kind", "hot_fire"), change.pop("conventions", "corrected")
    volume, mass = change.pop("volume", Value(s.volume, 0.0)), change.pop("mass", Value(s.mass, 0.02))
    sections = {
        "model": Model(conventions, s.source),
        "tank": Tank(volume, mass),
        "injector": Injector(HOLES, Value(HOLE_AREA, 0.0)),
        "deviations": EXACT,
        "purge": Purge(Value(4.2e5)),
        "nozzle": NozzleSection(Value(THROAT), Value(38.1e-3)),
        "site": Site(ambient_pressure=Value(AMBIENT, 0.0)),
    }
    sections.update(change)
    log, path = LogSpec((FileSpec("log.csv"),)), Path("T/test.toml")  # neither is read from disk
    return TestDefinition(Test("T", kind), log, {}, **sections, path=path, sha256="0" * 64)


def segments_of(test: Trial, t_open: float = 100.0, std: float = 1e-4, **change: Quantity) -> Segments:
    """The true phases of a test; single events may be given otherwise."""
    absent = {n: Quantity.absent("this test does not have it") for n in EVENTS if n != "t_fuel_gone"}  # as t_fuel_out
    known = {"t_v": Quantity(test.t_v, "s", std), "t_purge": Quantity(test.t_purge, "s", std)}
    return Segments.of(Quantity(t_open, "s", 1e-6), absent | known | change, kind="hot_fire")
