"""The content of calibration.json: the constants of a test's tank, feed line, injector and fuel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

from hfanalysis.products.budget import MADE_OF, Budget
from hfanalysis.products.model import Adopted, Is, Notes, Numbers, Part, Product, Warnings, Words
from hfanalysis.quantity import NOT_IDENTIFIABLE, Quantity

UNIT_OF_A = "m/s (kg/m^2/s)^-n"
UNIT_OF_FLUX = "kg/(m^2 s)"
NOT_SOUGHT = Quantity.absent("this calibration did not look for it", verdict=NOT_IDENTIFIABLE)


class Rest(Part):
    """What is known of the tank before and just after the opening."""

    pressure: Annotated[Quantity, Is("at rest", "Pa")]
    temperature: Annotated[Quantity, Is("of saturation at that pressure", "K")]
    bulk_temperature: Annotated[Quantity, Is("of the liquid that the blowdown starts from", "K")]
    liquid_fraction: Annotated[Quantity, Is("liquid's share of the volume", "")]
    blowdown_mass: Annotated[Quantity, Is("load that pressures and volume alone ask for, adiabatic", "kg")]
    liquid_phase_heat: Annotated[Quantity, Is("heat flow that would reconcile mass and pressures", "W")]
    load_cell_mass: Annotated[Quantity, Is("load that the cell shows", "kg")]
    remarks: Annotated[tuple[Words, ...], Is("what does not fit")] = ()


class CoefficientHistory(Part):
    """C_i over time from the tank's energy balance; a diagnostic, not a fit."""

    time: Annotated[Numbers, Is("after the opening", "s")]
    value: Annotated[Numbers, Is("C_i", "")]
    std: Annotated[Numbers, Is("its standard deviation", "")]
    drift: Annotated[Quantity | None, Is("slope of a straight line through it", "1/s")] = None


class Inlet(Part):
    """What reaches the injector: means over the liquid phase once the line is full."""

    subcooling: Annotated[Quantity, Is("of saturation at p_run less that of the tank; negative: it flashes", "K")]
    quality: Annotated[Quantity, Is("vapor by mass, isenthalpic from the tank's liquid", "")]
    density: Annotated[Quantity, Is("of the mixture", "kg/m^3")]
    back_pressure: Annotated[Quantity | None, Is("p_c over p_run", "")] = None


class TankHistory(Part):
    """What is in the tank over the liquid phase, from the pressures and the calibrated injector."""

    time: Annotated[Numbers, Is("after the opening", "s")]
    temperature: Annotated[Numbers, Is("of saturation", "K")]
    liquid: Annotated[Numbers, Is("amount of liquid", "mol")]
    vapor: Annotated[Numbers, Is("amount of vapor", "mol")]
    flow: Annotated[Numbers, Is("of the injector", "kg/s")]


class RegressionTest(Part):
    """What one test says of a and n, and what their fit leaves of it."""

    test: Annotated[str, Is("its name")]
    fitted_with: Annotated[tuple[Words, ...], Is("what was compared, and with what model")]
    window: Annotated[tuple[float, float], Is("in which the chamber pressure was compared", "s")]
    burn_time_measured: Annotated[float | None, Is("as stated or seen in the log", "s")] = None
    burn_time_std: Annotated[float | None, Is("its standard deviation", "s")] = None
    burn_time_model: Annotated[float, Is("with the fitted a and n", "s")]
    fuel_left_measured: Annotated[float | None, Is("fuel that was left", "kg")] = None
    initial_temperature: Annotated[float, Is("of the modeled tank at the opening", "K")]
    flux_range: Annotated[tuple[float, float], Is("least and largest oxidizer flux of the burn", UNIT_OF_FLUX)]
    p_chamber_rms: Annotated[float, Is("rms of measured minus modeled chamber pressure", "Pa")]
    p_chamber_bias: Annotated[float, Is("mean of measured minus modeled chamber pressure", "Pa")]
    independent_samples: Annotated[float, Is("values that the chamber pressure is worth", "")]


class RegressionBasis(Part):
    """What a and n were fitted with, and what the fit leaves; empty where there is none."""

    reference_flux: Annotated[Quantity | None, Is("at which the rate is known best", UNIT_OF_FLUX)] = None
    misfit: Annotated[float | None, Is("weighted sum of squares at the best", "")] = None
    systematic: Annotated[Mapping[str, float], Is(
        "standard deviation of n and, relative, of a and of that rate by what would be the same in a repeated test", ""
    )] = {}  # fmt: skip
    tests: Annotated[tuple[RegressionTest, ...], Is("that it was fitted to")] = ()


class Joint(Part):
    """Correlated errors of the constants that a model takes together."""

    names: Annotated[tuple[str, ...], Is("of the constants")]
    std: Annotated[Numbers, Is("their standard deviations", "SI")]
    correlation: Annotated[tuple[Numbers, ...], Is("of these with each other", "")]


class FuelLaw(Part):
    """The fuel's regression, r = a G^n."""

    a: Annotated[Quantity, Is("regression coefficient", UNIT_OF_A)]
    n: Annotated[Quantity, Is("regression exponent", "")]
    regression_rate_reference: Annotated[Quantity, Is("rate at the reference flux, where it is known best", "m/s")]
    regression: Annotated[RegressionBasis, Is("what these rest on")]
    joint: Annotated[Joint | None, Is("errors of all constants together: flow_area is C_i N_i A_i", "")] = None

    @classmethod
    def absent(cls, reason: str) -> FuelLaw:
        """Nothing can be said, and why."""
        none = Quantity.absent(reason, verdict=NOT_IDENTIFIABLE)
        return cls(a=none, n=none, regression_rate_reference=none, regression=RegressionBasis())


class TankConstants(Part):
    """The constants of tank, feed line and injector, and the tank at rest."""

    C_i: Annotated[Quantity, Is("injector coefficient, effective: on the density of the tank's liquid", "")]
    m: Annotated[Quantity, Is("polytropic exponent of the vapor by the report's law, an incompressible flow", "")]
    m_choked: Annotated[Quantity, Is("the same where the vapor chokes in the injector, with C_d = C_i", "")] = (
        NOT_SOUGHT
    )
    vapor_C_d: Annotated[Quantity, Is("discharge coefficient of choked vapor that an m of 1.0 to 1.3 needs", "")] = (
        NOT_SOUGHT
    )
    Z: Annotated[Quantity, Is("compressibility of the vapor at t_v", "")]
    K_loss: Annotated[Quantity, Is("feed loss = K_loss mdot^2 / rho", "1/m^4")]
    p_loss_liquid: Annotated[Quantity, Is("mean feed loss over [t_feed, t_v)", "Pa")]
    p_loss_vapor: Annotated[Quantity, Is("mean feed loss over [t_v, t_purge)", "Pa")]
    vapor_mass_at_t_v: Annotated[Quantity, Is("vapor left when the liquid is gone", "kg")]
    oxidizer_flow_peak: Annotated[Quantity, Is("peak of the injector's flow", "kg/s")]
    mass_at_t_feed: Annotated[Quantity, Is("in tank and line when the line is full", "kg")]
    oxidizer_mass_liquid_phase: Annotated[Quantity, Is("used as liquid", "kg")]
    oxidizer_mass: Annotated[Quantity, Is("loaded", "kg")]
    rest: Annotated[Rest | None, Is("the tank before the valve opens")]
    C_i_history: Annotated[CoefficientHistory | None, Is("C_i over the liquid phase")]
    tank_history: Annotated[TankHistory | None, Is("content of the tank over the liquid phase")]
    inlet: Annotated[Inlet | None, Is("what reaches the injector")] = None
    C_d: Annotated[Mapping[str, Quantity], Is("discharge coefficient by law: spi, hem, dyer")] = {}
    joint: Annotated[Joint | None, Is("errors of the constants together: flow_area is C_i N_i A_i", "")] = None
    budget: Annotated[Mapping[str, Budget], MADE_OF] = {}
    notes: Notes
    warnings: Warnings

    @property
    def load(self) -> Quantity:
        """The oxidizer [kg] that an engine with these constants starts with."""
        return self.oxidizer_mass


class Calibration(TankConstants, FuelLaw, Product):
    """All constants of a test; with adopted effects they are fitted together."""

    file: ClassVar[str] = "calibration.json"

    oxidizer_mass_fitted: Annotated[Quantity | None, Is("load, fitted with all else", "kg")] = None
    tank_temperature: Annotated[Quantity | None, Is("at the opening, fitted with all else", "K")] = None
    one_by_one: Annotated[Mapping[str, Quantity], Is("the constants as they are one after the other")] = {}
    effects: Adopted = ()

    @property
    def load(self) -> Quantity:
        """The oxidizer [kg] that an engine with these constants starts with: fitted with adopted effects."""
        return self.oxidizer_mass_fitted or self.oxidizer_mass

    def alone(self, name: str) -> Quantity:
        """A constant [SI] as it is by itself, with the balance of the load as it was weighed closed."""
        found = self.one_by_one.get(name) or getattr(self, name)
        assert isinstance(found, Quantity)
        return found
