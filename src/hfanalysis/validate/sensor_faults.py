"""What looks wrong with the sensors of the engine: verdicts that need no calibration."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from hfanalysis.engine.thrust_coefficient import TOLERANCE, possible
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Finding
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.sentences import said, text
from hfanalysis.validate.performance import Fire
from hfanalysis.validate.thrust import thrust_of

ZERO = "does not return to zero"
"""Of this ingest has warned already."""

DISAGREE = "thrust and p_c A_t disagree"

ZERO_SHARE = 0.02
"""Part of the largest thrust from which on a cell that does not come back to zero is called so. Evidence:
test_sensor_bounds.py."""

BALANCE = (1350.0, 1680.0)
"""Characteristic velocity [m/s] by which the integral of p_c and the propellant give a throat, on either side.
Evidence: equilibrium, frozen in the nozzle, at 20 bar has 1318 at O/F 3, 1546 at 6 to 7 and 1514 at 9 (oxidizer of 1.5
MJ/kg)."""


def findings(log: TestLog, segments: Segments, definition: TestDefinition, fire: Fire | str) -> list[Finding]:
    """Everything that looks wrong."""
    if isinstance(fire, str) or "thrust" not in log:
        return []
    found = [_zero(log, segments, definition, fire), _coefficient(log, segments, definition, fire)]
    return [f for f in found if f is not None]


def _zero(log: TestLog, segments: Segments, definition: TestDefinition, fire: Fire) -> Finding | None:
    """The thrust cell that does not come back to its zero after the burn."""
    channel, thrust = log["thrust"], thrust_of(log, segments, definition)
    burning = thrust.signal.between(0.0, fire.end)
    if not burning.time.size:
        return None
    error, peak = thrust.error, float(np.percentile(burning.value, 99.0))
    std = channel.zero_std if channel.zero_std is not None else channel.accuracy
    std = float(np.sqrt(max(std**2 - channel.doubt**2, 0.0)))  # a doubt must not hide what it is about
    if abs(error) < max(ZERO_SHARE * peak, 5.0 * std):
        return None
    where = f"with the chamber back at ambient ({thrust.since:.1f} s)" if thrust.since > 0.0 else "after the burn"
    words = text(
        "the thrust cell does not return to zero: it reads {error} {where}, {share:.0f} % of the peak; where it is "
        "left in, up to {impulse} of impulse are its drift",
        error=said(error, "N", "+.0f"),
        where=where,
        share=100.0 * abs(error) / peak,
        impulse=said(abs(error) * fire.end, "N s", ".0f"),
    )
    return Finding(channels=("thrust",), verdict=ZERO, text=words, size=Quantity(error, "N", std))


def _coefficient(log: TestLog, segments: Segments, definition: TestDefinition, fire: Fire) -> Finding | None:
    """Thrust and p_c A_t that no nozzle brings together."""
    if "p_chamber" not in log:
        return None
    ambient = definition.ambient_pressure.value
    means = _steady(log, segments, definition, fire)
    throat = _throat(log, segments, definition, fire)
    if means is None or throat is None:
        return None
    (thrust, pressure), (area, relative, source) = means, throat
    if pressure < 2.0 * ambient:
        return None
    low, high = possible(pressure, ambient, area, exit_area(definition))
    value, error = thrust / (pressure * area), 2.0 * relative
    if low * (1.0 - TOLERANCE - error) <= value <= high * (1.0 + TOLERANCE + error):
        return None
    words = text(
        "thrust and p_c A_t disagree: F/(p_c A_t) is {value:.2f} while liquid flows, a nozzle gives {low:.2f} to "
        "{high:.2f} at {pressure} (throat of {area:.0f} mm^2: {source}); thrust cell, chamber gauge or throat is off",
        value=value,
        low=low,
        high=high,
        pressure=said(pressure, "bar", ".1f"),
        area=area * 1e6,
        source=source,
    )
    return Finding(
        channels=("thrust", "p_chamber"), verdict=DISAGREE, text=words, size=Quantity(value, "", value * relative)
    )


def exit_area(definition: TestDefinition) -> float | None:
    """Of the stated nozzle's exit [m^2]; None where it is not stated."""
    nozzle = definition.nozzle
    return None if nozzle is None or nozzle.exit_radius is None else pi * nozzle.exit_radius.value**2


def _steady(log: TestLog, segments: Segments, definition: TestDefinition, fire: Fire) -> tuple[float, float] | None:
    """Mean thrust [N] and chamber pressure [Pa] of the steady part: line full, liquid and fuel still there."""
    origin = segments.t_open.value or 0.0
    ends = [t for name in ("t_v", "t_fuel_out", "t_end") if (t := segments.time(name)) is not None]
    start, end = max(segments.time("t_feed") or 0.0, 0.5), min([*ends, fire.end])
    chamber = Signal.of(log["p_chamber"]).shifted(origin)
    means = [s.mean(start, end) for s in (thrust_of(log, segments, definition).signal, chamber)]
    return (means[0], means[1]) if np.isfinite(means).all() and end > start + 0.5 else None


def _throat(
    log: TestLog, segments: Segments, definition: TestDefinition, fire: Fire
) -> tuple[float, float, str] | None:
    """Throat area [m^2], its relative standard deviation, and where it is from."""
    nozzle = definition.nozzle
    if nozzle is not None and nozzle.throat_radius is not None:
        radius = nozzle.throat_radius
        return pi * radius.value**2, 2.0 * (radius.std or 0.0) / radius.value, "stated"
    tank, grain = definition.tank, definition.grain
    if tank is None or tank.oxidizer_mass is None or grain is None or grain.mass is None:
        return None
    chamber = Signal.of(log["p_chamber"]).shifted(segments.t_open.value or 0.0).between(0.0, fire.end)
    total = float(np.trapezoid(chamber.value, chamber.time)) if chamber.time.size > 8 else 0.0
    if total <= 0.0:
        return None
    areas = [(tank.oxidizer_mass.value + grain.mass.value) * c / total for c in BALANCE]
    middle = sqrt(areas[0] * areas[1])
    return middle, 0.25 * (areas[1] - areas[0]) / middle, "not stated; from propellant, c* and p_c"
