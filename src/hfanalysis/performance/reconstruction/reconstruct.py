"""The reconstruction of a test: histories with their bands for performance.h5, and what validation.json says of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.engine.grain import oxidizer_flux
from hfanalysis.errors import AbsentError
from hfanalysis.performance.reconstruction.gathered import Gathered, gather
from hfanalysis.performance.reconstruction.inputs import Firing
from hfanalysis.performance.reconstruction.law import exponent_and_factor
from hfanalysis.performance.reconstruction.posterior import Courses, courses
from hfanalysis.performance.reconstruction.theory import MIXTURES, Theory
from hfanalysis.products.reconstruction import Reconstruction
from hfanalysis.quantity import CONDITIONAL, Quantity
from hfanalysis.record.sections import fuel_of

FAINT = 10.0
"""Per cent of OF that go with one of p_c, from which on a mixture is not told. Source: the technique's own measure: at
ten a sensor of 1 % tells OF no better than by 10 %."""

WITHIN = 1.5
"""Factor within which OF is told. Source: by choice; c* moves by some per cent over it."""

APART = 0.15
"""Difference of the mean logarithm of OF from which two groups of courses are two. Source: by choice: a group is denser
than that where the gauge tells anything."""

SEVERAL = 0.05
"""Part of all courses that counts as another answer. Source: the part outside of a 95 % band."""

OFF = 5.0
"""Standard deviations of an input from which on it is wrong and not off. Source: one in a million."""

REACH = (0.6, 1.1)
"""Of a c* efficiency [-]. Source: below 0.6 the fire is out, above 1 by more than errors nothing burns."""

ENDS = (0.025, 0.975)
"""Parts of all courses below the ends of a band."""


@dataclass(frozen=True)
class Reconstructed:
    """``time`` (n,) [s after the opening]; histories (n,) by name, with 95 % bands; ``told`` (n,): 1 where O/F is."""

    product: Reconstruction
    time: Array = field(default_factory=lambda: np.zeros(0))
    histories: dict[str, tuple[Array, Array, Array]] = field(default_factory=dict)
    told: Array = field(default_factory=lambda: np.zeros(0))


def reconstruct(firing: Firing) -> Reconstructed:
    """Of a test with its chamber's pressure; where it cannot be had the product says why."""
    try:
        if "p_chamber" not in firing.measured:
            raise AbsentError(firing.log.lacks("p_chamber"))
        shape = firing.shape
        theory = Theory.of(shape.oxidizer_enthalpy, shape.throat_area, shape.exit_area, fuel_of(firing.definition.fuel))
        gathered = gather(firing, theory)
        found = courses(gathered.inputs, theory)
        _fits(gathered, found)
    except (AbsentError, ArithmeticError, ValueError) as missing:
        return Reconstructed(Reconstruction(variant=None, reason=str(missing)))
    return _told(firing, gathered, found, theory)


def _fits(gathered: Gathered, found: Courses) -> None:
    """Raises AbsentError where the inputs contradict each other."""
    inputs = gathered.inputs
    burnt = float(np.median(np.trapezoid(inputs.oxidizer[:, None] / found.of_ratio, inputs.time, axis=0)))
    efficiency = float(np.median(found.efficiency))
    missed = abs(burnt - inputs.fuel[0]) / inputs.fuel[1] if inputs.fuel is not None else 0.0
    if REACH[0] < efficiency < REACH[1] and max(missed, float(np.abs(found.pulls).max())) < OFF:
        return
    fuel = "" if inputs.fuel is None else f" makes {inputs.fuel[0]:.3g} kg of fuel burn; {burnt:.3g} kg are nearest. It"
    raise AbsentError(
        f"no c* efficiency from {REACH[0]:.1f} to {REACH[1]:.1f}{fuel} fits: pressure, throat, oxidizer flow or the "
        "fuel's mass is off"
    )


def _told(firing: Firing, gathered: Gathered, found: Courses, theory: Theory) -> Reconstructed:
    inputs = gathered.inputs
    groups = _groups(found.of_ratio)
    histories = _histories(firing, gathered, found)
    bands = {name: _band(history, groups[0]) for name, history in histories.items()}
    center, low, high = bands["of_ratio"]
    steep = _stiffness(theory, inputs.pressure, center) < FAINT
    told = steep & (high < WITHIN * center) & (low > center / WITHIN)
    factor, exponent = exponent_and_factor(histories["oxidizer_flux"], histories["regression_rate"], told, groups[0])
    product = Reconstruction(
        variant=gathered.variant,
        assumption=gathered.assumption,
        window=(float(inputs.time[0]), float(inputs.time[-1])),
        told=float(told.mean()),
        of_ratio_mean=_quantity(_total(inputs.time, found), groups[0], gathered),
        c_star_efficiency=_quantity(histories["c_star_efficiency"].mean(axis=0), groups[0], gathered),
        throat_radius_change=_change(histories["throat_radius"], gathered),
        a=factor,
        n=exponent,
        nozzle_efficiency=None if gathered.nozzle_efficiency is None else Quantity(gathered.nozzle_efficiency, ""),
        other=None if len(groups) == 1 else _other(found, groups[1]),
    )
    return Reconstructed(product, inputs.time, bands, told.astype(float))


def _groups(of_ratio: Array) -> list[NDArray[np.int64]]:
    """The courses (n, draws) by groups that lie apart, the largest first; those of less than SEVERAL are left out."""
    mean = np.log(of_ratio).mean(axis=0)
    order = np.argsort(mean)
    parts = np.split(order, np.flatnonzero(np.diff(mean[order]) > APART) + 1)
    large = sorted((part for part in parts if part.size >= SEVERAL * mean.size), key=lambda part: -part.size)
    return large or [order]


def _histories(firing: Firing, gathered: Gathered, found: Courses) -> dict[str, Array]:
    """By name, (n, draws)."""
    inputs, shape = gathered.inputs, firing.shape
    fuel = found.oxidizer / found.of_ratio
    steps = np.diff(inputs.time, prepend=inputs.time[0])[:, None]
    before = fuel[:1] * inputs.time[0] * 0.5  # the ignition: the flow rises from nothing
    burnt = before + np.cumsum(steps * fuel, axis=0)
    port = np.sqrt(shape.port_radius**2 + burnt / (shape.fuel_density * pi * shape.grain_length))
    return {
        "of_ratio": found.of_ratio,
        "fuel_flow": fuel,
        "regression_rate": fuel / (2.0 * pi * port * shape.grain_length * shape.fuel_density),
        "port_radius": port,
        "oxidizer_flux": np.asarray(oxidizer_flux(found.oxidizer, port)),
        "c_star": found.pressure * found.throat / (found.oxidizer + fuel - inputs.stored[:, None]),
        "c_star_efficiency": found.efficiency,
        "throat_radius": np.sqrt(found.throat / pi),
    }


def _band(history: Array, group: NDArray[np.int64]) -> tuple[Array, Array, Array]:
    """The middle of the largest group (n,), and the ends of the 95 % interval of all."""
    center = np.median(history[:, group], axis=1)
    low, high = np.quantile(history, ENDS, axis=1)
    return center, np.minimum(low, center), np.maximum(high, center)


def _total(time: Array, found: Courses) -> Array:
    """O/F of all that passes in the window (draws,)."""
    oxidizer, fuel = (np.trapezoid(x, time, axis=0) for x in (found.oxidizer, found.oxidizer / found.of_ratio))
    return np.asarray(oxidizer / fuel)


def _quantity(draws: Array, group: NDArray[np.int64], gathered: Gathered) -> Quantity:
    center, low, high = (float(x[0]) for x in _band(draws[None], group))
    verdict = CONDITIONAL if gathered.variant == "a" else None
    return Quantity(center, "", float(np.std(draws)), (low, high), verdict=verdict, why=gathered.assumption)


def _change(radius: Array, gathered: Gathered) -> Quantity:
    if gathered.grows is None:
        return Quantity.absent("nobody measured the throat afterwards, and there is no thrust to tell it")
    change = radius[-1] - radius[0]
    return Quantity(float(np.median(change)), "m", float(np.std(change)), why=f"by {gathered.grows}")


def _stiffness(theory: Theory, pressure: Array, of_ratio: Array) -> Array:
    """|d ln OF / d ln p| (n,)."""
    left = np.log((1.0 + 1.0 / MIXTURES) * theory.rows(pressure))
    x = np.log(MIXTURES)
    slope = np.gradient(left, x, axis=1)
    at = np.array([np.interp(m, x, row) for m, row in zip(np.log(of_ratio), slope, strict=True)])
    return np.asarray(1.0 / np.maximum(np.abs(at), 1e-6))


def _other(found: Courses, group: NDArray[np.int64]) -> str:
    path = np.median(found.of_ratio[:, group], axis=1)
    efficiency, share = float(np.median(found.efficiency[:, group])), group.size / found.of_ratio.shape[1]
    return (
        f"O/F from {path[0]:.2g} to {path[-1]:.2g} at a c* efficiency of {efficiency:.3f} fits as well, with "
        f"{100.0 * share:.0f} % of the probability"
    )
