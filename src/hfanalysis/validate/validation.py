"""Everything that validate finds in a test; what cannot be had is named with its reason."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from hfanalysis.assembly.calibrated import Regression
from hfanalysis.calibrate.water_flow import is_water
from hfanalysis.engine.effect import Active
from hfanalysis.errors import AbsentError
from hfanalysis.inference.adopted.corrected_log import corrected
from hfanalysis.inference.full_run import FullRun, run_full
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Closure, Column, Performance, Validation
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.validate import histories as histories_of
from hfanalysis.validate import performance
from hfanalysis.validate.chamber_forced import run_chamber_forced
from hfanalysis.validate.flows import Flows, burn_fuel, oxidizer_flow
from hfanalysis.validate.full import compare_full
from hfanalysis.validate.histories import Histories
from hfanalysis.validate.performance import Fire
from hfanalysis.validate.residuals import Residual, gaps
from hfanalysis.validate.tank_free import run_tank_alone, run_tank_free
from hfanalysis.validate.thrust import motor_class

Result = TypeVar("Result")
MODES = ("tank_free", "chamber_forced", "full")
FLOW_NAMES = ("oxidizer_flow", "fuel_flow", "regression_rate", "port_radius", "of_ratio")
RATIO_NAMES = ("c_star", "c_star_efficiency", "thrust_coefficient", "thrust_coefficient_efficiency")


@dataclass(frozen=True)
class Validated:
    """The product, and what goes to HDF5: residuals by mode, and histories."""

    product: Validation
    residuals: dict[str, list[Residual]]
    histories: Histories


def validate(
    log: TestLog,
    segments: Segments,
    definition: TestDefinition,
    calibration: Calibration | None,
    uncalibrated: str | None,
    effects: Sequence[Active] = (),
) -> Validated:
    """Validate a test, ``effects`` acting; ``uncalibrated`` says why ``calibration`` is None.

    Raises AbsentError where there is nothing to compare and nothing to measure.
    """
    work = _Work(log, segments, definition, calibration, uncalibrated, effects)
    found = work.result()
    measured = found.product.performance.measured.quantities.values()
    if not found.residuals and all(q.value is None for q in measured):
        raise AbsentError(next(iter(found.product.absent.values())))
    return found


class _Work:
    """One validation under way."""

    def __init__(
        self,
        log: TestLog,
        segments: Segments,
        definition: TestDefinition,
        calibration: Calibration | None,
        uncalibrated: str | None,
        effects: Sequence[Active],
    ) -> None:
        self.log, self.segments, self.definition = log, segments, definition
        self.effects = effects
        self.true = corrected(log, segments.t_open.value or 0.0, effects)
        water = is_water(segments, definition)
        self._calibration = None if water else calibration
        self.uncalibrated = "water flows: there is no tank of nitrous oxide to run" if water else uncalibrated
        self.ambient = definition.ambient_pressure.value
        self.fire = performance.fire_of(segments, definition, self.true)
        self.absent: dict[str, str] = {}

    def result(self) -> Validated:
        """All modes, tables and histories."""
        full = self._try("full", self._full)
        flows = self._try("histories", lambda: self._flows(full))
        residuals = {
            "tank_free": self._try("tank_free", self._tank_free),
            "chamber_forced": self._try("chamber_forced", lambda: self._chamber_forced(full, flows)),
            "full": compare_full(self.log, self.segments, full) if full else None,
        }
        measured = performance.measured(self.true, self.segments, self.definition, self._calibration)
        if full is not None:
            model = performance.modeled(full, self.calibration)
        else:
            model = {name: Quantity.absent(self.absent["full"]) for name in performance.NAMES}
        kept = {mode: found for mode, found in residuals.items() if found}
        histories = self._histories(full, flows)
        notes = [note for found in kept.values() for r in found for note in r.notes]
        impulse = measured["total_impulse"].value
        about = {"motor_class": motor_class(impulse)} if impulse is not None and impulse > 0.0 else {}
        product = Validation(
            performance=Performance(measured=Column.from_json(measured), model=Column.from_json(model), **about),
            gap={mode: gaps(found) for mode, found in kept.items()},
            closure=Closure.from_json(histories.closure),
            sensors=(),
            absent=self.absent,
            notes=tuple(dict.fromkeys(notes)),
            warnings=(),
        )
        return Validated(product, kept, histories)

    @property
    def calibration(self) -> Calibration:
        """What every run needs. Raises AbsentError where there is none."""
        if self._calibration is None:
            raise AbsentError(str(self.uncalibrated))
        return self._calibration

    def _try(self, name: str, work: Callable[[], Result]) -> Result | None:
        try:
            _ = self.calibration
            return work()
        except (AbsentError, ArithmeticError, ValueError) as error:
            self.absent[name] = str(error)
            return None

    def _tank_free(self) -> list[Residual]:
        return run_tank_free(self.log, self.segments, self.calibration, self.definition, self.effects)

    def _full(self) -> FullRun:
        if isinstance(self.fire, str):
            raise AbsentError(self.fire)
        return run_full(self.true, self.segments, self.calibration, self.definition, self.effects)

    def _flows(self, full: FullRun | None) -> Flows:
        if full is None or isinstance(self.fire, str):
            raise AbsentError(self.absent["full"])
        alone = run_tank_alone(
            self.true, self.segments, self.calibration, self.definition, constant=False, effects=self.effects
        )
        time = histories_of.clock(self.log, self.segments, self.fire.end)
        flow = oxidizer_flow(self.true, self.segments, self.calibration, self.definition, alone, time)
        factor = full.factor("regression_factor", time)
        burnt = burn_fuel(full.engine, Regression.of(self.calibration), time, flow, factor)
        # all that flows drives the regression, as in the engine; what of it is nitrogen is no oxidizer
        nitrogen = np.interp(time, alone.measured.time, alone.nitrogen, left=0.0)
        return replace(burnt, oxidizer=flow * (1.0 - nitrogen))

    def _chamber_forced(self, full: FullRun | None, flows: Flows | None) -> list[Residual]:
        if full is None or flows is None or isinstance(self.fire, str):
            raise AbsentError(self.absent.get("full") or self.absent["histories"])
        return run_chamber_forced(self.log, self.segments, full, flows, self.ambient, self.fire.end)

    def _histories(self, full: FullRun | None, flows: Flows | None) -> Histories:
        end = self.fire.end if isinstance(self.fire, Fire) else 10.0
        time = histories_of.clock(self.log, self.segments, end)
        values = histories_of.measured_histories(self.true, self.segments, self.definition, time)
        if full is None or flows is None or isinstance(self.fire, str):
            reason = self.absent.get("histories", "")
            return Histories(time, values, dict.fromkeys((*FLOW_NAMES, *RATIO_NAMES), reason))
        purge = self.segments.time("t_purge")
        ratios = histories_of.efficiencies(values, flows, full.engine, self.ambient, self.fire, purge)
        closed = histories_of.closure(flows, values, full.engine, self.ambient, self.fire, purge)
        return Histories(time, values | histories_of.flow_histories(flows) | ratios, {}, closed | self._heat())

    def _heat(self) -> dict[str, Quantity]:
        """Heat that the calibrated tank takes in the liquid phase, where it can be told."""
        rest = self.calibration.rest
        return {"liquid_phase_heat": rest.liquid_phase_heat} if rest else {}
