"""The tank at rest: do pressure, loaded mass and volume fit a saturated tank, and how cold is the liquid really?

A tank that was filled and heated is hotter above than below; its gauge shows the warm top. When the valve opens the
pressure falls to what the bulk of the liquid can sustain, and from there on mass and temperature are tied by the
saturated blowdown. So the blowdown says which bulk temperature it started from, and also, without a load cell, which
mass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.tank import internal_energy, mass_along_blowdown, split
from hfanalysis.sentences import said, text
from hfanalysis.thermo.saturation import Property, Saturation

STRATIFIED = 2.0
"""Difference [K] between the gauge's and the bulk's saturation temperature that is worth a word. Evidence:
test_rest.py: a warm gauge over a cold bulk is stratified."""

MODEL_MASS_SPREAD = 0.05
"""Relative standard deviation of the blowdown's own mass from heat and stratification that an adiabatic tank lacks.
Evidence: test_rest.py: a load off by kilograms shows all the same."""


@dataclass(frozen=True)
class BulkFit:
    """Temperature of the saturated liquid [K] against the mass that has left [kg], taken back to the opening."""

    temperature: float
    std: float


def fit_bulk(left: Array, temperature: Array) -> BulkFit | None:
    """Extrapolate T_sat(p_tank) to the moment when nothing had left, over samples from t_feed to t_v.

    ``left`` [kg] (n,) increases; the ``temperature`` [K] (n,) of a saturated blowdown is close to a quadratic in it.
    None for too few samples.
    """
    if left.size < 12 or not np.isfinite(temperature).all() or not left[-1] > 0.0 or np.ptp(temperature) == 0.0:
        return None
    scale = left[-1]
    coefficients, covariance = np.polyfit(left / scale, temperature, 2, cov=True)
    return BulkFit(float(coefficients[-1]), float(np.sqrt(covariance[-1, -1])))


def blowdown_mass(saturation: Saturation, volume: float, bulk: float, t_v_temperature: float) -> float | None:
    """Mass [kg] that an adiabatic tank of ``volume`` [m^3] held saturated at ``bulk`` [K], run dry at
    ``t_v_temperature`` [K].
    """
    if not t_v_temperature < bulk < saturation.t_max:
        return None
    return float(mass_along_blowdown(saturation, volume, t_v_temperature, np.array([bulk]))[0])


def liquid_phase_heat(saturation: Saturation, volume: float, mass: float, bulk: float, t_end: float) -> float:
    """Heat [J] that the tank received from the opening to t_v: Q = U_v - U_0 + integral of h_l dm.

    ``mass`` [kg] at ``bulk`` [K] leaves as saturated liquid until only vapor at ``t_end`` [K] is left; how its
    temperature falls with the mass that has gone is taken from the adiabatic tank.
    """
    start = float(internal_energy(saturation, volume, mass, bulk))
    vapor = volume * float(saturation.vapor_density(t_end))
    end = vapor * float(saturation.energy(Property.VAPOR_ENERGY, t_end)[0])
    temperatures = np.linspace(t_end, bulk, 101)
    held = mass_along_blowdown(saturation, volume, t_end, temperatures)
    h = saturation.energy(Property.LIQUID_ENTHALPY, temperatures)[0]
    return end - start + float(np.trapezoid(h, held) / (held[-1] - held[0])) * (mass - vapor)


def state_remarks(
    saturation: Saturation, volume: float, mass: float, pressure: float
) -> tuple[float | None, list[str]]:
    """Liquid share [-] of the volume at rest, and in words where pressure, mass and volume do not fit a saturated tank.

    ``volume`` [m^3], ``mass`` [kg], ``pressure`` [Pa].
    """
    t = float(saturation.temperature(pressure))
    if not np.isfinite(t):
        limit = saturation.pressure_range[1]
        return None, [
            text(
                "at rest the tank stands at {pressure}, above nitrous oxide's critical pressure ({limit}): it is "
                "supercharged or its gauge is off, and no saturated tank",
                pressure=said(pressure, "bar", ".1f"),
                limit=said(limit, "bar", ".1f"),
            )
        ]
    parts = split(saturation, volume, mass, t)
    share = parts.liquid / float(saturation.liquid_density(t)) / volume
    where = text(
        "{mass:.2f} kg in {volume:.1f} L at {pressure} ({warmth:.1f} degC if saturated)",
        mass=mass,
        volume=volume * 1e3,
        pressure=said(pressure, "bar", ".1f"),
        warmth=t - 273.15,
    )
    if parts.vapor < 0.0:
        fits = _coldest_fit(saturation, volume, mass)
        return share, [
            text(
                "{where}: more than the tank holds as saturated liquid; it fits only below {fits:.0f} degC, so the "
                "bulk is colder than the gauge says, the mass is too large, or the tank is supercharged",
                where=where,
                fits=fits - 273.15,
            )
        ]
    if parts.liquid < 0.0:
        less = "{where}: less than the saturated vapour alone would weigh; mass, volume or pressure is off"
        return share, [text(less, where=where)]
    return share, []


def _coldest_fit(saturation: Saturation, volume: float, mass: float) -> float:
    """Temperature [K] below which the mass fits as liquid alone."""
    t = np.linspace(saturation.t_min, saturation.t_max, 400)
    density = saturation.liquid_density(t)
    return float(np.interp(mass / volume, density[::-1], t[::-1]))
