"""What test.toml states, held against the log: what cannot both be so is said, and what rests on it is doubted."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from hfanalysis.engine.thrust_coefficient import flows_full
from hfanalysis.products.calibration import Calibration, TankConstants
from hfanalysis.products.segments import Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal, live_signals
from hfanalysis.sentences import said, text

APPARENT = (880.0, 2550.0)
"""p_c A_t over the mean oxidizer flow [m/s] that a fire of nitrous oxide and a hydrocarbon can have. Source:
characteristic velocities of 800 m/s (poor combustion) to 1700 m/s (report, 4.4), times 1.1 to 1.5, all propellant over
its oxidizer."""

USUAL = (1250.0, 2200.0)
"""The same of a fire that burns as most do [m/s]: 1150 to 1700 m/s, times 1.1 to 1.3. A chamber pressure that has it is
believed against a thrust that has not its nozzle's. Evidence: 1480 and 1560 of HF4 and HF5."""

BEYOND = 1.5
"""Factor by which it may lie outside what it can be before it alone speaks against a gauge. Evidence: the oxidizer's
flow is a mean over the liquid phase, whose peak is a third above it (HF4, HF5)."""

LEAST_LEFT = 0.5
"""p_run over p_tank, above ambient, below which a feed line is none: the oxidizer would flash in it. Evidence: 0.72 to
0.87 of HF4 and HF5; saturated liquid that loses half of its pressure is more than half vapor by volume."""

SIZE = 0.2
"""Part of the chamber's pressure above ambient from which on what its health finds doubts its size, not its zero [-].
Source: zeros and drifts are a few percent of it, scales and units a third and more (docs/health-rates.md)."""

REGRESSION = ("a", "n", "regression_rate_reference")
FLOWS = ("C_i", "K_loss", "oxidizer_flow_peak")


@dataclass(frozen=True)
class Doubt:
    """What is wrong, in words; ``of``: the quantities that it bears on, and by which factor [-] they may be off.

    ``no_regression``: it leaves nothing to fit a and n to.
    """

    words: str
    of: Mapping[str, float]
    no_regression: bool = False

    def on(self, name: str, quantity: Quantity) -> Quantity:
        """The quantity with this doubt."""
        if quantity.value is None or name not in self.of:
            return quantity
        return quantity.doubted(self.words, (quantity.value * self.of[name],) * 2)


def nothing_to_regress(
    log: TestLog, segments: Segments, definition: TestDefinition, found: TankConstants
) -> str | None:
    """Why a and n have nothing to rest on; None where they have."""
    doubts = _Facts(log, segments, definition, found).doubts()
    return next((doubt.words for doubt in doubts if doubt.no_regression), None)


def held_against(log: TestLog, segments: Segments, definition: TestDefinition, found: Calibration) -> Calibration:
    """The calibration with what its test states and its log contradicts said, and what rests on it doubted."""
    doubts = list(_Facts(log, segments, definition, found).doubts())
    if not doubts:
        return found
    changed = dict(found.quantities)
    for doubt in doubts:
        changed = {name: doubt.on(name, quantity) for name, quantity in changed.items()}
    warnings = (*found.warnings, *(doubt.words for doubt in doubts))
    return found.but(**changed, warnings=tuple(dict.fromkeys(warnings)))


@dataclass(frozen=True)
class _Facts:
    log: TestLog
    segments: Segments
    definition: TestDefinition
    found: TankConstants

    def doubts(self) -> Iterator[Doubt]:
        """All there are."""
        for check in (self._fuel_end, self._run_line, self._chamber, self._exit):
            doubt = check()
            if doubt is not None:
                yield doubt

    @property
    def _burning(self) -> bool:
        return self.segments.kind == "hot_fire" and not self.segments.misfire

    def _signal(self, name: str) -> Signal | None:
        found = self._live.get(name)
        return None if found is None else found.shifted(self.segments.t_open.value or 0.0)

    @property
    def _live(self) -> dict[str, Signal]:
        return live_signals(self.log)

    def _fuel_end(self) -> Doubt | None:
        """A stated burn whose end the log shows at another time."""
        seen = self.definition.known("observed.burn_time")
        if seen is None or not self._burning:
            return None
        above = self.segments.time("t_end")
        if above is None or seen.value + 3.0 * (seen.std or 0.0) >= above - 3.0 * self.segments.std("t_end"):
            return None
        words = text(
            "[observed] burn_time is {seen:.1f} s, but the chamber burns on: its pressure is above 1.8 times ambient "
            "until {above:.1f} s",
            seen=seen.value,
            above=above,
        )
        return Doubt(words, {"a": seen.value / above, "n": 1.0, "regression_rate_reference": seen.value / above})

    def _run_line(self) -> Doubt | None:
        """A run line so far below the tank that no liquid would come through."""
        means = self._means("p_tank", "p_run", "p_chamber")
        if means is None:
            return None
        tank, run, chamber = means
        ambient = self.definition.ambient_pressure.value
        if run - ambient >= LEAST_LEFT * (tank - ambient) or tank <= 2.0 * ambient or chamber >= run:
            return None
        words = text(
            "p_run stands at {run} while liquid flows, far below the tank ({tank}): what leaves the tank as liquid "
            "would boil in such a line; p_run's scale or unit is off, or it is not measured before the injector",
            run=said(run, "bar", ".1f"),
            tank=said(tank, "bar", ".1f"),
        )
        ideal = sqrt((run - chamber) / (tank - chamber))
        return Doubt(words, {"C_i": ideal, "K_loss": 0.0, "p_loss_liquid": 0.0, "p_loss_vapor": 0.0, "m": 1.0})

    def _chamber(self) -> Doubt | None:
        """p_c A_t that the oxidizer's flow does not bring together with a fire.

        A gauge whose size its health doubts, by the thrust, is believed where the flow speaks for it.
        """
        nozzle, flow = self.definition.nozzle, self._oxidizer_flow()
        means = self._means("p_run", "p_chamber") or self._means("p_tank", "p_chamber")
        if not self._burning or nozzle is None or nozzle.throat_radius is None or means is None or flow is None:
            return None
        chamber, ambient = means[1], self.definition.ambient_pressure.value
        if chamber < 1.5 * ambient:
            return None
        velocity = chamber * pi * nozzle.throat_radius.value**2 / flow
        told = f"p_c A_t over the oxidizer's flow is {velocity:.0f} m/s"
        if self._doubted("p_chamber", chamber - ambient):
            return None if USUAL[0] <= velocity <= USUAL[1] else _too(told)
        if APPARENT[0] / BEYOND <= velocity <= APPARENT[1] * BEYOND:
            return None
        told = f"{told}, where a fire has {APPARENT[0]:.0f} to {APPARENT[1]:.0f}"
        by_flow, thrust = sqrt(APPARENT[0] * APPARENT[1]) / velocity, self._means("thrust")
        agree = thrust is not None and not self._doubted("thrust", thrust[0])
        return _flow(told, 1.0 / by_flow) if agree else _gauge(by_flow, told, means)

    def _doubted(self, name: str, level: float) -> bool:
        """Whether what its health found of a channel is about the size of its ``level`` [SI]."""
        return self.log[name].doubt > SIZE * abs(level)

    def _exit(self) -> Doubt | None:
        """An exit so wide that the flow would not fill it."""
        nozzle, means = self.definition.nozzle, self._means("p_chamber")
        if not self._burning or nozzle is None or not (nozzle.throat_radius and nozzle.exit_radius) or means is None:
            return None
        ratio = (nozzle.exit_radius.value / nozzle.throat_radius.value) ** 2
        ambient = self.definition.ambient_pressure.value
        if ratio < 1.0 or flows_full(means[0], ambient, ratio):
            return None
        words = text(
            "[nozzle] exit_radius is {radius:.1f} mm, an exit of {ratio:.0f} times the throat's area: at a chamber "
            "pressure of {chamber} the flow would not fill it; is its unit right?",
            radius=nozzle.exit_radius.value * 1e3,
            ratio=ratio,
            chamber=said(means[0], "bar", ".1f"),
        )
        return Doubt(words, dict.fromkeys(REGRESSION, 1.0))

    def _oxidizer_flow(self) -> float | None:
        """Mean over the liquid phase [kg/s]."""
        used, t_v = self.found.oxidizer_mass_liquid_phase.value, self.segments.time("t_v")
        return used / t_v if used is not None and t_v and used > 0.0 else None

    def _means(self, *names: str) -> tuple[float, ...] | None:
        """Means over the steady part of the liquid phase, None where one is missing."""
        ends = [t for name in ("t_v", "t_fuel_out", "t_end") if (t := self.segments.time(name)) is not None]
        signals = [self._signal(name) for name in names]
        if not ends:
            return None
        start, end = max(self.segments.time("t_feed") or 0.0, 0.1 * min(ends)), min(ends)
        means = tuple(s.mean(start, end) if s is not None else np.nan for s in signals)
        return means if np.isfinite(means).all() else None


def _too(evidence: str) -> Doubt:
    """That the flow speaks against the chamber's gauge as well."""
    of_most = f"where most have {USUAL[0]:.0f} to {USUAL[1]:.0f}"
    words = f"the size of p_chamber cannot be believed, or the stated throat: {evidence}, {of_most}"
    return Doubt(words, {}, no_regression=True)


def _gauge(factor: float, evidence: str, means: tuple[float, ...]) -> Doubt:
    """That p_c A_t has to be larger by a ``factor`` [-]; ``means``: of p_run and p_chamber [Pa]."""
    run, chamber = means
    throat = f"[nozzle] throat_radius is stated at {_times(1.0 / sqrt(factor))} of what it is"
    if chamber * factor >= run:  # no chamber stands above what feeds it
        return Doubt(f"{throat}: {evidence}", {}, no_regression=True)
    words = f"p_chamber reads about {_times(1.0 / factor)} of what it should, or {throat}: {evidence}"
    reach = sqrt((run - chamber) / (run - chamber * factor))
    return Doubt(words, {**dict.fromkeys(FLOWS, 1.0), "C_i": reach}, no_regression=True)


def _flow(evidence: str, factor: float) -> Doubt:
    """That the oxidizer's flow has to be larger by a ``factor`` [-]."""
    words = f"thrust and p_chamber agree, but not with the oxidizer: {evidence}; the loaded mass or t_v is off"
    return Doubt(words, {"C_i": factor, "oxidizer_flow_peak": factor, "K_loss": factor**-2}, no_regression=True)


def _times(factor: float) -> str:
    return f"{factor:.2g}" if factor < 10.0 else f"{factor:.0f}"
