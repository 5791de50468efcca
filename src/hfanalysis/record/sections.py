"""The sections that test.toml and engine files share; values in SI."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import PlainValidator

from hfanalysis.record.schema import (
    ANY,
    NOT_NEGATIVE,
    POSITIVE,
    Altitude,
    Area,
    Count,
    Duration,
    Factor,
    Length,
    ListOf,
    Mass,
    Name,
    NotNegative,
    Number,
    PressureDifference,
    Refused,
    Remainder,
    Room,
    Section,
    Share,
    Text,
    UpToTwo,
    Volume,
    between,
    quantity,
    read_quantity,
    section,
)
from hfanalysis.thermo.fuels import PARAFFIN, Fuel, atoms_of, blend, molar_mass
from hfanalysis.units import Value

LIQUID_DENSITY_LIMIT = 1250.0
"""[kg/m^3] above any liquid nitrous oxide that can be loaded. Source: saturated liquid at its normal boiling point,
1230 kg/m^3 (CoolProp)."""

_DENSITY = between(100.0, 20e3, "between 100 and 20000 kg/m^3")
_FORMATION = (-10e6, 1.5e6)
"""Heats of formation that solid fuels have [J/kg]. Source: by choice: sugars have -7, acrylic -4, paraffin -2, rubbers
and styrenes up to +1 MJ/kg; the report's slip of a sign would be +1.96."""
_AMBIENT = between(20e3, 120e3, "an absolute ambient pressure, between 0.2 and 1.2 bar")
_LAUNCH = between(220.0, 330.0, "a temperature of the air, 220 to 330 K")
_LOADABLE = between(182.0, 350.0, "a temperature at which nitrous oxide can be in a tank, 182 to 350 K")


@section
class Model(Section):
    """[model]: what the physics assumes; ``nozzle``: by which law a flight's thrust is taken to altitude, where the log
    is not to be asked."""

    conventions: Literal["corrected", "report"] = "corrected"
    properties: Literal["coolprop", "report"] = "coolprop"
    nozzle: Literal["one-dimensional", "separated"] | None = None


@section
class DipTubeSection(Section):
    """[tank] dip_tube: diameters [m]."""

    outer_diameter: Length
    inner_diameter: Length

    def check(self) -> None:
        if self.inner_diameter.value >= self.outer_diameter.value:
            raise Refused("the inner diameter is not smaller than the outer diameter")


def _exponent(found: Any) -> Value | str:
    if found == "c_p/c_v":
        return "c_p/c_v"
    try:
        return read_quantity(found, "dimensionless", POSITIVE)
    except Refused:
        raise ValueError("'c_p/c_v', or a number that is more than zero") from None


@section
class Tank(Section):
    """[tank]: tank and feed line; volume [m^3], oxidizer mass loaded before the valve opens [kg], temperature [K];
    ``nitrogen_pressure``: that of a supercharged tank before the valve opens [Pa]."""

    volume: Volume | None = None
    oxidizer_mass: Mass | None = None
    temperature: Annotated[Value, quantity("temperature", _LOADABLE)] | None = None
    inner_diameter: Length | None = None
    length: Length | None = None
    ullage: Share | None = None
    dip_tube: DipTubeSection | None = None
    polytropic_exponent: Annotated[Value | str, PlainValidator(_exponent)] | None = None
    nitrogen_pressure: Annotated[Value, quantity("pressure", POSITIVE)] | None = None

    def check(self) -> None:
        if self.volume is None or self.oxidizer_mass is None:
            return
        most = self.volume.value * LIQUID_DENSITY_LIMIT
        if self.oxidizer_mass.value > most:
            raise Refused(
                f"found {self.oxidizer_mass.value:.4g} kg in a tank of {self.volume.value * 1e3:.4g} L; "
                f"expected no more than {most:.4g} kg, a tank full of liquid",
                "oxidizer_mass",
            )


@section
class Feed(Section):
    """[feed] of an engine file: constant loss [Pa] or loss coefficient [1/m^4]."""

    p_loss: PressureDifference | None = None
    K_loss: Annotated[Value, quantity("loss_coefficient", NOT_NEGATIVE)] | None = None

    def check(self) -> None:
        self._not_both("p_loss", "K_loss")


@section
class Injector(Section):
    """[injector]: number of holes, area [m^2] or diameter [m] of one."""

    holes: Count | None = None
    hole_area: Area | None = None
    hole_diameter: Length | None = None
    C_i: UpToTwo | None = None

    def check(self) -> None:
        self._not_both("hole_area", "hole_diameter")

    @property
    def hole(self) -> Value | None:
        """Area of one hole [m^2]; None where it is not known."""
        return _circle(self.hole_diameter) if self.hole_diameter else self.hole_area

    @property
    def area(self) -> Value | None:
        """Area of all holes together [m^2]; None where it is not known."""
        one = self.hole
        if self.holes is None or one is None:
            return None
        return Value(self.holes * one.value, None if one.std is None else self.holes * one.std)


@section
class Purge(Section):
    """[purge]: pressure difference [Pa] at which the check valve between purge line and tank opens."""

    cracking_pressure: PressureDifference | None = None


@section
class FuelPart(Section):
    """What a fuel is made of: a formula, and its heat of formation at 25 degC, of a mass [J/kg] or a mole [J/mol]."""

    formula: Text
    enthalpy: Annotated[Value, quantity("specific_energy")] | None = None
    molar_enthalpy: Annotated[Value, quantity("molar_energy")] | None = None
    share: Share | None = None

    def check(self) -> None:
        self._not_both("enthalpy", "molar_enthalpy")
        _fuel("", self.formula, self.enthalpy, self.molar_enthalpy)


def _fuel(name: str, formula: str, enthalpy: Value | None, molar_enthalpy: Value | None) -> Fuel:
    """As chemistry knows it; Refused where it is none, or its enthalpy is not stated."""
    try:
        atoms = atoms_of(formula)
    except ValueError as error:
        raise Refused(f"found {error}", "formula") from None
    mass = PARAFFIN.molar_mass if atoms == PARAFFIN.atoms else molar_mass(atoms)
    if enthalpy is None and molar_enthalpy is None:
        raise Refused("expected 'enthalpy' or 'molar_enthalpy': the heat of formation of what burns at 25 degC")
    found = enthalpy.value if enthalpy is not None else 1e3 * molar_enthalpy.value / mass if molar_enthalpy else 0.0
    if not _FORMATION[0] <= found <= _FORMATION[1]:
        low, high = (1e-6 * end for end in _FORMATION)
        raise Refused(
            f"found {1e-6 * found:.3g} MJ/kg; expected a heat of formation from {low:g} to {high:g} MJ/kg: "
            "is the sign or the unit another, or is it one of combustion?",
            "enthalpy" if enthalpy is not None else "molar_enthalpy",
        )
    return Fuel(name, atoms, mass, found)


@section
class FuelSection(Section):
    """[fuel]: what the grain is made of; without it paraffin, n-eicosane. ``parts``: of a blend, with their shares by
    mass."""

    name: Text = ""
    formula: Text | None = None
    enthalpy: Annotated[Value, quantity("specific_energy")] | None = None
    molar_enthalpy: Annotated[Value, quantity("molar_energy")] | None = None
    parts: ListOf[FuelPart] = ()

    def check(self) -> None:
        if bool(self.parts) == (self.formula is not None):
            raise Refused("expected a 'formula' with its enthalpy, or 'parts' that have them")
        if self.parts:
            shares = [part.share for part in self.parts]
            total = sum(share.value for share in shares if share is not None)
            if None in shares or abs(total - 1.0) > 1e-3:
                raise Refused(
                    f"found shares of {100.0 * total:.4g} % together; expected one of each part, 100 % in all", "parts"
                )
        self._not_both("enthalpy", "molar_enthalpy")
        _ = self.made

    @property
    def made(self) -> Fuel:
        """As chemistry knows it."""
        name = self.name or self.formula or "blend"
        if self.formula is not None:
            return _fuel(name, self.formula, self.enthalpy, self.molar_enthalpy)
        found = [(p.share.value, _fuel("", p.formula, p.enthalpy, p.molar_enthalpy)) for p in self.parts if p.share]
        return blend(name, found)


def fuel_of(stated: FuelSection | None) -> Fuel:
    """What burns: as stated, else paraffin."""
    return PARAFFIN if stated is None else stated.made


@section
class GrainSection(Section):
    """[grain]: mass [kg], length [m], density [kg/m^3], outer radius [m]; regression a [SI], n."""

    mass: Mass | None = None
    length: Length | None = None
    density: Annotated[Value, quantity("density", _DENSITY)] | None = None
    outer_radius: Length | None = None
    a: Factor | None = None
    n: UpToTwo | None = None

    def check(self) -> None:
        if not (self.mass and self.length and self.density and self.outer_radius):
            return
        room = math.pi * self.outer_radius.value**2 * self.length.value
        needed = self.mass.value / self.density.value
        if needed >= room:
            raise Refused(
                f"found {self.outer_radius.value * 1e3:.4g} mm; expected room for the grain: "
                f"{self.mass.value:.4g} kg needs {needed * 1e3:.4g} L, a full cylinder of that radius and length holds "
                f"{room * 1e3:.4g} L",
                "outer_radius",
            )


@section
class Chamber(Section):
    """[chamber]: volumes before and after the grain [m^3]."""

    pre_volume: Room | None = None
    post_volume: Room | None = None


@section
class NozzleSection(Section):
    """[nozzle]: radii [m]."""

    throat_radius: Length | None = None
    exit_radius: Length | None = None

    def check(self) -> None:
        if self.throat_radius and self.exit_radius and self.exit_radius.value < self.throat_radius.value:
            raise Refused(
                f"found {self.exit_radius.value * 1e3:.4g} mm; expected no less than the throat radius, "
                f"{self.throat_radius.value * 1e3:.4g} mm",
                "exit_radius",
            )


@section
class Site(Section):
    """[site]: altitude [m] or ambient pressure [Pa, absolute] of the stand; air temperature [K] and pressure [Pa,
    absolute] at the launch site on the day of the launch."""

    altitude: Altitude | None = None
    ambient_pressure: Annotated[Value, quantity("pressure", _AMBIENT)] | None = None
    launch_temperature: Annotated[Value, quantity("temperature", _LAUNCH)] | None = None
    launch_pressure: Annotated[Value, quantity("pressure", _AMBIENT)] | None = None


@section
class StandSection(Section):
    """[stand]: how the engine stands, and the force [N] with which a full feed line pushes on the thrust cell."""

    orientation: Literal["horizontal", "vertical", "nozzle up", "nozzle down"] = "horizontal"
    feed_line_tare: Annotated[Value, quantity("force", ANY)] | None = None


@section
class ObservedSection(Section):
    """[observed]: seen or measured outside the log; time [s], radii [m], masses [kg]. ``port_radius_after``, of a grain
    that was not burnt up, says what ``fuel_mass_after`` says, and one of them is stated."""

    burn_time: Duration | None = None
    throat_radius_after: Length | None = None
    port_radius_after: Length | None = None
    fuel_mass_after: Remainder | None = None
    oxidizer_mass_after: Remainder | None = None


@section
class EngineSection(Section):
    """[engine] of an engine file."""

    id: Name
    description: Text = ""
    stand: Name | None = None


@section
class CovarianceSection(Section):
    """[covariance] of an engine file: errors of its constants together; standard deviations [SI], correlation."""

    names: ListOf[Text]
    std: ListOf[NotNegative]
    correlation: ListOf[ListOf[Number]]

    def check(self) -> None:
        size = len(self.names)
        if len(self.std) != size:
            raise Refused(f"found {len(self.std)} numbers; expected one for each of the {size} names", "std")
        if [len(row) for row in self.correlation] != [size] * size:
            raise Refused(f"expected {size} rows of {size} numbers, as there are names", "correlation")


@section
class DesignSection(Section):
    """[design] of an engine file: flow [kg/s], chamber pressure [Pa], target apogee [m]."""

    oxidizer_flow: Annotated[Value, quantity("mass_flow", POSITIVE)] | None = None
    chamber_pressure: Annotated[Value, quantity("pressure", POSITIVE)] | None = None
    target_apogee: Length | None = None


def _circle(diameter: Value) -> Value:
    """Area [m^2] of a hole of this diameter [m]."""
    std = None if diameter.std is None else math.pi / 2.0 * diameter.value * diameter.std
    return Value(math.pi / 4.0 * diameter.value**2, std)
