"""An engine file turned into what the models take; the models know nothing of files."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

from hfanalysis.assembly import rocket
from hfanalysis.assembly.burnt_gas import combustion_of
from hfanalysis.assembly.tank import TankBuilt, nitrogen_mass, properties, temperature
from hfanalysis.assembly.tank import tank as tank
from hfanalysis.engine import unsteady
from hfanalysis.engine.feed_line import FeedSystem
from hfanalysis.engine.grain import Grain
from hfanalysis.errors import InputError
from hfanalysis.record.engine_file import EngineFile, Needs
from hfanalysis.record.sections import fuel_of
from hfanalysis.rocket.parachute import Parachute
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.steady_design import injector, steady
from hfanalysis.thermo import atmosphere, combustion
from hfanalysis.thermo.saturation import Property
from hfanalysis.units import Value

_STANDARD = 101_325.0
"""Ambient pressure [Pa] where none is stated. Source: standard atmosphere."""


@dataclass(frozen=True)
class OxidizerEnthalpy:
    """Of the oxidizer entering the chamber on the formation scale [J/kg], and whose it is."""

    value: float
    of: str


def oxidizer_enthalpy(needs: Needs) -> OxidizerEnthalpy:
    """What the conventions take [J/kg]: PROPEP's ideal gas (report), or the liquid at the tank's initial
    temperature."""
    if needs.file.model.conventions == "report":
        return OxidizerEnthalpy(combustion.PROPEP_OXIDIZER_ENTHALPY, "PROPEP: ideal gas at 298.15 K")
    t = temperature(needs)
    liquid = float(properties(needs.file).energy(Property.LIQUID_ENTHALPY, t)[0])
    return OxidizerEnthalpy(combustion.FORMATION_OFFSET + liquid, f"saturated liquid at {t:.2f} K")


def ambient_pressure(file: EngineFile) -> float:
    """At the site [Pa]: stated, or of its altitude, or of the launch site's, or of sea level."""
    if file.site.ambient_pressure is not None:
        return file.site.ambient_pressure.value
    return float(atmosphere.pressure(site_altitude(file)))


def site_altitude(file: EngineFile) -> float:
    """Altitude [m] of the site: stated, the launch site's, or (from a pressure, by the atmosphere model) that of it."""
    if file.site.altitude is not None:
        return file.site.altitude.value
    if file.rocket is not None and file.rocket.launch_altitude is not None:
        return file.rocket.launch_altitude.value
    pressure = file.site.ambient_pressure
    return atmosphere.altitude_of(pressure.value if pressure else _STANDARD)


def feed(needs: Needs, volume: float) -> FeedSystem:
    """Feed line and injector on a tank of that ``volume`` [m^3]. Raises InputError where the file does not say
    enough."""
    stated, line = needs.file.injector, needs.file.feed
    key = "hole_area (or hole_diameter)" if stated.holes is not None else "holes"
    area = needs.value(stated.area, "injector", key).value * needs.value(stated.C_i, "injector", "C_i").value
    if not area > 0.0:
        raise InputError(f"{needs.file.where('injector', 'C_i')}: found 0; expected a number that is more than zero")
    if line.K_loss is not None:
        return FeedSystem(volume, area, loss_factor=line.K_loss.value)
    loss = needs.value(line.p_loss, "feed", "p_loss (or K_loss)").value
    return FeedSystem(volume, area, constant_losses=(loss, loss))


def line_loss(file: EngineFile) -> injector.Line:
    """What the feed line of the file loses; nothing where it does not say."""
    stated = file.feed
    if stated.K_loss is not None:
        return injector.Line(factor=stated.K_loss.value)
    return injector.Line(stated.p_loss.value if stated.p_loss else 0.0)


def vehicle(file: EngineFile) -> Vehicle | str:
    """The rocket of the file, or why it cannot fly."""
    return rocket.vehicle(file.rocket, file.path.parent, launch_altitude(file))


def launch_altitude(file: EngineFile) -> float:
    """Of the rocket's launch site [m]: stated, or that of the engine's site."""
    if file.rocket is not None and file.rocket.launch_altitude is not None:
        return file.rocket.launch_altitude.value
    return site_altitude(file)


def parachutes(file: EngineFile) -> tuple[Parachute, Parachute] | str:
    """Drogue and main, or why there is no descent under them."""
    return rocket.parachutes(file.rocket)


def steady_grain(needs: Needs) -> Grain:
    """The grain's casing [m] and regression law. Raises InputError where the file lacks one of them."""
    grain = needs.file.grain
    return Grain(
        length=needs.value(grain.length, "grain", "length").value,
        outer_radius=needs.value(grain.outer_radius, "grain", "outer_radius").value,
        density=needs.value(grain.density, "grain", "density").value,
        a=needs.value(grain.a, "grain", "a").value,
        n=needs.value(grain.n, "grain", "n").value,
    )


def fuel_mass(needs: Needs) -> float:
    """Mass of the grain [kg]; the section itself has checked that it fits."""
    return needs.value(needs.file.grain.mass, "grain", "mass").value


def requirement(needs: Needs) -> steady.Requirement:
    """What a steady design starts from [kg/s, Pa, m]; the exit is ideally expanded where the file gives no radius.

    Raises InputError for a chamber pressure that is not above ambient.
    """
    stated, exit_radius = needs.file.design, needs.file.nozzle.exit_radius
    ambient = ambient_pressure(needs.file)
    pressure = needs.value(stated.chamber_pressure, "design", "chamber_pressure").value
    if pressure <= ambient:
        raise InputError(
            f"{needs.file.where('design', 'chamber_pressure')}: found {pressure / 1e5:.4g} bar; expected more than the "
            f"ambient pressure of {ambient / 1e5:.4g} bar"
        )
    return steady.Requirement(
        oxidizer_flow=needs.value(stated.oxidizer_flow, "design", "oxidizer_flow").value,
        chamber_pressure=pressure,
        ambient=ambient,
        exit_radius=exit_radius.value if exit_radius else None,
        oxidizer_enthalpy=oxidizer_enthalpy(needs).value,
        fuel=fuel_of(needs.file.fuel),
    )


def engine(needs: Needs, built: TankBuilt) -> unsteady.Engine:
    """The unsteady engine on its rocket, or on its stand at the site where there is none that can fly.

    Raises InputError where the file does not say enough, or where nothing flows.
    """
    file, grain = needs.file, steady_grain(needs)
    flying = vehicle(file)
    throat = needs.value(file.nozzle.throat_radius, "nozzle", "throat_radius").value
    exit_radius = needs.value(file.nozzle.exit_radius, "nozzle", "exit_radius").value
    made = unsteady.Engine(
        saturation=properties(file),
        combustion=combustion_of(fuel_of(file.fuel)),
        feed=feed(needs, built.volume),
        oxidizer_mass=needs.value(file.tank.oxidizer_mass, "tank", "oxidizer_mass").value,
        temperature=temperature(needs),
        polytropic_exponent=_exponent(needs),
        fuel_mass=fuel_mass(needs),
        grain_length=grain.length,
        outer_radius=grain.outer_radius,
        fuel_density=grain.density,
        a=grain.a,
        n=grain.n,
        dead_volume=_dead_volume(needs),
        throat_area=pi * throat**2,
        exit_area=pi * exit_radius**2,
        vehicle=flying if isinstance(flying, Vehicle) else None,
        ambient_pressure=ambient_pressure(file),
        oxidizer_enthalpy=combustion.PROPEP_OXIDIZER_ENTHALPY if file.model.conventions == "report" else None,
        nitrogen_mass=nitrogen_mass(needs, built.volume),
    )
    return _that_flows(needs, made)


def _exponent(needs: Needs) -> float | None:
    """The polytropic exponent; None for c_p/c_v of the vapor when the liquid runs out."""
    found = needs.file.tank.polytropic_exponent
    needs.value(found, "tank", "polytropic_exponent")
    return found.value if isinstance(found, Value) else None


def _dead_volume(needs: Needs) -> float:
    chamber = needs.file.chamber
    before = needs.value(chamber.pre_volume, "chamber", "pre_volume").value
    return before + needs.value(chamber.post_volume, "chamber", "post_volume").value


def _that_flows(needs: Needs, made: unsteady.Engine) -> unsteady.Engine:
    """The engine, if its tank can push anything through the line at all."""
    at_rest = made.tank_pressure
    loss = made.feed.constant_losses[0] if made.feed.constant_losses else 0.0
    ambient = made.ambient
    if at_rest - loss <= ambient:
        raise InputError(
            f"{needs.file.where('tank', 'temperature')}: the tank's {at_rest / 1e5:.4g} bar less {loss / 1e5:.4g} bar "
            f"in the feed line do not exceed the ambient {ambient / 1e5:.4g} bar; nothing flows"
        )
    return made


def scaled(needs: Needs, made: unsteady.Engine, oxidizer_mass: float, of_ratio: float) -> unsteady.Engine:
    """The same engine with a load ``oxidizer_mass`` [kg] at an ``of_ratio`` [-] of loaded masses.

    The ullage stays (tank volume per mass). Raises ValueError where the fuel does not fit into the casing.
    """
    fuel = oxidizer_mass / of_ratio
    steady_grain(needs).port_radius(fuel)
    grown = oxidizer_mass / made.oxidizer_mass
    feed = replace(made.feed, volume=made.feed.volume * grown)
    nitrogen = made.nitrogen_mass * grown
    return replace(made, oxidizer_mass=oxidizer_mass, nitrogen_mass=nitrogen, fuel_mass=fuel, feed=feed)


def casing_diameter(file: EngineFile) -> float | None:
    """The wider of tank and grain [m]; None where neither is known."""
    widths = [2.0 * file.grain.outer_radius.value] if file.grain.outer_radius else []
    widths += [file.tank.inner_diameter.value] if file.tank.inner_diameter else []
    return max(widths, default=None)
