"""The injector of a design: the area that lets its oxidizer flow through (report, section 3.2.1)."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from hfanalysis.engine.feed_line import line_loss


@dataclass(frozen=True)
class Saturated:
    """Liquid that waits in the tank: pressure [Pa] and density [kg/m^3]."""

    pressure: float
    density: float


@dataclass(frozen=True)
class Line:
    """The feed line's loss: constant [Pa], or K_loss [1/m^4] where that is None; without either it loses nothing."""

    constant: float | None = None
    factor: float = 0.0


def behind_line(tank: Saturated, line: Line, flow: float) -> float:
    """Pressure [Pa] before the injector at an oxidizer ``flow`` [kg/s]."""
    lost = line.constant if line.constant is not None else line_loss(line.factor, flow, tank.density)
    return tank.pressure - float(lost)


def injector_area(tank: Saturated, line: Line, flow: float, chamber: float) -> float:
    """C_i N_i A_i [m^2] for an oxidizer ``flow`` [kg/s] into a ``chamber`` [Pa], from mdot = C_i N_i A_i sqrt(2 rho
    (p_run - p_c)).

    Raises ValueError where the tank does not hold more than the chamber is to have.

    >>> report = Saturated(57.2912e5, 742.5)
    >>> round(injector_area(report, Line(0.345e5), 2.5, 27.579e5), 8)
    3.786e-05
    """
    drop = behind_line(tank, line, flow) - chamber
    if not drop > 0.0:
        bars = f"{chamber / 1e5:.4g} bar: the tank holds {(drop + chamber) / 1e5:.4g} bar behind its feed line"
        raise ValueError(f"no injector lets {flow:.3g} kg/s into a chamber of {bars}")
    return flow / sqrt(2.0 * tank.density * drop)


@dataclass(frozen=True)
class Holes:
    """How many holes, and the area of one [m^2]."""

    count: int
    area: float


def holes_for(area: float, discharge: float, hole: float | None, count: int | None) -> Holes:
    """Holes for C_i N_i A_i = ``area`` [m^2] with C_i ``discharge`` [-].

    As many of ``hole`` [m^2] as come nearest, one at least; without it, ``count`` of the area that meets it. Raises
    ValueError where neither is given.

    >>> holes_for(3.786e-5, 1.0, 3.79e-6, None)
    Holes(count=10, area=3.79e-06)
    """
    if hole is not None:
        return Holes(max(1, round(area / (discharge * hole))), hole)
    if count is None:
        raise ValueError("neither the holes' area nor their number is given")
    return Holes(count, area / (discharge * count))
