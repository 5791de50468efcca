"""The phases of a test, put together from the single events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products.segments import EVENTS, NOTHING, Segments
from hfanalysis.products.segments import Opening as ListedOpening
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.log import TestLog
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal, live_signals
from hfanalysis.segment.coarse_load import CoarseLoad, coarse_load
from hfanalysis.segment.end_of_burn import CRITICAL_RATIO, QUIET, find_low_pressure, pulses_after
from hfanalysis.segment.feed import find_line_full
from hfanalysis.segment.firings import Flow, find_flows, largest
from hfanalysis.segment.fuel import BLURRED, FuelEnd, find_fuel_end
from hfanalysis.segment.kind import Kind, Known, recognize
from hfanalysis.segment.liquid import LiquidEnd, dry_pressure, find_liquid_end
from hfanalysis.segment.opening import Opening, find_opening, under_way
from hfanalysis.segment.purge import find_nitrogen
from hfanalysis.segment.purge_by_tank import find_nitrogen_by_tank
from hfanalysis.segment.sanity import BESIDE_HOLE, SHOWN_BY, anywhere_in, beside_hole, lies_in_hole, strange_tank
from hfanalysis.sentences import said, text
from hfanalysis.thermo.nitrous import saturation

FUEL_LEFT = 0.05
"""Part of the grain that may be left over as slivers when its fuel is gone."""

LONGEST_RUN = 120.0
"""Seconds after the opening in which events are looked for."""

SATURATION_MARGIN = 8.0
"""Kelvin by which the top of a heated tank may be hotter than its thermometer says [K]. Evidence: on real stands it is
often the thermometer that is wrong (docs/phases.md)."""

FROM_THE_START = 0.3
"""Nitrogen that flows within this time [s] of the opening presses on the liquid, not on what it leaves."""

LARGEST_OFFSET = 3e5
"""Reading of an open chamber this far from ambient [Pa] is no bias: the chamber was not open."""

MUCH_MORE = 4.0
"""Times the usual wander of the pressures at rest above which one is not at rest."""

BY_HAND = "set by the engineer"


def find_phases(log: TestLog, definition: TestDefinition, firing: int | None = None) -> Segments:
    """All events of a log, of its ``firing`` counted from 1, or of the one that test.toml or its size says.

    Raises AbsentError where no channel can tell, the log begins in mid-firing, or there are fewer firings.
    """
    signals = live_signals(log)
    _check_stated(definition, signals)
    firings = _Firings(signals, definition, firing or definition.log.firing)
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


def _check_stated(definition: TestDefinition, signals: Mapping[str, Signal]) -> None:
    """What the engineer sets must lie in the log and in order; raises InputError naming the key."""
    stated = definition.segments
    if not signals or not stated:
        return
    first = min(float(s.time[0]) for s in signals.values())
    last = max(float(s.time[-1]) for s in signals.values())
    where = f"{definition.path}: [segments]"
    opening = stated.get("t_open")
    if opening is not None and not first <= opening.value < last:
        raise InputError(
            f"{where} t_open: found {opening.value:g} s; expected a log time between {first:g} and {last:g} s"
        )
    for name, value in stated.items():
        if name != "t_open" and not 0.0 < value.value < last - first:
            raise InputError(
                f"{where} {name}: found {value.value:g} s; expected a time after the opening within the log"
            )
    if {"t_feed", "t_v"} <= set(stated) and stated["t_feed"].value >= stated["t_v"].value:
        raise InputError(f"{where} t_feed: found {stated['t_feed'].value:g} s; expected less than t_v")


class _Firings:
    """The openings of a log, and the one that is taken: ``taken`` (None: nothing opens), its signals ``cut``."""

    def __init__(self, signals: Mapping[str, Signal], definition: TestDefinition, number: int | None) -> None:
        self.definition, self.signals = definition, signals
        self.opened = self._openings()
        self.chosen = self._chosen(number)
        self.said: list[str] = self._several(number) if len(self.opened) > 1 else []
        self.taken: Opening | None = self.opened[self.chosen][1] if self.opened else None
        flow = self.opened[self.chosen][0] if self.opened else Flow(0.0, 0.0, -np.inf, np.inf)
        self.cut = {name: part for name, s in signals.items() if (part := _cut(s, flow)).time.size > 7}

    def _openings(self) -> list[tuple[Flow, Opening]]:
        """Every flow with its opening; one whose opening does not show belongs to its neighbor."""
        stated = self.definition.segments.get("t_open")
        flows = find_flows(self.signals)
        whole = Flow(-np.inf, np.inf, -np.inf, np.inf)
        if stated is not None:
            by_hand = Opening(stated.value, stated.std or 1e-3, (BY_HAND,))
            own = [flow for flow in flows if flow.since <= stated.value < flow.until] if len(flows) > 1 else [whole]
            others = [] if len(flows) < 2 else [(f, o) for f in flows if f not in own and (o := self._opening(f))]
            return sorted([*others, *((flow, by_hand) for flow in own)], key=lambda pair: pair[1].time)
        found = [(flow, opening) for flow in flows if (opening := self._opening(flow)) is not None]
        if len(found) > 1:
            return found
        if (name := under_way(self.signals)) is not None:
            raise AbsentError(
                f"test {self.definition.test.id}: the log starts in the middle of the firing ({name} is high from its "
                "first sample): there is no opening to count from; set [segments] t_open in test.toml, if it is known"
            )
        opening = find_opening(self.signals)
        return [] if opening is None else [(whole, opening)]

    def _opening(self, flow: Flow) -> Opening | None:
        opening = find_opening({name: _cut(s, flow) for name, s in self.signals.items()})
        return opening if opening is not None and opening.time < flow.end else None

    def _chosen(self, number: int | None) -> int:
        if number is not None and number > max(len(self.opened), 1):
            raise AbsentError(
                f"test {self.definition.test.id}: [log] firing = {number}: the log holds "
                f"{len(self.opened)} firing{'' if len(self.opened) == 1 else 's'}"
            )
        by_hand = [i for i, (_, opening) in enumerate(self.opened) if opening.channels == (BY_HAND,)]
        if number is not None or by_hand or len(self.opened) < 2:
            return number - 1 if number is not None else by_hand[0] if by_hand else 0
        fire = self.definition.test.kind == "hot_fire"
        return largest([flow for flow, _ in self.opened], self.signals, fire)

    def _several(self, number: int | None) -> list[str]:
        times = ", ".join(f"{i}: {opening.time:.2f} s" for i, (_, opening) in enumerate(self.opened, 1))
        how = "as asked" if number is not None else "the largest, the first of those alike"
        return [
            f"the log holds {len(self.opened)} firings or flows, which open at ({times}, log time); number "
            f"{self.chosen + 1} is taken, {how}: [log] firing = N in test.toml or --firing N takes another"
        ]

    @property
    def listed(self) -> tuple[ListedOpening, ...]:
        """As segments.json lists them."""
        return tuple(
            ListedOpening(
                number=i + 1,
                t_open=Quantity(opening.time, "s", max(opening.std, 1e-9), why=f"from {', '.join(opening.channels)}"),
                start=_finite(flow.since),
                end=_finite(flow.until),
                taken=i == self.chosen,
            )
            for i, (flow, opening) in enumerate(self.opened)
        )


def _cut(signal: Signal, flow: Flow) -> Signal:
    return signal.between(flow.since, flow.until)


def _finite(edge: float) -> float | None:
    return edge if np.isfinite(edge) else None


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
        self.events[name] = Quantity(stated.value, "s", stated.std or 1e-3, why=BY_HAND)
        if isinstance(found, str):
            self.notes.append(f"{name} is {BY_HAND} at {stated.value:.3f} s; the search found none: {found}")
            return
        self.found[name] = found[0]
        self.notes.append(f"{name} is {BY_HAND} at {stated.value:.3f} s; the search finds {found[0]:.3f} s")

    def _seconds(self, name: str, time: float, std: float) -> Quantity:
        """An event's instant, no surer than the hole of its channel that it was found in or beside."""
        for start, end in self._holes(name, time - BESIDE_HOLE, time + BESIDE_HOLE):
            time, std = anywhere_in(time, std, start, end)
            self.warnings.append(lies_in_hole(name, SHOWN_BY[name], start, end))
        return Quantity(time, "s", float(np.hypot(std, self.opening_std)))

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
        if "p_tank" not in self.signals:
            return "the log has no p_tank: the end of the liquid shows in the tank's pressure"
        tank = self.signals["p_tank"]
        end = _discharged(tank, min(self.last, LONGEST_RUN), self.ambient)
        load = coarse_load(self.definition, self.signals)
        dry = self._dry_pressure(tank)
        found = find_liquid_end(self.signals, end, dry, load.contradicts if load else _possible)
        if found is None:
            return self._no_liquid_end(find_liquid_end(self.signals, end, None), dry, load)
        for name, time in found.other_times.items():
            self.notes.append(f"{name} falls {time - found.time:+.2f} s from the tank's knee")
        return found.time, found.std

    def _no_liquid_end(self, knee: LiquidEnd | None, dry: float | None, load: CoarseLoad | None) -> str:
        """Why there is no t_v; a ``knee`` may be there that what is stated contradicts."""
        if knee is None:
            return (
                "the tank pressure shows no knee: it never falls faster than before, as it does when the liquid is gone"
            )
        if load is not None and load.contradicts(knee.time):
            words = (
                "the tank pressure has a knee at {time:.2f} s, but no injector of the stated holes passes the stated "
                "oxidizer by then: [injector] holes and hole_area, or [tank] oxidizer_mass are off"
            )
            return text(words, time=knee.time)
        words = (
            "the tank pressure has a knee at {time:.2f} s and {there}, but a tank of the stated volume and load runs "
            "dry at {dry}: [tank] oxidizer_mass or volume are off"
        )
        there = said(self.signals["p_tank"].mean(knee.time - 0.1, knee.time + 0.1), "bar", ".1f")
        return text(words, time=knee.time, there=there, dry=said(dry or 0.0, "bar", ".1f"))

    def _dry_pressure(self, tank: Signal) -> float | None:
        section = self.definition.tank
        if section is None or section.volume is None or section.oxidizer_mass is None:
            return None
        source = saturation(self.definition.model.properties)
        start = min(tank.mean(0.25, 0.75), 0.999 * source.pressure_range[1])
        if not np.isfinite(start):
            return None
        return dry_pressure(source, section.volume.value, section.oxidizer_mass.value, start)

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
        chamber, offset = self.signals["p_chamber"], self._chamber_offset()
        found = find_low_pressure(
            chamber, self.ambient, self._time("t_feed") or 0.3, offset, self._chamber_bias(), self._noise()
        )
        if not isinstance(found, str):
            for start, end in pulses_after(chamber, CRITICAL_RATIO * self.ambient + offset, found[0]):
                self.notes.append(
                    f"the chamber is above 1.8 times ambient again from {start:.2f} to {end:.2f} s: gas that is blown "
                    "through after the burn, which t_end does not count"
                )
        return found

    def _chamber_offset(self) -> float:
        """How far the open chamber reads from ambient before the opening [Pa]: a bias to allow for, where it is one."""
        quiet = self.signals["p_chamber"].between(-5.0, -0.05).value
        offset = float(np.median(quiet)) - self.ambient if quiet.size > 7 else 0.0
        return offset if abs(offset) < LARGEST_OFFSET else 0.0

    def _noise(self) -> Noise:
        """The chamber sensor's, its wander judged with that of the other pressures: the quiet time alone is short."""
        noises = {n: Noise.of(s, s.between(*QUIET)) for n, s in self.signals.items() if n.startswith("p_")}
        all_of_them = np.array([noise.flicker for noise in noises.values()])
        usual = float(all_of_them[all_of_them <= MUCH_MORE * np.median(all_of_them)].mean())
        return replace(noises["p_chamber"], flicker=0.5 * (noises["p_chamber"].flicker + usual))

    def _chamber_bias(self) -> float:
        """Standard deviation [Pa] of how 1.8 times ambient reads: the chamber's zero, and the air's pressure."""
        of_air = (CRITICAL_RATIO - 1.0) * (self.definition.ambient_pressure.std or 0.0)
        return float(np.hypot(of_air, self.zeros.get("p_chamber", 0.0)))

    def _take_fuel(self, kind: Kind) -> None:
        """t_fuel_out and t_fuel_gone: one fall at once, or the beginning and the end of a fade."""
        found = self._fuel_end(kind)
        if isinstance(found, str):
            self._take("t_fuel_out", found)
            self._take("t_fuel_gone", found)
            return
        self._take("t_fuel_out", (found.time, found.std))
        self._take("t_fuel_gone", found.hidden if found.gone is None else (found.gone, found.gone_std))
        if found.gone != found.time:
            self.notes.append(f"the fire fades from {found.time:.2f} s on, as the fuel runs out")

    def _fuel_end(self, kind: Kind) -> FuelEnd | str:
        if kind.name != "hot_fire":
            return f"nothing burns: {kind.why}"
        if "p_chamber" not in self.signals:
            return "the log has no p_chamber"
        t_v = self.events["t_v"]
        liquid_out = None if t_v.value is None else (t_v.value, t_v.std or 0.0)
        ambient = self.ambient + self._chamber_offset()
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
        ambient = self.ambient + (self._chamber_offset() if "p_chamber" in self.signals else 0.0)
        kind = recognize(self.signals, self.definition.test.kind, span, Known(ambient, flow, area))
        if kind.warning:
            self.warnings.append(kind.warning)
        if kind.misfire:
            self.warnings.append(f"stated as a hot fire, but nothing burns, a cold flow: {kind.why}")
        return kind

    def _note_supercharge(self) -> None:
        """Say where nitrogen presses on the tank: by its pressure at rest, or because it flows in from the start."""
        if "p_tank" not in self.signals:
            return
        critical = saturation(self.definition.model.properties).pressure_range[1]
        rest, t_purge = self.signals["p_tank"].mean(-3.0, -0.05), self._time("t_purge")
        if rest > critical:
            self.supercharged = True
            above = "the tank is supercharged: {rest} before the opening, above the critical pressure ({critical})"
            self.warnings.append(text(above, rest=said(rest, "bar", ".1f"), critical=said(critical, "bar", ".1f")))
        elif t_purge is not None and t_purge < FROM_THE_START:
            self.supercharged = True
            self.warnings.append("the tank is supercharged: nitrogen feeds it from the opening on")
        else:
            self._note_hot_gauge(rest)

    def _note_hot_gauge(self, rest: float) -> None:
        """Say where the pressure at rest [Pa] is more than the tank's thermometer allows; that alone proves nothing."""
        source, warmth = saturation(self.definition.model.properties), self._tank_temperature()
        if warmth is None or not source.t_min < warmth < source.t_max - SATURATION_MARGIN:
            return
        if rest > float(source.pressure(warmth + SATURATION_MARGIN)):
            self.warnings.append(
                text(
                    "the tank stands at {rest} before the opening, but saturation at the {warmth:.0f} degC of its "
                    "thermometer is {saturated}: it is supercharged, or the thermometer does not see the oxidizer",
                    rest=said(rest, "bar", ".1f"),
                    warmth=warmth - 273.15,
                    saturated=said(float(source.pressure(warmth)), "bar", ".1f"),
                )
            )

    def _tank_temperature(self) -> float | None:
        if "T_tank" in self.signals:
            quiet = self.signals["T_tank"].between(-30.0, -0.05).value
            return float(np.median(quiet)) if quiet.size else None
        tank = self.definition.tank
        return tank.temperature.value if tank is not None and tank.temperature is not None else None

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


def _possible(_time: float) -> bool:
    return False


def _discharged(tank: Signal, end: float, ambient: float) -> float:
    """When the tank has lost 90 % of its pressure above the lowest: knees beyond that are of no liquid.

    Readings below ``ambient`` [Pa] are of no tank: a failing gauge.
    """
    part = tank.between(0.0, end)
    if part.time.size < 8:
        return end
    smooth = part.smooth(max(0.1, 4.0 * tank.step))
    low, high = max(float(smooth.min()), ambient), float(smooth[0])
    gone = np.flatnonzero(smooth < low + 0.1 * (high - low))
    return float(part.time[gone[0]]) if gone.size else end
