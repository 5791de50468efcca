"""The content of validation.json: the performance of a test, and the model against the measurement."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

from hfanalysis.products.beyond import Beyond
from hfanalysis.products.budget import MADE_OF, Budget
from hfanalysis.products.model import Adopted, Is, Notes, Part, Product, Warnings, Words
from hfanalysis.products.reconstruction import Reconstruction
from hfanalysis.products.stability import Stability
from hfanalysis.quantity import Quantity


class Column(Part):
    """The performance of a burn, as measured or modeled."""

    burn_time: Annotated[Quantity, Is("from the opening to the end of the fire", "s")]
    total_impulse: Annotated[Quantity, Is("integral of the thrust over the burn", "N s")]
    specific_impulse: Annotated[
        Quantity, Is("total impulse over the weight of all that was expended, purge gas included", "s")
    ]
    peak_chamber_pressure: Annotated[Quantity, Is("of the mean curve", "Pa")]
    peak_thrust: Annotated[Quantity, Is("of the mean curve", "N")]
    average_thrust: Annotated[Quantity, Is("total impulse over burn time", "N")]
    oxidizer_mass: Annotated[Quantity, Is("loaded, less what is stated to be left", "kg")]
    fuel_mass: Annotated[Quantity, Is("loaded, less what is stated to be left", "kg")]
    specific_impulse_to_purge: Annotated[
        Quantity | None, Is("the same until nitrogen enters, or over the burn where none does", "s")
    ] = None
    specific_impulse_loaded: Annotated[
        Quantity | None, Is("total impulse over the weight of the loaded masses: the report's", "s")
    ] = None
    specific_impulse_liquid: Annotated[
        Quantity | None, Is("of the liquid phase, over the weight of what passed injector and grain in it", "s")
    ] = None
    largest_chamber_pressure: Annotated[
        Quantity | None, Is("largest good sample, which the structure has seen", "Pa")
    ] = None
    mean_chamber_pressure: Annotated[Quantity | None, Is("over the burn", "Pa")] = None
    ignition_delay: Annotated[Quantity | None, Is("opening to 10 % of the plateau of p_chamber", "s")] = None
    rise_time: Annotated[Quantity | None, Is("10 to 90 % of the plateau of p_chamber", "s")] = None
    ignition_overshoot: Annotated[Quantity | None, Is("largest p_chamber of the ignition over the plateau", "")] = None
    pressure_lag: Annotated[Quantity | None, Is("of p_chamber behind the thrust", "s")] = None
    action_time: Annotated[Quantity | None, Is("first to last passing of 10 % of the largest thrust", "s")] = None
    burn_time_5_percent: Annotated[Quantity | None, Is("first to last passing of 5 % of the largest thrust", "s")] = (
        None
    )
    impulse_liquid: Annotated[Quantity | None, Is("of the liquid phase", "N s")] = None
    impulse_vapor: Annotated[Quantity | None, Is("of the vapor phase", "N s")] = None
    impulse_nitrogen: Annotated[Quantity | None, Is("from when nitrogen enters", "N s")] = None
    tail_impulse: Annotated[Quantity | None, Is("after the liquid is gone", "N s")] = None
    injector_drop_liquid: Annotated[Quantity | None, Is("over p_chamber, mean of the liquid phase", "")] = None
    injector_drop_vapor: Annotated[Quantity | None, Is("over p_chamber, mean of the vapor phase", "")] = None
    total_impulse_of_file: Annotated[Quantity | None, Is("raw channel over the whole file, drift and all", "N s")] = (
        None
    )


class Performance(Part):
    """The table of performance."""

    measured: Annotated[Column, Is("by the log")]
    model: Annotated[Column, Is("of the calibrated engine, run by itself")]
    motor_class: Annotated[Words | None, Is("letter of the measured total impulse, and its limits")] = None


class PhaseGap(Part):
    """Measured minus model of a channel in one phase."""

    rms: Annotated[float, Is("root mean square", "of the channel")]
    bias: Annotated[float, Is("mean", "of the channel")]
    noise: Annotated[float, Is("what the sensor's noise alone would leave", "of the channel")]
    samples: Annotated[int, Is("compared", "")]
    unit: Annotated[str, Is("of the channel")]


class Balance(Part):
    """Masses in and out while no purge gas flows."""

    until: Annotated[Quantity, Is("when nitrogen enters, else the burn's end", "s")]
    oxidizer_through_injector: Annotated[Quantity, Is("integral of its flow", "kg")]
    fuel_burned: Annotated[Quantity, Is("by a and n", "kg")]
    propellant_through_nozzle: Annotated[Quantity, Is("by p_chamber and the equilibrium gas's c*", "kg")]
    difference: Annotated[Quantity, Is("through the nozzle less what went in", "kg")]
    verdict: Annotated[str | None, Is("closes, or does not close; null: it cannot be told")]


class Efficiencies(Part):
    """Means over the liquid phase; the efficiencies against shifting equilibrium, and against frozen flow."""

    c_star: Annotated[Quantity, Is("p_c A_t over mass flow", "m/s")]
    c_star_efficiency: Annotated[Quantity, Is("of shifting equilibrium", "")]
    c_star_efficiency_frozen: Annotated[Quantity, Is("of frozen flow", "")]
    thrust_coefficient: Annotated[Quantity, Is("thrust over p_c A_t", "")]
    thrust_coefficient_efficiency: Annotated[Quantity, Is("of shifting equilibrium, while the nozzle flows full", "")]
    thrust_coefficient_efficiency_frozen: Annotated[Quantity, Is("of frozen flow", "")]


class Standard(Part):
    """Quantities by which engines are compared."""

    mean_regression_rate: Annotated[Quantity, Is("space-time averaged: burnt web over burn time", "m/s")]
    mean_oxidizer_flux: Annotated[Quantity, Is("space-time averaged: mean flow in a port of mean radius", "kg/(m^2 s)")]
    published_regression_rate: Annotated[Quantity, Is("at that flux, by a published law for this propellant", "m/s")]
    vacuum_thrust: Annotated[Quantity, Is("F + p_a A_e, mean while the nozzle flows full, to t_purge", "N")]
    vacuum_specific_impulse: Annotated[Quantity, Is("of that, over the flow", "s")]
    vacuum_thrust_coefficient: Annotated[Quantity, Is("of that, over p_c A_t", "")]
    sea_level_specific_impulse: Annotated[Quantity, Is("the same at 101325 Pa", "s")]
    sea_level_thrust_coefficient: Annotated[Quantity, Is("the same at 101325 Pa", "")]
    characteristic_length: Annotated[Quantity, Is("L*: chamber over throat, at ignition", "m")]
    characteristic_length_end: Annotated[Quantity, Is("L* when the burn ends", "m")]


class Closure(Part):
    """How the masses close over the burn."""

    oxidizer_through_injector: Annotated[Quantity | None, Is("integral of its flow", "kg")] = None
    fuel_burned: Annotated[Quantity | None, Is("by a and n", "kg")] = None
    propellant_through_nozzle: Annotated[Quantity | None, Is("by p_chamber and the equilibrium gas's c*", "kg")] = None
    oxidizer_loaded: Annotated[Quantity | None, Is("into the tank", "kg")] = None
    fuel_loaded: Annotated[Quantity | None, Is("the grain", "kg")] = None
    liquid_phase_heat: Annotated[Quantity | None, Is("heat flow that the calibrated tank takes", "W")] = None
    to_purge: Annotated[Balance | None, Is("the same until nitrogen enters, which is judged")] = None
    verdict: Annotated[str | None, Is("of to_purge: closes, or does not close; null: it cannot be told")] = None


class Finding(Part):
    """A sensor that cannot be right by what the engine can give; what channels show by themselves is in health.json."""

    channels: Annotated[tuple[str, ...], Is("which")]
    verdict: Annotated[str, Is("what is wrong, in short")]
    text: Annotated[Words, Is("what is wrong, in a sentence")]
    size: Annotated[Quantity, Is("of the error")]


class Validation(Product):
    """Performance, gaps between measurement and model, closure of the masses, and what looks wrong."""

    file: ClassVar[str] = "validation.json"

    performance: Annotated[Performance, Is("measured and modeled")]
    gap: Annotated[
        dict[str, dict[str, dict[str, PhaseGap]]],
        Is(
            "measured minus model by mode (tank_free, chamber_forced: measured p_chamber put in; full: nothing), "
            "channel and phase"
        ),
    ]
    closure: Annotated[Closure, Is("of the masses")]
    efficiency_basis: Annotated[str, Is("of efficiencies: shifting equilibrium; those by frozen flow say so")] = (
        "shifting"
    )
    efficiencies: Annotated[Efficiencies | None, Is("c* and C_F over the liquid phase")] = None
    standard: Annotated[Standard | None, Is("by which engines are compared")] = None
    beyond: Annotated[tuple[Beyond, ...], Is("warnings with value, limit and source")] = ()
    sensors: Annotated[tuple[Finding, ...], Is("what looks wrong with sensors by what the engine can give")]
    budget: Annotated[Mapping[str, Budget], MADE_OF] = {}
    absent: Annotated[dict[str, Words], Is("what could not be done, and why")]
    reconstruction: Annotated[Reconstruction | None, Is("what the fuel did, without a regression law")] = None
    stability: Annotated[Stability | None, Is("how smoothly it burnt")] = None
    notes: Notes
    warnings: Warnings
    effects: Adopted = ()
