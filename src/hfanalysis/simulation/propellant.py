"""The propellant with which the unsteady engine's rocket reaches a target apogee, at the file's O/F and ullage."""

from __future__ import annotations

from collections.abc import Callable

from scipy.optimize import brentq

from hfanalysis.assembly import engine as build
from hfanalysis.engine import unsteady
from hfanalysis.engine.unsteady import Engine
from hfanalysis.flight.ascent import NOT_FROM_PAD
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import Needs
from hfanalysis.simulation import sized
from hfanalysis.simulation.flown import ascend

LOAD_STEP = 1.15
"""Factor by which the load is raised or lowered until the target lies between two apogees [-]."""

LOAD_STEPS = 8
"""How often it is raised or lowered: to three times or a third of the file's load."""


def for_apogee(needs: Needs, engine: Engine, target: float) -> dict[str, Quantity]:
    """Oxidizer and fuel [kg] to load for an apogee ``target`` [m] above the site, and the tank that holds it; or why
    there is no such load."""
    of_ratio = engine.oxidizer_mass / engine.fuel_mass

    def miss(factor: float) -> float:
        loaded = build.scaled(needs, engine, factor * engine.oxidizer_mass, of_ratio)
        return apogee(loaded) - target

    try:
        factor = _root(miss)
    except (ValueError, ArithmeticError) as error:
        reason = f"no load found for {target:.0f} m: {error}"
        return {name: Quantity.absent(reason) for name in ("oxidizer_mass", "fuel_mass", *sized.TANK)}
    return {
        "oxidizer_mass": Quantity(factor * engine.oxidizer_mass, "kg"),
        "fuel_mass": Quantity(factor * engine.fuel_mass, "kg"),
        **sized.tank(needs, factor * engine.oxidizer_mass),
    }


def apogee(engine: Engine) -> float:
    """Of the engine's rocket above its site [m]; 0 where it does not leave its pad."""
    try:
        return ascend(engine, unsteady.burn(engine)).height
    except ValueError as error:
        if str(error) == NOT_FROM_PAD:
            return 0.0
        raise


def _root(miss: Callable[[float], float]) -> float:
    """The factor at which ``miss`` is zero: outwards from 1 in steps, then bisected; ValueError where none is."""
    near, here = 1.0, miss(1.0)
    step = 1.0 / LOAD_STEP if here > 0.0 else LOAD_STEP
    for _ in range(LOAD_STEPS):
        far = near * step
        there = miss(far)
        if here * there <= 0.0:
            return float(brentq(miss, near, far, xtol=1e-6))
        near, here = far, there
    raise ValueError("it lies beyond a third and three times the load of the file")
