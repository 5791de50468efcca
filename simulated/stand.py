"""Logs from the project's own tank model, with what a stand adds: noise, biases, line filling, purge, lost samples.

The truth is drawn at random, the log is written as a logger would, and ``test.toml`` states what an engineer would
know. What the calibration then finds can be compared with the truth (benchmarks/recovery.py, tests/acceptance).
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hfanalysis.engine.injector import mass_flow_with_feed
from hfanalysis.engine.tank import energy_derivatives, liquid_mass, temperature_rate
from hfanalysis.thermo.nitrous import saturation
from hfanalysis.thermo.saturation import LIQUID_VOLUME, LN_PRESSURE, evaluate

Array = NDArray[np.float64]

PSI = 6894.757293168361
AMBIENT = 101_325.0
FULL_SCALE = 1000.0
HOLE_AREA = 3.142e-6


@dataclass(frozen=True)
class Truth:
    """What is in a log: SI units; times in seconds after the opening."""

    C_i: float
    m: float
    K_loss: float
    volume: float
    mass: float
    temperature: float
    holes: int
    chamber_slope: float
    fill_time: float
    purge_pressure: float
    cracking: float
    rate: float
    white: float
    flicker: float
    oscillation: float
    t_open: float
    t_v: float = 0.0
    t_purge: float = 0.0

    @property
    def area(self) -> float:
        """Effective injector area [m^2]."""
        return self.C_i * self.holes * HOLE_AREA


@dataclass(frozen=True)
class Sensors:
    """What a logger makes of a test: white ``noise`` over the usual [-], samples a second where they are not drawn, and
    the ``bits`` of its converter over FULL_SCALE [psi]; 0: as fine as it is printed."""

    noise: float = 1.0
    rate: float | None = None
    bits: int = 0

    def converted(self, pressure: Array) -> Array:
        """Pressures [psi] in the converter's steps."""
        step = FULL_SCALE / 2**self.bits
        return np.round(pressure / step) * step if self.bits else pressure


def draw_truth(generator: np.random.Generator) -> Truth:
    """A random stand: tanks of 8 to 25 L, 40 to 62 bar, injectors from poor to good, logs of 200 Hz to 1 kHz."""
    u = generator.uniform
    source = saturation("coolprop")
    volume = u(8e-3, 25e-3)
    temperature = float(source.temperature(u(42e5, 62e5)))
    liquid = u(0.55, 0.85)
    mass = volume * (liquid * source.liquid_density(temperature) + (1 - liquid) * source.vapor_density(temperature))
    C_i = u(0.2, 0.7)
    holes = int(np.clip(round(u(0.55, 1.1) * volume * 1e3 * 1.3 * 0.3 / C_i), 6, 60))
    area = C_i * holes * HOLE_AREA
    return Truth(
        C_i=C_i,
        m=u(1.0, 1.25),
        K_loss=u(0.05, 0.5) * 0.5 / area**2,
        volume=volume,
        mass=float(mass),
        temperature=temperature,
        holes=holes,
        chamber_slope=u(4e5, 12e5),
        fill_time=u(0.03, 0.3),
        purge_pressure=0.0,
        cracking=4.2e5,
        rate=float(generator.choice([200.0, 500.0, 1000.0])),
        white=u(0.8, 2.5) * PSI,
        flicker=u(0.0, 0.1) * PSI**2,
        oscillation=u(0.0, 0.03),
        t_open=u(-0.5, 0.5),
    )


@njit(cache=True)
def _burn(
    table: tuple[Array, float, float, float],
    volume: float,
    area: float,
    loss: float,
    m: float,
    slope: Array,
    full: Array,
    flush: float,
    mass: float,
    t_k: float,
    step: float,
    purge: tuple[float, float, float],
) -> tuple[Array, float, float, float]:
    """Pressures of tank, line and chamber, tank mass and flow every step; t_v; t_purge; tank pressure at t_purge.

    ``slope`` [Pa s/kg] and how ``full`` the line is [-] every step; ``flush`` [s] of the chamber. ``purge``: seconds of
    vapor before it, or, where that is NaN, the instant [s]; and the time constant [s] of its supply.
    """
    out = np.empty((5, slope.size))
    p_c = 101_325.0
    vapor_time, t_purge, fades = purge
    t_v = np.nan
    p_v = m_v = p_purge = 0.0
    nitrogen = 0.0
    for i in range(slope.size):
        t = i * step
        liquid = np.isnan(t_v)
        if liquid:
            p = np.exp(evaluate(*table, LN_PRESSURE, t_k)[0]) + nitrogen
            density = 1.0 / evaluate(*table, LIQUID_VOLUME, t_k)[0]
        else:
            p = p_v * (mass / m_v) ** m + nitrogen
            density = mass / volume
        steady = mass_flow_with_feed(area, loss, density, p - p_c)
        flow = np.sqrt(full[i]) * steady
        p_run = p_c + full[i] * steady**2 / (2.0 * density * area**2)
        out[0, i], out[1, i], out[2, i], out[3, i], out[4, i] = p, p_run, p_c, mass, flow
        if liquid:
            rate = temperature_rate(*energy_derivatives(table, volume, mass, t_k), flow, 0.0)
            before = liquid_mass(table, volume, mass, t_k)
            t_k += step * rate
            mass -= step * flow
            after = liquid_mass(table, volume, mass, t_k)
            if after <= 0.0:
                t_v = t + step * before / (before - after)
                p_v, m_v = np.exp(evaluate(*table, LN_PRESSURE, t_k)[0]), mass
                if np.isnan(t_purge):
                    t_purge = t_v + vapor_time
        else:
            mass = max(mass - step * flow, 1e-3 * m_v)
        if t >= t_purge:
            if p_purge == 0.0:
                p_purge = p
            nitrogen += step * 0.6 * max(p_purge * np.exp(-(t - t_purge) / fades) - p, 0.0)
        p_c += (1.0 - np.exp(-step / flush)) * (101_325.0 + slope[i] * flow - p_c)
    return out, t_v, t_purge, p_purge


def make_log(folder: Path, seed: int, sensors: Sensors = Sensors()) -> Truth:
    """Write ``folder``/log.csv and ``folder``/test.toml for a random truth; returns the truth with its phase times."""
    generator = np.random.default_rng([20220403, seed])
    truth = draw_truth(generator)
    truth = replace(truth, white=truth.white * sensors.noise, rate=sensors.rate or truth.rate)
    step = 1e-4
    vapor_time = generator.uniform(0.25, 1.0)
    time = step * np.arange(int(30.0 / step))
    out, t_v, t_purge, p_purge = empties(
        truth, np.full(time.size, truth.chamber_slope), 1.0 - np.exp(-time / truth.fill_time), step,
        (vapor_time, np.nan, np.inf),
    )  # fmt: skip
    if not t_purge < 26.0:
        raise ValueError(f"seed {seed}: the tank does not empty within the log")
    truth = Truth(**{**asdict(truth), "t_v": t_v, "t_purge": t_purge, "purge_pressure": p_purge + truth.cracking})
    _write_log(folder / "log.csv", truth, out, step, generator, sensors)
    (folder / "test.toml").write_text(_definition(folder.name, truth, generator), encoding="utf-8")
    return truth


def empties(
    truth: Truth, slope: Array, full: Array, step: float, purge: tuple[float, float, float], flush: float = 0.003
) -> tuple[Array, float, float, float]:
    """The stand's tank emptied, as :func:`_burn` does it."""
    table = saturation("coolprop").kernel_table
    return _burn(
        table, truth.volume, truth.area, truth.K_loss, truth.m, slope, full, flush, truth.mass, truth.temperature,
        step, purge,
    )  # fmt: skip


def noise(generator: np.random.Generator, count: int, rate: float, white: float, flicker: float) -> Array:
    """White noise and 1/f noise with the one-sided spectrum flicker / f."""
    padded = 4 * count
    frequency = np.fft.rfftfreq(padded, 1.0 / rate)
    density = np.zeros(frequency.size)
    density[1:] = flicker / frequency[1:]
    amplitude = np.sqrt(density * padded * rate / 4.0)
    spectrum = amplitude * (generator.standard_normal(frequency.size) + 1j * generator.standard_normal(frequency.size))
    return np.fft.irfft(spectrum, padded)[:count] + white * generator.standard_normal(count)


def _write_log(
    path: Path, truth: Truth, out: Array, step: float, generator: np.random.Generator, sensors: Sensors
) -> None:
    before = generator.uniform(1.5, 4.0)
    time = np.arange(truth.t_open - before, truth.t_open + truth.t_purge + 3.0, 1.0 / truth.rate)
    after = time - truth.t_open
    grid = step * np.arange(out.shape[1])
    rest = (out[0, 0], AMBIENT, AMBIENT, truth.mass)
    tank, run, chamber, mass = (np.where(after < 0.0, r, np.interp(after, grid, out[k])) for k, r in enumerate(rest))
    sag = 0.25 * (1.0 - np.exp(-np.maximum(after - truth.t_purge, 0.0) / 1.5))
    purge = truth.purge_pressure * (1.0 - sag)
    frequency = generator.uniform(20.0, 80.0) + 5.0 * generator.standard_normal(time.size)
    phase = 2.0 * np.pi * np.cumsum(frequency) / truth.rate
    chamber = chamber + truth.oscillation * (chamber - AMBIENT) * np.sin(phase)
    biases = 2.0 * PSI * generator.standard_normal(4)
    columns = [time]
    for value, bias in zip((tank, run, chamber, purge), biases, strict=True):
        own = noise(generator, time.size, truth.rate, truth.white, truth.flicker)
        columns.append(sensors.converted((value + bias + own) / PSI))
    thrust = 1.4 * 1.7e-3 * np.maximum(chamber - AMBIENT, 0.0) + 5.0 * generator.standard_normal(time.size)
    shaking = 0.02 + 0.15 * (after > 0.0)
    columns += [thrust, mass + shaking * generator.standard_normal(time.size)]
    _save(path, columns, generator)


def _save(path: Path, columns: list[Array], generator: np.random.Generator) -> None:
    lost = generator.random(columns[0].size) < 0.003
    with path.open("w", encoding="utf-8") as file:
        file.write("Time (s),PT-TANK (psia),PT-RUN (psia),PT-CC (psia),PT-PURGE (psia),LC-THRUST (N),LC-TANK (kg)\n")
        for i, row in enumerate(np.column_stack(columns)):
            values = "," * 5 if lost[i] else ",".join(f"{x:.4f}" for x in row[1:])
            file.write(f"{row[0]:.5f},{values}\n")


def _definition(name: str, truth: Truth, generator: np.random.Generator) -> str:
    mass_std = generator.uniform(0.002, 0.006) * truth.mass
    volume_std = generator.uniform(0.0, 0.004) * truth.volume
    mass = truth.mass + mass_std * generator.standard_normal()
    volume = truth.volume + volume_std * generator.standard_normal()
    pressures = "\n".join(
        f'[channels.{channel}]\ncolumn = "{column} (psia)"\nunit = "psi"\naccuracy = "2 psi"\n{zero}'
        for channel, column, zero in (
            ("p_tank", "PT-TANK", ""),
            ("p_run", "PT-RUN", 'zero = "ambient"\n'),
            ("p_chamber", "PT-CC", 'zero = "ambient"\n'),
            ("p_purge", "PT-PURGE", ""),
        )
    )
    return f"""schema = 1
[test]
id = "{name}"
kind = "hot_fire"
source = "synthetic"
description = "Made by the project's own tank model"
[log]
files = ["log.csv"]
time = {{ column = "Time (s)", unit = "s" }}
{pressures}
[channels.thrust]
column = "LC-THRUST (N)"
unit = "N"
tare = "auto"
[channels.m_tank]
column = "LC-TANK (kg)"
unit = "kg"
accuracy = "0.02 kg"
[tank]
volume = "{volume * 1e3:.6f} +/- {volume_std * 1e3:.6f} L"
oxidizer_mass = "{mass:.6f} +/- {mass_std:.6f} kg"
[injector]
holes = {truth.holes}
hole_area = "{HOLE_AREA * 1e6:.3f} +/- 0 mm^2"
[purge]
cracking_pressure = "{truth.cracking / 1e5:.2f} bar"
[nozzle]
throat_radius = "23.3 mm"
exit_radius = "38.1 mm"
[site]
ambient_pressure = "{AMBIENT / 100:.2f} hPa"
"""
