"""Size of a cylindrical tank with a dip tube (report, section 3.1.6): for an ullage, or for a length."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from hfanalysis.thermo.saturation import Saturation


@dataclass(frozen=True)
class DipTube:
    """Outer and inner diameter [m]."""

    outer_diameter: float
    inner_diameter: float


@dataclass(frozen=True)
class TankSize:
    """Lengths [m] of tank and dip tube, volumes [m^3], masses [kg] of both phases."""

    length: float
    dip_tube_length: float
    volume: float
    liquid_mass: float
    vapor_mass: float


def size_for_ullage(
    saturation: Saturation, mass: float, temperature: float, diameter: float, tube: DipTube, ullage: float
) -> TankSize:
    """Tank for ``mass`` [kg] at ``temperature`` [K] with U = V_vapor / V_liquid (report, eq. 3.51 to 3.57).

    Inner ``diameter`` [m], ``ullage`` U [-]. The dip tube ends at the liquid's surface, so that its length is that of
    the ullage. Raises ValueError for an ullage that is not positive.
    """
    if not ullage > 0.0:
        raise ValueError(f"an ullage has to be positive, not {ullage}")
    v_l, v_v = float(saturation.liquid_volume(temperature)[0]), float(saturation.vapor_volume(temperature)[0])
    liquid_volume = mass / (1.0 / v_l + ullage / v_v)
    dip = ullage * liquid_volume / _ullage_area(diameter, tube)
    length = liquid_volume / (0.25 * pi * diameter**2) + dip
    return TankSize(length, dip, (1.0 + ullage) * liquid_volume, liquid_volume / v_l, ullage * liquid_volume / v_v)


def size_for_length(
    saturation: Saturation, mass: float, temperature: float, diameter: float, tube: DipTube, length: float
) -> TankSize:
    """The same tank with its ``length`` [m] given instead (report, eq. 3.58); ``mass`` [kg], ``temperature`` [K],
    ``diameter`` [m].

    Raises ValueError where the mass does not fit as saturated liquid and vapor.
    """
    v_l, v_v = float(saturation.liquid_volume(temperature)[0]), float(saturation.vapor_volume(temperature)[0])
    section, ring = 0.25 * pi * diameter**2, _ullage_area(diameter, tube)
    # liquid fills the section below the dip tube's end, vapor the ring around it: mass is linear in the tube's length
    full = section * length / v_l
    dip = (full - mass) / (section / v_l - ring / v_v)
    if not 0.0 <= dip <= length:
        held = f"{ring * length / v_v:.3f} to {full:.3f} kg"
        raise ValueError(f"{mass:.3f} kg are no saturated tank of {length:.3f} m: it holds {held}")
    liquid_volume, vapor_volume = section * (length - dip), ring * dip
    return TankSize(length, dip, liquid_volume + vapor_volume, liquid_volume / v_l, vapor_volume / v_v)


def _ullage_area(diameter: float, tube: DipTube) -> float:
    """Free cross-section [m^2] around the dip tube, its bore included."""
    return 0.25 * pi * (diameter**2 - tube.outer_diameter**2 + tube.inner_diameter**2)
