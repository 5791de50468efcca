"""One fault of each kind, over the range of its sizes, put into a healthy log."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import accumulate

import numpy as np
from simulated.faults.healthy import AMBIENT, FORCES, PRESSURES, Array, Log, size_of

Rng = np.random.Generator


@dataclass(frozen=True)
class Faulty:
    """A log with a fault; the channels any of which a finding has to name, and its size in words."""

    log: Log
    channels: tuple[str, ...]
    size: str


def pick(rng: Rng, log: Log, *names: str) -> str:
    """One of the channels that the log has."""
    return str(rng.choice([n for n in names if n in log.values]))


def within(rng: Rng, log: Log, low: float = 0.15, high: float = 0.7) -> float:
    """An instant [s] within the firing."""
    return float(log.fire[0] + rng.uniform(low, high) * (log.fire[1] - log.fire[0]))


def dead(rng: Rng, log: Log) -> Faulty:
    """Constant; or at rest with its noise while the engine fires; or a line lost for a while."""
    name, way = pick(rng, log, "p_chamber", "thrust", "p_run", "p_tank"), float(rng.random())
    rest = float(np.nanmedian(log.values[name][log.time < -0.2]))
    if way < 0.5 or name == "p_tank":
        level = rest if rng.random() < 0.5 else rest + log.rise(name) * float(rng.uniform(-1.0, 3.0))
        return Faulty(log.but(name, np.full(log.time.size, level)), (name,), "constant")
    level = AMBIENT if name.startswith("p_") else rest
    quiet = level + log.std[name] * rng.standard_normal(log.time.size)
    if name == "p_run" and way > 0.75 and log.kind == "hot_fire":
        start = within(rng, log)
        gone = (log.time > start) & (log.time < start + max(rng.uniform(0.5, 1.5), 12.0 / log.rate))
        return Faulty(log.but(name, np.where(gone, quiet, log.values[name])), (name,), "for a while")
    return Faulty(log.but(name, quiet), (name,), "at rest")


def railed(rng: Rng, log: Log) -> Faulty:
    """Cut off at a part of its rise, with spikes or without; a supply at its rail with spikes."""
    if "p_purge" in log.values and rng.random() < 0.25:
        value = np.full(log.time.size, float(np.nanmax(log.values["p_purge"])) * rng.uniform(1.0, 2.0))
        spikes = rng.random(value.size) < rng.uniform(0.003, 0.02)
        value[spikes] *= rng.uniform(0.1, 1.5, int(spikes.sum()))
        return Faulty(log.but("p_purge", value), ("p_purge",), "with spikes")
    name = pick(rng, log, "p_chamber", "thrust", "p_run")
    share = float(rng.uniform(0.3, 0.85))
    rest = float(np.nanmedian(log.values[name][log.time < -0.2]))
    rail = rest + share * log.rise(name)
    value = np.minimum(log.values[name], rail)
    if rng.random() < 0.4:
        spikes = (rng.random(value.size) < 0.002) & (value == rail)
        value[spikes] += log.rise(name) * rng.uniform(0.2, 1.0, int(spikes.sum()))
    return Faulty(log.but(name, value), (name,), f"at {share:.2f}")


def coarse(rng: Rng, log: Log) -> Faulty:
    """A converter of few bits: steps of a part of its rise, wider than its noise."""
    name = pick(rng, log, "p_chamber", "thrust", "p_run", "p_tank")
    share = float(10.0 ** rng.uniform(-1.2, -0.4))
    step = max(share * log.rise(name), 4.0 * log.std[name])
    return Faulty(log.but(name, step * np.round(log.values[name] / step)), (name,), f"{share:.2f} of its rise")


def noise(rng: Rng, log: Log) -> Faulty:
    """A cell or gauge that dies in the burn: noise about some level from then on."""
    name, at = pick(rng, log, "p_chamber", "thrust", "m_tank", "p_run"), within(rng, log)
    share = float(10.0 ** rng.uniform(-0.7, 1.0))
    size = max(share * log.rise(name), 6.0 * log.std[name])
    level = float(np.nanmedian(log.values[name][log.time < -0.2])) + size * float(rng.uniform(-1.0, 1.0))
    wild = level + size * rng.standard_normal(log.time.size)
    return Faulty(log.but(name, np.where(log.time < at, log.values[name], wild)), (name,), f"{share:.2f} of its rise")


def open_(rng: Rng, log: Log) -> Faulty:
    """A code, a rail, or jumps; throughout or from an instant on."""
    base = log.values.get("T_tank", 290.0 + 0.2 * rng.standard_normal(log.time.size))
    unit = log.unit.get("T_tank", "degC")
    bad = [
        np.full(log.time.size, float(rng.choice([1272.15, 1645.15, 1073.15, 73.15]))),
        rng.uniform(-150.0, 900.0) + 273.15 + rng.uniform(40.0, 300.0) * rng.standard_normal(log.time.size),
    ][int(rng.integers(2))]
    at = -np.inf if rng.random() < 0.5 else within(rng, log)
    value = np.where(log.time < at, base, bad)
    keys = {**log.keys, "T_tank": log.keys.get("T_tank", [])}
    made = replace(log.but("T_tank", value), unit={**log.unit, "T_tank": unit}, keys=keys)
    return Faulty(made, ("T_tank",), "throughout" if at == -np.inf else "from an instant on")


def dropout(rng: Rng, log: Log) -> Faulty:
    """Codes and fault currents: stretches of a level that is none."""
    name = pick(rng, log, "p_tank", "p_run", "p_chamber", "thrust", "m_tank")
    unit = size_of(log.unit[name])
    if name.startswith("p_"):
        code = float(rng.choice([-10.0, 999.0, -999.0, -2.9e5 / unit, -5e5 / unit]))
        level = code * unit if code != -10.0 else min(-10.0 * unit, -0.8e5)
    else:
        level = float(rng.choice([-999.0, 9999.0, 99999.0])) * unit
    value, spread = log.values[name].copy(), 0.0 if rng.random() < 0.6 else 1e-4 * abs(level)
    lasting = max(0.2, 14.0 / log.rate)
    for _ in range(int(rng.integers(1, 4))):
        start = within(rng, log, 0.0, 0.9)
        gone = (log.time > start) & (log.time < start + lasting * rng.uniform(1.0, 4.0))
        value[gone] = level + spread * rng.standard_normal(int(gone.sum()))
    return Faulty(log.but(name, value), (name,), f"{level / unit:.0f}")


def zero(rng: Rng, log: Log) -> Faulty:
    """A zero that ignition shifts."""
    name = pick(rng, log, "thrust", "thrust", "p_chamber")
    share = float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-1.6, -0.6))
    if name == "p_chamber":
        # a shift upwards cannot be told from gas that still flows, below vacuum it is another kind
        share = -float(rng.uniform(0.3, 0.9)) * AMBIENT / log.rise(name)
    at = within(rng, log, 0.0, 0.5)
    shift = share * log.rise(name) * np.clip((log.time - at) / 0.05, 0.0, 1.0)
    return Faulty(log.but(name, log.values[name] + shift), (name,), f"{share:+.3f} of its rise")


def drift(rng: Rng, log: Log) -> Faulty:
    """A zero that runs through the whole log."""
    name, share = pick(rng, log, "thrust", "p_chamber"), float(rng.choice([-1, 1]) * 10.0 ** rng.uniform(-1.4, -0.7))
    slope = share * log.rise(name) / (log.fire[1] - log.fire[0])
    value = log.values[name] + slope * (log.time - log.time[0])
    return Faulty(log.but(name, value), (name,), f"{share:+.3f} of its rise through the firing")


def gauge_or_absolute(rng: Rng, log: Log) -> Faulty:
    """All pressures, or the chamber alone, the other way than stated."""
    names = [n for n in log.values if n.startswith("p_")] if rng.random() < 0.6 else ["p_chamber"]
    gauge = log.unit["p_chamber"].endswith("g") or "gauge = true" in log.keys["p_chamber"]
    made = log
    for name in names:
        made = made.but(name, made.values[name] + (AMBIENT if gauge else -AMBIENT))
    keys = {n: [k for k in lines if not k.startswith("zero")] for n, lines in log.keys.items()}
    return Faulty(replace(made, keys=keys), ("p_chamber",), "absolute as gauge" if gauge else "gauge as absolute")


def scale(rng: Rng, log: Log) -> Faulty:
    """Thrust or chamber pressure off by a factor of 1.6 to 5, either way; with throat and load stated."""
    name = pick(rng, log, "thrust", "p_chamber") if "thrust" in log.values else "p_chamber"
    factor = float(np.exp(rng.choice([-1.0, 1.0]) * rng.uniform(np.log(1.7), np.log(5.0))))
    floor = AMBIENT if name == "p_chamber" else 0.0
    return Faulty(log.but(name, floor + factor * (log.values[name] - floor)), (name,), f"{factor:.2f}")


def unit(rng: Rng, log: Log) -> Faulty:
    """A channel, or all of its dimension, stated in another unit than logged."""
    name = pick(rng, log, "thrust", "thrust", "p_tank", "m_tank")
    if name == "thrust":
        others = [u for u in FORCES if u != log.unit[name]]
        other = str(rng.choice(others))
        return Faulty(_stated_in(log, [name], other), (name,), f"{log.unit[name]} as {other}")
    if name == "m_tank":
        other = "lb" if log.unit[name] == "kg" else "kg"
        return Faulty(_stated_in(log, [name], other), (name,), f"{log.unit[name]} as {other}")
    plain = {u: s for u, s in PRESSURES.items() if u in ("psi", "bar", "kPa")}
    now = size_of(log.unit[name])
    other = str(rng.choice([u for u, s in plain.items() if abs(s - now) > 1.0]))
    return Faulty(_stated_in(log, [n for n in log.values if n.startswith("p_")], other), (name,), f"as {other}")


def _stated_in(log: Log, names: list[str], other: str) -> Log:
    """The readings stay as they are, the unit is stated to be another."""
    factor = {n: size_of(other) / size_of(log.unit[n]) for n in names}
    of_unit = ("accuracy", "gauge")
    keys = {n: [k for k in own if n not in names or not k.startswith(of_unit)] for n, own in log.keys.items()}
    return replace(log, unit={**log.unit, **dict.fromkeys(names, other)}, factor=factor, keys=keys)


def sign(rng: Rng, log: Log) -> Faulty:
    """A cell or gauge the other way round."""
    name = pick(rng, log, "thrust", "thrust", "m_tank", "p_chamber")
    floor = AMBIENT if name == "p_chamber" else 0.0
    return Faulty(log.but(name, floor - (log.values[name] - floor)), (name,), "reversed")


def swapped(rng: Rng, log: Log) -> Faulty:
    """Two columns."""
    pairs = [("p_tank", "p_run"), ("p_tank", "p_chamber"), ("p_run", "p_chamber"), ("p_tank", "p_purge")]
    a, b = pairs[int(rng.integers(len(pairs)))]
    if b not in log.values:
        b = "p_run"
    values = {**log.values, a: log.values[b], b: log.values[a]}
    return Faulty(replace(log, values=values), (a, b), f"{a} and {b}")


def gross_mass(rng: Rng, log: Log) -> Faulty:
    """The tank's own mass too; or only a part of what leaves."""
    value = log.values["m_tank"]
    if rng.random() < 0.6:
        dry = float(rng.uniform(2.0, 30.0))
        return Faulty(log.but("m_tank", value + dry), ("m_tank",), f"{dry:.0f} kg")
    part = float(rng.uniform(0.1, 0.7))
    return Faulty(log.but("m_tank", part * value), ("m_tank",), f"{part:.2f} of it")


def lag(rng: Rng, log: Log) -> Faulty:
    """Through a filter of first order."""
    name = pick(rng, log, "p_chamber", "p_run", "thrust")
    constant = float(10.0 ** rng.uniform(-0.6, 0.4))
    return Faulty(log.but(name, slowed(log.time, log.values[name], constant)), (name,), f"{constant:.2f} s")


def slowed(time: Array, values: Array, constant: float) -> Array:
    """Through a filter of first order with a time ``constant`` [s]."""
    part = 1.0 - np.exp(-float(np.median(np.diff(time))) / constant)
    filled = np.where(np.isnan(values), np.nanmedian(values), values)
    return np.array(list(accumulate(filled.tolist(), lambda held, new: held + part * (new - held))))


def clock(rng: Rng, log: Log) -> Faulty:
    """A clock at another pace, with a burn time from a video."""
    pace = float(rng.uniform(0.2, 0.5))
    burn = max((log.time[-1]) * rng.uniform(0.75, 0.95), log.fire[1])
    stated = log.stated.split("[observed]")[0] + f'[observed]\nburn_time = "{burn:.3g} s"\n'
    return Faulty(replace(log, time=log.time * pace, stated=stated), tuple(log.values), f"{pace:.2f}")


def edge(rng: Rng, log: Log) -> Faulty:
    """One to three wild readings at an end."""
    name, count = pick(rng, log, *log.values), int(rng.integers(1, 4))
    value = log.values[name].copy()
    at = slice(0, count) if rng.random() < 0.5 else slice(-count, None)
    far = float(rng.choice([8388607.0, 32767.0, 65535.0, 4095.0])) * size_of(log.unit[name])
    if name == "T_tank":
        far = 85.0 + 273.15
    most = float(np.nanmax(np.abs(value)))
    value[at] = far if abs(far) > 3.0 * most or name == "T_tank" else 100.0 * most
    return Faulty(log.but(name, value), (name,), f"{count} of {far:.3g}")


NEEDS: dict[str, tuple[str, ...]] = {
    "gross_mass": ("m_tank", "oxidizer_mass"), "scale": ("[nozzle]", "oxidizer_mass", "[grain]", "hot_fire", "thrust"),
    "unit": ("[nozzle]", "oxidizer_mass", "[grain]", "hot_fire", "thrust"), "swapped": ("hot_fire",),
    "lag": ("thrust",), "zero": ("thrust",), "sign": ("thrust",),
}  # fmt: skip
"""What a log has to hold or state for a fault to be told at all: channels, words of test.toml, the kind of test."""

FAULTS: dict[str, Callable[[Rng, Log], Faulty]] = {
    "dead": dead, "railed": railed, "coarse": coarse, "noise": noise, "open": open_, "dropout": dropout, "zero": zero,
    "drift": drift, "gauge_or_absolute": gauge_or_absolute, "scale": scale, "unit": unit, "sign": sign,
    "swapped": swapped, "gross_mass": gross_mass, "lag": lag, "clock": clock, "edge": edge,
}  # fmt: skip
"""By the kind of finding that they are to give."""


def suits(log: Log, kind: str) -> bool:
    """Whether the log holds what is needed to tell a fault of a kind."""
    return all(need in log.values or need in log.stated or need == log.kind for need in NEEDS.get(kind, ()))
