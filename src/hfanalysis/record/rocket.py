"""[rocket] of test.toml and engine files: what the flight stage needs; values in SI."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from hfanalysis.record.schema import (
    Altitude,
    Area,
    Count,
    Factor,
    Length,
    Mass,
    Place,
    Positive,
    Refused,
    Section,
    Text,
    between,
    quantity,
    section,
)
from hfanalysis.units import Value

_WIND = between(0.0, 60.0, "between 0 and 60 m/s")
_UPRIGHT = between(0.0, math.radians(90.0), "between 0 and 90 degrees from the vertical")


@section
class NoseSection(Section):
    """Nose cone: kind and length [m]."""

    kind: Literal["cone", "ogive", "von_karman", "ellipsoid"]
    length: Length


@section
class Body(Section):
    """Body tube: length [m]."""

    length: Length


@section
class FinsSection(Section):
    """Fin set: count, chords, span, sweep length, position of the root's leading edge, thickness [m]."""

    count: Count
    root: Length
    tip: Place
    span: Length
    sweep: Place | None = None
    position: Place | None = None
    thickness: Length | None = None


@section
class TailSection(Section):
    """Boat tail: length, aft diameter, position [m]."""

    length: Length
    diameter: Length
    position: Place | None = None


@section
class Structure(Section):
    """Everything but the engine: mass [kg] and center of gravity [m from the nose tip]."""

    mass: Mass
    center_of_gravity: Place


@section
class Geometry(Section):
    """[rocket.geometry]: lengths [m] from the nose tip; roughness of the surface [m]."""

    nose: NoseSection | None = None
    body: Body | None = None
    fins: FinsSection | None = None
    tail: TailSection | None = None
    structure: Structure | None = None
    roughness: Length | None = None
    tank_position: Place | None = None
    chamber_position: Place | None = None
    engine_mass: Mass | None = None
    engine_center_of_gravity: Place | None = None


@section
class ParachuteSection(Section):
    """[rocket.drogue]: drag coefficient and area [m^2]."""

    drag_coefficient: Factor
    area: Area


@section
class MainParachute(ParachuteSection):
    """[rocket.main]: opens at ``deploy_altitude`` [m above ground]."""

    deploy_altitude: Length | None = None


@section
class Rocket(Section):
    """[rocket]: dry mass [kg], drag, diameter [m] or frontal area [m^2], rail and launch site.

    ``drag_uncertainty``, ``shot_to_shot``: relative standard deviation of the drag, and of the thrust from one firing
    to the next; ``wind_speed`` [m/s] at the launch;
    ``effective_rail_length`` [m]: until the first guide leaves the rail; ``casing_diameter``, ``casing_length`` [m]: of
    the engine, for engine files.
    """

    dry_mass: Mass
    drag_coefficient: Factor | None = None
    drag_table: Text | None = None
    drag_uncertainty: Annotated[Positive, Field(lt=1.0)] | None = None
    shot_to_shot: Annotated[Positive, Field(lt=1.0)] | None = None
    diameter: Length | None = None
    frontal_area: Area | None = None
    launch_angle: Annotated[Value, quantity("angle", _UPRIGHT)] | None = None
    rail_length: Length | None = None
    effective_rail_length: Length | None = None
    casing_diameter: Length | None = None
    casing_length: Length | None = None
    launch_altitude: Altitude | None = None
    wind_speed: Annotated[Value, quantity("velocity", _WIND)] | None = None
    geometry: Geometry | None = None
    drogue: ParachuteSection | None = None
    main: MainParachute | None = None

    def check(self) -> None:
        self._not_both("drag_coefficient", "drag_table")
        self._not_both("diameter", "frontal_area")
        guided, rail = self.effective_rail_length, self.rail_length
        if guided is not None and rail is not None and guided.value > rail.value:
            raise Refused(
                f"found {guided.value:g} m; expected no more than the rail_length, {rail.value:g} m",
                "effective_rail_length",
            )

    @property
    def guided_length(self) -> float | None:
        """Over which the rail guides the rocket [m]: the effective length, else the rail's; None where neither is
        known."""
        length = self.effective_rail_length or self.rail_length
        return None if length is None else length.value
