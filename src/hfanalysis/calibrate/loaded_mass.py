"""Which oxidizer mass the calibration works with, and how well it is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.calibrate.measured_pressures import MeasuredPressures
from hfanalysis.calibrate.rest import MODEL_MASS_SPREAD, blowdown_mass
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import NORMAL_95
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.thermo.saturation import Saturation

UNSTATED = 0.01
"""Relative standard deviation of a loaded mass that is stated without one. Evidence: test_rest.py: it counts as known
to one percent."""


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
    """The stated mass [kg], else the load cell's quiet reading, else what the blowdown itself says; else None.

    ``p_v``: tank pressure [Pa] at the end of the liquid.
    """
    tank = definition.tank
    if tank is not None and tank.oxidizer_mass is not None:
        stated = tank.oxidizer_mass
        std = stated.std if stated.std is not None else UNSTATED * stated.value
        return LoadedMass(stated.value, std, f"{stated.value:.3f} +/- {std:.3f} kg as stated")
    cell = load_cell_mass(log, segments)
    if cell is not None:
        return LoadedMass(*cell, f"{cell[0]:.3f} +/- {cell[1]:.3f} kg from the load cell at rest; none is stated")
    if tank is None or tank.volume is None:
        return None
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
