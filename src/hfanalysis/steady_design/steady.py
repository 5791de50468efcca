"""Steady-state design of a hybrid engine (report, chapter 2): constant oxidizer flow, ideal nozzle, constant thrust.

Everything follows from oxidizer flow, chamber pressure, grain and exit: the burn time and the mean fuel flow have
closed forms because with a constant flow the port opens as r^N, N = 2 n + 1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi, sqrt

from hfanalysis.engine.grain import Grain
from hfanalysis.engine.nozzle import (
    SUPERSONIC,
    area_ratio,
    choked_flow,
    ejected,
    mach_at_area,
    mach_at_pressure,
    pressure_ratio,
)
from hfanalysis.flight.constant_thrust import STANDARD_GRAVITY, Vehicle, apogee, gravity
from hfanalysis.roots import root_between
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY, Gas, equilibrium
from hfanalysis.thermo.fuels import PARAFFIN, Fuel


@dataclass(frozen=True)
class Requirement:
    """What a steady design starts from: oxidizer flow [kg/s], pressures [Pa], exit radius [m] (None: ideal), fuel."""

    oxidizer_flow: float
    chamber_pressure: float
    ambient: float
    exit_radius: float | None
    oxidizer_enthalpy: float = PROPEP_OXIDIZER_ENTHALPY
    fuel: Fuel = PARAFFIN


@dataclass(frozen=True)
class SteadyEngine:
    """A steady design: SI units; ``of_ratio`` is the mean over the burn."""

    burn_time: float
    oxidizer_mass: float
    fuel_mass: float
    of_ratio: float
    chamber_temperature: float
    thrust: float
    throat_radius: float
    exit_radius: float
    total_impulse: float
    specific_impulse: float

    @property
    def propellant_flow(self) -> float:
        """Mean flow through the nozzle [kg/s]."""
        return (self.oxidizer_mass + self.fuel_mass) / self.burn_time

    def thrust_to_weight(self, vehicle: Vehicle) -> float:
        """Thrust over the weight of the loaded rocket on its pad [-]."""
        mass = vehicle.dry_mass + self.oxidizer_mass + self.fuel_mass
        return self.thrust / (mass * gravity(vehicle.launch_altitude))


def design(requirement: Requirement, grain: Grain, fuel_mass: float) -> SteadyEngine:
    """The engine that burns ``fuel_mass`` [kg] of a grain under the requirement (report, eq. 2.1 to 2.15).

    Raises ValueError for a grain that does not fit or an exit smaller than the throat.
    """
    time = grain.burn_time(requirement.oxidizer_flow, fuel_mass)
    fuel_flow = fuel_mass / time
    of_ratio = requirement.oxidizer_flow / fuel_flow
    gas = equilibrium(requirement.chamber_pressure, of_ratio, requirement.oxidizer_enthalpy, fuel=requirement.fuel)
    flow = requirement.oxidizer_flow + fuel_flow
    throat = flow / choked_flow(gas.gamma, _heat(gas), requirement.chamber_pressure, 1.0)
    thrust, exit_area = _thrust(gas, requirement, throat)
    return SteadyEngine(
        burn_time=time,
        oxidizer_mass=requirement.oxidizer_flow * time,
        fuel_mass=fuel_mass,
        of_ratio=of_ratio,
        chamber_temperature=gas.temperature,
        thrust=thrust,
        throat_radius=sqrt(throat / pi),
        exit_radius=sqrt(exit_area / pi),
        total_impulse=thrust * time,
        specific_impulse=thrust / (flow * STANDARD_GRAVITY),
    )


def _thrust(gas: Gas, requirement: Requirement, throat: float) -> tuple[float, float]:
    """Thrust [N] and exit area [m^2] of a supersonic nozzle on a choked throat."""
    if requirement.exit_radius is None:
        mach = mach_at_pressure(requirement.ambient / requirement.chamber_pressure, gas.gamma)
        exit_area = throat * area_ratio(mach, gas.gamma)
    else:
        exit_area = pi * requirement.exit_radius**2
        if exit_area < throat:
            raise ValueError(f"the exit radius of {requirement.exit_radius} m is smaller than the throat's")
        mach = mach_at_area(exit_area / throat, gas.gamma, True)
    pressure = requirement.chamber_pressure * pressure_ratio(mach, gas.gamma)
    chamber = gas.gamma, _heat(gas), requirement.chamber_pressure, requirement.ambient
    return ejected(*chamber, exit_area, mach, pressure, SUPERSONIC)[1], exit_area


def _heat(gas: Gas) -> float:
    """R T [J/kg]."""
    return gas.gas_constant * gas.temperature


def fuel_for_apogee(requirement: Requirement, grain: Grain, vehicle: Vehicle, target: float) -> float:
    """Fuel mass [kg] with which the rocket reaches ``target`` [m] above its site.

    Raises ValueError where no grain in this casing does.
    """
    full = 0.999 * grain.fuel(0.0)

    def miss(mass: float) -> float:
        engine = design(requirement, grain, mass)
        return apogee(vehicle, engine.thrust, engine.propellant_flow, engine.burn_time) - target

    if miss(full) < 0.0:
        raise ValueError(f"no grain in this casing reaches {target:.0f} m; a full one ends {-miss(full):.0f} m below")
    return root_between(lambda mass, _: miss(mass))(None, 1e-3 * full, full, 1e-7)


@dataclass(frozen=True)
class OptimumMixture:
    """The mixture of highest ideally expanded specific impulse [s]."""

    of_ratio: float
    specific_impulse: float


def ideal_specific_impulse(requirement: Requirement, of_ratio: float) -> float:
    """Specific impulse [s] of the ideally expanded nozzle at a mixture ``of_ratio`` [-] (report, eq. 2.9 to 2.15)."""
    gas = equilibrium(requirement.chamber_pressure, of_ratio, requirement.oxidizer_enthalpy, fuel=requirement.fuel)
    thrust, _ = _thrust(gas, replace(requirement, exit_radius=None), 1.0)
    flow = choked_flow(gas.gamma, _heat(gas), requirement.chamber_pressure, 1.0)
    return float(thrust / (flow * STANDARD_GRAVITY))


def optimum(requirement: Requirement) -> OptimumMixture:
    """The best mixture [-] at the chamber pressure, expanded to ambient, with its specific impulse [s]."""
    from scipy.optimize import minimize_scalar

    def loss(of_ratio: float) -> float:
        return -ideal_specific_impulse(requirement, of_ratio)

    found = minimize_scalar(loss, bounds=(2.0, 15.0), method="bounded", options={"xatol": 1e-4})
    return OptimumMixture(float(found.x), -float(found.fun))
