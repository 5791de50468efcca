"""How strong what is hidden has to be to be seen, by tangents: d' after the constants, with a rough noise.

It sizes strengths, and says which tests nobody could answer; it is no measure by which a diagnosis is scored.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from simulated.blind import slots as s
from simulated.blind.effects import LIBRARY, Hidden, drawn, slots_of
from simulated.blind.kernel import STEP
from simulated.blind.sensors import SIZE, UNITS
from simulated.blind.stand import Histories, Stand
from simulated.worlds.engines import simulated
from simulated.worlds.laws import Array, World
from simulated.worlds.loggers import Logger, Sensors

BLOCK = 0.1
"""Seconds of a block."""
FORM = 2e-3
"""Part of a channel's range that no two models agree on [-]. Assumed."""
AROUND = 0.1
"""Seconds about a change of phase that are not looked at."""
RIVAL = 0.1
"""Part of a rival's largest strength at which its tangent is taken [-]."""
CONSTANTS = {"C_i": 0.02, "K_loss": 0.05, "m": 0.02, "a": 0.02, "n": 0.02, "mass": 0.005, "temperature": 0.5}
"""Steps of the constants that follow: relative ones, of m, n [-] and temperature [K] absolute."""


def observed(
    stand: Stand, world: World, hidden: tuple[Hidden, ...], tables: tuple[Array, Array]
) -> tuple[Array, Histories]:
    """What the sensors' places hold (count, channels), and what is true."""
    true = simulated(stand, world, slots_of(hidden), tables)
    return distorted(true, hidden), true


def distorted(true: Histories, hidden: tuple[Hidden, ...]) -> Array:
    """What the sensors' places hold (count, channels), with what is hidden in sensors."""
    channels = true.traces[:, : len(s.CHANNELS)].copy()
    for h in hidden:
        if h.effect.distortion is not None:
            channels = h.effect.distortion(channels, true, h.strength, h.shape)  # type: ignore[arg-type]
    return channels


def moved(stand: Stand, name: str) -> Stand:
    """The stand with a constant a step away."""
    value, step = getattr(stand, name), CONSTANTS[name]
    return replace(stand, **{name: value + (step if name in ("m", "n", "temperature") else step * value)})


def d_prime(
    stand: Stand, world: World, hidden: tuple[Hidden, ...], logger: Logger, with_: Sensors, tables: tuple[Array, Array]
) -> float:
    """Root of the least chi-square at which the constants follow what is hidden, by tangents of the empty test."""
    return float(np.linalg.norm(left(stand, world, (hidden,), logger, with_, tables)[0]))


def to_rivals(
    stand: Stand, world: World, hidden: Hidden, logger: Logger, with_: Sensors, tables: tuple[Array, Array]
) -> float:
    """The same where the constants and the one effect of the library that is most like it follow, at any strength.

    Each rival has one shape; its tangent is taken at RIVAL of its largest strength.
    """
    others = [e for e in LIBRARY if e.name != hidden.effect.name]
    rivals = [drawn(e, np.random.default_rng(0)).at(RIVAL * e.most) for e in others]
    own, *rest = left(stand, world, ((hidden,), *((one,) for one in rivals)), logger, with_, tables)
    sizes = [np.linalg.norm(other) for other in rest]
    along = [max(float(own @ other) / size, 0.0) for other, size in zip(rest, sizes, strict=True) if size > 0.0]
    return float(np.sqrt(max(float(own @ own) - max(along, default=0.0) ** 2, 0.0)))


def left(
    stand: Stand, world: World, sets: Sequence[tuple[Hidden, ...]], logger: Logger, with_: Sensors,
    tables: tuple[Array, Array],
) -> list[Array]:  # fmt: skip
    """Of each of the ``sets``, what it changes in standard deviations of the noise, after the constants followed."""
    empty, true = observed(stand, world, (), tables)
    blocks = int(min(stand.closing, true.t_fuel_out if np.isfinite(true.t_fuel_out) else np.inf) / BLOCK)
    centers = (np.arange(blocks) + 0.5) * BLOCK
    good = centers > AROUND
    for instant in (true.t_v, true.t_fuel_out):
        good &= ~(np.abs(centers - instant) < AROUND + 0.5 * BLOCK)
    per, columns = round(BLOCK / STEP), [i for i, c in enumerate(s.CHANNELS) if c not in ("p_purge", *logger.lacks)]
    sizes = np.array([SIZE[UNITS[c]] for c in s.CHANNELS])
    samples = max(logger.rate * BLOCK, 1.0)
    slow = np.array([sum(v * v for v, _ in one) for one in with_.slow])
    noise = np.sqrt(with_.white**2 / samples + 3.0 * slow) * sizes + FORM * np.ptp(empty, axis=0)

    def looked_at(channels: Array) -> Array:
        means = channels[: blocks * per].reshape(blocks, per, -1).mean(axis=1)[good]
        return np.asarray((means / noise)[:, columns].T.ravel())

    base = looked_at(empty)
    follow = [looked_at(observed(moved(stand, name), world, (), tables)[0]) - base for name in CONSTANTS]
    follow += [np.repeat(np.eye(len(columns))[i], good.sum()) for i in range(len(columns))]
    basis, _ = np.linalg.qr(np.stack(follow, axis=1))
    changes = [looked_at(observed(stand, world, hidden, tables)[0]) - base for hidden in sets]
    return [np.asarray(change - basis @ (basis.T @ change)) for change in changes]


def sized(
    stand: Stand, world: World, hidden: Hidden, target: float, logger: Logger, with_: Sensors
) -> tuple[Hidden, float]:
    """The effect at the strength that d' asks for, at most the largest plausible; and d' there."""
    tables = world.tank_table(), world.gas_table()
    made = hidden
    found = d_prime(stand, world, (made,), logger, with_, tables)
    for _ in range(3):
        if 0.9 * target < found < 1.1 * target or found == 0.0:
            break
        grown = made.strength * min(max(target / found, 0.1), 10.0)
        made = made.at(min(grown, made.effect.most))
        found = d_prime(stand, world, (made,), logger, with_, tables)
    return made, found
