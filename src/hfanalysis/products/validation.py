"""The content of validation.json: the performance of a test, and the model against the measurement."""

from __future__ import annotations

from typing import Annotated, ClassVar

from hfanalysis.products.model import Adopted, Is, Notes, Part, Product, Warnings, Words
from hfanalysis.quantity import Quantity


class Column(Part):
    """The performance of a burn, as measured or modeled."""

    burn_time: Annotated[Quantity, Is("from the opening to the end of the fire", "s")]
    total_impulse: Annotated[Quantity, Is("integral of the thrust over the burn", "N s")]
    specific_impulse: Annotated[Quantity, Is("total impulse over the weight of the propellant used", "s")]
    peak_chamber_pressure: Annotated[Quantity, Is("of the mean curve", "Pa")]
    peak_thrust: Annotated[Quantity, Is("of the mean curve", "N")]
    average_thrust: Annotated[Quantity, Is("total impulse over burn time", "N")]
    oxidizer_mass: Annotated[Quantity, Is("used", "kg")]
    fuel_mass: Annotated[Quantity, Is("burned", "kg")]
    mean_chamber_pressure: Annotated[Quantity | None, Is("over the burn", "Pa")] = None
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


class Closure(Part):
    """How the masses close over the burn."""

    oxidizer_through_injector: Annotated[Quantity | None, Is("integral of its flow", "kg")] = None
    fuel_burned: Annotated[Quantity | None, Is("by a and n", "kg")] = None
    propellant_through_nozzle: Annotated[Quantity | None, Is("by p_chamber and the equilibrium gas's c*", "kg")] = None
    oxidizer_loaded: Annotated[Quantity | None, Is("into the tank", "kg")] = None
    fuel_loaded: Annotated[Quantity | None, Is("the grain", "kg")] = None
    liquid_phase_heat: Annotated[Quantity | None, Is("heat flow that the calibrated tank takes", "W")] = None


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
    sensors: Annotated[tuple[Finding, ...], Is("what looks wrong with sensors by what the engine can give")]
    absent: Annotated[dict[str, Words], Is("what could not be done, and why")]
    notes: Notes
    warnings: Warnings
    effects: Adopted = ()
