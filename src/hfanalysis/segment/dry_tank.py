"""t_v of a test: the tank's knee, held against the load, the volume and the injector that are stated."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.signals import Signal
from hfanalysis.segment.coarse_load import CoarseLoad, coarse_load
from hfanalysis.segment.liquid import LiquidEnd, dry_pressure, find_liquid_end
from hfanalysis.sentences import said, text
from hfanalysis.thermo.nitrous import saturation

NO_KNEE = "the tank pressure shows no knee: it never falls faster than before, as it does when the liquid is gone"


def liquid_end(signals: Mapping[str, Signal], definition: TestDefinition, end: float) -> LiquidEnd | str:
    """When the liquid is gone, from signals with time from the opening, up to ``end`` [s]; else the reason."""
    if "p_tank" not in signals:
        return "the log has no p_tank: the end of the liquid shows in the tank's pressure"
    tank = signals["p_tank"]
    until = _discharged(tank, end, definition.ambient_pressure.value)
    load = coarse_load(definition, signals)
    dry = _dry_pressure(tank, definition)
    found = find_liquid_end(signals, until, dry, load.contradicts if load else _possible)
    return found if found is not None else _why_none(tank, find_liquid_end(signals, until, None), dry, load)


def _why_none(tank: Signal, knee: LiquidEnd | None, dry: float | None, load: CoarseLoad | None) -> str:
    """Why there is no t_v; a ``knee`` may be there that what is stated contradicts."""
    if knee is None:
        return NO_KNEE
    if load is not None and load.contradicts(knee.time):
        words = (
            "the tank pressure has a knee at {time:.2f} s, but no injector of the stated holes passes the stated "
            "oxidizer by then: [injector] holes and hole_area, or [tank] oxidizer_mass are off"
        )
        return text(words, time=knee.time)
    words = (
        "the tank pressure has a knee at {time:.2f} s and {there}, but a tank of the stated volume and load runs "
        "dry at {dry}: [tank] oxidizer_mass or volume are off"
    )
    there = said(tank.around(knee.time, 0.1), "bar", ".1f")
    return text(words, time=knee.time, there=there, dry=said(dry or 0.0, "bar", ".1f"))


def _dry_pressure(tank: Signal, definition: TestDefinition) -> float | None:
    section = definition.tank
    if section is None or section.volume is None or section.oxidizer_mass is None:
        return None
    source = saturation(definition.model.properties)
    start = min(tank.mean(0.25, 0.75), 0.999 * source.pressure_range[1])
    if not np.isfinite(start):
        return None
    return dry_pressure(source, section.volume.value, section.oxidizer_mass.value, start)


def _possible(_time: float) -> bool:
    return False


def _discharged(tank: Signal, end: float, ambient: float) -> float:
    """When the tank has lost 90 % of its pressure above the lowest: knees beyond that are of no liquid.

    Readings below ``ambient`` [Pa] are of no tank: a failing gauge.
    """
    part = tank.between(0.0, end)
    if part.time.size < 8:
        return end
    smooth = part.smooth(max(0.1, 4.0 * tank.step))
    low, high = max(float(smooth.min()), ambient), float(smooth[0])
    gone = np.flatnonzero(smooth < low + 0.1 * (high - low))
    return float(part.time[gone[0]]) if gone.size else end
