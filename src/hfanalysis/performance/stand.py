"""What a stand puts on the thrust cell beside the thrust: the engine's weight where it stands upright, the feed line.

Upright, the cell has the fuel's weight in its zero, and loses it as it burns, in proportion to the impulse. Where a
zero after the firing was taken, too, a straight line between the two zeros has been taken off already: what is left of
the weight is how it differs from that line. With the nozzle up the thrust pushes the way the weight does, with the
nozzle down the other way.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.rocket.vehicle import STANDARD_GRAVITY

SIGNS = {"nozzle up": 1.0, "nozzle down": -1.0}
"""Which way the weight that is gone has to be added [-]."""


def without_stand(
    signal: Signal, log: TestLog, segments: Segments, definition: TestDefinition, zero_after: bool
) -> Signal:
    """The thrust [N] over time [s after the opening], as the engine has it; as it is where [stand] states nothing.

    ``zero_after``: whether a zero after the firing was taken off.
    """
    stand = definition.stand
    if stand is None or signal.time.size < 2:
        return signal
    value = signal.value
    if stand.orientation in SIGNS:
        value = value + SIGNS[stand.orientation] * _weight_gone(signal, definition, zero_after)
    if stand.feed_line_tare is not None:
        value = value - stand.feed_line_tare.value * _line_share(signal, log, segments)
    return replace(signal, value=value)


def unknown_weight(definition: TestDefinition) -> float:
    """Weight [N] of the fuel on the cell of an upright stand of which nobody says where the nozzle points; else 0."""
    stand = definition.stand
    return _fuel(definition) * STANDARD_GRAVITY if stand is not None and stand.orientation == "vertical" else 0.0


def _fuel(definition: TestDefinition) -> float:
    """That burns [kg]; 0 where it is not stated."""
    grain = definition.grain.mass if definition.grain else None
    left = definition.observed.fuel_mass_after if definition.observed else None
    return 0.0 if grain is None else grain.value - (left.value if left is not None else 0.0)


def _weight_gone(signal: Signal, definition: TestDefinition, zero_after: bool) -> Array:
    """[N], (n,): what the fuel's weight has lost, less the line that two zeros have taken off."""
    force = np.where(signal.time > 0.0, np.maximum(signal.value, 0.0), 0.0)
    passed = np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(signal.time))))
    share = passed / passed[-1] if passed[-1] > 0.0 else passed
    if zero_after:
        end = float(np.interp(0.99, share, signal.time))
        share = share - np.clip(signal.time / max(end, 1e-3), 0.0, 1.0)
    return np.asarray(STANDARD_GRAVITY * _fuel(definition) * share)


def _line_share(signal: Signal, log: TestLog, segments: Segments) -> Array:
    """Pressure of the feed line over its largest, above that before the opening [-], (n,); 0 without p_run."""
    if "p_run" not in log:
        return np.zeros(signal.time.size)
    line = Signal.of(log["p_run"]).shifted(segments.t_open.value or 0.0)
    rest = line.mean(-5.0, -0.1)
    above = line.at(signal.time) - (rest if np.isfinite(rest) else float(line.value[0]))
    most = float(np.max(above))
    return np.asarray(np.clip(above / most, 0.0, 1.0)) if most > 0.0 else np.zeros(signal.time.size)
