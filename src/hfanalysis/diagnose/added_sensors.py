"""Sensors that a test does not have: what each would add to what is known of the engine and of the effects.

A virtual sensor reads what the model says: only its slopes and its noise count. The noise is as large as its accuracy,
half of it (in variance) an offset that stays and half coherent over a second.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array, Integers
from hfanalysis.engine.equations import OUTPUTS, RADIUS, STATES
from hfanalysis.engine.observe import true_channels
from hfanalysis.engine.phases import LIQUID_OUT
from hfanalysis.engine.sensitivity import Tangents
from hfanalysis.engine.unsteady import Burn
from hfanalysis.inference.fitting.hypothesis import Hypothesis
from hfanalysis.inference.fitting.predict import TICK, aligned, slopes_of
from hfanalysis.inference.observations.alignment import share
from hfanalysis.inference.observations.channel import ObservedChannel, averaged
from hfanalysis.inference.observations.covariance import FILLING_ERROR, FILLING_TIME
from hfanalysis.inference.observations.frame import AROUND_CHANGE, FIRST
from hfanalysis.inference.observations.observed import Observed

BLOCK_POINTS = 5
"""Points of the common grid that a virtual sensor's block holds."""

COHERENT = 1.0
"""Time over which the slow half of its noise is coherent [s]."""


@dataclass(frozen=True)
class Sensor:
    """A sensor that could be added: its ``name``, in words, and how accurate [SI] it would be taken to be.

    ``reads``: a canonical channel ("channel"), a state or output of the model that no effect distorts ("inside"), or
    something measured after the test ("after"). ``of``: its name there. ``liquid_only``: no word in vapor.
    """

    name: str
    words: str
    accuracy: float
    unit: str
    reads: str
    of: str
    liquid_only: bool = False

    def slopes(self, hypothesis: Hypothesis, observed: Observed, found: Tangents) -> Array:
        """Whitened slopes (rows, parameters) [1/SI] of what it would read; they count like those of the residuals."""
        if self.reads == "after":
            return self._after(hypothesis, observed, found)
        points = self._points(observed, found.burn)
        if points.size == 0:  # a test that is over before a block is full
            return np.zeros((0, len(found.parameters)))
        if self.reads == "channel":
            values = true_channels(found.burn, aligned(observed, found.burn, observed.grid))[self.of]
            only = self._alone(values, points, observed)
            return slopes_of(hypothesis, only, found)[: points.size]
        values, slopes = _inside(self.of, observed, found)
        only = self._alone(values, points, observed)
        return -only.whiten(only.channels[0].averaged(slopes))

    def _after(self, hypothesis: Hypothesis, observed: Observed, found: Tangents) -> Array:
        if self.of == "throat_radius_after":
            stated = replace(observed, stated={self.of: (0.0, self.accuracy)})
            return slopes_of(hypothesis, stated, found)[-1:]
        # a mass: of the fuel when the comparison ends, as if the firing were cut short there
        at = np.array([min(observed.end, found.burn.steps.times[-1, 1])])
        radius = float(found.burn.steps.at(at)[0][0, RADIUS])
        ring = found.burn.steps.engine.grain.ring(radius)
        return np.asarray(ring * found.output("port_radius", at) / self.accuracy)

    def _alone(self, values: Array, points: Integers, observed: Observed) -> Observed:
        """The test as if only this sensor were there, which reads ``values`` on the common grid."""
        count = np.full(points.size, BLOCK_POINTS)
        time, value = (averaged(rows, points, count) for rows in (observed.grid, values))
        lag = np.abs(time[:, None] - time[None, :])
        covariance = 0.5 * self.accuracy**2 * (1.0 + np.exp(-lag / COHERENT))
        filling = np.where(time < observed.phases.get("liquid", 0.0), FILLING_ERROR * float(np.ptp(value)), 0.0)
        covariance = covariance + np.exp(-lag / FILLING_TIME) * np.outer(filling, filling)
        covariance[np.diag_indices_from(covariance)] += (1e-3 * self.accuracy) ** 2
        resting, std = np.zeros(points.size, dtype=bool), np.full(points.size, self.accuracy)
        name = "p_chamber" if self.of == "chamber_pressure" else self.of  # the model errs for both alike
        channel = ObservedChannel(name, time, value, points, count, resting, std, self.accuracy, covariance)
        return replace(observed, channels=(channel,), common=None, alike=None)

    def _points(self, observed: Observed, burnt: Burn) -> Integers:
        """Where its blocks begin on the common grid."""
        first = np.flatnonzero(~observed.resting)[::BLOCK_POINTS][:-1]
        last = first + BLOCK_POINTS - 1
        begin, end = observed.grid[first], observed.grid[last]
        gone = observed.events["t_v"][0] if "t_v" in observed.events else burnt.liquid_out
        good = (begin > FIRST) & (end < observed.end)
        if gone is not None:
            good &= (end < gone - AROUND_CHANGE) | ((begin > gone + AROUND_CHANGE) & (not self.liquid_only))
        return np.asarray(first[good], dtype=np.int64)


BAR = 1e5
"""A bar [Pa]. Source: definition."""

USUAL = (
    Sensor("p_tank", "a transducer at the tank", 0.15 * BAR, "Pa", "channel", "p_tank"),
    Sensor("p_run", "a transducer ahead of the injector", 0.15 * BAR, "Pa", "channel", "p_run"),
    Sensor("p_chamber", "a transducer at the chamber's tap", 0.1 * BAR, "Pa", "channel", "p_chamber"),
    Sensor("thrust", "a thrust cell", 7.0, "N", "channel", "thrust"),
    Sensor("m_tank", "a cell that weighs the tank", 0.01, "kg", "channel", "m_tank"),
)
"""Canonical channels, as accurate as is usual at such a stand."""

FURTHER = (
    Sensor("throat_radius_after", "the throat's radius after the test", 5e-5, "m", "after", "throat_radius_after"),
    Sensor("fuel_mass_after", "the fuel left after a firing cut short", 5e-3, "kg", "after", "fuel_mass_after"),
    Sensor(
        "p_chamber_flush", "a second, flush transducer in the chamber", 0.1 * BAR, "Pa", "inside", "chamber_pressure"
    ),
    Sensor("T_tank", "a thermocouple in the tank's liquid", 0.3, "K", "inside", "tank_temperature", liquid_only=True),
    Sensor("port_radius", "the port's radius over time, by ultrasound", 1e-4, "m", "inside", "port_radius"),
    Sensor("nitrogen_flow", "a flow meter in the purge line", 2e-3, "kg/s", "inside", "nitrogen_inflow"),
)
"""What effects call decisive, as far as the model has it."""


def missing_sensors(observed: Observed) -> tuple[Sensor, ...]:
    """Those of USUAL and FURTHER that the test does not have."""
    there = {*observed.names, *observed.stated}
    return tuple(s for s in (*USUAL, *FURTHER) if s.name not in there)


def _inside(name: str, observed: Observed, found: Tangents) -> tuple[Array, Array]:
    """A state or output on the common grid and its slopes there, at instants that move with the end of the liquid."""
    times, last = aligned(observed, found.burn, observed.grid), found.burn.steps.times[-1, 1]
    slopes = found.output(name, times)
    seen = observed.events.get("t_v")
    if seen is not None and found.burn.liquid_out is not None:
        ahead, behind = (_value(name, found.burn, np.clip(times + s * TICK, 0.0, last)) for s in (1.0, -1.0))
        speed = (ahead - behind) / (2.0 * TICK)
        speed = speed * share(observed.grid, seen[0], found.burn.liquid_out, observed.fuel_out)
        slopes = slopes + speed[:, np.newaxis] * np.nan_to_num(found.event(LIQUID_OUT))[np.newaxis]
    return _value(name, found.burn, times), slopes


def _value(name: str, burnt: Burn, times: Array) -> Array:
    states, outputs = burnt.steps.at(times)
    return np.asarray(outputs[:, OUTPUTS.index(name)] if name in OUTPUTS else states[:, STATES.index(name)])
