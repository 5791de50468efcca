"""Effects of the sensors: what is recorded instead of what is there."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numba import njit
from numpy.typing import NDArray

from . import slots as s
from .kernel import BAR, STEP
from .stand import Histories

Array = NDArray[np.float64]
Shape = Mapping[str, float]
Distortion = Callable[[Array, Histories, float, Shape], Array]
"""(channels (count, 6), what is true, strength, shape) -> distorted channels."""

PRESSURES = ("p_tank", "p_run", "p_chamber")


def heat_load(true: Histories) -> Array:
    """Integral of p_c / 10 bar while it burns [s]: the heat that stand and sensors have seen."""
    p_c = true.trace(s.P_CHAMBER)
    return np.cumsum(np.where(p_c > 1.5 * BAR, p_c / (10.0 * BAR), 0.0)) * STEP


def _with(channels: Array, name: str, added: Array) -> Array:
    out = channels.copy()
    out[:, s.CHANNELS.index(name)] += added
    return out


def load_cell_drift(channels: Array, true: Histories, strength: float, shape: Shape) -> Array:
    """The thrust cell's zero follows the heat it has seen by two exponentials, and recovers slowly when it is over."""
    h = heat_load(true)
    drift = 1.0 - shape["fast"] * np.exp(-h / shape["first"]) - (1.0 - shape["fast"]) * np.exp(-h / shape["second"])
    over = np.maximum(true.time - true.time[int(np.argmax(h >= h[-1]))], 0.0)
    return _with(channels, "thrust", strength * drift * np.exp(-over / 40.0))


def transducer_offset(channels: Array, true: Histories, strength: float, shape: Shape) -> Array:
    """A transducer shifts at ignition, within a few hundredths of a second, and stays."""
    shifted = 1.0 - np.exp(-((true.time / 0.03) ** 2))
    return _with(channels, PRESSURES[int(shape["channel"])], strength * shape["sign"] * shifted)


def tap_lag(channels: Array, true: Histories, strength: float, shape: Shape) -> Array:
    """The chamber's tap: a narrow line whose gas fills the slower the lower the pressure, tau = s sqrt(8 bar / p)."""
    if strength == 0.0:
        return channels
    out = channels.copy()
    column = s.CHANNELS.index("p_chamber")
    out[:, column] = _lagged(np.ascontiguousarray(channels[:, column]), strength)
    return out


@njit(cache=True)
def _lagged(p: Array, strength: float) -> Array:
    seen = np.empty_like(p)
    y = p[0]
    for i in range(len(p)):
        tau = strength * (8.0 * BAR / max(0.5 * (p[i] + y), 0.5 * BAR)) ** 0.5
        y += (p[i] - y) * (1.0 - np.exp(-STEP / tau))
        seen[i] = y
    return seen


def transducer_drift(channels: Array, true: Histories, strength: float, shape: Shape) -> Array:
    """A transducer warms: its zero moves with the heat seen, after a delay, as one diffusion-like rise."""
    h = np.maximum(heat_load(true) - shape["delay"], 0.0)
    return _with(
        channels, PRESSURES[int(shape["channel"])], strength * shape["sign"] * (1.0 - np.exp(-h / shape["scale"]))
    )


def logger_skew(channels: Array, true: Histories, strength: float, shape: Shape) -> Array:
    """Thrust and tank mass come from another logger, whose clock is late."""
    if strength == 0.0:
        return channels
    out = channels.copy()
    for name in ("thrust", "m_tank"):
        i = s.CHANNELS.index(name)
        before = channels[0, i] if name == "m_tank" else 0.0
        out[:, i] = np.interp(true.time - strength, true.time, channels[:, i], left=before)
    return out


def gusts(channels: Array, true: Histories, strength: float, shape: Shape) -> Array:
    """Wind on the thrust stand: a few slow waves."""
    waves = sum(np.sin(2.0 * np.pi * shape[f"f{i}"] * true.time + shape[f"phase{i}"]) / (i + 1.0) for i in range(3))
    return _with(channels, "thrust", strength * (1.0 - np.exp(-true.time / 0.3)) * np.asarray(waves))
