"""Loggers, and what stands lack: slow with jitter and 12 bit, fast with little rest, quiet with much, one whose sensors
wander; and, of wider worlds, 25 Hz with mains noise that is folded down, 5 kHz behind a filter, and stands without a
thrust cell, a sensor before the injector, or a tank that is weighed while it empties."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter
from simulated.blind import sensors as se
from simulated.blind import slots as s
from simulated.blind.kernel import STEP
from simulated.blind.stand import Histories, Stand
from simulated.worlds.laws import Array


@dataclass(frozen=True)
class Logger:
    """``rate`` [1/s], ``rest`` before the opening [s], white and slow noise over the usual [-], ``jitter`` of samples
    that is written down and that is not [s], and ``bits`` of the converter (0: as fine as it is printed).

    ``hum``: mains noise over the white one [-], at 50 Hz or nearly, folded down where the rate is slow; ``corner``
    [Hz] of a filter of the first order before the converter (0: none); ``lacks``: channels that the stand does not
    have."""

    rate: float
    rest: float
    white: float = 1.0
    slow: float = 1.0
    jitter: tuple[float, float] = (0.0, 0.0)
    bits: int = 0
    hum: float = 0.0
    corner: float = 0.0
    lacks: tuple[str, ...] = ()


QUICK = (
    "50 Hz, jitter, 12 bit",
    "2 kHz, 0.5 s of rest",
    "250 Hz, quiet, a minute of rest",
    "200 Hz, slow noise times 3",
)
"""The loggers of the first sets."""

MAINS, GRID = 50.0, 0.05
"""[Hz]; and by how much a grid is off at most, as usual: at 50 Hz sharp a logger of 25 Hz would read the same phase
each time, which is no noise, but a sensor that is off."""

LOGGERS = {
    "50 Hz, jitter, 12 bit": Logger(50.0, 20.0, jitter=(2e-3, 1.5e-3), bits=12),
    "2 kHz, 0.5 s of rest": Logger(2000.0, 0.5, white=1.5),
    "250 Hz, quiet, a minute of rest": Logger(250.0, 60.0, white=0.35, slow=0.35),
    "200 Hz, slow noise times 3": Logger(200.0, 4.0, slow=3.0),
    "25 Hz, mains noise, 14 bit": Logger(25.0, 120.0, hum=4.0, bits=14),
    "5 kHz behind 60 Hz": Logger(5000.0, 0.3, white=3.0, corner=60.0),
    "500 Hz, no thrust": Logger(500.0, 6.0, lacks=("thrust",)),
    "100 Hz, no run line": Logger(100.0, 10.0, bits=12, lacks=("p_run",)),
    "1 kHz, no purge, no cell": Logger(1000.0, 2.0, slow=1.5, lacks=("p_purge", "m_tank")),
}
SCALE = {"psi": 1500.0, "lbf": 3000.0, "kg": 60.0}
"""Full scale of a converter, in the channel's unit."""


@dataclass(frozen=True)
class Sensors:
    """What was drawn of a test's sensors, each in its channel's unit, by channel: bias, relative error of the gain,
    white and slow noise; the chamber's oscillation; and the size of the thrust cell over the usual one [-]."""

    zero: Array
    gain: Array
    white: Array
    slow: tuple[tuple[tuple[float, float], ...], ...]
    oscillation: se.Oscillation


def drawn(rng: np.random.Generator, logger: Logger, stand: Stand) -> Sensors:
    """Sensors of a stand by a logger."""
    force = max(stand.throat_radius / 0.018, 0.7) ** 2
    sizes = [force if c == "thrust" else 1.0 for c in s.CHANNELS]
    accuracy = np.array([se.ACCURACY[c] for c in s.CHANNELS])
    full = np.array([se.FULL_SCALE[c] for c in s.CHANNELS])
    slow = []
    for channel, size in zip(s.CHANNELS, sizes, strict=True):
        sigma = logger.slow * size * rng.uniform(*se.SLOW[channel]) / len(se.FLICKER_TIMES) ** 0.5
        slow.append(tuple((float(sigma), tau) for tau in se.FLICKER_TIMES))
    return Sensors(
        zero=rng.normal(0.0, 1.0, len(accuracy)) * accuracy,
        gain=rng.normal(0.0, 1.0, len(accuracy)) * accuracy / full,
        white=np.array([rng.uniform(*se.WHITE[c]) * k for c, k in zip(s.CHANNELS, sizes, strict=True)]) * logger.white,
        slow=tuple(slow),
        oscillation=se.Oscillation(
            *(float(rng.uniform(*r)) for r in ((20.0, 80.0), (2.0, 12.0), (0.003, 0.012), (0.5, 1.2)))
        ),
    )


def written(
    rng: np.random.Generator, stand: Stand, true: Histories, channels: Array, logger: Logger, with_: Sensors
) -> se.Log:
    """The log: slow noise and oscillation on the run's own grid, then what a logger samples of it."""
    end, fine = float(true.time[-1]), 1.0 / se.RATE
    grid = np.arange(-logger.rest, end - fine, fine)
    slow = np.stack([se.slow_noise(rng, one, grid.size) for one in with_.slow], axis=1)
    swing = se.narrow_band(rng, with_.oscillation.poles, grid.size)
    swing *= with_.oscillation.relative * np.interp(grid, true.time, se.envelope(true, stand.ambient), left=0.0)
    count = int((end - fine + logger.rest) * logger.rate)
    stamps = np.arange(count) / logger.rate - logger.rest + rng.uniform(0.0, 1.0) / logger.rate
    stamps = np.sort(stamps + rng.uniform(-1.0, 1.0, count) * logger.jitter[0])
    at = np.clip(stamps + rng.normal(0.0, 1.0, count) * logger.jitter[1], grid[0], grid[-1])
    seen = filtered(channels, logger.corner)
    ideal = np.where(at[:, None] < 0.0, se.rest(stand, true), se._sampled(seen, at))
    common = np.interp(at, grid, swing)
    ideal[:, s.P_CHAMBER] += common
    ideal[:, s.THRUST] += with_.oscillation.coupling * np.pi * stand.throat_radius**2 * common
    values = np.empty_like(ideal)
    mains = MAINS + rng.uniform(-GRID, GRID) if logger.hum else MAINS
    for i, channel in enumerate(s.CHANNELS):
        unit = se.UNITS[channel]
        x = ideal[:, i] / se.SIZE[unit] * (1.0 + with_.gain[i]) + with_.zero[i] + np.interp(at, grid, slow[:, i])
        x += rng.normal(0.0, with_.white[i], count)
        if logger.hum:
            x += logger.hum * with_.white[i] * np.sin(2.0 * np.pi * (mains * at + rng.uniform()))
        step = SCALE[unit] / 2**logger.bits
        values[:, i] = np.round(x / step) * step if logger.bits else x
    values[:, [s.CHANNELS.index(name) for name in logger.lacks]] = np.nan
    late = float(rng.choice([0.0, 37.5]))
    return se.Log(np.round(stamps + late, 4 if logger.rate > 1000.0 else 3), values, t_open=late)


def filtered(channels: Array, corner: float) -> Array:
    """The channels, at the run's own steps, behind a filter of the first order with its ``corner`` [Hz]."""
    if not corner:
        return channels
    kept = np.exp(-2.0 * np.pi * corner * STEP)
    return np.asarray(lfilter([1.0 - kept], [1.0, -kept], channels, axis=0, zi=kept * channels[:1])[0])
