"""What tank, grain and chamber hold over a firing, and what that makes of its rocket's balance."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.shape import built, places
from hfanalysis.flight.stability import Launch, StabilityRuns, stability
from hfanalysis.measured_flight.firing import Firing
from hfanalysis.record.definition import TestDefinition
from hfanalysis.rocket.balance import Held, engine_center
from hfanalysis.thermo.nitrous import saturation

Progress = Callable[[str, float | None], None]

UNDIVIDED = "how the oxidizer divides into liquid and vapor is not known: taken as all liquid"

ROOM_TEMPERATURE = 293.15
"""Of the liquid [K] where the tank's is not known. Source: by choice, 20 degC."""


def held(firing: Firing, definition: TestDefinition) -> Held:
    """Oxidizer, fuel and chamber gas [kg] on the thrust curve's clock."""
    time, load = firing.curve.time, firing.propellant
    histories = (load.oxidizer, load.liquid, load.fuel, load.temperature)
    mass, liquid, fuel, t = (np.interp(time, load.time, history) for history in histories)
    source, known = saturation(definition.model.properties), np.isfinite(load.temperature).all()
    volume = np.asarray(source.liquid_volume(np.where(np.isfinite(t), t, ROOM_TEMPERATURE))[0])
    return Held(mass, liquid, volume, fuel, firing.gas_mass, "" if known else UNDIVIDED)


def in_winds(
    firing: Firing, definition: TestDefinition, winds: Sequence[float], seeds: int, longest: float, progress: Progress
) -> StabilityRuns | str:
    """The firing's rocket in every wind [m/s], ``longest`` [s] at most; or why there is no stability to tell."""
    rocket = built(definition.rocket, definition.tank, definition.grain, definition.chamber)
    launch = Launch(firing.curve, firing.vehicle, firing.rail_length)
    return stability(launch, rocket, held(firing, definition), longest, winds, seeds, progress)


def propellant_center(firing: Firing, definition: TestDefinition) -> Array | str:
    """Center of gravity [m from the engine's front] of what tank, grain and chamber hold, on the thrust curve's clock;
    or what is not given of where they are."""
    where = places(definition.rocket, definition.tank, definition.grain, definition.chamber)
    return where if isinstance(where, str) else engine_center(held(firing, definition), where, None)
