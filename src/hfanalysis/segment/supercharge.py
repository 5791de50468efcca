"""Whether nitrogen presses on the tank: by its pressure at rest, or because it flows in from the start."""

from __future__ import annotations

import numpy as np

from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.signals import Signal
from hfanalysis.sentences import said, text
from hfanalysis.thermo.nitrous import saturation

SATURATION_MARGIN = 8.0
"""Kelvin by which the top of a heated tank may be hotter than its thermometer says [K]. Evidence: on real stands it is
often the thermometer that is wrong (docs/phases.md)."""

FROM_THE_START = 0.3
"""Nitrogen that flows within this time [s] of the opening presses on the liquid, not on what it leaves."""


def supercharge(
    tank: Signal, thermometer: Signal | None, t_purge: float | None, definition: TestDefinition
) -> tuple[bool, list[str]]:
    """Whether the ``tank`` [Pa] is supercharged, and what there is to say.

    ``thermometer``: T_tank [K], where the log has it; ``t_purge`` [s]: nitrogen enters.
    """
    critical = saturation(definition.model.properties).pressure_range[1]
    rest = tank.mean(-3.0, -0.05)
    if rest > critical:
        above = "the tank is supercharged: {rest} before the opening, above the critical pressure ({critical})"
        return True, [text(above, rest=said(rest, "bar", ".1f"), critical=said(critical, "bar", ".1f"))]
    if t_purge is not None and t_purge < FROM_THE_START:
        return True, ["the tank is supercharged: nitrogen feeds it from the opening on"]
    return False, _too_cold(rest, _temperature(thermometer, definition), definition)


def _too_cold(rest: float, warmth: float | None, definition: TestDefinition) -> list[str]:
    """Where the pressure at rest [Pa] is more than the thermometer [K] allows; that alone proves nothing."""
    source = saturation(definition.model.properties)
    if warmth is None or not source.t_min < warmth < source.t_max - SATURATION_MARGIN:
        return []
    if not rest > float(source.pressure(warmth + SATURATION_MARGIN)):
        return []
    return [
        text(
            "the tank stands at {rest} before the opening, but saturation at the {warmth:.0f} degC of its thermometer "
            "is {saturated}: it is supercharged, or the thermometer does not see the oxidizer",
            rest=said(rest, "bar", ".1f"),
            warmth=warmth - 273.15,
            saturated=said(float(source.pressure(warmth)), "bar", ".1f"),
        )
    ]


def _temperature(thermometer: Signal | None, definition: TestDefinition) -> float | None:
    if thermometer is not None:
        quiet = thermometer.between(-30.0, -0.05).value
        return float(np.median(quiet)) if quiet.size else None
    tank = definition.tank
    return tank.temperature.value if tank is not None and tank.temperature is not None else None
