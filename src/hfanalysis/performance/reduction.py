"""What follows from flows and measured channels: efficiencies, specific impulses, closure, standard quantities."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.engine.unsteady import Engine
from hfanalysis.performance.budgets import ratio_budgets
from hfanalysis.performance.closing import OPEN, balance, closure, spreads
from hfanalysis.performance.efficiency import Ideal, Spread, above_one, efficiencies, ideal, liquid_phase, means
from hfanalysis.performance.flows import Flows
from hfanalysis.performance.load_cell import CellError
from hfanalysis.performance.measured import Fire, cell_error_of, impulse_to, loaded
from hfanalysis.performance.specific_impulse import expended, impulses, liquid_impulse
from hfanalysis.performance.standard import standard
from hfanalysis.performance.tap import narrow, tap_of
from hfanalysis.performance.thrust import thrust_of
from hfanalysis.performance.warned import of_injector, of_nozzle
from hfanalysis.products.beyond import Beyond
from hfanalysis.products.budget import Budget
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.segments import Segments
from hfanalysis.products.validation import Balance, Efficiencies, Finding, Standard
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog


@dataclass(frozen=True)
class Test:
    """A burn as it was measured and as the calibration has it; ``nitrogen`` [kg/s], (n,), of an adopted purge."""

    log: TestLog
    segments: Segments
    definition: TestDefinition
    calibration: Calibration
    fire: Fire
    engine: Engine
    flows: Flows
    nitrogen: Array
    measured: Mapping[str, Array]

    @property
    def ambient(self) -> float:
        """[Pa]."""
        return self.definition.ambient_pressure.value

    @property
    def purge(self) -> float | None:
        """When nitrogen enters [s]; None where it does not."""
        return self.segments.time("t_purge")


@dataclass(frozen=True)
class Reduced:
    """``ratios`` are histories, (n,) on the clock of the flows; the rest goes into validation.json."""

    ratios: dict[str, Array] = field(default_factory=dict)
    closure: dict[str, Quantity] = field(default_factory=dict)
    balance: Balance | None = None
    efficiencies: Efficiencies | None = None
    standard: Standard | None = None
    beyond: tuple[Beyond, ...] = ()
    budget: dict[str, Budget] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    impulses: dict[str, Quantity] = field(default_factory=dict)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to be wary of, in words."""
        return tuple(beyond.text for beyond in self.beyond)

    @property
    def content(self) -> dict[str, Any]:
        """Its own fields of validation.json, those that there are."""
        named = {"efficiencies": self.efficiencies, "standard": self.standard}
        return {name: part for name, part in named.items() if part is not None} | {"beyond": self.beyond}


def reduced(test: Test) -> Reduced:
    """All of it; what has no channel says so in its place."""
    tap = tap_of(test.definition)
    given = (test.measured, test.flows, test.engine, test.ambient, test.fire)
    found = ideal(*given, test.purge, tap)
    ratios = efficiencies(test.measured, test.flows, test.engine, found)
    part = liquid_phase(test.flows.time, test.segments, test.fire)
    if found is not None:
        part = part & found.counted
    if not part.any():
        return Reduced(ratios, closure(test.flows, test.measured, test.engine, test.ambient, test.fire, test.purge))
    spread = Spread.of(test.log, test.definition, test.calibration, test.flows, test.measured, part, _cell(test))
    of_masses = spreads(test.calibration, spread)
    sums = closure(test.flows, test.measured, test.engine, test.ambient, test.fire, test.purge, of_masses)
    return Reduced(
        ratios,
        sums,
        standard=standard(*given, found, spread),
        impulses=_impulses(test),
        **(_of_chamber(test, found, ratios, part, spread, of_masses) if found is not None else {}),
    )


def _cell(test: Test) -> CellError | None:
    """What the load cell may be off by; None without one."""
    if "thrust" not in test.log:
        return None
    thrust = thrust_of(test.log, test.segments, test.definition)
    return cell_error_of(test.log, thrust, test.definition, test.fire.end)


def _of_chamber(
    test: Test, found: Ideal, ratios: Mapping[str, Array], part: NDArray[np.bool_], spread: Spread,
    of_masses: tuple[float, float, float],
) -> dict[str, Any]:  # fmt: skip
    """What needs the chamber's pressure."""
    judged = means(ratios, found, part, spread)
    closed = balance(test.flows, test.measured, test.engine, test.ambient, test.fire, test.purge, found, of_masses)
    beyond = [
        *narrow(tap_of(test.definition), test.engine, found.before, found.burning),
        *of_injector(test.log, test.segments, test.flows.time, found.pressure, part),
        *of_nozzle(test.engine, test.flows, found, test.ambient, part),
    ]
    return {
        "balance": closed,
        "efficiencies": judged,
        "budget": ratio_budgets(judged, spread),
        "beyond": (*beyond, *([_open(closed)] if closed.verdict == OPEN else [])),
        "findings": tuple(above_one(judged)),
    }


def _open(closed: Balance) -> Beyond:
    """The warning of masses that do not close."""
    difference, limit = closed.difference, closed.difference.interval or (0.0, 0.0)
    nearest = min(limit, key=abs)
    words = (
        f"the masses do not close until {closed.until.value:.2f} s: {difference.value:+.2f} kg ({limit[0]:+.2f} to "
        f"{limit[1]:+.2f}) more passed the nozzle, by p_chamber and c*, than came by injector and grain"
    )
    return Beyond(name="closure", value=difference, limit=nearest, source="its own 95 % interval", text=words)


def _impulses(test: Test) -> dict[str, Quantity]:
    """The specific impulses of a log with thrust."""
    if "thrust" not in test.log:
        return {}
    gone = expended(test.log, test.segments, test.definition, test.calibration, test.flows, test.fire, test.nitrogen)
    thrust = thrust_of(test.log, test.segments, test.definition)
    to_purge = Fire(gone.until, min(test.fire.std, 0.02) if test.purge else test.fire.std, test.fire.source)
    masses = loaded(test.log, test.segments, test.definition, test.calibration)
    whole, first = (impulse_to(test.log, thrust, fire, test.definition) for fire in (test.fire, to_purge))
    found = impulses(gone, whole, first, masses)
    to_v = Fire(test.segments.time("t_v") or test.fire.end, test.segments.std("t_v"), "t_v")
    liquid = liquid_impulse(gone, impulse_to(test.log, thrust, to_v, test.definition))
    return found | {"specific_impulse_liquid": liquid}
