"""Normal force, center of pressure and drag of a rocket from its geometry.

Barrowman (1967) for the slopes of the normal force and where it acts, Galejs for the body's lift at an angle of attack,
and the drag build-up of Niskanen (2009), who follows Hoerner: skin friction, pressure and base drag. Subsonic; between
Mach 0.8 and 1.1 the fins' compressibility is held, which is a guess.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, log, pi, sqrt
from typing import Literal

import numpy as np

from hfanalysis.thermo.air import air
from hfanalysis.thermo.atmosphere import temperature

NoseKind = Literal["cone", "ogive", "von_karman", "ellipsoid"]

REGULAR_PAINT = 60e-6
"""Roughness of an ordinary coat of paint [m]. Source: Niskanen 2009, table 3.2."""

BODY_LIFT = 1.1
"""K of a body that lifts as K A_plan/A_ref sin^2(alpha) [-]. Source: Galejs gives K = 1 to 1.1."""


@dataclass(frozen=True)
class Nose:
    """Kind and length [m]."""

    kind: NoseKind
    length: float


@dataclass(frozen=True)
class Fins:
    """Trapezoidal fins: count, chords, span and sweep of the leading edge, position of the root's leading edge from the
    nose tip [m]; thickness [m], 0 where it is not known."""

    count: int
    root: float
    tip: float
    span: float
    sweep: float
    position: float
    thickness: float = 0.0

    @property
    def area(self) -> float:
        """Of one fin [m^2]."""
        return 0.5 * (self.root + self.tip) * self.span

    @property
    def cos_sweep(self) -> float:
        """Cosine [-] of the sweep of the line through the chords' middles."""
        across = self.sweep + 0.5 * (self.tip - self.root)
        return self.span / sqrt(self.span**2 + across**2)


@dataclass(frozen=True)
class Tail:
    """Conical boat tail: length, aft diameter, position from the nose tip [m]."""

    length: float
    diameter: float
    position: float


@dataclass(frozen=True)
class Shape:
    """A rocket's outside: diameter [m], nose, length of the body tube behind it [m], fins, boat tail, roughness [m]."""

    diameter: float
    nose: Nose
    body_length: float
    fins: Fins | None = None
    tail: Tail | None = None
    roughness: float = REGULAR_PAINT

    @property
    def area(self) -> float:
        """Reference area [m^2]: the body's cross-section."""
        return 0.25 * pi * self.diameter**2

    @property
    def length(self) -> float:
        """From the nose tip to the aft end [m]."""
        return self.nose.length + self.body_length + (self.tail.length if self.tail else 0.0)


@dataclass(frozen=True)
class Component:
    """Slope of the normal force [1/rad] on the reference area, and where it acts [m from the nose tip]."""

    name: str
    slope: float
    position: float


def nose_center(nose: Nose, radius: float) -> float:
    """Where a nose's normal force acts [m from its tip]: L - V/A (Barrowman 1967).

    >>> round(nose_center(Nose("cone", 0.3), 0.05), 4)
    0.2
    """
    fill = {"cone": 1.0 / 3.0, "von_karman": 0.5, "ellipsoid": 2.0 / 3.0}.get(nose.kind)
    if fill is None:
        fill = _ogive_volume(nose.length, radius) / (pi * radius**2 * nose.length)
    return nose.length * (1.0 - fill)


def _ogive_volume(length: float, radius: float) -> float:
    """Of a tangent ogive [m^3]."""
    rho = (length**2 + radius**2) / (2.0 * radius)
    off = rho - radius
    return pi * ((rho**2 + off**2) * length - length**3 / 3.0 - off * (length * off + rho**2 * asin(length / rho)))


def compressibility(mach: float) -> float:
    """Prandtl and Glauert's sqrt(|1 - M^2|) [-], held at Mach 0.8's from 0.8 to 1.1.

    >>> round(compressibility(0.5), 4)
    0.866
    """
    if mach < 0.8:
        return sqrt(1.0 - mach * mach)
    return 0.6 if mach < 1.1 else sqrt(mach * mach - 1.0)


def components(shape: Shape, mach: float) -> list[Component]:
    """What carries normal force [1/rad] at small angles of attack and where [m]: nose, boat tail, fins in the presence
    of the body.

    ``mach`` [-] (Barrowman 1967).
    """
    found = [Component("nose", 2.0, nose_center(shape.nose, 0.5 * shape.diameter))]
    if shape.tail is not None:
        found.append(_tail(shape, shape.tail))
    if shape.fins is not None:
        found.append(_fins(shape, shape.fins, mach))
    return found


def _tail(shape: Shape, tail: Tail) -> Component:
    """A cone frustum: 2 ((d_2/d)^2 - (d_1/d)^2) at L/3 (1 + (1 - d_1/d_2)/(1 - (d_1/d_2)^2))."""
    ratio = tail.diameter / shape.diameter
    position = tail.position + tail.length / 3.0 * (1.0 + 1.0 / (1.0 + 1.0 / ratio))
    return Component("tail", 2.0 * (ratio**2 - 1.0), position)


def _fins(shape: Shape, fins: Fins, mach: float) -> Component:
    """Barrowman's fins with Diederich's slope and the body's interference 1 + R/(s + R); two fins count once."""
    chord, beta = fins.root + fins.tip, compressibility(mach)
    aspect = beta * fins.span**2 / (fins.area * fins.cos_sweep)
    one = 2.0 * pi * fins.span**2 / shape.area / (1.0 + sqrt(1.0 + aspect**2))
    radius = 0.5 * shape.diameter
    slope = 0.5 * fins.count * _crowding(fins.count) * one * (1.0 + radius / (fins.span + radius))
    position = fins.position + fins.sweep / 3.0 * (fins.root + 2.0 * fins.tip) / chord
    position += (chord - fins.root * fins.tip / chord) / 6.0
    return Component("fins", slope, position)


def _crowding(count: int) -> float:
    """How fins of more than four hinder each other (Niskanen 2009, eq. 3.54)."""
    return {5: 0.948, 6: 0.913, 7: 0.854, 8: 0.81}.get(count, 1.0 if count < 5 else 0.75)


def center_of_pressure(parts: list[Component]) -> tuple[float, float]:
    """Slope of the whole [1/rad], and where it acts [m from the nose tip]."""
    slope = sum(part.slope for part in parts)
    return slope, sum(part.slope * part.position for part in parts) / slope


def planform(shape: Shape) -> tuple[float, float]:
    """Area of the body seen from its side [m^2] and its centroid [m from the nose tip]."""
    share, center = {"cone": (0.5, 2.0 / 3.0), "ellipsoid": (0.25 * pi, 1.0 - 4.0 / (3.0 * pi))}.get(
        shape.nose.kind, (2.0 / 3.0, 0.625)
    )
    d, nose, body = shape.diameter, shape.nose.length, shape.body_length
    pieces = [(share * nose * d, center * nose), (body * d, nose + 0.5 * body)]
    if shape.tail is not None:
        aft, tail = shape.tail.diameter, shape.tail
        middle = tail.length / 3.0 * (d + 2.0 * aft) / (d + aft)
        pieces.append((0.5 * (d + aft) * tail.length, tail.position + middle))
    area = sum(piece for piece, _ in pieces)
    return area, sum(piece * at for piece, at in pieces) / area


def wetted_area(shape: Shape) -> float:
    """Of nose, body and boat tail [m^2]."""
    d, nose = shape.diameter, shape.nose.length
    sides = {"cone": 0.5 * pi * d * sqrt(nose**2 + 0.25 * d**2), "ellipsoid": 0.25 * pi**2 * d * nose}
    area = sides.get(shape.nose.kind, 2.0 / 3.0 * pi * d * nose) + pi * d * shape.body_length
    if shape.tail is not None:
        slant = sqrt(shape.tail.length**2 + 0.25 * (d - shape.tail.diameter) ** 2)
        area += 0.5 * pi * (d + shape.tail.diameter) * slant
    return area


def friction(length: float, roughness: float, mach: float, altitude: float) -> float:
    """Skin friction coefficient [-] of a turbulent boundary layer, smooth or rough whichever is more.

    ``length`` and ``roughness`` [m], ``altitude`` above sea level [m]. 1/(1.5 ln Re - 5.6)^2 (1 - 0.1 M^2) and 0.032
    (R_s/L)^0.2 (1 - 0.1 M^2) below Mach 1 (Niskanen 2009, eq. 3.81ff).
    """
    _, rho, sound = air(altitude)
    reynolds = max(rho * mach * sound * length / viscosity(temperature(altitude)), 1e4)
    smooth = 1.0 / (1.5 * log(reynolds) - 5.6) ** 2
    rough = 0.032 * (roughness / length) ** 0.2
    if mach < 1.0:
        return float(max(smooth, rough) * (1.0 - 0.1 * mach**2))
    return float(max(smooth / (1.0 + 0.15 * mach**2) ** 0.58, rough / (1.0 + 0.18 * mach**2)))


def viscosity(t: float) -> float:
    """Of air [Pa s] at a temperature [K] (Sutherland).

    >>> round(viscosity(288.15) * 1e5, 3)
    1.789
    """
    return float(1.458e-6 * t**1.5 / (t + 110.4))


def base_drag(mach: float) -> float:
    """Coefficient [-] on the area of a blunt base: 0.12 + 0.13 M^2, 0.25/M above Mach 1 (Hoerner).

    >>> round(base_drag(0.5), 4)
    0.1525
    """
    return 0.12 + 0.13 * mach**2 if mach < 1.0 else 0.25 / mach


def drag_parts(shape: Shape, mach: float, altitude: float = 0.0) -> dict[str, float]:
    """Drag coefficient [-] at no angle of attack, by part, on the body's cross-section; the engine is not burning.

    ``altitude`` above sea level [m] of the air that it flies through (Niskanen 2009).
    """
    cf, base = friction(shape.length, shape.roughness, mach, altitude), base_drag(mach)
    slender = shape.length / shape.diameter
    found = {
        "body friction": cf * (1.0 + 0.5 / slender) * wetted_area(shape) / shape.area,
        "nose pressure": _nose_pressure(shape),
        "base": base,
    }
    if shape.tail is not None:
        left = (shape.tail.diameter / shape.diameter) ** 2
        found["base"] = base * left
        found["tail pressure"] = base * (1.0 - left) * _steepness(shape, shape.tail)
    if shape.fins is not None:
        found |= _fin_drag(shape, shape.fins, cf, base, mach)
    return found


def _nose_pressure(shape: Shape) -> float:
    """0.8 sin^2 of a cone's half angle; shapes that join the body smoothly have none below Mach 0.8."""
    if shape.nose.kind != "cone":
        return 0.0
    return 0.8 / (1.0 + (2.0 * shape.nose.length / shape.diameter) ** 2)


def _steepness(shape: Shape, tail: Tail) -> float:
    """How much of a base a boat tail is: all of it when steep, nothing from three times as long as it steps down."""
    slope = tail.length / max(shape.diameter - tail.diameter, 1e-9)
    return min(max(0.5 * (3.0 - slope), 0.0), 1.0)


def _fin_drag(shape: Shape, fins: Fins, cf: float, base: float, mach: float) -> dict[str, float]:
    """Friction on both sides and the pressure on rounded leading and trailing edges."""
    chord = 0.5 * (fins.root + fins.tip)
    wetted = 2.0 * fins.count * fins.area / shape.area
    frontal = fins.count * fins.thickness * fins.span / shape.area
    leading = ((1.0 - min(mach, 0.9) ** 2) ** -0.417 - 1.0) * fins.cos_sweep**2
    return {
        "fin friction": cf * (1.0 + 2.0 * fins.thickness / chord) * wetted,
        "fin pressure": frontal * (leading + 0.5 * base),
    }


def drag_table(shape: Shape, altitude: float = 0.0) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Mach numbers and drag coefficients [-] of the build-up, from Mach 0.05 to 0.95, at an ``altitude`` [m]."""
    machs = tuple(float(round(mach, 2)) for mach in np.arange(0.05, 0.96, 0.05))
    return machs, tuple(sum(drag_parts(shape, mach, altitude).values()) for mach in machs)
