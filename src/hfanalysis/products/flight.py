"""The content of flight.json: the flight of the test's rocket on the measured thrust."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import Field

from hfanalysis.products.budget import MADE_OF, Budget
from hfanalysis.products.model import Adopted, Is, Notes, Part, Product, Warnings
from hfanalysis.quantity import Quantity


class FlightNumbers(Part):
    """A flight in numbers."""

    apogee: Annotated[Quantity, Is("above ground", "m")]
    time_to_apogee: Annotated[Quantity, Is("from ignition", "s")]
    rail_departure_velocity: Annotated[Quantity, Is("leaving the rail", "m/s")]
    peak_velocity: Annotated[Quantity, Is("on the way up", "m/s")]
    peak_mach: Annotated[Quantity, Is("on the way up", "")]
    peak_acceleration: Annotated[Quantity, Is("on the way up", "m/s^2")]
    terminal_velocity_drogue: Annotated[Quantity, Is("under the drogue", "m/s")]
    terminal_velocity_main: Annotated[Quantity, Is("under the main", "m/s")]
    time_to_main: Annotated[Quantity, Is("from ignition", "s")]
    main_deployment_acceleration: Annotated[Quantity, Is("when the main opens", "m/s^2")]
    landing_time: Annotated[Quantity, Is("from ignition", "s")]
    impact_velocity_ballistic: Annotated[Quantity, Is("without parachutes", "m/s")]


class Check(Part):
    """Whether a number of the flight keeps a limit."""

    limit: Annotated[float, Is("that it has to keep", "as unit says")]
    unit: Annotated[str, Is("of the limit")]
    side: Annotated[str, Is("at least or at most"), Field(alias="is")]
    result: Annotated[str, Is("passed, failed, or unknown")]
    why: Annotated[str, Is("the numbers that say so")]


class DispersionInput(Part):
    """An uncertain input of the flight."""

    std: Annotated[float, Is("standard deviation", "as unit says")]
    unit: Annotated[str, Is("of the deviation")]
    origin: Annotated[str, Is("test.toml or default"), Field(alias="from")]
    of: Annotated[str, Is("what it is the deviation of")]


class Dispersion(Part):
    """The flights that give the bands."""

    flights: Annotated[int, Is("how many", "")]
    seed: Annotated[int, Is("of the drawn inputs", "")]
    inputs: Annotated[dict[str, DispersionInput], Is("that differ, by name")]


class Mean(Part):
    """A mean with its scatter."""

    mean: Annotated[float, Is("mean", "calibers")]
    std: Annotated[float, Is("standard deviation over gusts", "calibers")]


class WindMargin(Part):
    """The static margin in one wind."""

    wind: Annotated[float, Is("its mean speed", "m/s")]
    departure: Annotated[Mean, Is("margin at the end of the rail")]
    least: Annotated[float, Is("least mean less two standard deviations", "calibers")]
    largest: Annotated[float, Is("largest mean and two standard deviations", "calibers")]
    apogee: Annotated[float, Is("mean over gusts", "m")]
    result: Annotated[str, Is("whether it keeps within the limits: passed, failed")]


class Slope(Part):
    """The normal force of a part of the rocket."""

    slope: Annotated[float, Is("of the coefficient over the angle of attack", "1/rad")]
    position: Annotated[float, Is("of its center, from the nose tip", "m")]


class Stability(Part):
    """The static margin; of all but the first, nothing where no geometry is given."""

    margin_at_rail_departure: Annotated[Quantity, Is("in the calmest wind", "")]
    static_margin_on_pad: Annotated[Quantity | None, Is("on the pad, in calibers", "")] = None
    normal_force_slope: Annotated[Quantity | None, Is("of the rocket", "1/rad")] = None
    center_of_pressure: Annotated[Quantity | None, Is("from the nose tip", "m")] = None
    center_of_gravity_loaded: Annotated[Quantity | None, Is("from the nose tip", "m")] = None
    center_of_gravity_empty: Annotated[Quantity | None, Is("from the nose tip", "m")] = None
    mach: Annotated[float, Is("at which slopes and drag are listed", "")] = 0.0
    slopes: Annotated[dict[str, Slope] | None, Is("by part of the rocket")] = None
    drag_parts: Annotated[dict[str, float] | None, Is("drag coefficient by part", "")] = None
    limits: Annotated[tuple[float, float] | None, Is("of the margin", "calibers")] = None
    gust_intensity: Annotated[float, Is("scatter of the wind over its mean", "")] = 0.0
    winds: Annotated[tuple[WindMargin, ...], Is("the margin by wind")] = ()
    notes: Notes = ()

    @property
    def shown(self) -> dict[str, Quantity]:
        """Nothing where no geometry is given."""
        return self.quantities if self.winds else {}


OF_STAND = ("total_impulse", "average_thrust")
"""What is of the stand's thrust and stands in no table of the flight's; its impulse does under its own name."""


class Flight(FlightNumbers, Product):
    """The flight with its bands, checks and stability."""

    file: ClassVar[str] = "flight.json"

    wet_mass: Annotated[Quantity, Is("of the rocket on its pad", "kg")]
    pad_thrust_to_weight: Annotated[Quantity, Is("peak thrust over wet weight", "")]
    liftoff_thrust_to_weight: Annotated[
        Quantity, Is("mean thrust from lift-off to the rail's end (half a second without one) over wet weight", "")
    ]
    apogee_as_measured: Annotated[Quantity, Is("above ground, on the thrust with the stand's purge gas in it", "m")]
    impulse_flown: Annotated[Quantity, Is("of the thrust that flies, at its altitudes", "N s")]
    impulse_stand: Annotated[Quantity, Is("of the thrust that the stand measured", "N s")]
    total_impulse: Annotated[Quantity, Is("of the thrust that the stand measured", "N s")]
    burn_time: Annotated[
        Quantity, Is("of the thrust that flies; without purge gas, until the chamber is at ambient pressure", "s")
    ]
    average_thrust: Annotated[Quantity, Is("of the stand: its impulse over its burn time", "N")]
    checks: Annotated[dict[str, Check], Is("limits that are kept or not, by name")]
    thrust: Annotated[str, Is("what was done to the measured thrust")]
    thrust_basis: Annotated[str, Is("what flies: without purge gas, or as measured")]
    band_covers: Annotated[str, Is("what the intervals hold, in words")]
    drag: Annotated[str, Is("where the drag is from")]
    masses: Annotated[dict[str, str], Is("how the masses over time were found, by propellant")]
    dispersion: Annotated[Dispersion, Is("what the bands come from")]
    stability: Annotated[Stability, Is("static margin")]
    budget: Annotated[Mapping[str, Budget], MADE_OF] = {}
    notes: Notes
    effects: Adopted = ()
    warnings: Warnings = ()

    @property
    def flown(self) -> dict[str, Quantity]:
        """Its quantities by name, but OF_STAND: all of one thrust, beside the stand's impulse."""
        return {name: value for name, value in self.quantities.items() if name not in OF_STAND}
