"""Where a source may be: sites of the model, the zero of a sensor, and its clock."""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.unknowns.late_channel import TYPICAL


@dataclass(frozen=True)
class Site:
    """Where a source can be: the model's site or a sensor's channel, its equation, unit, and physical scale."""

    name: str
    equation: str
    unit: str
    typical: float
    sensor: str | None = None


SITES = (
    Site("tank_heat", "tank_energy", "W", 2000.0),
    Site("nitrogen_inflow", "tank_volume", "kg/s", 0.02),
    Site("tank_leak", "tank_volume", "kg/s", 0.05),
    Site("tank_pressure", "tank_energy", "Pa", 1e5),
    Site("injector_factor", "injector", "1", 0.1),
    Site("feed_loss", "feed", "Pa", 1e5),
    Site("regression_factor", "grain", "1", 0.2),
    Site("temperature_factor", "chamber_energy", "1", 0.1),
    Site("throat_factor", "nozzle", "1", 0.05),
    Site("thrust_factor", "nozzle", "1", 0.05),
)
"""Of the model."""

VALVE, SWING = Site("valve", "feed", "Pa", 1e5), Site("swing of the flow", "injector", "1", 0.01)
FAILING = Site("failing flow", "injector", "kg/s", 0.1)
"""Of the model, where what is plain without it acts."""

OFFSET, CLOCK = "offset of ", "clock of "
"""How the names of a sensor's sites begin."""

BEYOND_ACCURACY = 5.0
"""Error of a pressure transducer that is typical of one that errs, in units of its stated accuracy."""

LOAD_CELL_DRIFT = 200.0
"""Typical drift of a thrust cell in the heat of a firing [N]."""


def sensor_site(observed: Observed, name: str) -> Site:
    """A sensor as a site: an offset over time."""
    accuracy = next(c.accuracy for c in observed.channels if c.name == name)
    unit = "N" if name == "thrust" else "kg" if name == "m_tank" else "Pa"
    typical = LOAD_CELL_DRIFT if name == "thrust" else BEYOND_ACCURACY * accuracy
    return Site(OFFSET + name, "sensor", unit, typical, sensor=name)


def clock_site(channel: str) -> Site:
    """A sensor's clock as a site."""
    return Site(CLOCK + channel, "sensor", "s", TYPICAL, sensor=channel)


def site_of(name: str, observed: Observed) -> Site:
    """The site of a name."""
    if name.startswith(OFFSET):
        return sensor_site(observed, name.removeprefix(OFFSET))
    if name.startswith(CLOCK):
        return clock_site(name.removeprefix(CLOCK))
    return next(s for s in (*SITES, VALVE, SWING, FAILING) if s.name == name)
