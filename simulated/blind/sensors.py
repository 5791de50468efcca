"""Sensors: biases, three families of noise, an oscillation common to p_c and thrust, lost and wild samples.

All slow noise is a sum of exponentially correlated (Ornstein-Uhlenbeck) processes, whose covariance is known exactly:
one of them, or, for 1/f noise, seven with time constants a factor of three apart and equal variances.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from . import slots as s
from .stand import Histories, Stand

Array = NDArray[np.float64]

PSI, POUND = 6894.757293168, 4.4482216152605
UNITS = {"p_tank": "psi", "p_run": "psi", "p_chamber": "psi", "p_purge": "psi", "thrust": "lbf", "m_tank": "kg"}
SIZE = {"psi": PSI, "lbf": POUND, "kg": 1.0}
ACCURACY = {"p_tank": 2.0, "p_run": 2.0, "p_chamber": 1.5, "p_purge": 2.0, "thrust": 1.5, "m_tank": 0.02}
"""One standard deviation of a bias, in the channel's unit."""
FULL_SCALE = {"p_tank": 900.0, "p_run": 900.0, "p_chamber": 400.0, "p_purge": 900.0, "thrust": 700.0, "m_tank": 10.0}
"""Where the gain's error reaches the accuracy, in the channel's unit."""
ZEROED = ("p_run", "p_chamber")
"""Open to the air before ignition."""
FAMILIES = ("ar1", "flicker", "mixed")
FLICKER_TIMES = tuple(0.02 * 3.0**i for i in range(7))
RATE = 1000.0
"""Samples per second."""


@dataclass(frozen=True)
class Sensor:
    """One channel, in its own unit: ``slow`` holds (standard deviation, time constant [s])."""

    channel: str
    white: float
    slow: tuple[tuple[float, float], ...]
    zero: float
    gain: float
    quantum: float

    @property
    def size(self) -> float:
        """Its unit in SI."""
        return SIZE[UNITS[self.channel]]


@dataclass(frozen=True)
class Oscillation:
    """Narrow-band chamber oscillation: relative standard deviation of p_c, and what of A_t p' the thrust cell sees."""

    frequency: float
    bandwidth: float
    relative: float
    coupling: float

    @property
    def poles(self) -> tuple[float, float]:
        """Radius and angle of the filter's poles at RATE."""
        return float(np.exp(-np.pi * self.bandwidth / RATE)), float(2.0 * np.pi * self.frequency / RATE)


@dataclass(frozen=True)
class Instruments:
    """All sensors of a test, and what else is wrong with its log."""

    family: str
    sensors: tuple[Sensor, ...]
    oscillation: Oscillation
    shake: float
    shake_frequency: float
    gaps: int
    spikes: int

    def sensor(self, channel: str) -> Sensor:
        """By channel."""
        return self.sensors[s.CHANNELS.index(channel)]

    def record(self) -> dict[str, Any]:
        """For the answer."""
        return {
            "family": self.family,
            "channels": {x.channel: {"unit": UNITS[x.channel], **asdict(x)} for x in self.sensors},
            "oscillation": asdict(self.oscillation),
            "shake": {"std": self.shake, "unit": "kg", "frequency": self.shake_frequency},
            "gaps": self.gaps,
            "spikes": self.spikes,
        }


WHITE = {"p_tank": (0.5, 1.2), "p_run": (0.5, 1.2), "p_chamber": (0.4, 1.2), "p_purge": (0.5, 1.5),
         "thrust": (1.0, 3.5), "m_tank": (0.01, 0.03)}  # fmt: skip
SLOW = {"p_tank": (0.1, 0.35), "p_run": (0.1, 0.35), "p_chamber": (0.08, 0.3), "p_purge": (0.1, 0.4),
        "thrust": (0.3, 1.0), "m_tank": (0.002, 0.006)}  # fmt: skip
"""Standard deviations in the channel's unit, from and to."""


def _slow(rng: np.random.Generator, family: str, size: float) -> tuple[tuple[float, float], ...]:
    single = ((size, float(np.exp(rng.uniform(np.log(0.02), np.log(0.6))))),)
    flicker = tuple((size / len(FLICKER_TIMES) ** 0.5, tau) for tau in FLICKER_TIMES)
    return {"ar1": single, "flicker": flicker, "mixed": (*single, *flicker)}[family]


def _sensor(rng: np.random.Generator, channel: str, family: str) -> Sensor:
    accuracy = ACCURACY[channel]
    zero = rng.normal(0.0, 4.0 * accuracy if channel == "thrust" else accuracy)
    quantum = {"psi": 0.06, "lbf": 0.12, "kg": 0.002}[UNITS[channel]] if family == "mixed" else 0.0
    size = rng.uniform(*SLOW[channel])
    return Sensor(channel, float(rng.uniform(*WHITE[channel])), _slow(rng, family, float(size)), float(zero),
                  float(rng.normal(0.0, accuracy / FULL_SCALE[channel])), quantum)  # fmt: skip


def draw(rng: np.random.Generator, family: str) -> Instruments:
    """Instruments of one stand."""
    sensors = tuple(_sensor(rng, channel, family) for channel in s.CHANNELS)
    oscillation = Oscillation(*(float(rng.uniform(*r)) for r in ((20.0, 80.0), (2.0, 12.0), (0.004, 0.02), (0.4, 1.3))))
    return Instruments(family, sensors, oscillation, float(rng.uniform(0.005, 0.05)), float(rng.uniform(8.0, 40.0)),
                       int(rng.integers(0, 4)), int(rng.integers(0, 7)))  # fmt: skip


def narrow_band(rng: np.random.Generator, poles: tuple[float, float], count: int) -> Array:
    """Unit-variance noise through a pair of poles, settled."""
    r, w = poles
    a1, a2 = 2.0 * r * np.cos(w), -r * r
    variance = (1.0 - a2) / ((1.0 + a2) * ((1.0 - a2) ** 2 - a1 * a1))
    x = lfilter([1.0], [1.0, -a1, -a2], rng.standard_normal(count + 3000))[3000:]
    return np.asarray(x) / np.sqrt(variance)


def narrow_band_covariance(poles: tuple[float, float], lags: int) -> Array:
    """Autocovariance of :func:`narrow_band` at lags 0, 1, ..."""
    r, w = poles
    a1, a2 = 2.0 * r * np.cos(w), -r * r
    rho = np.empty(max(lags, 2))
    rho[0], rho[1] = 1.0, a1 / (1.0 - a2)
    for k in range(2, lags):
        rho[k] = a1 * rho[k - 1] + a2 * rho[k - 2]
    return rho


def slow_noise(rng: np.random.Generator, slow: tuple[tuple[float, float], ...], count: int) -> Array:
    """Sum of exponentially correlated processes, stationary from the start."""
    out = np.zeros(count)
    for sigma, tau in slow:
        phi = float(np.exp(-1.0 / (RATE * tau)))
        start = rng.normal(0.0, sigma)
        step = rng.normal(0.0, sigma * np.sqrt(1.0 - phi * phi), count)
        out += lfilter([1.0], [1.0, -phi], step, zi=[phi * start])[0]
    return out


def rest(stand: Stand, true: Histories) -> Array:
    """The channels before the valve opens: of the tank that is true, not of the stand as it was thought to be."""
    p_tank, m_tank = true.traces[0, [s.P_TANK, s.M_TANK]]
    return np.array([p_tank, stand.ambient, stand.ambient, stand.supply or stand.ambient, 0.0, m_tank])


def envelope(true: Histories, ambient: float) -> Array:
    """Chamber pressure above ambient, of which the oscillation is a share [Pa]."""
    return np.maximum(true.trace(s.P_CHAMBER) - 1.2 * ambient, 0.0)


@dataclass(frozen=True)
class Log:
    """What the logger wrote: log time [s], channels in their units (nan where a sample was lost)."""

    time: Array
    values: Array
    t_open: float


def write_log(rng: np.random.Generator, stand: Stand, true: Histories, channels: Array, with_: Instruments) -> Log:
    """Sample a test at RATE, from ``stand.lead`` seconds before the valve opens to the end of the histories."""
    fraction = float(rng.uniform(0.05, 0.95)) / RATE
    before = int(stand.lead * RATE)
    t = (np.arange(-before, len(true.time) - 1)) / RATE + fraction
    ideal = np.where(t[:, None] < 0.0, rest(stand, true), _sampled(channels, t))
    swing = np.interp(t, true.time, envelope(true, stand.ambient), left=0.0)
    values = _measured(rng, ideal, swing, stand, with_)
    t_log = np.round(np.arange(len(t)) / RATE + float(rng.choice([0.0, -stand.lead, 4583.0])), 3)
    return Log(*_damaged(rng, t_log, values, with_), t_open=float(t_log[before] - t[before]))


def _sampled(channels: Array, t: Array) -> Array:
    x = np.clip(t * RATE, 0.0, len(channels) - 1.000001)
    i = x.astype(int)
    f = (x - i)[:, None]
    return (1.0 - f) * channels[i] + f * channels[i + 1]


def _measured(rng: np.random.Generator, ideal: Array, swing: Array, stand: Stand, with_: Instruments) -> Array:
    n, o = len(ideal), with_.oscillation
    common = narrow_band(rng, o.poles, n) * swing * o.relative
    out = ideal.copy()
    out[:, s.P_CHAMBER] += common
    out[:, s.THRUST] += o.coupling * np.pi * stand.throat_radius**2 * common
    moving = swing > 0.0
    shaking = narrow_band(rng, (float(np.exp(-0.01)), 2.0 * np.pi * with_.shake_frequency / RATE), n)
    out[:, s.M_TANK] += with_.shake * np.where(moving, 1.0, 0.1) * shaking
    for i, sensor in enumerate(with_.sensors):
        x = out[:, i] / sensor.size * (1.0 + sensor.gain) + sensor.zero
        x += rng.normal(0.0, sensor.white, n) + slow_noise(rng, sensor.slow, n)
        out[:, i] = np.round(x / sensor.quantum) * sensor.quantum if sensor.quantum else x
    return out


def _damaged(rng: np.random.Generator, t: Array, values: Array, with_: Instruments) -> tuple[Array, Array]:
    """Spikes in single channels, empty cells, and whole rows that the logger lost."""
    keep = np.ones(len(t), dtype=bool)
    for _ in range(with_.gaps):
        start, length = int(rng.integers(0, len(t) - 30)), int(rng.integers(2, 20))
        if rng.uniform() < 0.5:
            keep[start : start + length] = False
        else:
            values[start : start + length, int(rng.integers(0, values.shape[1]))] = np.nan
    for _ in range(with_.spikes):
        i = int(rng.integers(0, values.shape[1]))
        values[int(rng.integers(0, len(t))), i] += float(
            rng.choice([-1, 1]) * rng.uniform(15.0, 80.0) * with_.sensors[i].white
        )
    return t[keep], values[keep]
