"""What ``hfa simulate`` finds: the unsteady engine of an engine file, and the flight of its rocket."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly import engine as build
from hfanalysis.assembly.tank import TankBuilt
from hfanalysis.effects import library_of
from hfanalysis.engine import closure, unsteady
from hfanalysis.engine.effect import Active
from hfanalysis.engine.unsteady import Burn, Engine
from hfanalysis.errors import InputError
from hfanalysis.flight import stability
from hfanalysis.flight.histories import Flown
from hfanalysis.flight.stability import StabilityRuns
from hfanalysis.inference.adopted.effects import effects_in
from hfanalysis.products.engines import Simulated
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import EngineFile, Needs
from hfanalysis.rocket.vehicle import STANDARD_GRAVITY, Vehicle, gravity
from hfanalysis.simulation import flown, heading, propellant, sized, warned

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


def simulate(file: EngineFile, until: float | None = None) -> Simulation:
    """Run the unsteady model of an engine file, to burn-out or on through cold gas ``until`` [s].

    Raises :class:`InputError` where the file lacks what the model needs, or states an engine that cannot be run.
    """
    needs = Needs(file, COMMAND)
    tank = build.tank(needs)
    engine = replace(build.engine(needs, tank), effects=_effects(file))
    burnt = run(file, engine, until)
    hot = burnt.chamber_temperature()
    found = flown.to_ground(file, engine, burnt, tank)
    flight = _flight(file, engine, burnt, found)
    product = Simulated.from_json(
        {
            **heading.heading(file, COMMAND, build.oxidizer_enthalpy(needs)),
            **_engine(engine, burnt, hot),
            **_loaded(file, engine, burnt),
            **sized.of_tank(tank),
            "flight": flight,
            **_propellant(needs, engine),
            "beyond": (*warned.of_burn(engine, burnt, flight), *warned.of_stability(_stable(found))),
            "warnings": [*file.warnings, *_warnings(burnt)],
            "provenance": heading.provenance(file),
        }
    )
    return Simulation(file, tank, engine, burnt, hot, found, product)


def _effects(file: EngineFile) -> tuple[Active, ...]:
    """What [effects] states beside the base model, a team's own among them; InputError for what cannot be."""
    if not file.effects:
        return ()
    return effects_in(file.effects, file.path, library_of(file.path, file.effects)).acting


def run(file: EngineFile, engine: Engine, until: float | None = None) -> Burn:
    """The burn, ``until`` [s]; an engine that cannot be lit or integrated is refused with the reason (InputError)."""
    if until is not None and not 0.0 < until <= LONGEST_RUN:
        raise InputError(f"--until {until:g}: expected seconds between 0 and {LONGEST_RUN:g}")
    try:
        return unsteady.burn(engine) if until is None else unsteady.burn(engine, until, run_on=True)
    except (ValueError, ArithmeticError) as error:
        raise InputError(f"{file.path}: {error}") from None


def _engine(engine: Engine, burnt: Burn, hot: Array) -> dict[str, Quantity]:
    impulse = float(burnt.state("impulse")[-1])
    loaded = engine.oxidizer_mass + engine.fuel_mass
    burn_time = _burn_time(burnt)
    known = burn_time.value is not None
    dry = "the liquid does not run out within the burn"
    return {
        "burn_time": burn_time,
        "total_impulse": Quantity(impulse, "N s"),
        "specific_impulse": Quantity(impulse / (STANDARD_GRAVITY * loaded), "s"),
        "peak_chamber_temperature": Quantity(float(hot.max()), "K"),
        "peak_chamber_pressure": Quantity(float(burnt.output("chamber_pressure").max()), "Pa"),
        "peak_thrust": Quantity(peak_thrust(burnt), "N"),
        "average_thrust": Quantity(impulse / burnt.burn_time, "N") if known else burn_time,
        "liquid_depletion_time": Quantity.absent(dry) if burnt.liquid_out is None else Quantity(burnt.liquid_out, "s"),
        "residual_oxidizer_mass": Quantity(float(burnt.state("tank_mass")[-1]), "kg"),
        **_implied(burnt),
    }


def _implied(burnt: Burn) -> dict[str, Quantity]:
    """Heat that the polytropic vapor and the quasi-steady chamber would need: what the model leaves open."""
    power, stored = closure.vapor_heat(burnt), closure.chamber_energy(burnt)
    none = "there is no vapor phase within the burn"
    return {
        "implied_vapor_heat": Quantity(closure.vapor_heat_total(burnt), "J") if power.any() else Quantity.absent(none),
        "implied_vapor_power": Quantity(float(power[power != 0.0][0]), "W") if power.any() else Quantity.absent(none),
        "implied_chamber_heat": Quantity(float(stored[0] - stored[-1]), "J"),
    }


def _burn_time(burnt: Burn) -> Quantity:
    if not burnt.fuel_out:
        return Quantity.absent(f"the fuel is not gone after {burnt.burn_time:.0f} s")
    return Quantity(burnt.burn_time, "s")


def peak_thrust(burnt: Burn) -> float:
    """Highest thrust [N]."""
    return float(burnt.output("thrust").max())


def _loaded(file: EngineFile, engine: Engine, burnt: Burn) -> dict[str, Quantity]:
    """The loaded rocket on its pad."""
    if file.rocket is None:
        return {name: Quantity.absent("no [rocket] is given") for name in ("wet_mass", "pad_thrust_to_weight")}
    mass = file.rocket.dry_mass.value + engine.oxidizer_mass + engine.fuel_mass
    weight = mass * gravity(build.launch_altitude(file))
    return {"wet_mass": Quantity(mass, "kg"), "pad_thrust_to_weight": Quantity(peak_thrust(burnt) / weight)}


def _flight(file: EngineFile, engine: Engine, burnt: Burn, found: Flown | str) -> dict[str, Any]:
    """As flight.json."""
    stable = _stable(found)
    margin = {"checks": stability.checks(stable), "stability": stability.product(stable)}
    return flown.quantities(found) | _loaded(file, engine, burnt) | margin


def _stable(found: Flown | str) -> StabilityRuns | str:
    return found if isinstance(found, str) else found.stable


def _propellant(needs: Needs, engine: Engine) -> dict[str, dict[str, Quantity]]:
    """The load for the target apogee, where the file has one and its rocket can fly."""
    target = needs.file.design.target_apogee
    if target is None or not isinstance(build.vehicle(needs.file), Vehicle):
        return {}
    return {"propellant_for_target_apogee": propellant.for_apogee(needs, engine, target.value)}


def _warnings(burnt: Burn) -> list[str]:
    return [] if burnt.fuel_out else [f"{_burn_time(burnt).reason}; impulse and residual are those until then"]
