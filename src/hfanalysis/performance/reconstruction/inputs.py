"""What a reconstruction starts from: a burn in its window, and all that it may be off by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

from hfanalysis.arrays import Array
from hfanalysis.performance.measured import Fire
from hfanalysis.products.calibration import TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog

SIGNS = {"pressure": 1.0, "throat": 1.0, "oxidizer": -1.0, "efficiency": -1.0}
"""Sense in which each moves p A_t / (efficiency * oxidizer flow). Source: that expression."""


@dataclass(frozen=True)
class Shape:
    """Areas [m^2], radii and length [m], volume before and behind the grain [m^3], density [kg/m^3], and the enthalpy
    of the oxidizer [J/kg]; no regression law."""

    throat_area: float
    exit_area: float
    port_radius: float
    outer_radius: float
    grain_length: float
    dead_volume: float
    fuel_density: float
    oxidizer_enthalpy: float

    @property
    def fuel_mass(self) -> float:
        """Of the whole grain [kg]."""
        return self.fuel_density * pi * self.grain_length * (self.outer_radius**2 - self.port_radius**2)


@dataclass(frozen=True)
class Firing:
    """A test as it was measured: ``oxidizer`` flow [kg/s] and the ``measured`` histories [SI], (n,) each at ``time``
    [s after the opening]."""

    log: TestLog
    segments: Segments
    definition: TestDefinition
    calibration: TankConstants
    fire: Fire
    shape: Shape
    time: Array
    oxidizer: Array
    measured: Mapping[str, Array]

    @property
    def ambient(self) -> float:
        """[Pa]."""
        return self.definition.ambient_pressure.value


@dataclass(frozen=True)
class Error:
    """Of the logarithm of one of SIGNS: ``shape`` (n,) is what one standard deviation does; ``mean`` in those."""

    of: str
    shape: Array
    mean: float = 0.0


@dataclass(frozen=True)
class Inputs:
    """A burn in its window, (n,) at ``time`` [s after the opening].

    ``pressure`` before the nozzle [Pa], ``oxidizer`` flow [kg/s], ``throat`` area [m^2], ``stored``: what fills the
    chamber [kg/s]; ``white``: standard deviation of each sample of the pressure, as share of it [-]. ``fuel`` burnt in
    the window and its standard deviation [kg], None where nobody says. ``efficiency``: of c*, as taken beforehand, and
    the standard deviation of its logarithm [-].
    """

    time: Array
    pressure: Array
    oxidizer: Array
    throat: Array
    stored: Array
    white: Array
    fuel: tuple[float, float] | None
    efficiency: tuple[float, float]
    errors: Mapping[str, Error] = field(default_factory=dict)

    @property
    def share(self) -> Array:
        """Of the window that has passed [-], (n,)."""
        return (self.time - self.time[0]) / (self.time[-1] - self.time[0])
