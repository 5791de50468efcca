"""The engines that benchmarks and tests run: the report's design point and the one of its hot fires."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi, radians

from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.unsteady import Engine
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.steady_design.sizing import DipTube, size_for_ullage
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY
from hfanalysis.thermo.combustion_table import CombustionTable, build
from hfanalysis.thermo.nitrous import saturation

HARDWARE = {
    "grain_length": 0.610,
    "outer_radius": 0.039497,
    "dead_volume": 1.103e-3,
    "throat_area": pi * 0.0233**2,
    "exit_area": pi * 0.0381**2,
}
"""Chamber and nozzle, the same in the design and on the stand (report, tables 3.1 and 3.2)."""

HOLES, HOLE_AREA = 22, 3.142e-6
"""Of the injector on the stand [m^2 each]."""


def maelstrom(combustion: CombustionTable | None = None) -> Engine:
    """The report's design point (tables 3.1 and 3.2), under the report's conventions."""
    source = saturation("report")
    tank = size_for_ullage(source, 7.035, 298.15, 0.128194, DipTube(6.35e-3, 4.572e-3), 0.2)
    return Engine(
        saturation=source,
        combustion=combustion or build(),
        feed=FeedSystem(tank.volume, 3.79e-5, constant_losses=(0.345e5, 0.345e5)),
        oxidizer_mass=7.035,
        temperature=298.15,
        polytropic_exponent=None,
        fuel_mass=1.639,
        fuel_density=900.0,
        a=1.32e-4,
        n=0.555,
        vehicle=Vehicle(52.5, 0.529, 19478e-6, radians(6.0), 1402.0),
        oxidizer_enthalpy=PROPEP_OXIDIZER_ENTHALPY,
        **HARDWARE,
    )


def hf5_like() -> Engine:
    """An engine on a stand like that of the report's Hot Fire 5, under the report's conventions for the chemistry."""
    return Engine(
        saturation=saturation("coolprop"),
        combustion=build(),
        feed=FeedSystem(16.5e-3, HOLES * HOLE_AREA * 0.2926, loss_factor=6.4e8),
        oxidizer_mass=8.35,
        temperature=293.0,
        polytropic_exponent=1.1,
        fuel_mass=1.594,
        fuel_density=788.9,
        a=1.0e-4,
        n=0.555,
        ambient_pressure=100_900.0,
        oxidizer_enthalpy=PROPEP_OXIDIZER_ENTHALPY,
        **HARDWARE,
    )


@cache
def _on_stand() -> Engine:
    return replace(hf5_like(), oxidizer_enthalpy=None)


def engine_on_stand(**changes: object) -> Engine:
    """HF5's engine with constants near those that its test gives, under the corrected conventions."""
    return replace(_on_stand(), **changes)  # type: ignore[arg-type]
