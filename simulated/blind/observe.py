"""What a test's channels tell: block means at 50 Hz, their true covariance, and the instants of events.

Traces of two runs are compared at equal phase: between the instants at which the valve opens, the liquid is gone and
the valve closes, one time axis is stretched onto the other, and the instants themselves count as observations of
their own. Otherwise a knee that moves by 50 ms would look like a difference that no calibration can absorb.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, cholesky, solve_triangular, toeplitz

from . import sensors as se
from . import slots as s
from .stand import Histories, Stand

Array = NDArray[np.float64]

BLOCK = 20
"""Samples in a block."""
BLIND = 0.04
"""Half the time around an event that is not looked at [s]: what milliseconds tell there is not counted."""
SIGMA_EVENT = 4e-3
"""How well an instant can be seen [s]."""
BEFORE = 1.0
"""Quiet time before the opening that is looked at [s]."""
UNCHOKED = 1.8
"""Ambient pressures below which no hot gas chokes a throat: ((k + 1) / 2)^(k / (k - 1)), 1.77 to 1.83 for k of 1.2 to
1.3."""
POINTS = (0.125, 0.375, 0.625, 0.875)
"""Where in a block the noise-free traces are evaluated."""


def block_covariance(covariance: Array, blocks: int) -> Array:
    """Autocovariance of block means from that of samples (length at least (blocks + 1) BLOCK)."""
    d = np.arange(-BLOCK + 1, BLOCK)
    weight = (BLOCK - np.abs(d)) / BLOCK**2
    lags = np.abs(np.arange(blocks)[:, None] * BLOCK + d[None, :])
    return np.asarray(covariance[lags] @ weight)


def _noise_covariance(sensor: se.Sensor, blocks: int) -> Array:
    """Of block means, in SI."""
    lags = np.arange((blocks + 1) * BLOCK) / se.RATE
    c = sum((sigma**2 * np.exp(-lags / tau) for sigma, tau in sensor.slow), np.zeros(len(lags)))
    c[0] += sensor.white**2 + sensor.quantum**2 / 12.0
    return block_covariance(c, blocks) * sensor.size**2


@dataclass(frozen=True)
class Observer:
    """Compares runs with a reference run of the same test.

    ``told``: for every channel, which of the ``used`` blocks count.
    """

    stand: Stand
    reference: Histories
    centers: Array
    used: NDArray[np.bool_]
    told: tuple[NDArray[np.bool_], ...]
    factors: tuple[Array, ...]

    @classmethod
    def of(cls, stand: Stand, reference: Histories, instruments: se.Instruments) -> Observer:
        """With the true covariance of the instruments' noise."""
        width = BLOCK / se.RATE
        edges = np.arange(-BEFORE, reference.time[-1] - width, width)
        used = np.ones(len(edges), dtype=bool)
        for instant in (0.0, reference.t_v, reference.t_fuel_out, stand.closing):
            if np.isfinite(instant):
                used &= (edges > instant + BLIND) | (edges + width < instant - BLIND)
        flowing = edges + width <= stand.closing
        fire_out = _fire_out(stand, reference)
        dying = (edges + width > fire_out) & (edges < stand.closing + BLIND)
        # the tank side counts up to the closing: what test.toml excludes is no evidence
        counts = {s.P_CHAMBER: ~dying, s.THRUST: ~dying, s.P_RUN: flowing & ~dying}
        told = tuple(counts.get(i, flowing)[used] for i in range(len(s.CHANNELS)))
        factors = _factors(stand, reference, instruments, edges, used, told)
        return cls(stand, reference, edges, used, told, factors)

    def means(self, channels: Array, true: Histories) -> Array:
        """Block means (blocks, channels) of noise-free channels, at the reference's phase."""
        width = BLOCK / se.RATE
        t = (self.centers[self.used][:, None] + width * np.array(POINTS)).ravel()
        x = np.interp(t, *self._knots(true))
        values = np.where(x[:, None] < 0.0, se.rest(self.stand, true), se._sampled(channels, x))
        return values.reshape(-1, len(POINTS), len(s.CHANNELS)).mean(axis=1)

    def _knots(self, true: Histories) -> tuple[Array, Array]:
        r, end = self.reference, float(self.reference.time[-1])
        pairs = [(-10.0, -10.0), (0.0, 0.0), (self.stand.closing, self.stand.closing), (end, end)]
        pairs += [(a, b) for a, b in ((r.t_v, true.t_v), (r.t_fuel_out, true.t_fuel_out)) if np.isfinite(a + b)]
        pairs.sort()
        here, there = np.array(pairs).T
        if np.any(np.diff(there) <= 0.0):  # the order of events has changed
            return np.array([-10.0, end]), np.array([-10.0, end])
        return here, there

    def whitened(self, means: Array, true: Histories) -> Array:
        """Block means over their noise, uncorrelated, and the instants over their uncertainty."""
        parts = [np.concatenate([means[self.told[i], i] for i in group]) for group in GROUPS]
        white = [
            solve_triangular(f, p, lower=True, check_finite=False) for f, p in zip(self.factors, parts, strict=True)
        ]
        return np.concatenate([*white, self._instants(true)])

    def _instants(self, true: Histories) -> Array:
        r = self.reference
        pairs = ((r.t_v, true.t_v), (r.t_fuel_out, true.t_fuel_out))
        return np.array([(b - a) / SIGMA_EVENT if np.isfinite(a + b) else 0.0 for a, b in pairs])


GROUPS = ((s.P_TANK,), (s.P_RUN,), (s.P_CHAMBER, s.THRUST), (s.P_PURGE,), (s.M_TANK,))
"""Channels whose noise goes together."""


def _fire_out(stand: Stand, true: Histories) -> float:
    """When the fuel is gone or the nozzle has unchoked [s], whichever is first: the test's end for chamber, thrust and
    the run line, whose flow the chamber's pressure holds back.

    How a chamber flushes then, and what a cold flow or a smouldering grain makes of it, no model knows to the per mille
    that a sensor would show.
    """
    choked = np.flatnonzero(true.trace(s.P_CHAMBER) > UNCHOKED * stand.ambient)
    unchoked = float(true.time[choked[-1]]) if choked.size else 0.0
    return min(unchoked, true.t_fuel_out) if np.isfinite(true.t_fuel_out) else unchoked


def _factors(
    stand: Stand,
    reference: Histories,
    instruments: se.Instruments,
    edges: Array,
    used: NDArray[np.bool_],
    told: tuple[NDArray[np.bool_], ...],
) -> tuple[Array, ...]:
    n = len(edges)
    kept = []
    for own in told:
        kept.append(used.copy())
        kept[-1][used] = own
    one = {
        i: toeplitz(_noise_covariance(x, n))[np.ix_(k, k)]
        for i, (x, k) in enumerate(zip(instruments.sensors, kept, strict=True))
    }
    # the tank's shaking, settled in a few hundredths of a second: nearly white from block to block
    shake = se.narrow_band_covariance(
        (float(np.exp(-0.01)), 2.0 * np.pi * instruments.shake_frequency / se.RATE), (n + 1) * BLOCK
    )
    swing = np.interp(edges + 0.5 * BLOCK / se.RATE, reference.time, se.envelope(reference, stand.ambient), left=0.0)
    level = instruments.shake * np.where(swing[kept[s.M_TANK]] > 0.0, 1.0, 0.1)
    weighed = np.ix_(kept[s.M_TANK], kept[s.M_TANK])
    one[s.M_TANK] = one[s.M_TANK] + toeplitz(block_covariance(shake, n))[weighed] * np.outer(level, level)
    joint = block_diag(one[s.P_CHAMBER], one[s.THRUST])
    o = instruments.oscillation
    burning = kept[s.P_CHAMBER]
    wave = toeplitz(block_covariance(se.narrow_band_covariance(o.poles, (n + 1) * BLOCK), n))[np.ix_(burning, burning)]
    swing = swing[burning]
    amplitude = np.concatenate([swing, swing * o.coupling * np.pi * stand.throat_radius**2]) * o.relative
    joint += np.tile(wave, (2, 2)) * np.outer(amplitude, amplitude)
    blocks = [joint if len(g) > 1 else one[g[0]] for g in GROUPS]
    return tuple(cholesky(b, lower=True, check_finite=False) for b in blocks)
