"""The phases of a test, put together from the single events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hfanalysis.errors import AbsentError
from hfanalysis.products.segments import EVENTS, NOTHING, Segments
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.signals import Signal, live_signals
from hfanalysis.segment import chamber_gauge
from hfanalysis.segment.dry_tank import liquid_end
from hfanalysis.segment.end_of_burn import CRITICAL_RATIO, find_low_pressure, pulses_after
from hfanalysis.segment.feed import find_line_full
from hfanalysis.segment.fuel import FuelEnd, find_fuel_end
from hfanalysis.segment.fuel_at_once import BLURRED
from hfanalysis.segment.kind import Kind, Known, recognize
from hfanalysis.segment.purge import find_nitrogen
from hfanalysis.segment.purge_by_tank import find_nitrogen_by_tank
from hfanalysis.segment.sanity import (
    BESIDE_HOLE,
    BY_HAND,
    HAND_STD,
    SHOWN_BY,
    anywhere_in,
    beside_hole,
    contradicted,
    lies_in_hole,
    strange_tank,
)
from hfanalysis.segment.supercharge import supercharge
from hfanalysis.segment.taken import TakenFiring, check_stated
from hfanalysis.sentences import text

FUEL_LEFT = 0.05
"""Part of the grain that may be left over as slivers when its fuel is gone."""

LONGEST_RUN = 120.0
"""Seconds after the opening in which events are looked for."""

RESPONSE = 2e-4
"""Standard deviation [s] of how far one sensor answers after another. Source: data sheets of strain-gauge transducers:
1 ms from 10 to 90 % is a time constant of 0.45 ms, a tube of 0.1 m before it adds 0.3 ms, and half of that differs."""


def find_phases(log: TestLog, definition: TestDefinition, firing: int | None = None) -> Segments:
    """All events of a log, of its ``firing`` counted from 1, or of the one that test.toml or its size says.

    Raises AbsentError where no channel can tell, the log begins in mid-firing, or there are fewer firings.
    """
    signals = live_signals(log)
    check_stated(definition, signals)
    firings = TakenFiring(signals, definition, firing or definition.log.firing)
    if firings.taken is None:
        return _nothing(signals, definition)
    signals = firings.cut
    opening, unsure = beside_hole(firings.taken, signals)
    origin = opening.time
    shifted = {name: s.between(origin - 60.0, origin + LONGEST_RUN).shifted(origin) for name, s in signals.items()}
    dead = [f"{n} never changes or has no good samples: left out" for n in log.channels if n not in signals]
    unsure += strange_tank(shifted.get("p_tank")) + firings.said
    zeros = {name: channel.zero_std or 0.0 for name, channel in log.channels.items()}
    search = _Search({n: s for n, s in shifted.items() if s.time.size > 7}, definition, opening.std, zeros)
    kind = search.run()
    return Segments.of(
        Quantity(opening.time, "s", max(opening.std, 1e-9), why=f"from {', '.join(opening.channels)}"),
        search.events,
        kind=kind.name,
        kind_reason=kind.why,
        misfire=kind.misfire,
        supercharged=search.supercharged,
        firings=firings.listed,
        engineer=tuple(name for name in ("t_open", *EVENTS) if name in definition.segments),
        found_where_engineer_set=search.found,
        notes=tuple(search.notes),
        warnings=(*dead, *unsure, *search.warnings),
    )


def _nothing(signals: Mapping[str, Signal], definition: TestDefinition) -> Segments:
    """A log in which nothing opens. Raises AbsentError where no channel could tell."""
    looked = ", ".join(n for n in ("valve", "p_run", "p_chamber", "p_tank", "thrust") if n in signals)
    why = f"nothing in {looked} responds to an opening valve" if looked else "no channel has good samples that change"
    reason = (
        f"test {definition.test.id}: the log holds no firing and no flow: {why}; "
        "set [segments] t_open in test.toml if there is one"
    )
    if not looked:
        raise AbsentError(reason)
    absent = Quantity.absent(reason)
    return Segments.of(absent, dict.fromkeys(EVENTS, absent), kind=NOTHING, kind_reason=why, warnings=(reason,))


class _Search:
    """The search for the events of one test; keeps what has been found while the next event is looked for."""

    def __init__(
        self,
        signals: Mapping[str, Signal],
        definition: TestDefinition,
        opening_std: float,
        zeros: Mapping[str, float],
    ) -> None:
        self.opening_std, self.zeros = opening_std, zeros
        self.signals = signals
        self.definition = definition
        self.ambient = definition.ambient_pressure.value
        self.offset = chamber_gauge.offset(signals["p_chamber"], self.ambient) if "p_chamber" in signals else 0.0
        self.last = max((float(s.time[-1]) for s in signals.values()), default=0.0)
        self.events: dict[str, Quantity] = {}
        self.found: dict[str, float] = {}
        self.notes: list[str] = []
        self.warnings: list[str] = []
        self.supercharged = False

    def run(self) -> Kind:
        """Every event in an order in which each can use the ones before; the kind of test."""
        self._take("t_v", self._liquid_end())
        self._take("t_feed", self._line_full())
        self._take("t_purge", self._nitrogen())
        kind = self._kind()
        self._note_supercharge()
        self._take("t_end", self._low_pressure(kind))
        self._take_fuel(kind)
        self._check_order()
        return kind

    def _take(self, name: str, found: tuple[float, float] | str) -> None:
        stated = self.definition.segments.get(name)
        if stated is None:
            self.events[name] = (
                Quantity.absent(self._why_not(name, found)) if isinstance(found, str) else self._seconds(name, *found)
            )
            return
        self.events[name] = Quantity(stated.value, "s", stated.std or HAND_STD, why=BY_HAND)
        if isinstance(found, str):
            self.notes.append(f"{name} is {BY_HAND} at {stated.value:.3f} s; the search found none: {found}")
            return
        self.found[name] = found[0]
        self.notes.append(f"{name} is {BY_HAND} at {stated.value:.3f} s; the search finds {found[0]:.3f} s")
        self.warnings += contradicted(name, stated, *found)

    def _seconds(self, name: str, time: float, std: float) -> Quantity:
        """An event's instant, no surer than the hole of its channel that it was found in or beside."""
        for start, end in self._holes(name, time - BESIDE_HOLE, time + BESIDE_HOLE):
            time, std = anywhere_in(time, std, start, end)
            self.warnings.append(lies_in_hole(name, SHOWN_BY[name], start, end))
        return Quantity(time, "s", float(np.linalg.norm([std, self.opening_std, RESPONSE])))

    def _why_not(self, name: str, reason: str) -> str:
        """Why an event was not found; a hole of its channel may hide it."""
        found = self._holes(name, 0.0, self.last)
        if not len(found):
            return reason
        start, end = max(found, key=lambda hole: hole[1] - hole[0])
        hole = "{reason}; {channel} has no good samples from {start:.2f} to {end:.2f} s, where it may be"
        return text(hole, reason=reason, channel=SHOWN_BY[name], start=start, end=end)

    def _holes(self, name: str, start: float, end: float) -> Sequence[Sequence[float]]:
        channel = self.signals.get(SHOWN_BY[name])
        return [] if channel is None else channel.holes(start, end).tolist()

    def _liquid_end(self) -> tuple[float, float] | str:
        found = liquid_end(self.signals, self.definition, min(self.last, LONGEST_RUN))
        if isinstance(found, str):
            return found
        for name, time in found.other_times.items():
            self.notes.append(f"{name} falls {time - found.time:+.2f} s from the tank's knee")
        return found.time, found.std

    def _line_full(self) -> tuple[float, float] | str:
        if "p_run" not in self.signals:
            return "the log has no p_run"
        t_v = self._time("t_v")
        return find_line_full(self.signals["p_run"], t_v if t_v is not None else min(self.last, 5.0))

    def _nitrogen(self) -> tuple[float, float] | str:
        if "p_purge" not in self.signals:
            if "p_tank" not in self.signals:
                return "the log has no p_purge: nitrogen shows in its supply line"
            return find_nitrogen_by_tank(self.signals["p_tank"], self._time("t_v"))
        return find_nitrogen(self.signals["p_purge"], self.last, self.signals.get("p_tank"), self._sharp("t_v"))

    def _low_pressure(self, kind: Kind) -> tuple[float, float] | str:
        if "p_chamber" not in self.signals:
            return "the log has no p_chamber"
        if kind.name != "hot_fire":
            return f"nothing burns: {kind.why}"
        chamber, offset = self.signals["p_chamber"], self.offset
        bias = chamber_gauge.limit_std(self.definition, self.zeros.get("p_chamber", 0.0))
        noise = chamber_gauge.noise(self.signals)
        found = find_low_pressure(chamber, self.ambient, self._time("t_feed") or 0.3, offset, bias, noise)
        if not isinstance(found, str):
            for start, end in pulses_after(chamber, CRITICAL_RATIO * self.ambient + offset, found[0]):
                self.notes.append(
                    f"the chamber is above 1.8 times ambient again from {start:.2f} to {end:.2f} s: gas that is blown "
                    "through after the burn, which t_end does not count"
                )
        return found

    def _take_fuel(self, kind: Kind) -> None:
        """t_fuel_out and t_fuel_gone: one fall at once, or the beginning and the end of a fade."""
        found = self._fuel_end(kind)
        if isinstance(found, str):
            self._take("t_fuel_out", found)
            self._take("t_fuel_gone", found)
            return
        self._take("t_fuel_out", (found.time, found.std))
        self._take("t_fuel_gone", found.hidden if found.gone is None else (found.gone, found.gone_std))
        if not found.at_once:
            self.notes.append(f"the fire fades from {found.time:.2f} s on, as the fuel runs out")

    def _fuel_end(self, kind: Kind) -> FuelEnd | str:
        if kind.name != "hot_fire":
            return f"nothing burns: {kind.why}"
        if "p_chamber" not in self.signals:
            return "the log has no p_chamber"
        t_v = self.events["t_v"]
        liquid_out = None if t_v.value is None else (t_v.value, t_v.std or 0.0)
        ambient = self.ambient + self.offset
        found = find_fuel_end(self.signals, ambient, self._time("t_feed") or 0.3, liquid_out, self.last)
        if isinstance(found, str):
            return found
        return self._fuel_left(found.time) or found

    def _fuel_left(self, time: float) -> str:
        """Why a fall of the chamber's pressure is not the end of the fuel; empty where nothing speaks against it."""
        seen, grain = self.definition.observed, self.definition.grain
        left = seen.fuel_mass_after if seen is not None else None
        loaded = grain.mass if grain is not None else None
        if left is not None and loaded is not None and left.value > FUEL_LEFT * loaded.value:
            return f"{left.value:.3g} kg of fuel were left after the test: the fall at {time:.2f} s is not its end"
        return ""

    def _kind(self) -> Kind:
        t_v, nozzle, tank = self._time("t_v"), self.definition.nozzle, self.definition.tank
        span = (self._time("t_feed") or 0.0, t_v if t_v is not None else min(self.last, 5.0))
        flow = None
        if t_v and tank is not None and tank.oxidizer_mass is not None:
            flow = 0.8 * tank.oxidizer_mass.value / t_v  # about a fifth of a load is still there as vapor
        area = (
            np.pi * nozzle.throat_radius.value**2 if nozzle is not None and nozzle.throat_radius is not None else None
        )
        ambient = self.ambient + self.offset
        kind = recognize(self.signals, self.definition.test.kind, span, Known(ambient, flow, area))
        if kind.warning:
            self.warnings.append(kind.warning)
        if kind.misfire:
            self.warnings.append(f"stated as a hot fire, but nothing burns, a cold flow: {kind.why}")
        return kind

    def _note_supercharge(self) -> None:
        if "p_tank" in self.signals:
            tank, thermometer = self.signals["p_tank"], self.signals.get("T_tank")
            self.supercharged, said_of_it = supercharge(tank, thermometer, self._time("t_purge"), self.definition)
            self.warnings += said_of_it

    def _check_order(self) -> None:
        t_v, t_purge = self._time("t_v"), self._time("t_purge")
        t_feed = self._time("t_feed")
        if t_feed is not None and t_v is not None and t_feed >= t_v:
            self.events["t_feed"] = Quantity.absent(f"{t_feed:.2f} s would be after the end of the liquid")
        if t_v is None or t_purge is None:
            return
        early = t_v - t_purge
        if early > 2.0 * np.hypot(self.events["t_v"].std or 0.0, self.events["t_purge"].std or 0.0):
            self.notes.append(f"nitrogen enters {early:.2f} s before the liquid is gone: there is no vapor-only phase")

    def _sharp(self, name: str) -> float | None:
        """An event's instant [s], where it is dated well enough to leave a corner of its own in another channel."""
        return self._time(name) if (self.events[name].std or 0.0) < BLURRED else None

    def _time(self, name: str) -> float | None:
        return self.events[name].value if name in self.events else None
