"""The calibrated engine of a test, run with nothing measured in (report, 4.3.3).

The tank starts from the pressure at which its liquid phase, extrapolated to the opening, meets the measured one at
t_feed; the filling of the line is not in the model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import Regression, engine_of_test, starting_for
from hfanalysis.engine.effect import Active
from hfanalysis.engine.equations import OUTPUTS, evaluate_rates
from hfanalysis.engine.sites import SITES
from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal, line_at
from hfanalysis.thermo.nitrous import saturation

LONGEST_BURN = 60.0
"""Seconds after which a burn that does not end is cut off."""


@dataclass(frozen=True)
class FullRun:
    """The engine as started, and its burn.

    ``follows``: in the burn the oxidizer enters the chamber with the enthalpy that the tank's content has at that
    moment, as where constants were fitted with adopted effects; else with that of the opening, which ``engine`` has.
    """

    engine: Engine
    burnt: Burn
    follows: bool = False

    def burn(self, engine: Engine) -> Burn:
        """Another engine's burn, like this one's."""
        return _burn(engine, self.follows)

    def factor(self, site: str, times: Array) -> Array:
        """What effects make of one of the model's factors [-] along the run, at ``times`` (n,) [s after the opening]; 1
        without effects."""
        if not self.engine.effects:
            return np.ones(times.size)
        return np.asarray(np.interp(times, self.burnt.time, self._sites[:, SITES.index(site)]))

    @cached_property
    def _sites(self) -> Array:
        """Every site at every point of the run."""
        steps, gone = self.burnt.steps, self.burnt.liquid_out
        equations = steps.engine.equations(steps.composition)
        rates, out = np.empty(self.burnt.states.shape[1]), np.empty(len(OUTPUTS))
        values = np.empty((self.burnt.time.size, len(SITES)))
        for i, (time, state) in enumerate(zip(self.burnt.time, self.burnt.states, strict=True)):
            wet = gone is None or bool(time <= gone)
            evaluate_rates(time, np.ascontiguousarray(state), wet, True, equations, rates, out)
            values[i] = equations.site
        return values

    @property
    def run_pressure(self) -> Array:
        """Modelled pressure before the injector [Pa] at the run's points (n,)."""
        return self.burnt.output("run_pressure")


def run_full(
    log: TestLog,
    segments: Segments,
    calibration: Calibration,
    definition: TestDefinition,
    effects: Sequence[Active] = (),
) -> FullRun:
    """Run the calibrated engine with ``effects``.

    Raises AbsentError where the test does not state it or it is not calibrated.
    """
    law = Regression.of(calibration)
    fitted = calibration.tank_temperature
    if fitted is not None and fitted.value is not None:  # with adopted effects, together with all else
        engine = engine_of_test(definition, calibration, fitted.value, law, effects)
        follows = definition.model.conventions != "report"
        return FullRun(engine, _burn(engine, follows), follows)
    tank = Signal.of(log["p_tank"]).shifted(segments.t_open.value or 0.0)
    instant = segments.time("t_feed") or min(0.1, 0.1 * (segments.time("t_v") or 1.0))
    pressure = line_at(tank, instant)
    engine = engine_of_test(definition, calibration, _temperature(definition, pressure), law, effects)
    started = starting_for(engine, instant, pressure)
    return FullRun(started, burn(started, longest=LONGEST_BURN))


def _burn(engine: Engine, follows: bool) -> Burn:
    return burn(replace(engine, oxidizer_enthalpy=None) if follows else engine, longest=LONGEST_BURN)


def _temperature(definition: TestDefinition, pressure: float) -> float:
    source = saturation(definition.model.properties)
    return float(source.temperature(min(pressure, 0.999 * source.pressure_range[1])))


def moved(full: FullRun, change: Mapping[str, float]) -> Burn:
    """The burn of the same engine with other constants [SI], from the same tank temperature.

    ``change`` names fields of the engine, or ``area`` [m^2] and ``loss_factor`` [1/m^4] of its feed system.
    """
    parts: dict[str, Any] = dict(change)
    feed: dict[str, Any] = {name: parts.pop(name) for name in ("area", "loss_factor") if name in parts}
    engine = replace(full.engine, feed=replace(full.engine.feed, **feed), **parts)
    return full.burn(engine)
