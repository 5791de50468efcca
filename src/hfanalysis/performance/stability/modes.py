"""At which frequencies a hybrid engine can swing by itself, from its geometry and its state at the time."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.grain import oxidizer_flux
from hfanalysis.engine.unsteady import Engine
from hfanalysis.performance.flows import Flows, nozzle_along

SLOWER = 0.8
"""Speed of sound over that of the burnt gas, at least: before the end of the grain less is burnt. Source: it goes with
the root of the temperature, of which two thirds are left there."""

COLDER = (0.4, 1.0)
"""Mean temperature of the boundary layer over that of the burnt gas. Source: it lies between the flame's and that of
the fuel's surface."""

DELAY = 2.05
"""Delay of the boundary layer: DELAY L p / ((2 + 1/OF) G R T) [-]. Source: Karabeyoglu et al., J. Propulsion and Power
21(6), 1107 (2005); from memory, not checked against the text."""

TURN = 0.48
"""Its frequency times the delay [-]. Source: the same, as little checked."""


@dataclass(frozen=True)
class Mode:
    """A way to swing: its name, and the frequencies [Hz] that it can have."""

    name: str
    lowest: float
    highest: float

    def has(self, frequency: float, reach: float) -> bool:
        """Whether a frequency [Hz], give or take ``reach`` [Hz], can be it."""
        return self.lowest <= frequency + reach and frequency - reach <= self.highest


@dataclass(frozen=True)
class Chamber:
    """The chamber between two instants: geometry [m, m^3], and ranges (2,) of what changes.

    ``port`` radius [m]; ``sound`` speed in the burnt gas [m/s]; ``delay`` of the boundary layer [s].
    """

    grain_length: float
    outer_radius: float
    pre_volume: float
    post_volume: float
    port: tuple[float, float]
    sound: tuple[float, float]
    delay: tuple[float, float]

    @property
    def length(self) -> float:
        """From the injector to the nozzle [m], volumes before and after the grain as wide as it is."""
        return self.grain_length + (self.pre_volume + self.post_volume) / (pi * self.outer_radius**2)

    def modes(self) -> tuple[Mode, ...]:
        """The intrinsic low frequency of a hybrid, the Helmholtz mode of the volumes at either end of the port, and the
        first longitudinal mode of the whole length."""
        slow, fast = SLOWER * self.sound[0], self.sound[1]
        spring = 1.0 / self.pre_volume + 1.0 / self.post_volume
        helmholtz = [c / (2.0 * pi) * np.sqrt(pi * r**2 / self.grain_length * spring)
                     for c, r in zip((slow, fast), self.port, strict=True)]  # fmt: skip
        return (
            Mode("the intrinsic low frequency of a hybrid", TURN / self.delay[1], TURN / self.delay[0]),
            Mode("the Helmholtz mode of the chamber", float(helmholtz[0]), float(helmholtz[1])),
            Mode("the first longitudinal mode of the chamber", 0.5 * slow / self.length, 0.5 * fast / self.length),
        )


def chamber_between(
    engine: Engine, volumes: tuple[float, float], flows: Flows, pressure: Array, start: float, end: float
) -> Chamber | None:
    """The chamber of an ``engine`` from ``start`` to ``end`` [s]; None where its mixture is not known then.

    ``volumes`` [m^3]: before and after the grain. ``pressure`` [Pa], (n,) at the times of ``flows``.
    """
    ratio = flows.of_ratio
    known = (flows.time >= start) & (flows.time <= end) & np.isfinite(ratio) & (pressure > 0.0)
    if known.sum() < 2 or not min(volumes) > 0.0:
        return None
    gas = nozzle_along(engine, pressure[known], ratio[known], engine.ambient_pressure or 0.0)
    sound = np.sqrt(gas.gamma * gas.heat)
    flux = oxidizer_flux(flows.oxidizer[known], flows.port[known])
    per_heat = DELAY * engine.grain_length * pressure[known] / ((2.0 + 1.0 / ratio[known]) * flux)
    delay = per_heat[None] / (np.array(COLDER)[:, None] * gas.heat)
    if not (np.isfinite(sound).all() and np.isfinite(delay).all()):
        return None
    return Chamber(
        engine.grain_length,
        engine.outer_radius,
        *volumes,
        port=_range(flows.port[known]),
        sound=_range(sound),
        delay=_range(delay),
    )


def _range(values: Array) -> tuple[float, float]:
    return float(values.min()), float(values.max())
