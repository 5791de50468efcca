"""Logs of whole engines with all the errors that a test engineer signs for, each drawn from what is stated of it.

As simulated/engine.py, of fuels that paraffin is known for, but: volume, holes, masses, throat and burn time are off as
test.toml states or as the documented defaults have it; C_i drifts along any course; the log may be reduced with another
table of nitrous oxide; gauges have errors of zero and span; the load cell one of gain, and a drift of any course; the
rocket differs from what is stated of it. No nitrogen enters.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi, sqrt
from pathlib import Path

import numpy as np
from simulated.engine import possible
from simulated.stand import AMBIENT, HOLE_AREA, PSI, Array, Truth, noise

from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.flight.ascent import ANGLE, CROSSWIND, DRAG, MASS, NOMINAL, PROPELLANT, WIND
from simulated import drifting_injector

DRIFT = 0.05
"""Standard deviation of the part by which C_i changes while the liquid lasts [-]."""
CELL_DRIFT = 0.02
"""Standard deviation of a load cell's drift over the burn, of the peak thrust [-]."""
ACCURACY = 2.0 * PSI
SPAN = sqrt(0.5)
CHANNELS = ("p_tank", "p_run", "p_chamber", "thrust", "m_tank")


@dataclass(frozen=True)
class Signed:
    """What is true of a log: [SI], times in s after the opening.

    ``curves`` by channel on ``time``, ``rest`` before it; ``flow`` [kg/s] of both propellants; ``row`` (9,): how the
    rocket's flight differs from what is stated, as NOMINAL of the flight.
    """

    stand: Truth
    engine: Engine
    C_i: float
    burn_time: float
    time: Array
    curves: dict[str, Array]
    rest: dict[str, float]
    flow: Array
    row: Array

    @property
    def total_impulse(self) -> float:
        """Of the true thrust to the fuel's end [N s]."""
        return self._until(self.curves["thrust"])

    @property
    def expended(self) -> float:
        """Propellant that has left by then [kg]."""
        return self._until(self.flow)

    def _until(self, values: Array) -> float:
        part = self.time <= self.burn_time
        return float(np.trapezoid(values[part], self.time[part]))

    def at(self, name: str, time: Array) -> Array:
        """A channel without any error at ``time`` (n,) [s after the opening]."""
        return np.where(time < 0.0, self.rest[name], np.interp(time, self.time, self.curves[name]))


def paraffin(generator: np.random.Generator, flux: float) -> tuple[float, float]:
    """About the published laws of paraffin: rate [m/s] at a ``flux`` [kg/m^2/s], and n [-]."""
    return 0.155e-3 * sqrt(flux) * generator.uniform(0.75, 1.4), generator.uniform(0.43, 0.77)


def make_log(folder: Path, seed: int) -> Signed:
    """Write ``folder``/log.csv and ``folder``/test.toml for a random engine and its errors; returns the truth."""
    generator = np.random.default_rng([20240611, seed])
    while True:
        stand, engine, done = possible(generator, paraffin, early=0.75)
        try:
            truth = _ran(stand, engine, done, generator)
            break
        except (ValueError, ArithmeticError):
            continue
    stated = _Stated(generator, truth)
    _write_log(folder / "log.csv", truth, stated, generator)
    (folder / "test.toml").write_text(stated.text(folder.name), encoding="utf-8")
    return replace(truth, row=stated.row)


def _ran(stand: Truth, engine: Engine, done: Burn, generator: np.random.Generator) -> Signed:
    """The engine once more, with an injector that drifts, to the end of the log."""
    wet = burn(engine, longest=40.0, run_on=True).liquid_out
    if wet is None:
        raise ValueError("the liquid does not run out")
    drift = drifting_injector.drawn(generator, DRIFT, wet)
    drifting = replace(engine, effects=(drift,))
    burnt = burn(drifting, longest=max(done.burn_time, wet) * 1.2 + 4.0, run_on=True)
    if burnt.liquid_out is None or not burnt.fuel_out:
        raise ValueError("the log does not hold both ends")
    time, flow = burnt.time, burnt.output("oxidizer_flow")
    factor = drifting_injector.factor(drift, time)
    liquid = time <= burnt.liquid_out
    mean = np.trapezoid(flow[liquid], time[liquid]) / np.trapezoid((flow / factor)[liquid], time[liquid])
    curves = {
        "p_tank": burnt.output("tank_pressure"),
        "p_run": burnt.output("run_pressure"),
        "p_chamber": burnt.output("chamber_pressure"),
        "thrust": burnt.output("thrust"),
        "m_tank": burnt.state("tank_mass"),
    }
    rest = {"p_tank": float(curves["p_tank"][0]), "p_run": AMBIENT, "p_chamber": AMBIENT, "thrust": 0.0,
            "m_tank": stand.mass}  # fmt: skip
    stand = replace(stand, t_v=burnt.liquid_out)
    both = flow + burnt.output("fuel_flow")
    return Signed(stand, engine, stand.C_i * float(mean), burnt.burn_time, time, curves, rest, both, NOMINAL.copy())


class _Stated:
    """What test.toml says, each value off by its deviation: stated, or the default of its kind."""

    def __init__(self, generator: np.random.Generator, truth: Signed) -> None:
        self._draw, self.truth = generator.standard_normal, truth
        self.states, self.seen = generator.random() < 0.5, generator.random() < 0.5
        self.properties = str(generator.choice(["coolprop", "report"]))
        self.in_place = generator.random() < 0.5
        engine, stand = truth.engine, truth.stand
        hole = 2.0 * sqrt(HOLE_AREA / pi)
        throat = sqrt(engine.throat_area / pi)
        self.volume = self._value(1e3 * stand.volume, 0.01 * 1e3 * stand.volume, "L")
        self.mass = self._value(stand.mass, 0.01 * stand.mass, "kg")
        self.hole = self._value(1e3 * hole, 0.05, "mm")
        self.grain = self._value(1e3 * engine.fuel_mass, 0.01 * 1e3 * engine.fuel_mass, "g")
        self.throat = self._value(1e3 * throat, 0.05, "mm")
        self.video = self._value(truth.burn_time, 0.25, "s")
        self.peak = float(truth.curves["thrust"].max())
        loaded = stand.mass + engine.fuel_mass
        self.dry = max(self.peak / (9.81 * 5.0) - loaded, 10.0)
        self.row = NOMINAL.copy()
        self.row[MASS] = 0.005 * self.dry * self._draw()
        self.row[PROPELLANT] = loaded / (self._number(self.mass) + 1e-3 * self._number(self.grain))
        self.row[DRAG] = 1.0 + 0.1 * self._draw()
        self.row[ANGLE] = abs(np.radians(5.0 + self._draw()))
        self.row[WIND], self.row[CROSSWIND] = 2.0 * self._draw(), 2.0 * self._draw()

    def _value(self, true: float, std: float, unit: str) -> str:
        """Stated with a deviation that is less than the default, or without, and then off by the default."""
        std = 0.4 * std if self.states else std
        spread = f" +/- {std:.6g}" if self.states else ""
        return f"{true + std * self._draw():.7g}{spread} {unit}"

    @staticmethod
    def _number(text: str) -> float:
        return float(text.split()[0])

    @property
    def cell_accuracy(self) -> float:
        """Standard deviation of the load cell's own error [N]: 0.25 % of its range as a limit."""
        return 0.0025 * 1.5 * self.peak / sqrt(3.0)

    @property
    def gain(self) -> float:
        """Standard deviation of the load cell's gain [-]."""
        return max(0.0025 if self.in_place else 0.01, SPAN * self.cell_accuracy / self.peak)

    def text(self, name: str) -> str:
        """test.toml."""
        e, stand = self.truth.engine, self.truth.stand
        zero = 'zero = "ambient"\n'
        pressures = "\n".join(
            f'[channels.{channel}]\ncolumn = "{channel}"\nunit = "Pa"\naccuracy = "2 psi"\n{more}'
            for channel, more in (("p_tank", ""), ("p_run", zero), ("p_chamber", zero))
        )
        seen = f'[observed]\nburn_time = "{self.video}"\n' if self.seen else ""
        return f"""schema = 1
[test]
id = "{name}"
kind = "hot_fire"
date = 2024-06-11
source = "synthetic"
[model]
properties = "{self.properties}"
[log]
files = ["log.csv"]
time = {{ column = "time", unit = "s" }}
{pressures}
[channels.thrust]
column = "thrust"
unit = "N"
tare = "auto"
accuracy = "0.25 % of {1.5 * self.peak:.3f} N, limit"
{"calibrated = 2024-05-02" if self.in_place else ""}
[channels.m_tank]
column = "m_tank"
unit = "kg"
[tank]
volume = "{self.volume}"
oxidizer_mass = "{self.mass}"
[injector]
holes = {stand.holes}
hole_diameter = "{self.hole}"
[nozzle]
throat_radius = "{self.throat}"
exit_radius = "{1e3 * sqrt(e.exit_area / pi):.5f} mm"
[grain]
mass = "{self.grain}"
length = "{1e3 * e.grain_length:.5f} mm"
density = "900 kg/m^3"
outer_radius = "{1e3 * e.outer_radius:.6f} mm"
[chamber]
pre_volume = "{0.3 * e.dead_volume * 1e3:.6f} L"
post_volume = "{0.7 * e.dead_volume * 1e3:.6f} L"
{seen}[site]
ambient_pressure = "{AMBIENT / 100:.2f} hPa"
[rocket]
dry_mass = "{self.dry:.4f} kg"
drag_coefficient = 0.5
diameter = "{157.0 * sqrt(self.peak / 3000.0):.3f} mm"
launch_angle = "5 deg"
rail_length = "6 m"
launch_altitude = "0 m"
"""


def _course(generator: np.random.Generator) -> Callable[[Array], Array]:
    """A course of a drift from 0 to 1 over the burn: a step, heat, or a straight line."""
    kind, at = generator.integers(3), generator.uniform()
    if kind == 0:
        return lambda part: (part > at).astype(np.float64)
    if kind == 1:
        within = 10.0 ** generator.uniform(-1.0, 0.5)
        return lambda part: -np.expm1(-part / within) / -np.expm1(-1.0 / within)
    return lambda part: part


def _write_log(path: Path, truth: Signed, stated: _Stated, generator: np.random.Generator) -> None:
    stand, draw = truth.stand, generator.standard_normal
    before = generator.uniform(2.5, 4.0)
    last = max(stand.t_v, truth.burn_time) + 6.0
    time = np.arange(-before, last, 1.0 / stand.rate)
    ringing = 1.0 + stand.oscillation * np.sin(2.0 * pi * np.cumsum(40.0 + 5.0 * draw(time.size)) / stand.rate)
    columns = [time + stand.t_open]
    for name in ("p_tank", "p_run", "p_chamber"):
        true, span = truth.at(name, time), SPAN * ACCURACY * draw() / float(truth.curves[name].max())
        true = AMBIENT + (true - AMBIENT) * ringing if name == "p_chamber" else true
        sensor = noise(generator, time.size, stand.rate, stand.white, stand.flicker)
        columns.append(true + SPAN * ACCURACY * draw() + span * (true - AMBIENT) + sensor)
    part = np.clip(time / truth.burn_time, 0.0, 1.0)
    drift = CELL_DRIFT * stated.peak * draw() * _course(generator)(part)
    force = truth.at("thrust", time) * ringing * (1.0 + stated.gain * draw())
    columns.append(force + drift + 30.0 * draw() + 0.002 * stated.peak * draw(time.size))
    columns.append(truth.at("m_tank", time) + (0.02 + 0.15 * (time > 0.0)) * draw(time.size))
    rows = (",".join(f"{x:.5f}" for x in row) for row in np.column_stack(columns))
    path.write_text("\n".join([",".join(["time", *CHANNELS]), *rows]) + "\n", encoding="utf-8")
