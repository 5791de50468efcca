"""What a solved steady design comes to as hardware: the injector's holes, the port, and the tank for its load."""

from __future__ import annotations

from collections.abc import Callable

from hfanalysis.assembly import engine as build
from hfanalysis.assembly import tank as held
from hfanalysis.errors import InputError
from hfanalysis.quantity import Quantity
from hfanalysis.record.engine_file import Needs
from hfanalysis.steady_design.injector import Holes, holes_for, injector_area
from hfanalysis.steady_design.steady import Requirement

TANK = {"tank_length": "m", "dip_tube_length": "m", "tank_volume": "m^3"}
"""Quantities of a tank with their units."""


def area(needs: Needs, asked: Requirement) -> float:
    """C_i N_i A_i [m^2] of the design. Raises InputError where the tank does not say, or does not hold enough."""
    try:
        return injector_area(
            held.saturated(needs), build.line_loss(needs.file), asked.oxidizer_flow, asked.chamber_pressure
        )
    except ValueError as error:
        raise InputError(f"{needs.file.where('design', 'chamber_pressure')}: {error}") from None


def holes(needs: Needs, asked: Requirement) -> Holes:
    """As many holes of the stated area as come nearest to the design, or the stated number of the area that meets it.

    Raises InputError where neither is stated, or C_i is not.
    """
    stated = needs.file.injector
    discharge = needs.value(stated.C_i, "injector", "C_i").value
    one = stated.hole.value if stated.hole else None
    if one is None:
        needs.value(stated.holes, "injector", "hole_area (or hole_diameter, or holes)")
    if not discharge > 0.0:
        raise InputError(f"{needs.file.where('injector', 'C_i')}: found 0; expected a number that is more than zero")
    return holes_for(area(needs, asked), discharge, one, stated.holes)


def injector(needs: Needs, asked: Requirement) -> dict[str, Quantity]:
    """Area C_i N_i A_i [m^2], number of holes and area of one [m^2]; each that cannot be had says why."""
    return {
        "injector_area": _had(needs, "m^2", lambda: area(needs, asked)),
        "injector_holes": _had(needs, "", lambda: holes(needs, asked).count),
        "injector_hole_area": _had(needs, "m^2", lambda: holes(needs, asked).area),
    }


def tank(needs: Needs, mass: float) -> dict[str, Quantity]:
    """The tank for a load ``mass`` [kg], by the file's ullage, length or volume; why, where it cannot be had."""
    try:
        return of_tank(held.tank(needs, mass))
    except InputError as error:
        return {name: _absent(needs, error) for name in TANK}


def of_tank(built: held.TankBuilt) -> dict[str, Quantity]:
    """Lengths [m] and volume [m^3] of a tank."""
    size = built.size
    return {
        "tank_length": Quantity(size.length, "m") if size else Quantity.absent(built.reason),
        "dip_tube_length": Quantity(size.dip_tube_length, "m")
        if size and built.dipped
        else Quantity.absent(built.reason),
        "tank_volume": Quantity(built.volume, "m^3"),
    }


def _had(needs: Needs, unit: str, found: Callable[[], float]) -> Quantity:
    try:
        return Quantity(float(found()), unit)
    except InputError as error:
        return _absent(needs, error)


def _absent(needs: Needs, error: InputError) -> Quantity:
    return Quantity.absent(str(error).removeprefix(f"{needs.file.path}, "))
