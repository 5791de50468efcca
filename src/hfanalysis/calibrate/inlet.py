"""What reaches the injector, and its discharge coefficient by laws that know that it has flashed.

The liquid leaves the tank saturated; what the feed line loses of pressure lets it boil at constant enthalpy, so that
vapor comes along. Each law has C_d = C_i times the integral of C_i's own flux over that of the law, from t_feed to t_v:
the same mass through the same holes. While the line fills, the state before the injector is none that a throttle makes;
what C_d would be with that time in is a bound of its error.

- ``spi``: incompressible, G = sqrt(2 rho (p_run - p_c)), with the density of the mixture at p_run;
- ``hem``: homogeneous equilibrium, isentropic from p_run and the inlet's quality, at its largest flux;
- ``dyer``: (kappa G_spi + G_hem) / (1 + kappa), their mean where the inlet is saturated (kappa = 1).

C_i is on the density of the tank's liquid, which does not reach the injector: an effective coefficient.

All by one equation of state (CoolProp), whatever table the test's engine has: energies, densities and pressures have to
fit each other here, and those of the report's correlations do so to 2 to 5 % only (docs/properties.md).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.calibrate.systematic import UNIFORM, other_table
from hfanalysis.calibrate.uncertainty import SEED, Draws
from hfanalysis.products.calibration import Inlet
from hfanalysis.quantity import DERIVED, NORMAL_95, NOT_IDENTIFIABLE, Quantity
from hfanalysis.thermo.nitrous import saturation as saturation_of
from hfanalysis.thermo.saturation import Saturation
from hfanalysis.thermo.two_phase import (
    Throttled,
    blended_flux,
    equilibrium_flux,
    incompressible_flux,
    non_equilibrium,
    throttled,
)

POINTS = 200
"""Block means of the pressures over the liquid phase. Evidence: HF5: 100 and 400 give the same C_d to 1e-4."""

LAWS = ("spi", "hem", "dyer")
"""By which C_d is told."""


@dataclass(frozen=True)
class Feed:
    """Pressures of the liquid phase: block means [Pa] of ``tank``, ``run`` and ``chamber`` over ``step`` [s], (n,).

    ``full``: from which of them on the line is full.
    """

    step: Array
    tank: Array
    run: Array
    chamber: Array
    full: NDArray[np.bool_]

    @classmethod
    def of(cls, histories: MeasuredPressures, t_feed: float, t_v: float) -> Feed:
        """From the opening to t_v [s]."""
        edges = np.linspace(0.0, t_v, POINTS + 1)
        time = histories.time
        middle = 0.5 * (edges[1:] + edges[:-1])
        tank, run, chamber = (_means(time, x, edges) for x in (histories.tank, histories.run, histories.chamber))
        return cls(np.diff(edges), tank, run, chamber, middle >= t_feed)

    def with_bias(self, name: str, bias: float) -> Feed:
        """One of the pressures off by a ``bias`` [Pa]."""
        return replace(self, **{name: getattr(self, name) + bias})

    def inlet(self, saturation: Saturation) -> Throttled:
        """What reaches the injector at each of them."""
        low, high = saturation.pressure_range
        warm = saturation.temperature(np.clip(self.tank, low, high))
        return throttled(saturation, warm, np.clip(self.run, low, high))

    def flux(self, saturation: Saturation, law: str) -> Array:
        """G dt [kg/m^2], (n,), by a law, or by "tank": that of C_i."""
        inlet = self.inlet(saturation)
        if law == "tank":
            tank = saturation.liquid_density(inlet.liquid)
            return incompressible_flux(tank, self.run, self.chamber) * self.step
        behind = np.minimum(self.chamber, self.run)
        plain = incompressible_flux(inlet.density, self.run, behind)
        if law == "spi":
            return plain * self.step
        flashing = np.where(behind < self.run, equilibrium_flux(saturation, inlet, behind), 0.0)
        if law == "hem":
            return flashing * self.step
        kappa = non_equilibrium(inlet, saturation.pressure(inlet.liquid), behind)
        return blended_flux(kappa, plain, flashing) * self.step

    def share(self, of_C_i: Saturation, saturation: Saturation, law: str, filling: bool = False) -> float:
        """C_d over C_i [-], which is by a table of its own, once the line is full, or with the time of its
        ``filling``."""
        seen = np.ones(self.step.size, dtype=bool) if filling else self.full
        by_tank, by_law = (float(x[seen].sum()) for x in (self.flux(of_C_i, "tank"), self.flux(saturation, law)))
        return by_tank / by_law if by_law > 0.0 else float("nan")


def _means(time: Array, value: Array, edges: Array) -> Array:
    """Means over cells, of straight lines through the samples."""
    total = np.concatenate([[0.0], np.cumsum(0.5 * (value[1:] + value[:-1]) * np.diff(time))])
    return np.asarray(np.diff(np.interp(edges, time, total)) / np.diff(edges))


def inlet_of(
    feed: Feed, saturation: Saturation, bias: Mapping[str, float], discharge: Quantity, C_i: float, draws: Draws
) -> tuple[Inlet, dict[str, Quantity]]:
    """The state before the injector, means over the liquid phase from t_feed on, and C_d by law.

    ``saturation``: the table that C_i is by.
    ``bias`` [Pa]: standard deviation of ``tank``, ``run`` and ``chamber``. ``discharge``: C_i as it is told; ``C_i``
    [-] as it is without effects; ``draws`` have its errors.
    """
    fluid = saturation_of("coolprop")
    states = _states(feed, fluid, bias)
    if not C_i > 0.0 or discharge.value is None:
        none = Quantity.absent(discharge.reason or "no C_i to take it from", verdict=NOT_IDENTIFIABLE)
        return states, dict.fromkeys(LAWS, none)
    return states, {law: _discharge(feed, saturation, fluid, bias, C_i, draws, law) for law in LAWS}


def _states(feed: Feed, saturation: Saturation, bias: Mapping[str, float]) -> Inlet:
    units = {"subcooling": "K", "quality": "", "density": "kg/m^3", "back_pressure": ""}
    return Inlet(**{name: _mean(feed, saturation, bias, name, unit) for name, unit in units.items()})


def _course(feed: Feed, saturation: Saturation, name: str) -> Array:
    if name == "back_pressure":
        return np.where(feed.run > 0.0, feed.chamber / np.where(feed.run > 0.0, feed.run, 1.0), np.nan)
    return np.asarray(getattr(feed.inlet(saturation), name))


def _mean(feed: Feed, saturation: Saturation, bias: Mapping[str, float], name: str, unit: str) -> Quantity:
    """Of a course over the liquid phase, once the line is full, with its range."""
    course = _course(feed, saturation, name)
    seen = course[feed.full & np.isfinite(course)]
    if not seen.size:
        return Quantity.absent("no sample between t_feed and t_v has pressures of saturated nitrous oxide")

    def of(other: Feed, table: Saturation) -> float:
        return float(np.nanmean(_course(other, table, name)[feed.full]))

    value, std = float(seen.mean()), _spread(feed, saturation, bias, of)
    why = f"mean from t_feed to t_v, {seen.min():.3g} to {seen.max():.3g}"
    if name != "back_pressure":
        why += "; isenthalpic from the tank's liquid to p_run"
    low, high = value - NORMAL_95 * std, value + NORMAL_95 * std
    return Quantity(value, unit, std, (max(low, 0.0) if name == "quality" else low, high), verdict=DERIVED, why=why)


def _spread(
    feed: Feed, saturation: Saturation, bias: Mapping[str, float], of: Callable[[Feed, Saturation], float]
) -> float:
    """Standard deviation by the biases of the pressures and the other table of properties."""
    return float(np.linalg.norm([moved for _, moved in _slopes(feed, saturation, bias, of)]))


def _slopes(
    feed: Feed, saturation: Saturation, bias: Mapping[str, float], of: Callable[[Feed, Saturation], float]
) -> list[tuple[str, float]]:
    """What each error moves by one standard deviation."""
    plain = of(feed, saturation)
    moved = [(name, of(feed.with_bias(name, std), saturation) - plain) for name, std in bias.items()]
    return [*moved, ("properties", (of(feed, other_table(saturation)) - plain) / UNIFORM)]


def _discharge(
    feed: Feed,
    of_C_i: Saturation,
    saturation: Saturation,
    bias: Mapping[str, float],
    C_i: float,
    draws: Draws,
    law: str,
) -> Quantity:
    """C_d by a law, with what C_i and the pressures leave open."""

    def ratio(other: Feed, table: Saturation) -> float:
        return other.share(of_C_i, table, law)

    share = ratio(feed, saturation)
    if not np.isfinite(share):
        return Quantity.absent("the pressures are none of saturated nitrous oxide", verdict=NOT_IDENTIFIABLE)
    drawn = draws.values["C_i"] / C_i
    own = np.random.default_rng(SEED + 2)
    for name, moved in _slopes(feed, saturation, bias, ratio):
        z = _multiples(draws, name, bias.get(name, 1.0), own)
        drawn = drawn * (1.0 + z * moved / share)
    filling = feed.share(of_C_i, saturation, law, filling=True) / share - 1.0
    drawn = drawn * (1.0 + own.uniform(-1.0, 1.0, drawn.size) * (filling if np.isfinite(filling) else 0.0))
    value, good = C_i * share, drawn[np.isfinite(drawn)]
    if good.size < 10:
        return Quantity.absent("the repetitions of the calibration have no C_i", verdict=NOT_IDENTIFIABLE)
    low, middle, high = np.quantile(good, (0.025, 0.5, 0.975))
    interval = (float(value * (1.0 + low - middle)), float(value * (1.0 + high - middle)))
    return Quantity(
        value, "", value * float(good.std(ddof=1)), interval, verdict=DERIVED, why=_why(feed, saturation, law)
    )


def _why(feed: Feed, saturation: Saturation, law: str) -> str:
    """What the law takes the flow for."""
    if law != "dyer":
        return {
            "spi": "incompressible, with the density of the mixture at p_run",
            "hem": "homogeneous equilibrium, isentropic from p_run and the inlet's quality, at its largest flux",
        }[law]
    cold = float((feed.inlet(saturation).quality[feed.full] == 0.0).mean())
    if cold == 0.0:
        return "mean of spi and hem: kappa = 1, as the inlet is saturated"
    part = f"but for {100.0 * cold:.0f} % of the time, when the inlet is subcooled"
    return f"(kappa G_spi + G_hem) / (1 + kappa); kappa = 1 {part}"


def _multiples(draws: Draws, name: str, std: float, own: np.random.Generator) -> Array:
    """What was drawn of this error, in standard deviations; its own numbers where nothing was."""
    size = draws.values["C_i"].size
    if name == "properties":
        return own.standard_normal(size)
    drawn = draws.inputs.get(f"p_{name}")
    return drawn / std if drawn is not None and std > 0.0 else own.standard_normal(size)
