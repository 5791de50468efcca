"""Everything that validate finds in a test; what cannot be had is named with its reason."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import Regression
from hfanalysis.calibrate.head_pressure import before_injector, before_nozzle_of
from hfanalysis.calibrate.narrow_port import with_stated_tap
from hfanalysis.calibrate.water_flow import is_water
from hfanalysis.engine.effect import Active
from hfanalysis.errors import AbsentError
from hfanalysis.flight.motor import motor_class
from hfanalysis.inference.adopted.corrected_log import corrected
from hfanalysis.inference.full_run import FullRun, run_full
from hfanalysis.performance import histories as histories_of
from hfanalysis.performance.budgets import budgets
from hfanalysis.performance.efficiency import BASIS
from hfanalysis.performance.flows import Flows, Oxidizer, burn_fuel, oxidizer_flow, whole
from hfanalysis.performance.histories import Histories
from hfanalysis.performance.measured import NAMES, Fire, fire_of, impulse_inputs
from hfanalysis.performance.measured import measured as measured_column
from hfanalysis.performance.reconstruction.of_test import reconstructed
from hfanalysis.performance.reconstruction.reconstruct import Reconstructed
from hfanalysis.performance.reduction import Reduced, Test, reduced
from hfanalysis.performance.stability.modes import Mode, chamber_between
from hfanalysis.performance.stability.stability import stability
from hfanalysis.performance.tank_alone import run_tank_alone
from hfanalysis.performance.thrust import thrust_of
from hfanalysis.performance.transients import transients
from hfanalysis.products.budget import Budget
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.reconstruction import Reconstruction
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Closure, Column, Performance, Validation
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.validate.chamber_forced import run_chamber_forced
from hfanalysis.validate.full import compare_full
from hfanalysis.validate.modeled import modeled
from hfanalysis.validate.residuals import Residual, gaps
from hfanalysis.validate.tank_free import run_tank_free

Result = TypeVar("Result")
MODES = ("tank_free", "chamber_forced", "full")
FLOW_NAMES = ("oxidizer_flow", "fuel_flow", "regression_rate", "port_radius", "of_ratio")
RATIO_NAMES = ("c_star", "c_star_efficiency", "c_star_efficiency_frozen", "thrust_coefficient",
               "thrust_coefficient_efficiency", "thrust_coefficient_efficiency_frozen")  # fmt: skip


@dataclass(frozen=True)
class Validated:
    """The product, and what goes to HDF5: residuals by mode, and histories."""

    product: Validation
    residuals: dict[str, list[Residual]]
    histories: Histories
    reconstructed: Reconstructed


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
        self.before_nozzle = before_nozzle_of(log, definition)
        water = is_water(segments, definition)
        self._calibration = None if water else calibration
        self.uncalibrated = "water flows: there is no tank of nitrous oxide to run" if water else uncalibrated
        self.ambient = definition.ambient_pressure.value
        self.fire = fire_of(segments, definition, self.true)
        self.absent: dict[str, str] = {}

    def result(self) -> Validated:
        """All modes, tables and histories."""
        full = self._try("full", self._full)
        oxidizer = self._try("oxidizer_flow", self._oxidizer)
        flows = self._try("histories", lambda: self._flows(full, oxidizer))
        residuals = {
            "tank_free": self._try("tank_free", self._tank_free),
            "chamber_forced": self._try("chamber_forced", lambda: self._chamber_forced(full, flows)),
            "full": compare_full(self.before_nozzle, self.segments, full) if full else None,
        }
        measured = measured_column(self.true, self.segments, self.definition, self._calibration)
        if full is not None:
            model = modeled(full, self.calibration, self.segments.time("t_purge"))
        else:
            model = {name: Quantity.absent(self.absent["full"]) for name in NAMES}
        histories, found = self._histories(full, flows)
        again = self._reconstructed(full, oxidizer, histories)
        measured |= found.impulses
        if isinstance(fire := self.fire, Fire):
            starts = self._attempt("transients", lambda: transients(self.true, self.segments, self.definition, fire))
            measured |= starts or {}
        kept = {mode: compared for mode, compared in residuals.items() if compared}
        notes = [note for of_mode in kept.values() for r in of_mode for note in r.notes]
        impulse = measured["total_impulse"].value
        about = {"motor_class": motor_class(impulse)} if impulse is not None and impulse > 0.0 else {}
        product = Validation(
            performance=Performance(measured=Column.from_json(measured), model=Column.from_json(model), **about),
            gap={mode: gaps(compared) for mode, compared in kept.items()},
            closure=self._closure(found),
            efficiency_basis=BASIS,
            **found.content,
            budget=self._budgets(measured) | found.budget,
            sensors=found.findings,
            absent=self.absent,
            reconstruction=again.product,
            **self._stability(full, flows[0] if flows else None, histories),
            notes=tuple(dict.fromkeys(notes)),
            warnings=(*(finding.text for finding in found.findings), *found.warnings),
        )
        return Validated(product, kept, histories, again)

    def _budgets(self, measured: dict[str, Quantity]) -> dict[str, Budget]:
        impulse = measured["total_impulse"].value
        if impulse is None or isinstance(self.fire, str):
            return {}
        thrust = thrust_of(self.true, self.segments, self.definition)
        return budgets(measured, impulse_inputs(self.true, thrust, self.fire, self.definition, impulse))

    @property
    def calibration(self) -> Calibration:
        """What every run needs. Raises AbsentError where there is none."""
        if self._calibration is None:
            raise AbsentError(str(self.uncalibrated))
        return self._calibration

    def _try(self, name: str, work: Callable[[], Result]) -> Result | None:
        """What needs a calibration."""

        def calibrated() -> Result:
            _ = self.calibration
            return work()

        return self._attempt(name, calibrated)

    def _attempt(self, name: str, work: Callable[[], Result]) -> Result | None:
        try:
            return work()
        except (AbsentError, ArithmeticError, ValueError) as error:
            self.absent[name] = str(error)
            return None

    def _tank_free(self) -> list[Residual]:
        read = before_injector(self.log, self.segments, self.definition)
        return run_tank_free(read, self.segments, self.calibration, self.definition, self.effects)

    def _full(self) -> FullRun:
        if isinstance(self.fire, str):
            raise AbsentError(self.fire)
        acting = with_stated_tap(self.definition, self.effects)
        return run_full(self.true, self.segments, self.calibration, self.definition, acting)

    def _oxidizer(self) -> Oxidizer:
        """What passes the injector; no regression law is needed."""
        if isinstance(self.fire, str):
            raise AbsentError(self.fire)
        read = before_injector(self.true, self.segments, self.definition)
        alone = run_tank_alone(
            read, self.segments, self.calibration, self.definition, constant=False, effects=self.effects
        )
        time = histories_of.clock(self.log, self.segments, self.fire.end)
        flow = oxidizer_flow(read, self.segments, self.calibration, self.definition, alone, time)
        whole(time, flow, self.fire.end)
        nitrogen = flow * np.interp(time, alone.measured.time, alone.nitrogen, left=0.0)
        return Oxidizer(time, flow, nitrogen)

    def _flows(self, full: FullRun | None, oxidizer: Oxidizer | None) -> tuple[Flows, Array]:
        """The flows, and the nitrogen [kg/s] that passes the injector beside the oxidizer, where a purge is adopted."""
        if full is None or oxidizer is None:
            raise AbsentError(self.absent.get("full") or self.absent["oxidizer_flow"])
        factor = full.factor("regression_factor", oxidizer.time)
        # all that flows drives the regression, as in the engine; what of it is nitrogen is no oxidizer
        burnt = burn_fuel(full.engine, Regression.of(self.calibration), oxidizer.time, oxidizer.flow, factor)
        return replace(burnt, oxidizer=oxidizer.oxidizer), oxidizer.nitrogen

    def _reconstructed(self, full: FullRun | None, oxidizer: Oxidizer | None, histories: Histories) -> Reconstructed:
        """With or without an engine that can be run."""
        if oxidizer is None or isinstance(self.fire, str):
            return Reconstructed(Reconstruction(variant=None, reason=self.absent["oxidizer_flow"]))
        test = self.true, self.segments, self.definition, self.calibration, self.fire
        engine = None if full is None else full.engine
        return reconstructed(*test, oxidizer, histories.values, engine)

    def _chamber_forced(self, full: FullRun | None, flows: tuple[Flows, Array] | None) -> list[Residual]:
        if full is None or flows is None or isinstance(self.fire, str):
            raise AbsentError(self.absent.get("full") or self.absent["histories"])
        return run_chamber_forced(self.before_nozzle, self.segments, full, flows[0], self.ambient, self.fire.end)

    def _histories(self, full: FullRun | None, flows: tuple[Flows, Array] | None) -> tuple[Histories, Reduced]:
        end = self.fire.end if isinstance(self.fire, Fire) else 10.0
        time = histories_of.clock(self.log, self.segments, end)
        values = histories_of.measured_histories(self.true, self.segments, self.definition, time)
        if full is None or flows is None or isinstance(self.fire, str):
            reason = self.absent.get("histories", "")
            return Histories(time, values, dict.fromkeys((*FLOW_NAMES, *RATIO_NAMES), reason)), Reduced()
        test = Test(self.true, self.segments, self.definition, self.calibration, self.fire, full.engine, *flows, values)
        found = reduced(test)
        values |= histories_of.flow_histories(flows[0]) | found.ratios
        return Histories(time, values), found

    def _stability(self, full: FullRun | None, flows: Flows | None, histories: Histories) -> dict[str, Any]:
        """How a hot fire burnt."""
        if not isinstance(fire := self.fire, Fire):
            return {}

        def modes(start: float, end: float) -> Iterable[Mode] | None:
            chamber = self.definition.chamber
            pressure = histories.values.get("p_chamber")
            if full is None or flows is None or pressure is None or chamber is None:
                return None
            volumes = [v.value if v is not None else 0.0 for v in (chamber.pre_volume, chamber.post_volume)]
            state = chamber_between(full.engine, (volumes[0], volumes[1]), flows, pressure, start, end)
            return state.modes() if state is not None else None

        found = self._attempt("stability", lambda: stability(self.log, self.segments, fire.end, modes))
        return {} if found is None else {"stability": found}

    def _closure(self, found: Reduced) -> Closure:
        """How the masses close, and the heat that the calibrated tank takes in the liquid phase, where it is told."""
        rest = self._calibration.rest if self._calibration is not None and found.closure else None
        heat = {"liquid_phase_heat": rest.liquid_phase_heat} if rest else {}
        judged = {"to_purge": found.balance, "verdict": found.balance.verdict} if found.balance else {}
        return Closure.model_validate({**found.closure, **heat, **judged})
