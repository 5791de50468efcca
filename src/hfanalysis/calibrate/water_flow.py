"""C_i from a flow of water: what the holes let through of what they would ideally, with the density of water.

mdot = C_i N_i A_i sqrt(2 rho dp) (report, eq. 3.2), over the steady part of the flow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hfanalysis.errors import AbsentError
from hfanalysis.products.calibration import Rest, TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import IDENTIFIED, NOT_IDENTIFIABLE, Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal, live_signals

WATER = (998.2, 2.0)
"""Density [kg/m^3] of water at 20 degC and how far it is from that between 5 and 30 degC. Source: CRC Handbook, 999.97
at 5 and 995.65 at 30 degC."""

FLOWS = 0.5
"""Part of the plateau above ambient from which on the line flows."""

STEADY = 0.1
"""Part of the flow left out at either end: opening and closing."""

LEAST_SIGHT = 5.0
"""Noises of a sample [-] by which the plateau has to stand above ambient. Evidence: test_water_flow.py."""

KIND = "water_flow"


@dataclass(frozen=True)
class _Flow:
    """Mass flow [kg/s], its standard deviation, and in words where it is from."""

    value: float
    std: float
    source: str


def is_water(segments: Segments, definition: TestDefinition) -> bool:
    """Whether water flows in this test, as stated or as recognized."""
    return KIND in (segments.kind, definition.test.kind)


def calibrate_water(log: TestLog, segments: Segments, definition: TestDefinition) -> TankConstants:
    """C_i of a water flow; all else is of nitrous oxide, and absent.

    Raises AbsentError where the pressure before the injector is missing or nothing flows.
    """
    run = _signal(log, segments, "p_run")
    if run is None:
        raise AbsentError(f"test {definition.test.id}: the log has no live p_run: a water flow's C_i needs it")
    ambient = definition.ambient_pressure.value
    chamber = _signal(log, segments, "p_chamber")
    start, end = _steady(run, ambient, definition.test.id)
    behind = chamber.at(run.time) if chamber is not None else np.full(run.time.size, ambient)
    part = (run.time >= start) & (run.time < end)
    drop = np.maximum((run.value - behind)[part], 0.0)
    root = float(np.sqrt(drop).mean())
    found = _discharge(log, segments, definition, (start, end), root, float(drop.mean()))
    none = Quantity.absent("water flows: this is a constant of nitrous oxide", verdict=NOT_IDENTIFIABLE)
    names = [name for name, field in TankConstants.model_fields.items() if field.annotation is Quantity]
    note = f"a water flow: C_i with {WATER[0]:.0f} kg/m^3 over {start:.2f} to {end:.2f} s, {drop.mean() / 1e5:.2f} bar"
    rest: dict[str, Rest | None] = dict.fromkeys(("rest", "C_i_history", "tank_history"))
    by_law = {"C_d": {"spi": found}} if found.value is not None else {}
    return TankConstants.model_validate(
        {**dict.fromkeys(names, none), "C_i": found, **rest, **by_law, "notes": (note,), "warnings": ()}
    )


def _discharge(
    log: TestLog, segments: Segments, definition: TestDefinition, span: tuple[float, float], root: float, drop: float
) -> Quantity:
    """C_i from the flow over ``span`` [s]; ``root``: mean root of the pressure drop [Pa^0.5], ``drop``: its mean."""
    area = definition.injector.area if definition.injector else None
    flow = _flow(log, segments, definition, span)
    if area is None:
        return Quantity.absent("[injector] holes and hole_area are not stated", verdict=NOT_IDENTIFIABLE)
    if isinstance(flow, str):
        return Quantity.absent(flow, verdict=NOT_IDENTIFIABLE)
    value = flow.value / (area.value * np.sqrt(2.0 * WATER[0]) * root)
    bias = log["p_run"].zero_std if log["p_run"].zero_std is not None else log["p_run"].accuracy
    parts = (flow.std / flow.value, 0.5 * float(bias) / drop, (area.std or 0.0) / area.value, 0.5 * WATER[1] / WATER[0])
    return Quantity(
        float(value), "", float(abs(value) * np.linalg.norm(parts)), verdict=IDENTIFIED, why=f"of water, {flow.source}"
    )


def _flow(log: TestLog, segments: Segments, definition: TestDefinition, span: tuple[float, float]) -> _Flow | str:
    """By the cell's slope, else by what was in and what was left; or why there is none."""
    cell = _signal(log, segments, "m_tank")
    part = cell.between(*span) if cell is not None else None
    if part is not None and part.time.size > 16:
        return _slope(part)
    loaded, left = definition.known("tank.oxidizer_mass"), definition.known("observed.oxidizer_mass_after")
    if loaded is None or left is None:
        return (
            "no mass flow: the log has no live m_tank, and what was in the tank and what was left of it is not stated "
            "([tank] oxidizer_mass, [observed] oxidizer_mass_after)"
        )
    duration = (span[1] - span[0]) / (1.0 - 2.0 * STEADY)
    gone, std = loaded.value - left.value, float(np.hypot(loaded.std or 0.0, left.std or 0.0))
    if gone <= 0.0:
        return "no mass flow: as much is stated to be left as was loaded"
    return _Flow(gone / duration, std / duration, f"{gone:.3f} kg in {duration:.2f} s")


def _slope(part: Signal) -> _Flow | str:
    """Of a straight line through the cell's readings, with what its noise and wander make of it."""
    x = part.time - part.time.mean()
    weights = x / (x @ x)
    slope = -float(weights @ part.value)
    line = part.value.mean() - slope * x
    left = Signal(part.name, part.time, part.value - line, part.noise, part.step).reduced(0.1)
    w = left.time - left.time.mean()
    std = Noise.of(left, left).std_of(w / (w @ w), left.time)
    return _Flow(slope, float(std), "by the tank's load cell") if slope > 0.0 else "the tank's load cell does not fall"


def _steady(run: Signal, ambient: float, test: str) -> tuple[float, float]:
    """From when to when [s] the line stands at its plateau."""
    after = run.between(0.0, np.inf)
    smooth = after.smooth(0.2) if after.time.size > 16 else np.empty(0)
    level = float(np.percentile(smooth, 90.0)) - ambient if smooth.size else 0.0
    flows = np.flatnonzero(smooth > ambient + FLOWS * level)
    if level <= LEAST_SIGHT * run.noise or not flows.size:
        raise AbsentError(f"test {test}: p_run does not rise above ambient after the opening: nothing flows")
    closed = np.flatnonzero(np.diff(flows) > 1)
    start, end = after.time[flows[0]], after.time[flows[closed[0]] if closed.size else flows[-1]]
    return float(start + STEADY * (end - start)), float(end - STEADY * (end - start))


def _signal(log: TestLog, segments: Segments, name: str) -> Signal | None:
    found = live_signals(log).get(name)
    return None if found is None else found.shifted(segments.t_open.value or 0.0)
