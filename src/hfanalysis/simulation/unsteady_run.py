"""What ``hfa simulate`` finds: the unsteady engine of an engine file, and the flight of its rocket."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly import engine as build
from hfanalysis.assembly.tank import TankBuilt
from hfanalysis.effects import library_of
from hfanalysis.engine import closure, unsteady
from hfanalysis.engine.unsteady import Burn, Engine
from hfanalysis.errors import InputError
from hfanalysis.flight import stability
from hfanalysis.flight.histories import Flown
from hfanalysis.flight.stability import StabilityRuns
from hfanalysis.inference.adopted.effects import Adopted, effects_in
from hfanalysis.products.engines import Simulated
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import EngineFile, Needs
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.simulation import flown, heading, numbers, propellant, sized, spread, warned
from hfanalysis.simulation.over_temperature import OverTemperature, over_temperature

COMMAND = "hfa simulate"

LONGEST_RUN = 600.0
"""Longest run that can be asked for [s]: no stand runs on for longer."""

EVEN = 1501
"""Times of a chart. Source: by choice: 2 ms of a burn of three seconds."""


@dataclass(frozen=True)
class Simulation:
    """An engine as stated and as built, its burn, the chamber's temperature [K] along it, its rocket's flight or why
    there is none, and the JSON product."""

    file: EngineFile
    adopted: Adopted
    tank: TankBuilt
    engine: Engine
    burnt: Burn
    chamber_temperature: Array
    flown: Flown | str
    product: Simulated

    def evenly(self, points: int = EVEN) -> Simulation:
        """The same on so many times of even distance, for charts."""
        burnt = replace(self.burnt, time=np.linspace(0.0, float(self.burnt.time[-1]), points))
        return replace(self, burnt=burnt, chamber_temperature=burnt.chamber_temperature())

    @cached_property
    def on_other_days(self) -> OverTemperature:
        """The engine over the temperature of its tank; with bands where its numbers have them."""
        drawn = {} if self.product.spread is not None else {"drawn": 0}
        return over_temperature(self.file, self.adopted, COMMAND, **drawn)


def simulate(file: EngineFile, until: float | None = None, draws: int = 0) -> Simulation:
    """Run the unsteady model of an engine file, to burn-out or on through cold gas ``until`` [s].

    ``draws``: engines drawn over what the file states with a +/-, for bands about its numbers.

    Raises :class:`InputError` where the file lacks what the model needs, or states an engine that cannot be run.
    """
    needs = Needs(file, COMMAND)
    tank = build.tank(needs)
    adopted = effects_of(file)
    engine = replace(build.engine(needs, tank), effects=adopted.acting)
    burnt = run(file, engine, until)
    hot = burnt.chamber_temperature()
    found = flown.to_ground(file, engine, burnt, tank)
    flight = _flight(file, engine, burnt, found)
    of_engine, of_rocket = numbers.of_burn(engine, burnt, hot), numbers.loaded(file, engine, burnt)
    known = spread.bands(file, adopted, COMMAND, draws) if draws and until is None and spread.is_loose(file) else None
    if known is not None:
        of_engine, of_rocket = (spread.about(of, known.engine) for of in (of_engine, of_rocket))
        flight |= spread.about(numbers.of(flight), known.flight)
    product = Simulated.from_json(
        {
            **heading.heading(file, COMMAND, build.oxidizer_enthalpy(needs)),
            **of_engine,
            **_implied(burnt),
            **of_rocket,
            **sized.of_tank(tank),
            "flight": flight,
            **({} if known is None else {"spread": known.product}),
            **_propellant(needs, engine),
            "beyond": (*warned.of_burn(engine, burnt, flight), *warned.of_stability(_stable(found))),
            "warnings": [*file.warnings, *_warnings(burnt)],
            "provenance": heading.provenance(file),
        }
    )
    return Simulation(file, adopted, tank, engine, burnt, hot, found, product)


def effects_of(file: EngineFile) -> Adopted:
    """What [effects] states beside the base model, a team's own among them; InputError for what cannot be."""
    if not file.effects:
        return Adopted()
    return effects_in(file.effects, file.path, library_of(file.path, file.effects))


def run(file: EngineFile, engine: Engine, until: float | None = None) -> Burn:
    """The burn, ``until`` [s]; an engine that cannot be lit or integrated is refused with the reason (InputError)."""
    if until is not None and not 0.0 < until <= LONGEST_RUN:
        raise InputError(f"--until {until:g}: expected seconds between 0 and {LONGEST_RUN:g}")
    try:
        return unsteady.burn(engine) if until is None else unsteady.burn(engine, until, run_on=True)
    except (ValueError, ArithmeticError) as error:
        raise InputError(f"{file.path}: {error}") from None


def _implied(burnt: Burn) -> dict[str, Quantity]:
    """Heat that the polytropic vapor and the quasi-steady chamber would need: what the model leaves open."""
    power, stored = closure.vapor_heat(burnt), closure.chamber_energy(burnt)
    none = "there is no vapor phase within the burn"
    return {
        "implied_vapor_heat": Quantity(closure.vapor_heat_total(burnt), "J") if power.any() else Quantity.absent(none),
        "implied_vapor_power": Quantity(float(power[power != 0.0][0]), "W") if power.any() else Quantity.absent(none),
        "implied_chamber_heat": Quantity(float(stored[0] - stored[-1]), "J"),
    }


def _flight(file: EngineFile, engine: Engine, burnt: Burn, found: Flown | str) -> dict[str, Any]:
    """As flight.json."""
    stable = _stable(found)
    margin = {"checks": stability.checks(stable), "stability": stability.product(stable)}
    return flown.quantities(found) | numbers.loaded(file, engine, burnt) | margin


def _stable(found: Flown | str) -> StabilityRuns | str:
    return found if isinstance(found, str) else found.stable


def _propellant(needs: Needs, engine: Engine) -> dict[str, dict[str, Quantity]]:
    """The load for the target apogee, where the file has one and its rocket can fly."""
    target = needs.file.design.target_apogee
    if target is None or not isinstance(build.vehicle(needs.file), Vehicle):
        return {}
    return {"propellant_for_target_apogee": propellant.for_apogee(needs, engine, target.value)}


def _warnings(burnt: Burn) -> list[str]:
    return (
        [] if burnt.fuel_out else [f"{numbers.burn_time_of(burnt).reason}; impulse and residual are those until then"]
    )
