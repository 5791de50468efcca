"""Numbers of a simulated engine and of its loaded rocket."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hfanalysis.arrays import Array
from hfanalysis.assembly import engine as build
from hfanalysis.engine.unsteady import Burn, Engine
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import EngineFile
from hfanalysis.rocket.vehicle import STANDARD_GRAVITY, gravity


def of_burn(engine: Engine, burnt: Burn, hot: Array | None = None) -> dict[str, Quantity]:
    """Of the burn; ``hot``: the chamber's temperature [K] along it, (n,), where it has been found already."""
    warm = burnt.chamber_temperature() if hot is None else hot
    impulse = float(burnt.state("impulse")[-1])
    loaded = engine.oxidizer_mass + engine.fuel_mass
    burn_time = burn_time_of(burnt)
    known = burn_time.value is not None
    dry = "the liquid does not run out within the burn"
    return {
        "burn_time": burn_time,
        "total_impulse": Quantity(impulse, "N s"),
        "specific_impulse": Quantity(impulse / (STANDARD_GRAVITY * loaded), "s"),
        "peak_chamber_temperature": Quantity(float(warm.max()), "K"),
        "peak_chamber_pressure": Quantity(float(burnt.output("chamber_pressure").max()), "Pa"),
        "peak_thrust": Quantity(peak_thrust(burnt), "N"),
        "average_thrust": Quantity(impulse / burnt.burn_time, "N") if known else burn_time,
        "liquid_depletion_time": Quantity.absent(dry) if burnt.liquid_out is None else Quantity(burnt.liquid_out, "s"),
        "residual_oxidizer_mass": Quantity(float(burnt.state("tank_mass")[-1]), "kg"),
    }


def burn_time_of(burnt: Burn) -> Quantity:
    """Until the fuel is gone [s]."""
    if not burnt.fuel_out:
        return Quantity.absent(f"the fuel is not gone after {burnt.burn_time:.0f} s")
    return Quantity(burnt.burn_time, "s")


def peak_thrust(burnt: Burn) -> float:
    """Highest thrust [N]."""
    return float(burnt.output("thrust").max())


def loaded(file: EngineFile, engine: Engine, burnt: Burn) -> dict[str, Quantity]:
    """The loaded rocket on its pad."""
    if file.rocket is None:
        return {name: Quantity.absent("no [rocket] is given") for name in ("wet_mass", "pad_thrust_to_weight")}
    mass = file.rocket.dry_mass.value + engine.oxidizer_mass + engine.fuel_mass
    weight = mass * gravity(build.launch_altitude(file))
    return {"wet_mass": Quantity(mass, "kg"), "pad_thrust_to_weight": Quantity(peak_thrust(burnt) / weight)}


def of(found: Mapping[str, Any]) -> dict[str, Quantity]:
    """The quantities among what a product has."""
    return {name: one for name, one in found.items() if isinstance(one, Quantity)}
