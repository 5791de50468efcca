"""The parametric study of the report (section 2.2): what oxidizer flow, grain length, mixture and pressure do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.simulation.steady_run import Task, solve
from hfanalysis.steady_design.steady import Requirement, SteadyEngine, ideal_specific_impulse
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY

FLOWS = np.linspace(0.4, 1.6, 13)
"""Oxidizer flows, over the design's [-]."""

LENGTHS = (0.75, 1.0, 4.0 / 3.0)
"""Grain lengths, over the design's [-]."""

PRESSURES = (0.5, 1.0, 1.5, 2.0)
"""Chamber pressures, over the design's [-]."""

RATIOS = np.linspace(2.0, 12.0, 81)
"""O/F ratios [-]."""


@dataclass(frozen=True)
class FlowPoint:
    """One engine of the study: oxidizer flow [kg/s], grain length [m]; ``ideal`` is expanded to ambient, ``fixed`` has
    the exit of the file. An engine that cannot be had is None, ``reason`` says why."""

    oxidizer_flow: float
    grain_length: float
    ideal: SteadyEngine | None
    fixed: SteadyEngine | None
    reason: str


@dataclass(frozen=True)
class MixturePoint:
    """Specific impulse [s] expanded to ambient at a chamber pressure [Pa] and O/F: as designed, and with PROPEP's."""

    chamber_pressure: float
    of_ratio: float
    specific_impulse: float
    specific_impulse_propep: float


def over_flow_and_length(task: Task) -> list[FlowPoint]:
    """Engines over oxidizer flow and grain length, each with the fuel for the target apogee (or the fuel stated)."""
    return [
        _flow_point(task, task.grain.length * length, task.requirement.oxidizer_flow * float(flow))
        for length in LENGTHS
        for flow in FLOWS
    ]


def _flow_point(task: Task, length: float, flow: float) -> FlowPoint:
    varied = replace(
        task,
        grain=replace(task.grain, length=length),
        requirement=replace(task.requirement, oxidizer_flow=flow, exit_radius=None),
    )
    ideal, reason = _solved(varied)
    exit_radius = task.requirement.exit_radius
    if exit_radius is None:
        return FlowPoint(flow, length, ideal, None, reason)
    fixed, why = _solved(replace(varied, requirement=replace(varied.requirement, exit_radius=exit_radius)))
    return FlowPoint(flow, length, ideal, fixed, reason or why)


def _solved(task: Task) -> tuple[SteadyEngine | None, str]:
    try:
        return solve(task), ""
    except (ValueError, ArithmeticError) as error:
        return None, str(error)


def over_mixture(requirement: Requirement) -> Iterator[MixturePoint]:
    """Ideal specific impulse over O/F and chamber pressure, with the design's oxidizer enthalpy and with PROPEP's."""
    for factor in PRESSURES:
        pressure = requirement.chamber_pressure * factor
        if pressure <= requirement.ambient:
            continue
        here = replace(requirement, chamber_pressure=pressure)
        propep = replace(here, oxidizer_enthalpy=PROPEP_OXIDIZER_ENTHALPY)
        for ratio in RATIOS:
            own = ideal_specific_impulse(here, float(ratio))
            beside = own if propep == here else ideal_specific_impulse(propep, float(ratio))
            yield MixturePoint(pressure, float(ratio), own, beside)
