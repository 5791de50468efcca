"""All courses of the mixture that a burn allows, each as likely as it is.

A chamber pressure p_c says the flow through the throat, p_c A_t / c*; the oxidizer's share of it is known. So

    (1 + 1 / OF) c*(p_c, OF) = p_c A_t / (efficiency * oxidizer flow)

holds at every moment, and the integral of oxidizer flow over OF is the fuel burnt. The left side falls with OF on the
lean side; from its peak to its valley on the rich side it rises: up to three mixtures fit. Where it is flat, a per cent
of efficiency is ten per cent of OF and more, and a course that fits each sample exactly is none of the engine's.

So the logarithm of OF leads from one end to another as the flow usually has it, with a few slow waves about that; the
errors of all inputs are unknowns beside it. For every pair of ends the rest is linear: how likely the pair is, and what
the rest is, has a closed form (Bayesian linear regression; Bishop, Pattern Recognition and Machine Learning, 3.3). All
branches are in it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.grain import USUAL_N
from hfanalysis.errors import AbsentError
from hfanalysis.performance.reconstruction.inputs import SIGNS, Inputs
from hfanalysis.performance.reconstruction.theory import MIXTURES, Theory

ENDS = np.linspace(np.log(1.0), np.log(40.0), 48)
"""Logarithms of OF [-] from which and to which courses lead. Source: no hybrid burns beyond them."""

USUAL = (float(np.log(6.5)), 0.5)
"""Logarithm of OF in the middle of a burn and its standard deviation, before anything is measured. Source: c* of
nitrous oxide and hydrocarbons is best at 6 to 8, and tests lie from 3 to 12."""

CHANGE = 0.3
"""Standard deviation of the change of the logarithm of OF through a burn, about ``inputs.usual``. Source: there
r goes as G^n with the usual n of :data:`hfanalysis.engine.grain.USUAL_N`; its spread makes 0.3 of a flow that falls by
a third and a port that nearly doubles."""

BEND = 0.04
"""Standard deviation of the first wave of the logarithm of OF about its line; those of the next fall with the square of
their number. Source: of r = a G^n with a flow that falls and a port that opens evenly OF bends by 0.01 to 0.03."""

WAVES = 3
"""Of them. Source: by choice; the third has a standard deviation of 0.4 %."""

PATHS = WAVES + 3
"""Unknowns of a course: what lies between two ENDS, how far OF follows the flow, and the waves."""

ROUGH = 0.004
"""Part of the pressure [-] by which a sample may miss beside its noise. Source: a table of c* read linearly, and flow
that fluctuates."""

UNLIKELY = 14.0
"""Difference of the logarithm of a probability from which a pair of ends is left out. Source: one in a million."""

COARSE = 10.0
"""Times the noise with which a first course is found, from which samples are judged. Source: by choice: a wild sample
pulls no more than its neighbors do."""

WILD = 10.0
"""Times the median miss of all samples beside that course, from which on one is wild. Source: by choice: no spread of
errors of one kind reaches that far."""

TAILS = 4.0
"""Degrees of freedom of a sample's error. Source: by choice, of robust fits (Lange et al., JASA 84, 881 (1989))."""

DRAWS = 500
"""Courses that stand for all."""

ROUNDS = 2
"""Times that a course is expanded anew about itself. Evidence: a third moves OF by less than 0.1 %."""


@dataclass(frozen=True)
class Courses:
    """DRAWS courses (n, DRAWS), as likely each: ``of_ratio`` and ``efficiency`` of c* [-], ``pressure`` [Pa],
    ``oxidizer`` flow [kg/s], ``throat`` area [m^2].

    ``pulls``: of the likeliest, what its errors, efficiency and fuel are off by, in standard deviations.
    """

    of_ratio: Array
    efficiency: Array
    pressure: Array
    oxidizer: Array
    throat: Array
    pulls: Array


@dataclass(frozen=True)
class _Linear:
    """Of each pair of ends: logarithm of its probability (pairs,), unknowns' mean (pairs, k) and covariance
    (pairs, k, k)."""

    probability: Array
    mean: Array
    covariance: Array


class _Problem:
    """Unknowns: the waves of ln OF (PATHS, with what lies between two of ENDS), errors, ln efficiency."""

    def __init__(self, inputs: Inputs, theory: Theory, louder: Array | float = 1.0) -> None:
        self.inputs, share = inputs, inputs.share
        idle = np.flatnonzero(~(inputs.oxidizer > 0.0))
        if idle.size:
            raise AbsentError(
                f"by the pressures nothing passes the injector at {inputs.time[idle[0]]:.2f} s, within the burn"
            )
        width = (ENDS[1] - ENDS[0]) / np.sqrt(12.0)
        k = np.arange(1, WAVES + 1)
        waves = BEND / k**2 * np.sin(np.pi * k * share[:, None])
        flow = USUAL_N[1] * inputs.bent(np.log(inputs.oxidizer))
        self.waves = np.column_stack([width * (1.0 - share), width * share, flow, waves])
        errors = inputs.errors.values()
        shapes = [-SIGNS[error.of] * error.shape for error in errors]
        self.fixed = np.column_stack([*shapes, np.full(share.size, inputs.efficiency[1])])
        self.prior = np.array([*np.zeros(PATHS), *(error.mean for error in errors), 0.0])
        self.table = np.log((1.0 + 1.0 / MIXTURES) * theory.rows(inputs.pressure))
        self.slopes = np.gradient(self.table, np.log(MIXTURES), axis=1)
        usual = inputs.efficiency[0] * theory.at(theory.c_star, inputs.pressure, np.full(share.size, 7.0))
        passed = (inputs.pressure * inputs.throat + usual * inputs.stored) / inputs.oxidizer
        if not (passed > 0.0).all():
            raise AbsentError(
                "the chamber's pressure falls faster than its volume lets it: p_chamber, the clock, or the volume by "
                "[grain] and [chamber] is off"
            )
        self.right = np.log(passed / inputs.efficiency[0])
        self.noise = louder * np.hypot(inputs.white, ROUGH)

    def solve(self, line: Array, unknown: Array | None = None) -> _Linear:
        """About the courses ``line`` (pairs, n), with the waves of ``unknown`` (pairs, k) where they are known."""
        waves = np.zeros((line.shape[0], self.waves.shape[1]))
        if unknown is not None:
            waves = unknown[:, : self.waves.shape[1]]
        x = line + waves @ self.waves.T
        value, slope = self._left(x)
        path = slope[:, :, None] * self.waves
        design = np.concatenate([path, np.broadcast_to(self.fixed, (*x.shape, self.fixed.shape[1]))], axis=2)
        left = self.right - value + np.einsum("cnk,ck->cn", path, waves)
        design, left = design / self.noise[:, None], left / self.noise
        if self.inputs.fuel is not None:
            row, miss = self._fuel(x, waves, *self.inputs.fuel)
            design, left = np.concatenate([design, row[:, None]], axis=1), np.column_stack([left, miss])
        left = left - design @ self.prior
        return _solved(design, left, self.prior)

    def _left(self, x: Array) -> tuple[Array, Array]:
        """Logarithm of the left side and its slope (pairs, n)."""
        grid = np.log(MIXTURES)
        at = np.clip((x - grid[0]) / (grid[1] - grid[0]), 0.0, grid.size - 1.000001)
        i = at.astype(np.int64)
        part, n = at - i, np.arange(x.shape[1])
        value, slope = ((1.0 - part) * t[n, i] + part * t[n, i + 1] for t in (self.table, self.slopes))
        return value, slope

    def _fuel(self, x: Array, waves: Array, fuel: float, std: float) -> tuple[Array, Array]:
        """Row (pairs, k) and what is missed (pairs,) of the logarithm of the fuel burnt, over its deviation."""
        flow = self.inputs.oxidizer * np.exp(-x)
        steps = _steps(self.inputs.time)
        burnt = flow @ steps
        weight = flow * steps / burnt[:, None]
        none = np.zeros(x.shape[1])
        oxidizer = [e.shape if e.of == "oxidizer" else none for e in self.inputs.errors.values()]
        row = np.concatenate([-weight @ self.waves, weight @ np.column_stack([*oxidizer, none])], axis=1)
        miss = np.log(fuel / burnt) + np.einsum("ck,ck->c", row[:, : waves.shape[1]], waves)
        return row * fuel / std, miss * fuel / std

    def missed(self, x: Array, unknown: Array) -> Array:
        """What one course ``x`` (n,) leaves of the pressure, over its noise (n,)."""
        rest = self.right - self._left(x[None])[0][0] - self.fixed @ unknown[self.waves.shape[1] :]
        return np.asarray(rest / np.hypot(self.inputs.white, ROUGH))


def _steps(time: Array) -> Array:
    """Weights (n,) of the trapezoidal rule [s]."""
    steps = np.gradient(time)
    steps[[0, -1]] *= 0.5
    return np.asarray(steps)


def _solved(design: Array, left: Array, prior: Array) -> _Linear:
    square = np.swapaxes(design, 1, 2)
    precision = square @ design + np.eye(prior.size)
    covariance = np.linalg.inv(precision)
    pulled = np.einsum("ckn,cn->ck", square, left)
    moved = np.einsum("ckl,cl->ck", covariance, pulled)
    cost = np.sum(left**2, axis=1) - np.sum(pulled * moved, axis=1)
    return _Linear(
        -0.5 * cost - 0.5 * np.linalg.slogdet(precision)[1], prior + moved, np.asarray(covariance, dtype=np.float64)
    )


def courses(inputs: Inputs, theory: Theory) -> Courses:
    """As likely as the inputs have them."""
    first, last = (end.ravel() for end in np.meshgrid(ENDS, ENDS, indexing="ij"))
    near = np.abs(last - first - inputs.usual[-1]) < 3.0 * CHANGE
    first, last = first[near], last[near]
    lines = first[:, None] * (1.0 - inputs.share) + last[:, None] * inputs.share + inputs.bent(inputs.usual)
    wild = _left_by_best(_Problem(inputs, theory, COARSE), lines)
    louder = np.where(np.abs(wild) > WILD * max(1.0, float(np.median(np.abs(wild)))), COARSE**2, 1.0)
    left = _left_by_best(_Problem(inputs, theory, louder), lines) / louder
    # what is slow and no error of an input has to be noise, some samples' more than others'
    louder = louder * max(1.0, float(np.sqrt(np.mean(left**2)))) * np.sqrt(1.0 + left**2 / TAILS)
    problem = _Problem(inputs, theory, louder)
    return _drawn(problem, *_likely(problem, lines))


def _left_by_best(problem: _Problem, lines: Array) -> Array:
    """What the likeliest of the courses about ``lines`` (pairs, n) leaves (n,), over the samples' own noise."""
    found, probability = _weighed(problem, lines)
    best = int(probability.argmax())
    return problem.missed(lines[best] + problem.waves @ found.mean[best, :PATHS], found.mean[best])


def _weighed(problem: _Problem, lines: Array) -> tuple[_Linear, Array]:
    """What is known with each of the ``lines`` (pairs, n), and the logarithm of its probability (pairs,)."""
    found = problem.solve(lines)
    return found, found.probability + _before(problem.inputs, lines)


def _likely(problem: _Problem, lines: Array) -> tuple[Array, _Linear, Array]:
    """The lines that are not UNLIKELY, and what is known of each."""
    found, probability = _weighed(problem, lines)
    for _ in range(ROUNDS):
        kept = probability > probability.max() - UNLIKELY
        lines, probability = lines[kept], probability[kept]
        found = problem.solve(lines, found.mean[kept])
        probability = found.probability + _before(problem.inputs, lines)
    return lines, found, probability


def _before(inputs: Inputs, lines: Array) -> Array:
    """Logarithm of the probability of lines (pairs, n) before anything is measured."""
    first, last = lines[:, 0], lines[:, -1]
    middle, change = (0.5 * (first + last) - USUAL[0]) / USUAL[1], (last - first - inputs.usual[-1]) / CHANGE
    return np.asarray(-0.5 * (middle**2 + change**2))


def _drawn(problem: _Problem, lines: Array, found: _Linear, probability: Array) -> Courses:
    """DRAWS of all; each pair of ends as often as it is likely."""
    inputs, r = problem.inputs, np.random.default_rng(0)
    weight = np.exp(probability - probability.max())
    summed = np.cumsum(weight) / weight.sum()
    which = np.searchsorted(summed, (np.arange(DRAWS) + 0.5) / DRAWS)
    root = np.linalg.cholesky(found.covariance[which])
    normal = r.standard_normal((DRAWS, problem.prior.size))
    unknown = found.mean[which] + np.einsum("dkl,dl->dk", root, normal)
    mixture = lines[which] + unknown[:, :PATHS] @ problem.waves.T
    moved = dict.fromkeys(SIGNS, np.zeros((inputs.time.size, DRAWS)))
    for i, error in enumerate(inputs.errors.values()):
        moved[error.of] = moved[error.of] + error.shape[:, None] * unknown[:, PATHS + i]
    efficiency = inputs.efficiency[0] * np.exp(inputs.efficiency[1] * unknown[:, -1])
    best = found.mean[int(probability.argmax())]
    return Courses(
        np.exp(mixture).T,
        efficiency * np.exp(moved["efficiency"]),
        inputs.pressure[:, None] * np.exp(moved["pressure"]),
        inputs.oxidizer[:, None] * np.exp(moved["oxidizer"]),
        inputs.throat[:, None] * np.exp(moved["throat"]),
        best[PATHS:],
    )
