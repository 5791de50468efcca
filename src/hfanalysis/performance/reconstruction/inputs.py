"""What a reconstruction starts from: a burn in its window, and all that it may be off by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import Regression, engine_of_test
from hfanalysis.engine.grain import USUAL_N
from hfanalysis.engine.unsteady import Engine
from hfanalysis.errors import AbsentError
from hfanalysis.performance.measured import Fire
from hfanalysis.products.calibration import TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.thermo.nitrous import saturation

SIGNS = {"pressure": 1.0, "throat": 1.0, "oxidizer": -1.0, "efficiency": -1.0, "theory": -1.0}
"""Sense in which each moves p A_t / (efficiency * theory * oxidizer flow). Source: that expression."""


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

    @classmethod
    def of(cls, engine: Engine) -> Shape:
        """That of an engine whose oxidizer enters with a known enthalpy."""
        if engine.oxidizer_enthalpy is None:
            raise AbsentError("the enthalpy of the oxidizer is not known")
        return cls(
            engine.throat_area, engine.exit_area, engine.port_radius, engine.outer_radius, engine.grain_length,
            engine.dead_volume, engine.fuel_density, engine.oxidizer_enthalpy,
        )  # fmt: skip

    @classmethod
    def of_test(cls, definition: TestDefinition, calibration: TankConstants, tank_pressure: float) -> Shape:
        """As test.toml states it, with the tank at ``tank_pressure`` [Pa] at the opening; no law is needed.

        Raises AbsentError naming all that it does not state.
        """
        source = saturation(definition.model.properties)
        temperature = float(source.temperature(min(tank_pressure, 0.999 * source.pressure_range[1])))
        return cls.of(engine_of_test(definition, calibration, temperature, Regression(1.0, USUAL_N[0])))

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
    the standard deviation of its logarithm [-]. ``usual``: course of the logarithm of OF, from 0 on, that is usual for
    such a flow [-], (n,).
    """

    time: Array
    pressure: Array
    oxidizer: Array
    throat: Array
    stored: Array
    white: Array
    fuel: tuple[float, float] | None
    efficiency: tuple[float, float]
    usual: Array
    errors: Mapping[str, Error] = field(default_factory=dict)

    def bent(self, course: Array) -> Array:
        """What a ``course`` (n,) has beside the line between its ends."""
        return np.asarray(course - course[0] - (course[-1] - course[0]) * self.share)

    @property
    def share(self) -> Array:
        """Of the window that has passed [-], (n,)."""
        return np.asarray((self.time - self.time[0]) / (self.time[-1] - self.time[0]))
