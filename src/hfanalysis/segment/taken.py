"""Which of a log's firings is taken, by its size or by what is asked for, and its part of every signal."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hfanalysis.errors import AbsentError, InputError
from hfanalysis.products.segments import Opening as ListedOpening
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.signals import Signal
from hfanalysis.segment.firings import Flow, find_flows, largest
from hfanalysis.segment.opening import Opening, find_opening, under_way
from hfanalysis.segment.sanity import BY_HAND, HAND_STD, contradicted


class TakenFiring:
    """The openings of a log, and the one that is taken: ``taken`` (None: nothing opens), its signals ``cut``.

    Raises AbsentError where the log begins in mid-firing, or holds fewer firings than the ``number`` asked for.
    """

    def __init__(self, signals: Mapping[str, Signal], definition: TestDefinition, number: int | None) -> None:
        self.definition, self.signals = definition, signals
        self.opened = self._openings()
        self.chosen = self._chosen(number)
        self.said: list[str] = self._several(number) if len(self.opened) > 1 else []
        self.said += self._against_search()
        self.taken: Opening | None = self.opened[self.chosen][1] if self.opened else None
        flow = self.opened[self.chosen][0] if self.opened else Flow(0.0, 0.0, -np.inf, np.inf)
        self.cut = {name: part for name, s in signals.items() if (part := _cut(s, flow)).time.size > 7}

    def _openings(self) -> list[tuple[Flow, Opening]]:
        """Every flow with its opening; one whose opening does not show belongs to its neighbor."""
        stated = self.definition.segments.get("t_open")
        flows = find_flows(self.signals)
        whole = Flow(-np.inf, np.inf, -np.inf, np.inf)
        if stated is not None:
            by_hand = Opening(stated.value, stated.std or HAND_STD, (BY_HAND,))
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

    def _against_search(self) -> list[str]:
        """What the log says against an opening that was set by hand; of several flows nobody knows which was meant."""
        stated = self.definition.segments.get("t_open")
        found = find_opening(self.signals) if stated is not None and len(self.opened) == 1 else None
        return contradicted("t_open", stated, found.time, found.std) if stated is not None and found else []

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


def check_stated(definition: TestDefinition, signals: Mapping[str, Signal]) -> None:
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
