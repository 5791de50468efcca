"""[rocket] of test.toml and engine files: what the flight stage needs; values in SI."""

# ruff: noqa: RUF009  (key() makes dataclass fields, not defaults)
from __future__ import annotations

import math
from dataclasses import dataclass

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

Maybe = Value | None

_LENGTH = quantity("length", POSITIVE)
_PLACE = quantity("length", NOT_NEGATIVE)
_MASS = quantity("mass", POSITIVE)
_DRAG = number(POSITIVE)
_UPRIGHT = between(0.0, math.radians(90.0), "between 0 and 90 degrees from the vertical")
_ALTITUDE = between(-500.0, 9000.0, "between -500 and 9000 m")


@dataclass(frozen=True)
class Nose:
    """Nose cone: kind and length [m]."""

    kind: str = key(one_of("cone", "ogive", "von_karman", "ellipsoid"))
    length: Value = key(_LENGTH)


@dataclass(frozen=True)
class Body:
    """Body tube: length [m]."""

    length: Value = key(_LENGTH)


@dataclass(frozen=True)
class Fins:
    """Fin set: count, chords, span, sweep length, position of the root's leading edge, thickness [m]."""

    count: int = key(integer(1))
    root: Value = key(_LENGTH)
    tip: Value = key(_PLACE)
    span: Value = key(_LENGTH)
    sweep: Maybe = key(_PLACE, None)
    position: Maybe = key(_PLACE, None)
    thickness: Maybe = key(_LENGTH, None)


@dataclass(frozen=True)
class Tail:
    """Boat tail: length, aft diameter, position [m]."""

    length: Value = key(_LENGTH)
    diameter: Value = key(_LENGTH)
    position: Maybe = key(_PLACE, None)


@dataclass(frozen=True)
class Structure:
    """Everything but the engine: mass [kg] and centre of gravity [m from the nose tip]."""

    mass: Value = key(_MASS)
    center_of_gravity: Value = key(_PLACE)


@dataclass(frozen=True)
class Geometry:
    """[rocket.geometry]: lengths [m] from the nose tip."""

    nose: Nose | None = key(section(Nose), None)
    body: Body | None = key(section(Body), None)
    fins: Fins | None = key(section(Fins), None)
    tail: Tail | None = key(section(Tail), None)
    structure: Structure | None = key(section(Structure), None)
    tank_position: Maybe = key(_PLACE, None)
    chamber_position: Maybe = key(_PLACE, None)
    engine_mass: Maybe = key(_MASS, None)
    engine_center_of_gravity: Maybe = key(_PLACE, None)


@dataclass(frozen=True)
class Parachute:
    """[rocket.drogue]: drag coefficient and area [m^2]."""

    drag_coefficient: float = key(_DRAG)
    area: Value = key(quantity("area", POSITIVE))


@dataclass(frozen=True)
class MainParachute(Parachute):
    """[rocket.main]: opens at ``deploy_altitude`` [m above ground]."""

    deploy_altitude: Maybe = key(quantity("length", POSITIVE), None)


@dataclass(frozen=True)
class Rocket:
    """[rocket]: dry mass [kg], drag, diameter [m] or frontal area [m^2], rail and launch site."""

    dry_mass: Value = key(_MASS)
    drag_coefficient: float | None = key(_DRAG, None)
    drag_table: str | None = key(text, None)
    diameter: Maybe = key(_LENGTH, None)
    frontal_area: Maybe = key(quantity("area", POSITIVE), None)
    launch_angle: Maybe = key(quantity("angle", _UPRIGHT), None)
    rail_length: Maybe = key(_LENGTH, None)
    launch_altitude: Maybe = key(quantity("length", _ALTITUDE), None)
    geometry: Geometry | None = key(section(Geometry), None)
    drogue: Parachute | None = key(section(Parachute), None)
    main: MainParachute | None = key(section(MainParachute), None)

    def check(self, where: Where) -> None:
        for one, other in (("drag_coefficient", "drag_table"), ("diameter", "frontal_area")):
            if getattr(self, one) is not None and getattr(self, other) is not None:
                raise InputError(f"{where}: both {one!r} and {other!r} are given; expected one of them")
