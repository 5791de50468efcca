"""Detectability: how many standard deviations of its own an effect's strength is away from none.

d' = p sqrt(S_k), S_k being the information on the strength after projecting out the nuisances with their priors. Here
in its form for responses that are not linear: d'^2 is the least chi-square, priors included, with which the model
without the effect can describe the noise-free test (whitened by the true noise). For small strengths both are the
same. d'_{k|l} likewise, the rival l being free as well, with a strength that is not negative.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from . import kernel
from . import sensors as se
from . import slots as s
from .effects import EFFECTS, LIBRARY, Hidden, drawn, slots_of
from .observe import Observer
from .stand import Histories, Stand, simulate

Array = NDArray[np.float64]

NUISANCES = (("C_i", 0.5, 0.004, True), ("K_loss", 1.0, 0.02, True), ("m", 0.087, 0.003, False),
             ("a", 1.0, 0.005, True), ("n", 0.25, 0.003, False), ("mass", 0.01, 0.004, False),
             ("temperature", 5.0, 0.05, False))  # fmt: skip
"""Name, standard deviation of the prior, step of the difference, whether both are relative."""


def observed(stand: Stand, hidden: tuple[Hidden, ...]) -> tuple[Array, Histories]:
    """Channels (count, 6) in SI as ideal sensors, but for the hidden effects, would give them."""
    true = simulate(stand, slots_of(hidden))
    channels = true.traces[:, : len(s.CHANNELS)]
    for h in hidden:
        if h.effect.distortion is not None:
            channels = h.effect.distortion(channels, true, h.strength, h.shape)  # type: ignore[arg-type]
    return channels, true


def shifted(stand: Stand, q: Array) -> Stand:
    """The stand with its nuisances moved by ``q``."""
    changes = {}
    for (name, _, _, relative), x in zip(NUISANCES, q, strict=True):
        now = getattr(stand, name)
        changes[name] = now * float(np.exp(np.clip(x, -2.0, 2.0))) if relative else now + float(x)
    changes["temperature"] = min(max(changes["temperature"], 265.0), 306.0)
    changes["m"] = min(max(changes["m"], 0.6), 1.8)
    return replace(stand, **changes)


EXPONENT = [n[0] for n in NUISANCES].index("n")

VALLEYS = (-0.2, -0.1, -0.05, 0.05, 0.1, 0.2)
"""How far from where a fit has ended n is tried as well."""

NOT_HOPELESS = 4.0
"""How many times the least chi-square a start there may have to be followed."""

STRIDE, STRIDES = 0.05, 12
"""Where something is hidden in the grain's equation, in which a and n are: how far n is moved at a time, and how often,
while all else follows. The valley is narrow and bends; steps of everything at once crawl in it, and a start far away
lies high above it."""

FOLLOWED, MOST_FOLLOWING = 0.8, 8
"""Part of chi-square that a step of all else leaves where it has followed, and the most steps."""

LEFT = 100.0
"""Times the least chi-square at which a valley is left."""

OPENING = 5e-3
"""Standard deviation of the instant of opening [s]; the log does not state it."""

CONVERGED, MOST_STEPS = 2e-3, 25
"""Relative gain in chi-square (twice that in d') below which a fit has ended, and the most steps."""

ALIKE = 0.06
"""Difference in the logarithm of d' that a quick fit may make: hardly more than the search for a strength leaves."""


LASTS_ALIKE = 0.1
"""Relative difference of the seconds of fire after the liquid up to which a test has the time axis of the base."""


@dataclass(frozen=True)
class Slopes:
    """Tangents of the nuisances at a point, and Q and R of their least-squares system in units of the priors."""

    tangents: Array
    q: Array
    r: Array


@dataclass(frozen=True)
class Fit:
    """What is left of a test after the best model without the effect: whitened residual, nuisances, chi-square.

    ``slopes``: those on which the last steps were made.
    """

    residual: Array
    nuisances: Array
    chi2: float
    slopes: Slopes


class Detector:
    """Detectability for one stand, one test and its instruments.

    ``axis``: the stand whose run has the phases on whose time axis tests are compared; this one if it is not given.
    """

    def __init__(
        self, stand: Stand, instruments: se.Instruments, rivals: Sequence[Hidden] = (), axis: Stand | None = None
    ) -> None:
        self.stand, self.instruments = stand, instruments
        channels, self.base = observed(stand, ())
        reference = self.base if axis is None else observed(axis, ())[1]
        self.observer = Observer.of(axis or stand, reference, instruments)
        self._base_means = self.observer.means(channels, self.base)
        self.zero = self._white(channels, self.base)
        self.priors = np.array(
            [n[1] for n in NUISANCES] + [v for i in instruments.sensors for v in _sensor_priors(i)] + [OPENING]
        )
        self._of_sensors = np.column_stack([*self._sensor_tangents(), self._later(channels)])
        self.slopes = self._slopes_at(np.zeros(len(NUISANCES)))
        self.rivals = {r.effect.name: r for r in rivals}
        self._columns: dict[str, Array] = {}

    def _white(self, channels: Array, true: Histories) -> Array:
        return self.observer.whitened(self.observer.means(channels, true), true)

    def response(self, hidden: tuple[Hidden, ...], q: Array | None = None) -> Array:
        """Whitened observations less those of the base test."""
        stand = self.stand if q is None else shifted(self.stand, q)
        return self._white(*observed(stand, hidden)) - self.zero

    def _slopes_at(self, q: Array) -> Slopes:
        physics = [self._tangent(i, q) for i in range(len(NUISANCES))]
        tangents = np.column_stack([*physics, self._of_sensors])
        return Slopes(tangents, *np.linalg.qr(np.vstack([tangents * self.priors, np.eye(len(self.priors))])))

    def _tangent(self, i: int, q: Array) -> Array:
        step = np.zeros(len(NUISANCES))
        step[i] = NUISANCES[i][2]
        up = self.response((), q + step)
        return (up - self.response((), q - step)) / (2.0 * step[i])

    def _sensor_tangents(self) -> list[Array]:
        out = []
        for i in range(len(s.CHANNELS)):
            for values in (np.ones(len(self._base_means)), self._base_means[:, i]):
                means = np.zeros_like(self._base_means)
                means[:, i] = values
                out.append(self.observer.whitened(means, self.base))
        return out

    def _later(self, channels: Array) -> Array:
        """The opening a millisecond later than thought, per second."""
        late = np.vstack([channels[:1], channels[:-1]])
        return (self.observer.whitened(self.observer.means(late, self.base), self.base) - self.zero) / kernel.STEP

    def quick_fit(self, target: Array, most: int = 4) -> Fit:
        """The base model fitted to a response: steps on the tangents of the base, each checked by a run.

        Near the least chi-square for most effects, and far above it where a bent valley of the nuisances follows the
        effect, as a and n do a regression that depends on pressure.
        """
        best = Fit(target, np.zeros(len(self.priors)), float(target @ target), self.slopes)
        for _ in range(most):
            before, best = best, self._stepped(target, best, (1.0, 0.4, 0.1))
            if before.chi2 - best.chi2 < 0.02 * best.chi2:
                break
        return best

    def fit(self, target: Array) -> Fit:
        """The base model fitted to a response to the end."""
        return self._ended(target, self.quick_fit(target))

    def _ended(self, target: Array, fit: Fit) -> Fit:
        """A fit followed to the end: every step on tangents of its own."""
        for _ in range(MOST_STEPS):
            before = replace(fit, slopes=self._slopes_at(fit.nuisances[: len(NUISANCES)]))
            fit = self._stepped(target, before, (1.0, 0.5, 0.2, 0.05))
            if before.chi2 - fit.chi2 < CONVERGED * fit.chi2:
                break
        return fit

    def lowest(self, hidden: tuple[Hidden, ...]) -> Fit:
        """The best of the fits that start at other exponents of regression, too.

        a and n may have a second valley, which no step leads to (seen where regression depends on pressure).
        """
        target = self.response(hidden)
        first = best = self.fit(target)
        for away in VALLEYS:
            try:
                start = self._at_exponent(target, first, away)
                if start.chi2 < NOT_HOPELESS * best.chi2:
                    best = min(best, self._ended(target, start), key=_chi2)
            except ArithmeticError:  # there the engine does not run
                continue
        if any("grain" in h.effect.equations for h in hidden):
            lowest = min((self._along_valley(target, first, stride) for stride in (STRIDE, -STRIDE)), key=_chi2)
            best = min(best, self._ended(target, lowest), key=_chi2)
        return best

    def _along_valley(self, target: Array, fit: Fit, stride: float) -> Fit:
        """The best of the fits at exponents further and further to one side; all else follows at each."""
        best = fit
        for _ in range(STRIDES):
            try:
                fit = self._followed(target, self._at_exponent(target, fit, stride))
            except ArithmeticError:  # there the engine does not run
                break
            best = min(best, fit, key=_chi2)
            if fit.chi2 > LEFT * best.chi2:
                break
        return best

    def _followed(self, target: Array, fit: Fit) -> Fit:
        """A fit at its exponent to which all else has moved."""
        for _ in range(MOST_FOLLOWING):
            slopes = self._slopes_at(fit.nuisances[: len(NUISANCES)])
            moved = self._at_exponent(target, replace(fit, slopes=slopes), 0.0)
            if moved.chi2 > FOLLOWED * fit.chi2:
                return min(moved, replace(fit, slopes=slopes), key=_chi2)
            fit = moved
        return fit

    def _at_exponent(self, target: Array, fit: Fit, away: float) -> Fit:
        """A fit with n elsewhere; what else is uncertain has followed as far as tangents tell."""
        columns = fit.slopes.q @ fit.slopes.r
        moved = fit.nuisances / self.priors
        shift = away / self.priors[EXPONENT]
        moved[EXPONENT] += shift
        others = np.delete(np.arange(moved.size), EXPONENT)
        right = self._right(fit) - columns[:, EXPONENT] * shift
        moved[others] += np.linalg.lstsq(columns[:, others], right, rcond=None)[0]
        return self._at(target, fit.slopes, moved * self.priors)

    def _stepped(self, target: Array, fit: Fit, shares: Sequence[float]) -> Fit:
        """The first share of a step that fits better; the fit itself where none does."""
        step = self._step(fit)
        for share in shares:
            trial = self._at(target, fit.slopes, fit.nuisances + share * step)
            if trial.chi2 < fit.chi2:
                return trial
        return fit

    def _at(self, target: Array, slopes: Slopes, theta: Array) -> Fit:
        count = len(NUISANCES)
        moved = self.response((), theta[:count]) + self._of_sensors @ theta[count:]
        residual = target - moved
        return Fit(residual, theta, float(residual @ residual + np.sum((theta / self.priors) ** 2)), slopes)

    def _right(self, fit: Fit) -> Array:
        return np.concatenate([fit.residual, -fit.nuisances / self.priors])

    def _step(self, fit: Fit) -> Array:
        """To the least squares of the linear problem; columns are in units of their priors."""
        return np.asarray(solve_triangular(fit.slopes.r, fit.slopes.q.T @ self._right(fit))) * self.priors

    def d_prime(self, hidden: tuple[Hidden, ...], quick: bool = False) -> tuple[float, Fit]:
        """Detectability of a hidden effect (or of all of them together) against none."""
        target = self.response(hidden)
        fit = self.quick_fit(target) if quick else self.fit(target)
        return sqrt(fit.chi2), fit

    def column(self, name: str) -> Array:
        """A rival's response at its nominal strength on the base test."""
        if name not in self._columns:
            self._columns[name] = self.response((self.rivals[name],))
        return self._columns[name]

    def against(self, fit: Fit, name: str) -> float:
        """d' left where a rival of any strength may explain the test: linear, then once more at the size found."""
        rival = self.rivals[name]
        chi2, amount = self._with_rival(fit, self.column(name))
        if amount <= 0.0 or fit.chi2 - chi2 < 1e-3 * fit.chi2:
            return sqrt(fit.chi2)
        strength = min(amount * rival.effect.nominal, rival.effect.most)
        if amount > 1.5 or amount < 0.3:
            at = self.response((rival.at(strength),), fit.nuisances[: len(NUISANCES)])
            plain = self.response((), fit.nuisances[: len(NUISANCES)])
            chi2 = min(self._with_rival(fit, at - plain, rival.effect.most / strength)[0], fit.chi2)
        return sqrt(max(chi2, 0.0))

    def _with_rival(self, fit: Fit, column: Array, most: float = np.inf) -> tuple[float, float]:
        """Least chi-square, and the rival's amount, from 0 to ``most``, at which it is had."""
        right, c = self._right(fit), np.concatenate([column, np.zeros(len(self.priors))])
        q = fit.slopes.q
        right, c = (v - q @ (q.T @ v) for v in (right, c))
        square = float(c @ c)
        amount = min(max(float(c @ right) / square, 0.0), most) if square > 1e-12 else 0.0
        rest = right - amount * c
        return min(float(rest @ rest), fit.chi2), amount

    def solve(self, hidden: Hidden, target: float, among: Sequence[str] = ()) -> tuple[Hidden, float, Fit]:
        """The strength, up to the most plausible, at which d' (with rivals: the least against them) is ``target``.

        Sought with quick fits, and once more with whole ones where these see another d'; anew where the test has
        another time axis.
        """
        found, d, fit = self._solved(hidden, target, among)
        other = self.on_axis_of((found,), fit)
        return (found, d, fit) if other is self else other._solved(found, target, among, found.strength)

    def _solved(
        self, hidden: Hidden, target: float, among: Sequence[str], start: float | None = None
    ) -> tuple[Hidden, float, Fit]:
        def measure(x: Hidden, quick: bool = False) -> tuple[float, Fit]:
            d, fit = self.d_prime((x,), quick)
            return (min([d, *(self.against(fit, r) for r in among)]) if among else d), fit

        found, seen, _ = _bracketed(hidden, target, partial(measure, quick=True), start)
        d, fit = measure(found)
        if abs(np.log(max(d, 1e-9) / seen)) < ALIKE:
            return found, d, fit
        return _bracketed(found, target, measure, found.strength)

    def on_axis_of(self, hidden: tuple[Hidden, ...], fit: Fit) -> Detector:
        """This one, or where the fire of the test does not last as long as on its axis, one on that of the test's fit.

        Blocks are those of the axis: a phase that is longer there than in the test would tell more than was measured.
        """
        here, there = (fire_after_liquid(true) for true in (self.observer.reference, observed(self.stand, hidden)[1]))
        if here == there or abs(here - there) < LASTS_ALIKE * max(abs(here), abs(there)):
            return self
        axis = shifted(self.stand, fit.nuisances[: len(NUISANCES)])
        return Detector(self.stand, self.instruments, list(self.rivals.values()), axis)


def _chi2(fit: Fit) -> float:
    return fit.chi2


def fire_after_liquid(true: Histories) -> float:
    """Seconds of fire without liquid (negative: of liquid without fire) until the fuel is gone; 0 if it is not."""
    return float(true.t_fuel_out - true.t_v) if np.isfinite(true.t_fuel_out) else 0.0


def _bracketed(
    hidden: Hidden, target: float, measure: Callable[[Hidden], tuple[float, Fit]], start: float | None = None
) -> tuple[Hidden, float, Fit]:
    """Secants in the logarithms of strength and d'; they are nearly proportional."""
    most, strength = hidden.effect.most, hidden.effect.nominal if start is None else start
    seen: list[tuple[float, float]] = []
    best: tuple[float, Hidden, float, Fit] | None = None
    for _ in range(9):
        x = hidden.at(strength)
        d, fit = measure(x)
        seen.append((strength, d))
        miss = abs(np.log(max(d, 1e-9) / target))
        if best is None or miss < best[0]:
            best = (miss, x, d, fit)
        if miss < 0.03 or (strength >= most and d < target):
            break
        strength = _next(seen, target, most)
    assert best is not None
    return best[1:]


def _next(seen: list[tuple[float, float]], target: float, most: float) -> float:
    below = max((p for p in seen if p[1] < target), default=None)
    above = min((p for p in seen if p[1] >= target), default=None)
    if below and above:
        (p0, d0), (p1, d1) = below, above
        w = np.log(target / max(d0, 1e-9)) / np.log(d1 / max(d0, 1e-9))
        return float(np.exp(np.log(p0) + np.clip(w, 0.1, 0.9) * np.log(p1 / p0)))
    p, d = below or above  # type: ignore[misc]
    return min(p * float(np.clip(target / max(d, 1e-9), 0.03, 30.0)), most)


def _sensor_priors(sensor: se.Sensor) -> tuple[float, float]:
    accuracy = se.ACCURACY[sensor.channel]
    zero = 100.0 if sensor.channel == "thrust" else accuracy * sensor.size
    return zero, accuracy / se.FULL_SCALE[sensor.channel]


def rivals(rng: np.random.Generator) -> list[Hidden]:
    """Every effect of the generator, with a shape each."""
    return [drawn(e, rng) for e in EFFECTS.values()]


LIBRARY_NAMES = tuple(e.name for e in LIBRARY)
