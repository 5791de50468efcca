"""The content of segments.json: when what happens in a test."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from hfanalysis.errors import AbsentError
from hfanalysis.products.model import Is, Notes, Part, Product, Warnings, Words
from hfanalysis.quantity import Quantity

EVENTS = ("t_feed", "t_v", "t_purge", "t_fuel_out", "t_fuel_gone", "t_end")

NOTHING = "nothing"
"""The kind of a log in which nothing opens."""


class Opening(Part):
    """One of the firings or flows that a log holds."""

    number: Annotated[int, Is("counted from 1 in the order of the log", "")]
    t_open: Annotated[Quantity, Is("its valve opens, in log time", "s")]
    start: Annotated[
        float | None, Is("from when on its events are looked for, in log time; null: the log's start", "s")
    ]
    end: Annotated[float | None, Is("until when, in log time; null: the log's end", "s")]
    taken: Annotated[bool, Is("whether the events are this one's")]


class Segments(Product):
    """Kind and events of a test; events count from the opening, whose instant is in log time."""

    file: ClassVar[str] = "segments.json"

    kind: Annotated[str, Is("of test, as recognized: hot_fire, cold_flow, water_flow, nothing")]
    kind_reason: Annotated[Words, Is("what it was recognized by")]
    misfire: Annotated[bool, Is("stated as a hot fire, and nothing burns")]
    supercharged: Annotated[bool, Is("nitrogen presses on the tank from the start")]
    firings: Annotated[tuple[Opening, ...], Is("all openings in the log; events are those of the one taken")]
    t_open: Annotated[Quantity, Is("the valve opens, in log time", "s")]
    t_feed: Annotated[Quantity, Is("the feed line is full", "s")]
    t_v: Annotated[Quantity, Is("the liquid is gone from the tank", "s")]
    t_purge: Annotated[Quantity, Is("nitrogen enters the tank", "s")]
    t_fuel_out: Annotated[Quantity, Is("the fade of chamber pressure and thrust begins as the fuel runs out", "s")]
    t_fuel_gone: Annotated[Quantity, Is("it has ended: the solid fuel is gone", "s")]
    t_end: Annotated[
        Quantity, Is("the chamber stays below 1.8 times ambient pressure; without it, the thrust has ended", "s")
    ]
    order: Annotated[tuple[str, ...], Is("the events that there are, by time")]
    engineer: Annotated[tuple[str, ...], Is("events that were set by hand")]
    found_where_engineer_set: Annotated[dict[str, float], Is("what the search finds for these", "s")]
    notes: Notes
    warnings: Warnings

    @classmethod
    def of(cls, t_open: Quantity, events: Mapping[str, Quantity], **about: Any) -> Segments:
        """With the ``events`` [s after the opening] by name, and their order; ``t_open`` [s, log time].

        What ``about`` does not say is nothing special.
        """
        fields = {"t_fuel_gone": events["t_fuel_out"], **events}  # at once, where nobody says otherwise
        there = {name: t for name in EVENTS if name in fields and (t := fields[name].value) is not None}
        order = sorted(there, key=lambda name: there[name])
        usual = {"kind_reason": "", "misfire": False, "supercharged": False, "found_where_engineer_set": {}}
        said = {"firings": (), "engineer": (), "notes": (), "warnings": ()}
        return cls.model_validate({"t_open": t_open, **fields, "order": order, **usual, **said, **about})

    @property
    def fired(self) -> Segments:
        """Itself; raises AbsentError with the reason where nothing opened."""
        if self.t_open.value is None:
            raise AbsentError(str(self.t_open.reason))
        return self

    @property
    def taken(self) -> Opening | None:
        """The opening whose events these are, where the log has several."""
        return next((one for one in self.firings if one.taken), None)

    @property
    def events(self) -> dict[str, Quantity]:
        """The events [s after the opening] by name."""
        return {name: getattr(self, name) for name in EVENTS}

    def time(self, name: str) -> float | None:
        """An event's instant [s], None where the test does not have it."""
        return self.events[name].value

    def std(self, name: str) -> float:
        """An event's standard deviation [s]; 0 where there is none."""
        return self.events[name].std or 0.0
