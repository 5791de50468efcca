"""The content of simulate.json and design.json: what an engine file comes to."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from hfanalysis.products.beyond import Beyond
from hfanalysis.products.budget import MADE_OF, Budget
from hfanalysis.products.flight import Check, FlightNumbers, Stability
from hfanalysis.products.model import Is, Part, Warnings
from hfanalysis.quantity import Quantity


class Enthalpy(Part):
    """Of the oxidizer that enters the chamber."""

    value: Annotated[float, Is("of the oxidizer", "J/kg")]
    unit: Annotated[str, Is("of the value")]
    std: Annotated[float | None, Is("not known", "J/kg")] = None
    ci95: Annotated[tuple[float, float] | None, Is("not known", "J/kg")] = None
    of: Annotated[str, Is("what it is that of")]


class EngineHead(Part):
    """Which engine, by which command, under which conventions."""

    file: ClassVar[str]

    engine: Annotated[str, Is("its name")]
    command: Annotated[str, Is("that made this")]
    conventions: Annotated[str, Is("corrected or report")]
    properties: Annotated[str, Is("of nitrous oxide: coolprop or report")]
    fuel: Annotated[str, Is("what burns, by its name in [fuel]")] = "paraffin"
    oxidizer_enthalpy: Annotated[Enthalpy, Is("with which the oxidizer enters the chamber")]


class SimulatedFlight(FlightNumbers):
    """The flight of the simulated engine's rocket."""

    wet_mass: Annotated[Quantity, Is("of the rocket on its pad", "kg")]
    pad_thrust_to_weight: Annotated[Quantity, Is("peak thrust over wet weight", "")]
    checks: Annotated[Mapping[str, Check], Is("limits of the static margin that are kept or not, by name")] = {}
    stability: Annotated[Stability | None, Is("static margin in winds")] = None


class Load(Part):
    """Propellant."""

    oxidizer_mass: Annotated[Quantity, Is("of oxidizer", "kg")]
    fuel_mass: Annotated[Quantity, Is("of fuel", "kg")]
    tank_length: Annotated[Quantity | None, Is("of the tank that holds it, sized as the file's", "m")] = None
    dip_tube_length: Annotated[Quantity | None, Is("of its dip tube", "m")] = None
    tank_volume: Annotated[Quantity | None, Is("of the same", "m^3")] = None

    @property
    def shown(self) -> dict[str, Quantity]:
        """Under names that say what is to be done with them."""
        loaded = {"oxidizer_to_load": self.oxidizer_mass, "fuel_to_load": self.fuel_mass}
        tank = {name: of for name, of in self.quantities.items() if name not in ("oxidizer_mass", "fuel_mass")}
        return loaded | tank


class SpreadInput(Part):
    """Something that is stated with its +/-."""

    name: Annotated[str, Is("key of the engine file, or name in its [covariance]")]
    value: Annotated[float | None, Is("as stated", "SI")] = None
    std: Annotated[float, Is("standard deviation", "SI")]


class Chance(Part):
    """How likely it is that a limit is kept."""

    name: Annotated[str, Is("of the limit")]
    probability: Annotated[float, Is("share of the draws that keep it", "")]
    limit: Annotated[float, Is("that is to be kept", "as unit says")]
    unit: Annotated[str, Is("of the limit")]
    text: Annotated[str, Is("what is kept, in words")]


class Spread(Part):
    """What is stated with +/- makes of the numbers: engines drawn over it."""

    draws: Annotated[int, Is("engines drawn", "")]
    refused: Annotated[int, Is("of them, that cannot be run", "")]
    seed: Annotated[int, Is("of the draws", "")]
    inputs: Annotated[tuple[SpreadInput, ...], Is("what was drawn")]
    chances: Annotated[tuple[Chance, ...], Is("that limits are kept")] = ()
    budget: Annotated[Mapping[str, Budget], MADE_OF] = {}


class Simulated(EngineHead):
    """The unsteady engine of an engine file, and the flight of its rocket."""

    file: ClassVar[str] = "simulate.json"

    burn_time: Annotated[Quantity, Is("until the fuel is gone", "s")]
    total_impulse: Annotated[Quantity, Is("integral of the thrust", "N s")]
    specific_impulse: Annotated[Quantity, Is("total impulse over the weight of the load", "s")]
    peak_chamber_temperature: Annotated[Quantity, Is("of the gas", "K")]
    peak_chamber_pressure: Annotated[Quantity, Is("of the gas", "Pa")]
    peak_thrust: Annotated[Quantity, Is("highest", "N")]
    average_thrust: Annotated[Quantity, Is("total impulse over burn time", "N")]
    liquid_depletion_time: Annotated[Quantity, Is("when the liquid is gone", "s")]
    residual_oxidizer_mass: Annotated[Quantity, Is("left in the tank", "kg")]
    implied_vapor_heat: Annotated[Quantity, Is("that the polytropic vapor would need", "J")]
    implied_vapor_power: Annotated[Quantity, Is("the same as power, at first", "W")]
    implied_chamber_heat: Annotated[Quantity, Is("that the quasi-steady chamber would need", "J")]
    wet_mass: Annotated[Quantity, Is("of the rocket on its pad", "kg")]
    pad_thrust_to_weight: Annotated[Quantity, Is("peak thrust over wet weight", "")]
    tank_length: Annotated[Quantity, Is("of the tank", "m")]
    dip_tube_length: Annotated[Quantity, Is("of its dip tube", "m")]
    tank_volume: Annotated[Quantity, Is("of the tank", "m^3")]
    flight: Annotated[SimulatedFlight, Is("of its rocket")]
    spread: Annotated[Spread | None, Is("of what the bands are made, where the file states +/-")] = None
    propellant_for_target_apogee: Annotated[Load | None, Is("load for [design] target_apogee")] = None
    beyond: Annotated[tuple[Beyond, ...], Is("warnings with value, limit and source")] = ()
    warnings: Warnings
    provenance: Annotated[dict[str, Any], Is("version, and files by SHA-256")]


class Optimum(Part):
    """The best mixture."""

    of_ratio: Annotated[Quantity, Is("oxidizer over fuel", "")]
    specific_impulse: Annotated[Quantity, Is("there", "s")]


class Designed(EngineHead):
    """The steady-state design of an engine file."""

    file: ClassVar[str] = "design.json"

    fuel_mass_from: Annotated[str, Is("grain.mass, or design.target_apogee that it was solved for")]
    burn_time: Annotated[Quantity, Is("of the constant thrust", "s")]
    oxidizer_mass: Annotated[Quantity, Is("used", "kg")]
    fuel_mass: Annotated[Quantity, Is("of the grain", "kg")]
    of_ratio: Annotated[Quantity, Is("oxidizer over fuel", "")]
    chamber_temperature: Annotated[Quantity, Is("of the gas", "K")]
    thrust: Annotated[Quantity, Is("constant", "N")]
    throat_radius: Annotated[Quantity, Is("of the nozzle", "m")]
    exit_radius: Annotated[Quantity, Is("of the nozzle", "m")]
    total_impulse: Annotated[Quantity, Is("thrust times burn time", "N s")]
    specific_impulse: Annotated[Quantity, Is("total impulse over the weight of the propellant", "s")]
    port_radius: Annotated[Quantity, Is("of the grain, before it burns", "m")]
    grain_length: Annotated[Quantity, Is("of the grain", "m")]
    injector_area: Annotated[Quantity, Is("C_i N_i A_i that lets the oxidizer through", "m^2")]
    injector_holes: Annotated[Quantity, Is("of the stated area, or as many as stated", "")]
    injector_hole_area: Annotated[Quantity, Is("of one hole", "m^2")]
    tank_length: Annotated[Quantity, Is("of the tank, for the load", "m")]
    dip_tube_length: Annotated[Quantity, Is("of its dip tube", "m")]
    tank_volume: Annotated[Quantity, Is("of the tank, for the load", "m^3")]
    wet_mass: Annotated[Quantity, Is("of the rocket on its pad", "kg")]
    pad_thrust_to_weight: Annotated[Quantity, Is("peak thrust over wet weight", "")]
    apogee: Annotated[Quantity, Is("of its rocket, above ground", "m")]
    optimum: Annotated[Optimum, Is("the best mixture")]
    spread: Annotated[Spread | None, Is("of what the bands are made, where the file states +/-")] = None
    beyond: Annotated[tuple[Beyond, ...], Is("warnings with value, limit and source")] = ()
    warnings: Warnings
    provenance: Annotated[dict[str, Any], Is("version, and files by SHA-256")]


class NextTest(Part):
    """A test that is thought of."""

    name: Annotated[str, Is("what of the engine is another then")]
    std: Annotated[float | None, Is("standard deviation of the target after it", "as unit says")] = None
    narrowed: Annotated[float | None, Is("by how much that is less than now", "as unit says")] = None
    reason: Annotated[str | None, Is("why it cannot be told")] = None


class SensorWorth(Part):
    """What a sensor is worth to the same test again."""

    name: Annotated[str, Is("of the sensor")]
    worth: Annotated[float, Is("by how much more the target's deviation is without it", "as unit says")]


class NextTests(Part):
    """What to test next: each test by how far it narrows what is not known of an engine."""

    file: ClassVar[str] = "next.json"

    engine: Annotated[str, Is("its name")]
    target: Annotated[str, Is("what is to be narrowed")]
    unit: Annotated[str, Is("of the target")]
    value: Annotated[float | None, Is("of the target", "as unit says")]
    std: Annotated[float, Is("its standard deviation by the constants, now", "as unit says")]
    tests: Annotated[tuple[NextTest, ...], Is("the one that narrows most first")]
    sensors: Annotated[tuple[SensorWorth, ...], Is("the one that is worth most first")]
    assumed: Annotated[Mapping[str, float], Is("relative standard deviations of what is measured", "")]
