"""The phases of a test for a comparison with a model that burns: up to where the chamber does.

What burns on for a time when the fuel is gone, and how a chamber without a flame turns cold, is in no model. A fall of
chamber pressure and thrust is followed to where it begins, and where its end was not seen, or seen too late, the
chamber's pressure over the flow tells that there is no flame.
"""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.inference.observations.flame import FlameOut, OverFlow, flame_out, shown_to_burn
from hfanalysis.inference.observations.recorded import LONGEST_RECORD, signal_of
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.thermo.nitrous import saturation

FADES = 0.08
"""Seconds from the beginning to the end of a fall from which on it is a fade."""

LATE = 0.1
"""Seconds that a flame may fade before the end of the fuel as it was found, that this is still believed."""

BEYOND = 0.5
"""Seconds after t_end that are looked at: the pressure of a chamber without a flame may be below its limit at once."""

NEEDED = ("p_tank", "p_chamber")
"""Channels without which nothing tells of a flame."""


@dataclass(frozen=True)
class Burning:
    """The segments with the end of the fuel where the flame begins to go out; and until when a flame is ``shown`` [s
    after the opening], where it is neither shown to go out nor to burn to the end."""

    segments: Segments
    shown: float | None = None


def as_it_burns(log: TestLog, segments: Segments, definition: TestDefinition, origin: float) -> Burning:
    """How the chamber burns; the segments are as they were where the flame goes out at once, or not at all.

    ``origin``: of the opening [s of the log].
    """
    begins, gone = segments.time("t_fuel_out"), segments.time("t_fuel_gone")
    if begins is not None and gone is not None and gone - begins > FADES:
        std = max(segments.std("t_fuel_out"), (gone - begins) / 12.0**0.5)
        segments = ended(segments, begins, std)
    gone = segments.time("t_fuel_gone")
    if gone is None and _left(definition):
        return Burning(segments)
    seen = _over_flow(log, segments, definition, origin)
    if seen is None:
        return Burning(segments)
    found, shown = flame_out(seen), None
    if found is None:
        last = segments.time("t_end") if gone is None else segments.time("t_fuel_out")
        shown = shown_to_burn(seen, definition.ambient_pressure.value, last)
        if shown is not None and gone is not None:
            found, shown = FlameOut(shown, gone), None
    if found is not None and (gone is None or gone >= found.begins + LATE):
        return Burning(ended(segments, found.begins, found.std))
    return Burning(segments, shown)


def _left(definition: TestDefinition) -> bool:
    """Whether fuel was weighed after the test: then none ended, whatever became of the flame."""
    weighed = definition.observed.fuel_mass_after if definition.observed is not None else None
    return weighed is not None and weighed.value > 0.0


def ended(segments: Segments, at: float, std: float) -> Segments:
    """The segments with the fuel gone at an instant, known to ``std``; both [s]."""
    end = Quantity(at, "s", std)
    return segments.but(t_fuel_out=end, t_fuel_gone=end)


def _over_flow(log: TestLog, segments: Segments, definition: TestDefinition, origin: float) -> OverFlow | None:
    """What tells of a flame in the chamber; None where a pressure for it is missing."""
    if not set(NEEDED) <= set(log.channels):
        return None
    tank, chamber = (signal_of(log, name, origin) for name in NEEDED)
    if tank.dead or chamber.dead:
        return None
    run = signal_of(log, "p_run", origin) if "p_run" in log else None
    end = (segments.time("t_end") or LONGEST_RECORD) + BEYOND
    run = None if run is None or run.dead else run
    return OverFlow.of(tank, run, chamber, saturation(definition.model.properties), segments.time("t_v"), end)
