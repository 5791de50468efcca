"""The flight of a simulated engine's rocket, in the quantities of flight.json."""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.unsteady import Burn, Engine
from hfanalysis.flight import summary
from hfanalysis.flight.ascent import Ascent
from hfanalysis.flight.ascent import ascend as ascend_on
from hfanalysis.flight.curve import Curve, even_curve
from hfanalysis.quantity import Quantity
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import Vehicle


def curve_of(engine: Engine, burnt: Burn) -> Curve:
    """Thrust [N] at the altitudes of the burn, and the rocket's mass [kg]; it coasts with its dry mass, as the report
    does."""
    vehicle = flying(engine)
    later = np.flatnonzero(np.diff(burnt.time, prepend=-1.0) > 0.0)
    time, impulse = burnt.time[later], burnt.state("impulse")[later]
    return even_curve(time, impulse, mass(engine, burnt)[later], vehicle.dry_mass)


def flying(engine: Engine) -> Vehicle:
    """The engine's rocket; ValueError for an engine on its stand."""
    if engine.vehicle is None:
        raise ValueError("the engine stands on its bench")
    return engine.vehicle


def mass(engine: Engine, burnt: Burn) -> Array:
    """Of the rocket over the burn [kg], (n,): dry mass, tank, grain, and the gas in the chamber (report, eq. 3.47)."""
    grain = engine.grain.fuel(burnt.state("port_radius"))
    stored = burnt.state("chamber_oxidizer") + burnt.state("chamber_fuel")
    return np.asarray(flying(engine).dry_mass + burnt.state("tank_mass") + grain + stored)


def ascend(engine: Engine, burnt: Burn, rail_length: float | None = None) -> Ascent:
    """From ignition to apogee; ``rail_length`` [m] (None: there is no rail to leave).

    Raises ValueError for a rocket that stays on its pad or leaves the atmosphere model.
    """
    return ascend_on(curve_of(engine, burnt), flying(engine), rail_length)


def flight(
    engine: Engine, burnt: Burn, rail_length: float | None, canopies: tuple[Parachute, Parachute] | str
) -> dict[str, Quantity]:
    """The quantities of a flight, each with its unit [m, s, m/s, m/s^2]; each that cannot be had says why.

    ``rail_length`` [m] (None: not known).
    """
    try:
        flown = ascend(engine, burnt, rail_length)
    except ValueError as error:
        return summary.absent(str(error))
    return summary.quantities(flying(engine), flown, rail_length, canopies)
