"""A test as inference takes it: what was recorded, what was stated, and the base model with its constants free."""

from __future__ import annotations

from dataclasses import dataclass

from hfanalysis.engine.unsteady import Engine
from hfanalysis.inference.fitting.departures import with_departures
from hfanalysis.inference.fitting.fade import with_abrupt_end
from hfanalysis.inference.fitting.hypothesis import Hypothesis, base_hypothesis
from hfanalysis.inference.full_run import run_full
from hfanalysis.inference.half_known import with_ranges
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.observations.reduction import observe_test
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.health import Finding
from hfanalysis.products.segments import Segments
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal


@dataclass(frozen=True)
class Subject:
    """What a diagnosis is made from: a test's log, its segments and base calibration, and what was stated.

    The calibration is None where none could be had; ``notes`` say what stands for a missing channel, ``found`` what its
    channels' health tells. ``start``: the engine that a fit starts from where it is not the calibrated one.
    """

    log: TestLog
    segments: Segments
    calibration: Calibration | None
    definition: TestDefinition
    notes: tuple[str, ...] = ()
    found: tuple[Finding, ...] = ()
    start: Engine | None = None

    def observed(self) -> Observed:
        """What is compared."""
        return observe_test(self.log, self.segments, self.definition)

    def stated(self) -> dict[str, dict[str, float]]:
        """What it states of parameters of effects [SI], by effect and parameter."""
        return {"n2_purge": _purge(self)}

    def hypothesis(self) -> Hypothesis:
        """The base model with its constants free."""
        assert self.calibration is not None
        engine = self.start or run_full(self.log, self.segments, self.calibration, self.definition).engine
        return base_hypothesis(engine, self.calibration, self.definition.model.conventions != "report")

    def compared(self, as_run: bool = False) -> tuple[Hypothesis, Observed]:
        """The base model and the observations, with what only the model says of these.

        ``as_run``: by the table of nitrous oxide and the laws that the engine has, and with what is stated as a range
        at its center: nothing of these is free in an engine that is run.
        """
        hypothesis = self.hypothesis()
        observed = with_abrupt_end(self.observed(), hypothesis.engine)
        if as_run:
            return hypothesis, observed
        return with_departures(with_ranges(hypothesis, self.definition), observed), observed


def _purge(subject: Subject) -> dict[str, float]:
    """The purge line's pressure before nitrogen can enter, as measured, and its valve's, as stated [Pa].

    Afterwards the line follows the tank through its check valve, whether or not much flows: what drives the nitrogen is
    the pressure that its regulator was set to.
    """
    out: dict[str, float] = {}
    t_purge, origin = subject.segments.time("t_purge"), subject.segments.t_open.value
    if origin is not None and "p_purge" in subject.log:
        last = 0.0 if t_purge is None else t_purge
        level = Signal.of(subject.log["p_purge"]).shifted(origin).mean(last - LEVEL, last - 0.1)
        if level == level:
            out["supply_pressure"] = level
    section = subject.definition.purge
    if section is not None and section.cracking_pressure is not None:
        out["cracking_pressure"] = section.cracking_pressure.value
    return out


LEVEL = 1.0
"""Seconds over which the purge line's pressure is taken."""
