"""[rocket.geometry] turned into a shape, and into where the masses are."""

from __future__ import annotations

from math import pi

from hfanalysis.record.rocket import Geometry, Rocket
from hfanalysis.record.sections import Chamber, GrainSection, Tank
from hfanalysis.rocket.aerodynamics import REGULAR_PAINT, Fins, Nose, Shape, Tail
from hfanalysis.rocket.balance import Masses, MassPart, Places, TankPlace

AGREE = 0.02
"""Relative difference [-] within which the dry mass and the sum of structure and engine are the same rocket."""


def shape(rocket: Rocket | None) -> Shape | str:
    """The rocket's outside [m], or what is not given of it."""
    geometry = rocket.geometry if rocket is not None else None
    if rocket is None or geometry is None:
        return "no [rocket.geometry] is given"
    if rocket.diameter is None:
        return "rocket.diameter is not given"
    if geometry.nose is None or geometry.body is None:
        return f"rocket.geometry.{'nose' if geometry.nose is None else 'body'} is not given"
    nose = Nose(geometry.nose.kind, geometry.nose.length.value)
    aft = nose.length + geometry.body.length.value
    rough = geometry.roughness.value if geometry.roughness is not None else REGULAR_PAINT
    return Shape(
        rocket.diameter.value, nose, geometry.body.length.value, _fins(geometry, aft), _tail(geometry, aft), rough
    )


def _fins(geometry: Geometry, aft: float) -> Fins | None:
    """Without a sweep the trailing edge is straight; without a position the root ends where the body does."""
    fins = geometry.fins
    if fins is None:
        return None
    sweep = fins.sweep.value if fins.sweep is not None else fins.root.value - fins.tip.value
    position = fins.position.value if fins.position is not None else aft - fins.root.value
    thickness = fins.thickness.value if fins.thickness is not None else 0.0
    return Fins(fins.count, fins.root.value, fins.tip.value, fins.span.value, sweep, position, thickness)


def _tail(geometry: Geometry, aft: float) -> Tail | None:
    tail = geometry.tail
    if tail is None:
        return None
    return Tail(tail.length.value, tail.diameter.value, tail.position.value if tail.position is not None else aft)


def built(
    rocket: Rocket | None, tank: Tank | None, grain: GrainSection | None, chamber: Chamber | None
) -> tuple[Shape, Masses] | str:
    """The rocket's outside, and where its masses [kg] are [m from the nose tip]; or what is not given of them."""
    outside = shape(rocket)
    geometry = rocket.geometry if rocket is not None else None
    if isinstance(outside, str):
        return outside
    assert rocket is not None
    assert geometry is not None
    if geometry.structure is None:
        return "rocket.geometry.structure is not given"
    where = places(rocket, tank, grain, chamber)
    if isinstance(where, str):
        return where
    engine = _engine(geometry, outside)
    parts = (MassPart(geometry.structure.mass.value, geometry.structure.center_of_gravity.value, outside.length),)
    dry = (*parts, *((engine,) if engine else ()))
    return outside, Masses(dry, where, engine, _remark(rocket, geometry, engine))


def places(
    rocket: Rocket | None, tank: Tank | None, grain: GrainSection | None, chamber: Chamber | None
) -> Places | str:
    """Where the engine holds its propellant [m from the nose tip], or what is not given of it."""
    geometry = rocket.geometry if rocket is not None else None
    if geometry is None:
        return "no [rocket.geometry] is given"
    needed = {
        "rocket.geometry.tank_position": geometry.tank_position,
        "rocket.geometry.chamber_position": geometry.chamber_position,
        "tank.volume": tank and tank.volume,
        "tank.inner_diameter (or length)": tank and (tank.inner_diameter or tank.length),
        "grain.length": grain and grain.length,
        "grain.outer_radius": grain and grain.outer_radius,
    }
    missing = [name for name, found in needed.items() if not found]
    if missing:
        return f"{missing[0]} is not given"
    place = _tank(geometry, tank)
    pre, length, post = _chamber(grain, chamber)
    assert geometry.chamber_position is not None
    top = geometry.chamber_position.value
    front, end = min(place.top, top), top + pre + length + post
    return Places(
        place,
        top + pre + 0.5 * length,
        length,
        top + 0.5 * (pre + length + post),
        front,
        max(end, place.top + place.length) - front,
    )


def _engine(geometry: Geometry, outside: Shape) -> MassPart | None:
    """The empty engine, where it is weighed apart; a rod from its front to the rocket's end."""
    if geometry.engine_mass is None or geometry.engine_center_of_gravity is None:
        return None
    center = geometry.engine_center_of_gravity.value
    return MassPart(geometry.engine_mass.value, center, 2.0 * max(outside.length - center, 0.0))


def _tank(geometry: Geometry, tank: Tank | None) -> TankPlace:
    assert tank is not None
    assert tank.volume is not None
    assert geometry.tank_position is not None
    if tank.length is not None:
        length = tank.length.value
    else:
        assert tank.inner_diameter is not None
        length = tank.volume.value / (0.25 * pi * tank.inner_diameter.value**2)
    return TankPlace(geometry.tank_position.value, length, tank.volume.value)


def _chamber(grain: GrainSection | None, chamber: Chamber | None) -> tuple[float, float, float]:
    """Lengths [m] before, along and behind the grain, the casing as wide as the grain."""
    assert grain is not None
    assert grain.length is not None
    assert grain.outer_radius is not None
    area = pi * grain.outer_radius.value**2
    volumes = (chamber.pre_volume, chamber.post_volume) if chamber is not None else (None, None)
    pre, post = (volume.value / area if volume is not None else 0.0 for volume in volumes)
    return pre, grain.length.value, post


def _remark(rocket: Rocket, geometry: Geometry, engine: MassPart | None) -> str:
    assert geometry.structure is not None
    total = geometry.structure.mass.value + (float(engine.mass) if engine is not None else 0.0)
    if abs(total / rocket.dry_mass.value - 1.0) < AGREE:
        return ""
    of = "structure and engine" if engine is not None else "the structure (no engine_mass is given)"
    return f"{of} weigh {total:.2f} kg, the dry mass is {rocket.dry_mass.value:.2f} kg; the balance takes the former"
