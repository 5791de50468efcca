"""An engine on a stand like the one of the report's hot fires, for tests."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi

from hfanalysis.engine.blowdown import FeedSystem
from hfanalysis.engine.unsteady import Engine
from hfanalysis.thermo.combustion_table import build
from hfanalysis.thermo.nitrous import saturation


@cache
def _engine() -> Engine:
    return Engine(
        saturation=saturation("coolprop"),
        combustion=build(),
        feed=FeedSystem(16.5e-3, 22 * 3.142e-6 * 0.2926, loss_factor=6.4e8),
        oxidizer_mass=8.35,
        temperature=293.0,
        polytropic_exponent=1.1,
        fuel_mass=1.594,
        grain_length=0.61,
        outer_radius=0.039497,
        fuel_density=788.9,
        a=1.0e-4,
        n=0.555,
        dead_volume=1.103e-3,
        throat_area=pi * 0.0233**2,
        exit_area=pi * 0.0381**2,
        ambient_pressure=100_900.0,
    )


def engine_on_stand(**changes: object) -> Engine:
    """HF5's engine with constants near those that its test gives."""
    return replace(_engine(), **changes)  # type: ignore[arg-type]
