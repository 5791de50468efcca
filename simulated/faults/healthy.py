"""A healthy log: an engine or a cold flow, sensors within their accuracy, and a logger of some rate, unit and form."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache
from math import pi, sqrt
from pathlib import Path

import numpy as np
from simulated.engine import Histories, made
from simulated.stand import AMBIENT, Array, noise

PSI, LBF, KGF, LB = 6894.757293168361, 4.4482216152605, 9.80665, 0.45359237
PRESSURES = {"psi": PSI, "psig": PSI, "psia": PSI, "bar": 1e5, "barg": 1e5, "kPa": 1e3}
FORCES = {"N": 1.0, "kN": 1e3, "lbf": LBF, "kgf": KGF}
MASSES = {"kg": 1.0, "lb": LB, "g": 1e-3}
RATES = (10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0)
ENGINES = 40
"""Engines that the logs are made from; each is run once."""
FULL_SCALE = {"p_tank": 100e5, "p_run": 100e5, "p_chamber": 60e5, "p_purge": 160e5}
"""[Pa] of a gauge."""


@dataclass(frozen=True)
class Log:
    """A log as written: time [s], channels [SI] as their sensors say them, how each is logged, what is stated.

    ``keys``: lines of test.toml by channel; ``fire``: from when to when [s]; ``std``: noise [SI].
    """

    time: Array
    values: dict[str, Array]
    unit: dict[str, str]
    keys: dict[str, list[str]]
    stated: str
    kind: str
    fire: tuple[float, float]
    std: dict[str, float]
    accuracy: dict[str, float]
    rate: float
    digits: int = 6
    factor: dict[str, float] = field(default_factory=dict)
    """What a reading is multiplied by beside its unit, where a channel is in another one than stated."""

    def but(self, channel: str, values: Array) -> Log:
        """With other values of a channel."""
        return replace(self, values={**self.values, channel: values})

    def rise(self, channel: str) -> float:
        """From rest to the usual height of the firing [SI]; how far it falls, of what falls."""
        inside = (self.time > self.fire[0]) & (self.time < self.fire[1])
        before = self.values[channel][self.time < self.fire[0] - 0.1]
        moved = self.values[channel][inside] - np.nanmedian(before)
        return float(np.nanpercentile(np.abs(moved), 90.0))


@cache
def _engine(number: int) -> tuple[Histories, float, dict[str, float]]:
    stand, engine, done, true = made(5000 + number)
    sizes = {
        "volume": stand.volume, "mass": stand.mass, "holes": float(stand.holes),
        "throat": sqrt(engine.throat_area / pi), "exit": sqrt(engine.exit_area / pi), "fuel": engine.fuel_mass,
        "length": engine.grain_length, "outer": engine.outer_radius, "burn": done.burn_time, "t_v": stand.t_v,
        "temperature": stand.temperature,
    }  # fmt: skip
    return true, float(max(stand.t_purge, done.burn_time)), sizes


def draw(seed: int) -> Log:
    """A healthy log; the same for the same seed."""
    rng = np.random.default_rng([51, seed])
    true, end, sizes = _engine(int(rng.integers(ENGINES)))
    rate = float(rng.choice(RATES))
    lead, tail = float(rng.uniform(3.0, 15.0)), float(rng.uniform(3.0, 12.0))
    time = np.arange(-lead, end + tail, 1.0 / rate)
    if rate <= 50.0:
        time = time + rng.uniform(-0.2, 0.2, time.size) / rate
    cold = rng.random() < 0.15
    values = {n: np.where(time < 0.0, true.rest[n], np.interp(time, true.time, c)) for n, c in true.curves.items()}
    if cold:
        values = _cold(values)
    _ring(rng, time, values, rate)
    names = [n for n in values if n in ("p_tank", "p_run", "p_chamber") or rng.random() < 0.75]
    values = {n: values[n] for n in names}
    if rng.random() < 0.35:
        values["T_tank"] = _warmth(rng, time, sizes)
    log = _logged(rng, time, values, rate, (0.0, min(sizes["burn"], end)), "cold_flow" if cold else "hot_fire")
    return replace(log, stated=_stated(rng, sizes, cold))


def _cold(values: dict[str, Array]) -> dict[str, Array]:
    """The same flow without a fire: a quarter of the chamber's rise, and of the thrust a little less."""
    p_c = AMBIENT + 0.22 * (values["p_chamber"] - AMBIENT)
    return {**values, "p_chamber": p_c, "thrust": 0.2 * values["thrust"]}


def _ring(rng: np.random.Generator, time: Array, values: dict[str, Array], rate: float) -> None:
    """The chamber's oscillation, and what the cell sees of it."""
    size = float(rng.uniform(0.0, 0.04))
    frequency = rng.uniform(20.0, 80.0) + 5.0 * rng.standard_normal(time.size)
    wave = size * np.sin(2.0 * pi * np.cumsum(frequency) / rate)
    values["p_chamber"] = values["p_chamber"] + wave * (values["p_chamber"] - AMBIENT)
    values["thrust"] = values["thrust"] * (1.0 + rng.uniform(0.3, 1.2) * wave)
    if "m_tank" in values:
        shake = float(rng.uniform(0.0, 0.15))
        values["m_tank"] = values["m_tank"] + shake * np.where(time > 0.0, 1.0, 0.05) * rng.standard_normal(time.size)


def _warmth(rng: np.random.Generator, time: Array, sizes: dict[str, float]) -> Array:
    """A thermocouple in the tank: falls with the liquid, by twenty to forty kelvin."""
    fall = float(rng.uniform(20.0, 40.0))
    return sizes["temperature"] + rng.uniform(-5.0, 5.0) - fall * np.clip(time / sizes["t_v"], 0.0, 1.0)


def _logged(
    rng: np.random.Generator, time: Array, values: dict[str, Array], rate: float, fire: tuple[float, float], kind: str
) -> Log:
    pressure, force, mass = (str(rng.choice(list(u))) for u in (PRESSURES, FORCES, MASSES))
    stated, zeroed, tared = rng.random() < 0.5, rng.random() < 0.5, rng.random() < 0.7
    slow, bits = float(rng.choice([0.0, 0.3, 1.0])), int(rng.choice([0, 0, 12, 16, 24]))
    unit, keys, std, accuracy = {}, {}, {}, {}
    out: dict[str, Array] = {}
    for name, value in values.items():
        full, white, bias, unit[name], keys[name] = _sensor(rng, name, value, pressure, force, mass)
        wander = slow * white * rng.uniform(0.2, 0.5)
        accuracy[name] = bias
        off = 0.7 * bias * rng.standard_normal()
        if name == "thrust" and tared:
            off, keys[name] = 3.0 * bias * rng.standard_normal(), [*keys[name], 'tare = "auto"']
        if name in ("p_run", "p_chamber") and zeroed:
            keys[name] = [*keys[name], 'zero = "ambient"']
        read = value + off + noise(rng, time.size, rate, white, wander**2)
        if name == "thrust":
            read = read + rng.uniform(-0.004, 0.004) * np.max(value) * np.clip(time / fire[1], 0.0, 1.0)
        step = full / 2.0**bits if bits else 0.0
        out[name] = np.round(read / step) * step if step else read
        std[name] = max(white, 0.3 * step)
        if stated:
            keys[name] = [*keys[name], _accuracy(name, bias, unit[name])]
    out = _damaged(rng, out, std)
    return Log(time, out, unit, keys, "", kind, fire, std, accuracy, rate, int(rng.choice([5, 6, 8])))


def _sensor(
    rng: np.random.Generator, name: str, value: Array, pressure: str, force: str, mass: str
) -> tuple[float, float, float, str, list[str]]:
    """Full scale, white noise and accuracy [SI], unit and keys."""
    if name.startswith("p_"):
        full = FULL_SCALE[name]
        gauge = ["gauge = true"] if pressure in ("bar", "kPa") and rng.random() < 0.3 else []
        return full, full * 10.0 ** rng.uniform(-4.3, -2.6), full * rng.uniform(0.0008, 0.002), pressure, gauge
    if name == "T_tank":
        return 1000.0, float(rng.uniform(0.05, 0.8)), 1.0, str(rng.choice(["degC", "K", "degF"])), []
    full = 1.5 * float(np.max(value))
    if name == "thrust":
        return full, full * 10.0 ** rng.uniform(-3.7, -2.2), full * rng.uniform(0.001, 0.003), force, []
    return full, full * 10.0 ** rng.uniform(-3.7, -2.6), full * rng.uniform(0.001, 0.003), mass, []


def size_of(unit: str) -> float:
    """A unit in SI; differences of temperature."""
    return {**PRESSURES, **FORCES, **MASSES, "degC": 1.0, "K": 1.0, "degF": 5.0 / 9.0}[unit]


def _accuracy(name: str, bias: float, unit: str) -> str:
    if name == "T_tank":
        return 'accuracy = "1 K"'
    plain = unit.removesuffix("g") if unit in ("psig", "barg") else "psi" if unit == "psia" else unit
    return f'accuracy = "{bias / size_of(unit):.6g} {plain}"'


def _damaged(rng: np.random.Generator, values: dict[str, Array], std: dict[str, float]) -> dict[str, Array]:
    """Single spikes and lost cells, as every log has them."""
    out = {}
    for name, value in values.items():
        made_ = value.copy()
        for _ in range(int(rng.integers(0, 4))):
            at, times = int(rng.integers(6, len(made_) - 6)), float(rng.choice([-1, 1]) * rng.uniform(15, 60))
            made_[at] += times * std[name]
        made_[rng.random(len(made_)) < 0.001] = np.nan
        out[name] = made_
    return out


def _stated(rng: np.random.Generator, sizes: dict[str, float], cold: bool) -> str:
    """What the engineer knows: masses and sizes, some of them, with or without their errors."""
    lines = ["[tank]", f'volume = "{sizes["volume"] * 1e3:.5g} L"']
    if rng.random() < 0.8:
        error = float(rng.uniform(0.002, 0.01))
        mass = sizes["mass"] * (1.0 + error * rng.standard_normal())
        spread = f" +/- {error * mass:.3g}" if rng.random() < 0.5 else ""
        lines.append(f'oxidizer_mass = "{mass:.5g}{spread} kg"')
    lines += ["[injector]", f"holes = {int(sizes['holes'])}", 'hole_area = "3.142 mm^2"']
    if rng.random() < 0.7 and not cold:
        radii = {name: f'{name}_radius = "{1e3 * sizes[name]:.5g} mm"' for name in ("throat", "exit")}
        lines += ["[nozzle]", *radii.values()]
    if rng.random() < 0.7 and not cold:
        lines += [
            "[grain]", f'mass = "{1e3 * sizes["fuel"]:.5g} g"', f'length = "{1e3 * sizes["length"]:.5g} mm"',
            'density = "900 kg/m^3"', f'outer_radius = "{1e3 * sizes["outer"]:.6g} mm"',
        ]  # fmt: skip
    lines += ["[site]", f'ambient_pressure = "{AMBIENT / 100.0:.2f} hPa"']
    if rng.random() < 0.4 and not cold:
        lines += ["[observed]", f'burn_time = "{sizes["burn"]:.3g} s"']
    return "\n".join(lines) + "\n"


def write(folder: Path, log: Log) -> None:
    """``folder``/log.csv and test.toml."""
    folder.mkdir(parents=True, exist_ok=True)
    columns = {name: _as_logged(log, name) for name in log.values}
    rows = np.column_stack([log.time, *columns.values()])
    form = f"%.{log.digits}g"
    lines = [",".join(["time", *columns])]
    lines += [",".join([f"{row[0]:.5f}", *("" if np.isnan(x) else form % x for x in row[1:])]) for row in rows]
    (folder / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "test.toml").write_text(_toml(folder.name, log), encoding="utf-8")


def _as_logged(log: Log, name: str) -> Array:
    """Readings in the unit they are stated to be in."""
    value, unit = log.values[name], log.unit[name]
    if name == "T_tank":
        return {"degC": value - 273.15, "K": value, "degF": value * 1.8 - 459.67}[unit]
    if name.startswith("p_") and (unit.endswith("g") or "gauge = true" in log.keys[name]):
        value = value - AMBIENT
    return value / size_of(unit) * log.factor.get(name, 1.0)


def _toml(name: str, log: Log) -> str:
    head = f'schema = 1\n[test]\nid = "{name}"\nkind = "{log.kind}"\nsource = "synthetic"\n'
    head += '[log]\nfiles = ["log.csv"]\ntime = { column = "time", unit = "s" }\n'
    tables = [
        "\n".join([f"[channels.{n}]", f'column = "{n}"', f'unit = "{log.unit[n]}"', *log.keys[n]]) for n in log.values
    ]
    return head + "\n".join([*tables, log.stated])
