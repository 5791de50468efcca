"""The phases of a test for a comparison with a model that burns: up to where the chamber does.

What burns on for a time when the fuel is gone, and how a chamber without a flame turns cold, is in no model. A fall of
chamber pressure and thrust is followed to where it begins, and where its end was not seen, or seen too late, the
chamber's pressure over the flow tells that there is no flame.
"""

from __future__ import annotations

from hfanalysis.inference.observations.flame import FlameOut, flame_out
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

PRESSURES = ("p_tank", "p_run", "p_chamber")


def as_it_burns(log: TestLog, segments: Segments, definition: TestDefinition, origin: float) -> Segments:
    """The segments with the end of the fuel where the flame begins to go out; as they are where it goes out at once.

    ``origin``: of the opening [s of the log].
    """
    begins, gone = segments.time("t_fuel_out"), segments.time("t_fuel_gone")
    if begins is not None and gone is not None and gone - begins > FADES:
        std = max(segments.std("t_fuel_out"), (gone - begins) / 12.0**0.5)
        segments = ended(segments, begins, std)
    gone = segments.time("t_fuel_gone")
    if gone is None and _left(definition):
        return segments
    found = _flame_out(log, segments, definition, origin)
    if found is None or (gone is not None and gone < found.begins + LATE):
        return segments
    return ended(segments, found.begins, found.std)


def _left(definition: TestDefinition) -> bool:
    """Whether fuel was weighed after the test: then none ended, whatever became of the flame."""
    weighed = definition.observed.fuel_mass_after if definition.observed is not None else None
    return weighed is not None and weighed.value > 0.0


def ended(segments: Segments, at: float, std: float) -> Segments:
    """The segments with the fuel gone at an instant, known to ``std``; both [s]."""
    end = Quantity(at, "s", std)
    return segments.but(t_fuel_out=end, t_fuel_gone=end)


def _flame_out(log: TestLog, segments: Segments, definition: TestDefinition, origin: float) -> FlameOut | None:
    """When the chamber is found to burn no more; None where it is not, or a pressure is missing."""
    if not set(PRESSURES) <= set(log.channels):
        return None
    tank, run, chamber = (signal_of(log, name, origin) for name in PRESSURES)
    if tank.dead or run.dead or chamber.dead:
        return None
    table = saturation(definition.model.properties)
    return flame_out(
        tank, run, chamber, table, segments.time("t_v"), (segments.time("t_end") or LONGEST_RECORD) + BEYOND
    )
