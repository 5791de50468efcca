"""The sections that test.toml and engine files share: each a frozen dataclass, values in SI."""

# ruff: noqa: RUF009  (key() makes dataclass fields, not defaults)
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from hfanalysis.errors import InputError
from hfanalysis.testdata.schema import (
    NOT_NEGATIVE,
    POSITIVE,
    Where,
    between,
    integer,
    key,
    number,
    one_of,
    quantity,
    section,
    text,
)
from hfanalysis.units import Value

LIQUID_DENSITY_LIMIT = 1250.0
"""[kg/m^3] above any liquid nitrous oxide that can be loaded (1230 at its normal boiling point)."""

_DENSITY = between(100.0, 20e3, "between 100 and 20000 kg/m^3")
_ALTITUDE = between(-500.0, 9000.0, "between -500 and 9000 m")
_AMBIENT = between(20e3, 120e3, "an absolute ambient pressure, between 0.2 and 1.2 bar")
_LOADABLE = between(182.0, 350.0, "a temperature at which nitrous oxide can be in a tank, 182 to 350 K")

Maybe = Value | None


@dataclass(frozen=True)
class Model:
    """[model]: what the physics assumes."""

    conventions: str = key(one_of("corrected", "report"), "corrected")
    properties: str = key(one_of("coolprop", "report"), "coolprop")


@dataclass(frozen=True)
class DipTube:
    """[tank] dip_tube: diameters [m]."""

    outer_diameter: Value = key(quantity("length", POSITIVE))
    inner_diameter: Value = key(quantity("length", POSITIVE))

    def check(self, where: Where) -> None:
        if self.inner_diameter.value >= self.outer_diameter.value:
            raise InputError(f"{where}: the inner diameter is not smaller than the outer diameter")


def _exponent(found: Any, where: Where) -> float | str:
    return "c_p/c_v" if found == "c_p/c_v" else float(number(POSITIVE)(found, where))


@dataclass(frozen=True)
class Tank:
    """[tank]: tank and feed line; volume [m^3], oxidizer mass loaded before the valve opens [kg], temperature [K]."""

    volume: Maybe = key(quantity("volume", POSITIVE), None)
    oxidizer_mass: Maybe = key(quantity("mass", POSITIVE), None)
    temperature: Maybe = key(quantity("temperature", _LOADABLE), None)
    inner_diameter: Maybe = key(quantity("length", POSITIVE), None)
    length: Maybe = key(quantity("length", POSITIVE), None)
    ullage: float | None = key(number(NOT_NEGATIVE), None)
    dip_tube: DipTube | None = key(section(DipTube), None)
    polytropic_exponent: float | str | None = key(_exponent, None)

    def check(self, where: Where) -> None:
        if self.volume is None or self.oxidizer_mass is None:
            return
        most = self.volume.value * LIQUID_DENSITY_LIMIT
        if self.oxidizer_mass.value > most:
            raise InputError(
                f"{where / 'oxidizer_mass'}: found {self.oxidizer_mass.value:.4g} kg in a tank of "
                f"{self.volume.value * 1e3:.4g} L; expected no more than {most:.4g} kg, a tank full of liquid"
            )


@dataclass(frozen=True)
class Feed:
    """[feed] of an engine file: constant loss [Pa] or loss coefficient [1/m^4]."""

    p_loss: Maybe = key(quantity("pressure_difference", NOT_NEGATIVE), None)
    K_loss: Maybe = key(quantity("loss_coefficient", NOT_NEGATIVE), None)

    def check(self, where: Where) -> None:
        _not_both(self, "p_loss", "K_loss", where)


@dataclass(frozen=True)
class Injector:
    """[injector]: number of holes, area of one [m^2]; a stated diameter [m] gives the area."""

    holes: int | None = key(integer(1), None)
    hole_area: Maybe = key(quantity("area", POSITIVE), None)
    hole_diameter: Maybe = key(quantity("length", POSITIVE), None)
    C_i: float | None = key(number(between(0.0, 2.0, "between 0 and 2")), None)

    def check(self, where: Where) -> None:
        _not_both(self, "hole_area", "hole_diameter", where)
        if self.hole_diameter is not None:
            object.__setattr__(self, "hole_area", _circle(self.hole_diameter))

    @property
    def area(self) -> Maybe:
        """Area of all holes together [m^2]; None where it is not known."""
        if self.holes is None or self.hole_area is None:
            return None
        std = self.hole_area.std
        return Value(self.holes * self.hole_area.value, None if std is None else self.holes * std)


@dataclass(frozen=True)
class Purge:
    """[purge]: pressure difference [Pa] at which the check valve between purge line and tank opens."""

    cracking_pressure: Maybe = key(quantity("pressure_difference", NOT_NEGATIVE), None)


@dataclass(frozen=True)
class Grain:
    """[grain]: mass [kg], length [m], density [kg/m^3], outer radius [m]; regression a [SI], n."""

    mass: Maybe = key(quantity("mass", POSITIVE), None)
    length: Maybe = key(quantity("length", POSITIVE), None)
    density: Maybe = key(quantity("density", _DENSITY), None)
    outer_radius: Maybe = key(quantity("length", POSITIVE), None)
    a: float | None = key(number(POSITIVE), None)
    n: float | None = key(number(between(0.0, 2.0, "between 0 and 2")), None)

    def check(self, where: Where) -> None:
        if not (self.mass and self.length and self.density and self.outer_radius):
            return
        room = math.pi * self.outer_radius.value**2 * self.length.value
        needed = self.mass.value / self.density.value
        if needed >= room:
            raise InputError(
                f"{where / 'outer_radius'}: found {self.outer_radius.value * 1e3:.4g} mm; expected room for the grain: "
                f"{self.mass.value:.4g} kg needs {needed * 1e3:.4g} L, a full cylinder of that radius and length holds "
                f"{room * 1e3:.4g} L"
            )


@dataclass(frozen=True)
class Chamber:
    """[chamber]: volumes before and after the grain [m^3]."""

    pre_volume: Maybe = key(quantity("volume", NOT_NEGATIVE), None)
    post_volume: Maybe = key(quantity("volume", NOT_NEGATIVE), None)


@dataclass(frozen=True)
class Nozzle:
    """[nozzle]: radii [m]."""

    throat_radius: Maybe = key(quantity("length", POSITIVE), None)
    exit_radius: Maybe = key(quantity("length", POSITIVE), None)

    def check(self, where: Where) -> None:
        if self.throat_radius and self.exit_radius and self.exit_radius.value < self.throat_radius.value:
            raise InputError(
                f"{where / 'exit_radius'}: found {self.exit_radius.value * 1e3:.4g} mm; expected no less than the "
                f"throat radius, {self.throat_radius.value * 1e3:.4g} mm"
            )


@dataclass(frozen=True)
class Site:
    """[site]: altitude [m] or ambient pressure [Pa, absolute]."""

    altitude: Maybe = key(quantity("length", _ALTITUDE), None)
    ambient_pressure: Maybe = key(quantity("pressure", _AMBIENT), None)


@dataclass(frozen=True)
class Observed:
    """[observed]: seen or measured outside the log; time [s], radius [m], masses [kg]."""

    burn_time: Maybe = key(quantity("time", POSITIVE), None)
    throat_radius_after: Maybe = key(quantity("length", POSITIVE), None)
    fuel_mass_after: Maybe = key(quantity("mass", NOT_NEGATIVE), None)
    oxidizer_mass_after: Maybe = key(quantity("mass", NOT_NEGATIVE), None)


@dataclass(frozen=True)
class Engine:
    """[engine] of an engine file."""

    id: str = key(text)
    description: str = key(text, "")
    stand: str | None = key(text, None)


@dataclass(frozen=True)
class Design:
    """[design] of an engine file: flow [kg/s], chamber pressure [Pa], target apogee [m]."""

    oxidizer_flow: Maybe = key(quantity("mass_flow", POSITIVE), None)
    chamber_pressure: Maybe = key(quantity("pressure", POSITIVE), None)
    target_apogee: Maybe = key(quantity("length", POSITIVE), None)


def _circle(diameter: Value) -> Value:
    """Area [m^2] of a hole of this diameter [m]."""
    std = None if diameter.std is None else math.pi / 2.0 * diameter.value * diameter.std
    return Value(math.pi / 4.0 * diameter.value**2, std)


def _not_both(made: Any, one: str, other: str, where: Where) -> None:
    if getattr(made, one) is not None and getattr(made, other) is not None:
        raise InputError(f"{where}: both {one!r} and {other!r} are given; expected one of them")
