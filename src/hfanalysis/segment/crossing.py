"""Where a noisy pressure falls through a limit: a parabola over as much of it as fits, or a sudden fall's own curve."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.quantity import NORMAL_95
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal

WINDOWS = (0.02, 0.04, 0.08, 0.15, 0.3, 0.6, 1.2, 2.4, 4.8)
"""Seconds on either side of the crossing through which a parabola is laid: the widest that still fits."""

BENT = 6.0
"""A parabola fits as long as a curve of fourth order leaves no less than this times the noise's variance less. Source:
chi^2 of two parameters, at 95 %."""

BENT_BY_WANDER = 0.15
"""What a wander of spectrum A/f puts into a parameter of third or fourth order, over A and the samples. Source: its
variance in the band of one cycle in 3 to 5 half-windows."""

APART_BY = 2.0
"""Standard deviations by which a narrower window's parabola may miss the crossing of a wider one. Source: Lepski's
rule: the widest window is taken that no narrower one contradicts; two deviations are one in twenty."""

AGAIN = 2
"""Times that what is found is looked around again."""

USUAL, LEFT_OF_NORMAL = 0.95, 0.759
"""Part of the second differences that no step made, and what is then left of a normal variance. Source: the normal
distribution cut at its 95 %."""

REACH = 0.2
"""Seconds on either side in which a sudden fall is looked for."""

LEVEL_TIME = 0.05
"""Seconds from which the level of a fall's tail is known."""

_QUANTILES = np.array([NormalDist().inv_cdf((k + 0.5) / 9.0) for k in range(9)])
NODES: Array = _QUANTILES / _QUANTILES.std()
"""Equally likely values of a normal error, in its standard deviations."""


def crossing(part: Signal, rough: float, limit: float, noise: Noise) -> tuple[float, float]:
    """Where a falling signal passes a limit, in its unit, about ``rough`` [s], and its standard deviation [s].

    ``noise`` is the sensor's.
    """
    found = _widest(part, rough, limit, noise)
    for _ in range(AGAIN):
        found = (_widest(part, found.passes, limit, noise) or found) if found is not None else None
    return (found.passes, found.doubt) if found is not None and found.fits else _in_a_fall(part, rough, limit, noise)


def usual_noise(value: Array) -> float:
    """Standard deviation of samples (n,) about a smooth curve, in their unit, also where readings are coarse."""
    seconds = np.sort(np.abs(np.diff(value, 2)))[: max(int(USUAL * value.size), 1)]
    return float(np.sqrt(seconds @ seconds / max(seconds.size, 1) / 6.0 / LEFT_OF_NORMAL)) if value.size > 7 else 0.0


def _in_a_fall(part: Signal, rough: float, limit: float, noise: Noise) -> tuple[float, float]:
    """Which instant best parts what is above from what is below, in a fall about ``rough`` [s] of any shape.

    Its flat tail may lie as near to the limit as its level is unsure.
    """
    reach = max(REACH, 4.0 * part.step)
    near = part.between(rough - reach, rough + reach)
    limits = limit + noise.white * np.sqrt(part.step / max(LEVEL_TIME, part.step)) * NODES
    found = np.array([near.time[_parting(near.value - one)] for one in limits]) + 0.5 * part.step
    return float(found.mean()), float(np.hypot(found.std(), part.step / np.sqrt(12.0)))


def _parting(excess: Array) -> int:
    return int(np.argmax(np.cumsum(excess)))


def _widest(part: Signal, rough: float, limit: float, noise: Noise) -> _Parabola | None:
    """The parabola over the widest window that fits and whose crossing no narrower one contradicts; else the first."""
    kept: list[_Parabola] = []
    for wide in WINDOWS:
        near = part.between(rough - wide, rough + wide)
        one = _parabola(near, rough, wide, limit, noise) if near.time.size > 7 else None
        if one is None or not one.clear > 0.0:
            continue
        if kept and (not one.fits or any(other.contradicts(one, limit, noise) for other in kept)):
            break
        kept.append(one)
    return kept[-1] if kept else None


@dataclass(frozen=True)
class _Parabola:
    """A parabola ``curve`` [Pa] over ``wide`` [s] on either side of ``about`` [s] that ``passes`` the limit [s].

    ``covariance`` (3, 3) of its coefficients: white noise alone. It ``fits`` where it leaves what the sensor does.
    """

    curve: np.polynomial.Polynomial
    about: float
    wide: float
    passes: float
    covariance: Array
    wander: float
    fits: bool

    def contradicts(self, wider: _Parabola, limit: float, noise: Noise) -> bool:
        """Whether a wider window's crossing is clearly none here; in more time the sensor wanders more."""
        x = wider.passes - self.about
        error = np.hypot(self.scatter(x), np.sqrt(noise.flicker * np.log(wider.wide / self.wide)))
        return bool(abs(x) < self.wide and abs(self.curve(x) - limit) > APART_BY * error)

    def scatter(self, x: float) -> float:
        """Standard deviation [Pa] of the curve at ``x`` [s] from ``about``, by white noise."""
        at = np.array([1.0, x, x**2])
        return float(np.sqrt(at @ self.covariance @ at))

    @property
    def clear(self) -> float:
        """Square of the slope [Pa/s] beyond its own 95 % error (Fieller); not positive where it may be none."""
        x = self.passes - self.about
        rate = np.array([0.0, 1.0, 2.0 * x])
        variance = float(rate @ self.covariance @ rate) + (self.wander / self.wide) ** 2
        return float(self.curve.deriv()(x)) ** 2 - NORMAL_95**2 * variance

    @property
    def doubt(self) -> float:
        """Standard deviation [s] of the crossing."""
        return float(self.scatter(self.passes - self.about) / np.sqrt(self.clear))


def _parabola(near: Signal, about: float, wide: float, limit: float, noise: Noise) -> _Parabola | None:
    x = near.time - about
    middle, half = 0.5 * float(x[0] + x[-1]), 0.5 * float(x[-1] - x[0])
    powers = np.vander((x - middle) / half, 5, increasing=True)
    best, left, inverse = _fitted(powers[:, :3], near.value)
    back = _shifted(middle, half)
    curve = np.polynomial.Polynomial(back @ best)
    passes = _root(curve, limit, wide)
    if passes is None:
        return None
    _, more, _ = _fitted(powers, near.value)
    spread = max(noise.white**2, left / (x.size - 3))
    return _Parabola(
        curve,
        about,
        wide,
        about + passes,
        np.asarray(spread * back @ inverse @ back.T),
        float(np.sqrt(noise.flicker)),
        bool(left - more < BENT * (noise.white**2 + BENT_BY_WANDER * x.size * noise.flicker)),
    )


def _fitted(columns: Array, value: Array) -> tuple[Array, float, Array]:
    """Coefficients (k,) of the columns (n, k) that fit a value (n,) best, the squares that they leave, and the inverse
    of the columns' products.

    By the normal equations: powers up to the fourth over -1 to 1 lose three digits of sixteen by them.
    """
    inverse = np.linalg.inv(columns.T @ columns)
    best = inverse @ (columns.T @ value)
    left = value - columns @ best
    return best, float(left @ left), inverse


def _shifted(middle: float, half: float) -> Array:
    """From the coefficients of a parabola in (x - middle)/half to those in x, (3, 3)."""
    m = middle / half
    return np.array([[1.0, -m, m * m], [0.0, 1.0, -2.0 * m], [0.0, 0.0, 1.0]]) / half ** np.arange(3.0)[:, np.newaxis]


def _root(curve: np.polynomial.Polynomial, limit: float, wide: float) -> float | None:
    """The x [s] at which the parabola falls through the limit, where there is one within ``wide``: the root at which
    its slope is minus the square root of the discriminant."""
    c, b, a = float(curve.coef[0]) - limit, float(curve.coef[1]), float(curve.coef[2])
    inside = b * b - 4.0 * a * c
    if inside <= 0.0 or (a == 0.0 and b >= 0.0):
        return None
    root = float(np.sqrt(inside))
    found = (-b - root) / (2.0 * a) if b > 0.0 else 2.0 * c / (root - b)
    return found if abs(found) < wide else None
