"""The parametric study of the report (section 2.2): what oxidizer flow, grain length, mixture and pressure do."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.errors import InputError
from hfanalysis.simulation.steady_run import Task, solve
from hfanalysis.steady_design.steady import Requirement, SteadyEngine, ideal_specific_impulse
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY
from hfanalysis.units import parse

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


@dataclass(frozen=True)
class Ranges:
    """What a study goes through: oxidizer ``flows`` [kg/s], grain ``lengths`` [m], chamber ``pressures`` [Pa].

    Where one has none, it is FLOWS, LENGTHS or PRESSURES times the design's.
    """

    flows: tuple[float, ...] = ()
    lengths: tuple[float, ...] = ()
    pressures: tuple[float, ...] = ()

    def flows_of(self, task: Task) -> tuple[float, ...]:
        """Oxidizer flows [kg/s]."""
        return self.flows or tuple(task.requirement.oxidizer_flow * float(flow) for flow in FLOWS)

    def lengths_of(self, task: Task) -> tuple[float, ...]:
        """Grain lengths [m]."""
        return self.lengths or tuple(task.grain.length * length for length in LENGTHS)

    def pressures_of(self, requirement: Requirement) -> tuple[float, ...]:
        """Chamber pressures [Pa]."""
        return self.pressures or tuple(requirement.chamber_pressure * factor for factor in PRESSURES)


USUAL = Ranges()
"""Those of the report's study, about the design. Source: by definition."""

_DIMENSIONS = {"flow": "mass_flow", "length": "length", "pressure": "pressure"}


def ranges_of(given: Mapping[str, Sequence[str]]) -> Ranges:
    """The ranges by "flow", "length" and "pressure", each a list of values with their units.

    Raises InputError for a value without its unit, or one that is not more than zero.
    """
    return Ranges(*(_values(name, given.get(name, ())) for name in _DIMENSIONS))


def _values(name: str, texts: Sequence[str]) -> tuple[float, ...]:
    found = tuple(sorted({parse(text, _DIMENSIONS[name], f"--{name}").value for text in texts}))
    if found and found[0] <= 0.0:
        raise InputError(f"--{name}: found {found[0]:g}; expected more than zero")
    return found


def over_flow_and_length(task: Task, ranges: Ranges = USUAL) -> list[FlowPoint]:
    """Engines over oxidizer flow and grain length, each with the fuel for the target apogee (or the fuel stated)."""
    return [_flow_point(task, length, flow) for length in ranges.lengths_of(task) for flow in ranges.flows_of(task)]


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


def over_mixture(requirement: Requirement, ranges: Ranges = USUAL) -> Iterator[MixturePoint]:
    """Ideal specific impulse over O/F and chamber pressure, with the design's oxidizer enthalpy and with PROPEP's."""
    for pressure in ranges.pressures_of(requirement):
        if pressure <= requirement.ambient:
            continue
        here = replace(requirement, chamber_pressure=pressure)
        propep = replace(here, oxidizer_enthalpy=PROPEP_OXIDIZER_ENTHALPY)
        for ratio in RATIOS:
            own = ideal_specific_impulse(here, float(ratio))
            beside = own if propep == here else ideal_specific_impulse(propep, float(ratio))
            yield MixturePoint(pressure, float(ratio), own, beside)
