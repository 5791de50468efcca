"""How well a value of test.toml is known that is stated without +/-: a default deviation for each kind of value.

A stated ``+/-`` wins, ``+/- 0`` too; then ``[deviations]`` of the test, then the defaults here. They are of the ruler,
drill and scale that made or measured the part, the same in every repetition: systematic errors.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

from pydantic import PlainValidator

from hfanalysis.errors import InputError
from hfanalysis.record.schema import Section, section
from hfanalysis.units import Value, parse


class Deviation(NamedTuple):
    """One standard deviation: a ``share`` of the value [-], or an ``absolute`` one [SI]."""

    share: float = 0.0
    absolute: float = 0.0

    def of(self, value: float) -> float:
        """Of a ``value`` [SI], in its unit.

        >>> Deviation(share=0.01).of(0.0165), Deviation(absolute=5e-5).of(2e-3)
        (0.000165, 5e-05)
        """
        return self.share * abs(value) + self.absolute


TANK_VOLUME = Deviation(share=0.01)
"""Of tank and line. Source: a tube's inner diameter is kept to half a per cent (EN 10305-1, EN 754-8: 0.15 to 0.5 mm on
60 to 130 mm), which is 1 % of the volume; ends and fittings are as much again on a short tank. Filled with water and
weighed it is known to 0.2 %: then state that."""

OXIDIZER_MASS = Deviation(share=0.01)
"""Loaded, or left. Source: a hanging or platform scale of 0.5 % (OIML R 76 class IIII), the hoses that pull at it, and
what is vented between reading and opening. Evidence: tests/calibrate/test_rest.py."""

FUEL_MASS = Deviation(share=0.01)
"""Of a grain, and of what is left of it as a share of the grain. Source: a bench scale is better than 0.1 %, but liner
and glue, what is shaved off at assembly, soot and slivers are some grams to either side of a kilogram."""

LINE_VOLUME = Deviation(share=0.04)
"""Of the stated volume, what the feed line behind the tank is. Source: 2 to 3 m of 3/4 in tube with its valve are 0.5
to 0.8 L beside a tank of 16.5 L."""

PROPERTIES = Deviation(share=1.0)
"""Of what CoolProp and the report's table differ by, the part up to which the table in use may be off. Source: the
other table is a bound: the report's correlations are off by 1 to 5 % in pressure (docs/properties.md)."""

HOLE_DIAMETER = Deviation(absolute=0.05e-3)
"""Of an injector's holes [m], the same for all: one drill. Source: ISO 2768-1, class m, allows 0.1 mm to either side
from 0.5 to 6 mm; uniform within that is 0.058 mm. It is 5 % of the area of 2 mm holes."""

THROAT_RADIUS = Deviation(absolute=0.05e-3)
"""[m]. Source: ISO 2768-1, class m, allows 0.2 mm to either side of a diameter from 6 to 30 mm; uniform within that is
0.12 mm of the diameter, 0.058 mm of the radius."""

BURN_TIME = Deviation(absolute=0.25)
"""[s]. Source: a flame's end is seen in a video to half a second (report, 4.3.1, states burn times from video to the
second)."""


def _read(dimension: str) -> PlainValidator:
    """A share such as "1 %", or a deviation with its unit."""

    def check(found: Any) -> Deviation:
        if isinstance(found, Deviation):
            return found
        share = isinstance(found, str) and found.rstrip().endswith("%")
        try:
            value = parse(found, "dimensionless" if share else dimension, "").value
        except InputError:
            value = math.nan
        if not value >= 0.0:
            raise ValueError(f"one standard deviation, as a share of the value such as '1 %' or as a {dimension}")
        return Deviation(share=value) if share else Deviation(absolute=value)

    return PlainValidator(check)


@section
class Deviations(Section):
    """[deviations]: one standard deviation of what is stated without +/-, by kind."""

    tank_volume: Annotated[Deviation, _read("volume")] = TANK_VOLUME
    line_volume: Annotated[Deviation, _read("volume")] = LINE_VOLUME
    properties: Annotated[Deviation, _read("dimensionless")] = PROPERTIES
    oxidizer_mass: Annotated[Deviation, _read("mass")] = OXIDIZER_MASS
    fuel_mass: Annotated[Deviation, _read("mass")] = FUEL_MASS
    hole_diameter: Annotated[Deviation, _read("length")] = HOLE_DIAMETER
    throat_radius: Annotated[Deviation, _read("length")] = THROAT_RADIUS
    burn_time: Annotated[Deviation, _read("time")] = BURN_TIME


KINDS = {
    "tank.volume": "tank_volume",
    "tank.oxidizer_mass": "oxidizer_mass",
    "observed.oxidizer_mass_after": "oxidizer_mass",
    "grain.mass": "fuel_mass",
    "observed.fuel_mass_after": "fuel_mass",
    "injector.hole_diameter": "hole_diameter",
    "nozzle.throat_radius": "throat_radius",
    "observed.throat_radius_after": "throat_radius",
    "observed.burn_time": "burn_time",
}
"""The kind of a value of test.toml, by its dotted key."""

SHARE_OF = {"observed.oxidizer_mass_after": "tank.oxidizer_mass", "observed.fuel_mass_after": "grain.mass"}
"""What is left is known to a share of what there was."""


class Stated:
    """What knows its values by their sections; a part of the definition of a test."""

    deviations: Deviations

    def known(self, key: str) -> Value | None:
        """The value [SI] at a dotted key such as "tank.volume", with the default deviation of its kind where it is
        stated without; None where it is not stated. KeyError for a key that has no kind.
        """
        found: Value | None = _at(self, key)
        kind: Deviation = getattr(self.deviations, KINDS[key])
        if found is None or found.std is not None:
            return found
        whole = _at(self, SHARE_OF.get(key, key)) or found
        return Value(found.value, kind.of(whole.value))

    def known_std(self, key: str) -> float:
        """Its standard deviation [SI]; 0 where it is not stated."""
        found = self.known(key)
        return found.std or 0.0 if found is not None else 0.0

    @property
    def injector_area(self) -> Value | None:
        """Area of all holes together [m^2], all of them drilled too wide or too narrow alike; None where not known."""
        injector = _at(self, "injector")
        area: Value | None = injector.area if injector is not None else None
        if area is None or area.std is not None:
            return area
        diameter = math.sqrt(4.0 / math.pi * area.value / injector.holes)
        return Value(area.value, 2.0 * area.value * self.deviations.hole_diameter.of(diameter) / diameter)


def _at(found: Any, key: str) -> Any:
    for name in key.split("."):
        found = getattr(found, name, None)
    return found
