"""Which oxidizer mass the calibration works with, and how well it is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.calibrate.rest import MODEL_MASS_SPREAD, blowdown_mass
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import NORMAL_95
from hfanalysis.record.default_deviations import OXIDIZER_MASS
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.sections import Tank
from hfanalysis.record.signals import Signal
from hfanalysis.thermo.saturation import Saturation

UNSTATED = OXIDIZER_MASS.share
"""Relative standard deviation of a loaded mass that is stated without one. Source: record/default_deviations.py.
Evidence: test_rest.py: it counts as known to one percent."""

ULLAGE_READ = 0.05
"""Standard deviation of a stated ullage without one: vapor over liquid volume [-]. Evidence: a fill that is stopped
when the vent spits is known to some per cent of the tank."""
WARMTH_READ = 4.0
"""How much colder than its top the liquid may be [K], one standard deviation. Evidence: 6.6 K of HF5, 8.5 K of HF4 by
their gauges (docs/calibration.md)."""


@dataclass(frozen=True)
class LoadedMass:
    """The mass [kg], its standard deviation, and in words where it comes from; ``doubts``: what speaks against it.

    It was ``weighed``, or follows from what the log and other statements say.
    """

    value: float
    std: float
    source: str
    weighed: bool = True
    doubts: tuple[str, ...] = ()

    def against(self, doubts: Mapping[str, float]) -> LoadedMass:
        """The same with the other masses [kg] by the words that say them within its 95 %."""
        away = max((abs(other - self.value) for other in doubts.values()), default=0.0)
        return replace(self, std=float(np.hypot(self.std, away / NORMAL_95)), doubts=tuple(doubts))


def loaded_mass(
    log: TestLog,
    segments: Segments,
    definition: TestDefinition,
    saturation: Saturation,
    histories: MeasuredPressures,
    p_v: float,
) -> LoadedMass | None:
    """The stated mass [kg], else the load cell's quiet reading, else by volume and fill, else what the blowdown itself
    says; else None.

    ``p_v``: tank pressure [Pa] at the end of the liquid.
    """
    tank = definition.tank
    if tank is not None and tank.oxidizer_mass is not None:
        mass, std = tank.oxidizer_mass.value, definition.known_std("tank.oxidizer_mass")
        return LoadedMass(mass, std, f"{mass:.3f} +/- {std:.3f} kg as stated")
    cell = load_cell_mass(log, segments)
    if cell is not None:
        return LoadedMass(*cell, f"{cell[0]:.3f} +/- {cell[1]:.3f} kg from the load cell at rest; none is stated")
    if tank is None or tank.volume is None:
        return None
    by_fill = _by_fill(log, segments, tank, saturation)
    if by_fill is not None:
        return by_fill
    return _from_blowdown(saturation, histories, tank.volume.value, segments, p_v)


def load_cell_mass(log: TestLog, segments: Segments) -> tuple[float, float] | None:
    """Quiet reading of the tank's load cell before the opening [kg] with the standard deviation of its bias."""
    channel = log.get("m_tank")
    if channel is None or channel.good.sum() < 8:
        return None
    quiet = Signal.of(channel).shifted(segments.t_open.value or 0.0).between(-5.0, -0.1).value
    if quiet.size < 8 or np.median(quiet) <= 0.0:
        return None
    return float(np.median(quiet)), channel.zero_std if channel.zero_std is not None else channel.accuracy


def _by_fill(log: TestLog, segments: Segments, tank: Tank, saturation: Saturation) -> LoadedMass | None:
    """By the stated volume and ullage, of saturated liquid and vapor at the stated temperature or the pressure at rest;
    None where these are not known."""
    if tank.ullage is None or tank.volume is None:
        return None
    warm = tank.temperature.value if tank.temperature is not None else _at_rest(log, segments, saturation)
    liquid, vapor = float(saturation.liquid_density(warm)), float(saturation.vapor_density(warm))
    share, volume = 1.0 / (1.0 + tank.ullage.value), tank.volume
    mass = volume.value * (share * liquid + (1.0 - share) * vapor)
    if not np.isfinite(mass):
        return None
    by_ullage = volume.value * (liquid - vapor) * share**2 * (tank.ullage.std or ULLAGE_READ)
    by_warmth = volume.value * share * abs(float(saturation.liquid_density(warm - WARMTH_READ)) - liquid)
    std = float(np.linalg.norm([by_ullage, by_warmth, mass * (volume.std or 0.0) / volume.value]))
    source = f"{mass:.2f} +/- {std:.2f} kg from [tank] volume and ullage at {warm - 273.15:.0f} degC; none was weighed"
    return LoadedMass(mass, std, source, weighed=False)


def _at_rest(log: TestLog, segments: Segments, saturation: Saturation) -> float:
    """Temperature [K] of saturation at the pressure before the opening; NaN where there is none."""
    rest = Signal.of(log["p_tank"]).shifted(segments.t_open.value or 0.0).mean(-2.0, -0.1)
    return float(saturation.temperature(rest))


def _from_blowdown(
    saturation: Saturation, histories: MeasuredPressures, volume: float, segments: Segments, p_v: float
) -> LoadedMass | None:
    t_feed, t_v = segments.time("t_feed") or 0.1, segments.time("t_v") or 0.0
    liquid = (histories.time > t_feed) & (histories.time < t_v)
    if liquid.sum() < 12:
        return None
    t = histories.tank_temperature(saturation)[liquid]
    fit = np.polyfit(histories.time[liquid], t, 2)
    mass = blowdown_mass(saturation, volume, float(np.polyval(fit, 0.0)), float(saturation.temperature(p_v)))
    if mass is None:
        return None
    std = 2.0 * MODEL_MASS_SPREAD * mass
    return LoadedMass(
        mass,
        std,
        f"{mass:.2f} +/- {std:.2f} kg from the blowdown itself; none is stated and there is no load cell",
        weighed=False,
    )
