"""What the page of a test is made from: the products that there are, and why the others are not."""

from __future__ import annotations

import datetime
import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.charts.svg import Event, Phase
from hfanalysis.errors import AbsentError
from hfanalysis.health.reasons import Doubt, reasons
from hfanalysis.products.calibration import Calibration
from hfanalysis.products.flight import Flight
from hfanalysis.products.health import Health
from hfanalysis.products.model import AdoptedEffect, Product
from hfanalysis.products.segments import EVENTS, Segments
from hfanalysis.products.validation import Validation
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.limits import Rule
from hfanalysis.record.log import TestLog
from hfanalysis.report.names import called
from hfanalysis.wording.numbers import EVENT_LABELS, adopted_in_words

P = TypeVar("P", bound=Product)
_BEFORE, _AFTER = 2.0, 3.0
"""[s] shown before the opening and after the last event; as :mod:`hfanalysis.performance.histories` has them."""


@dataclass(frozen=True)
class StoredVariable:
    """A variable of an HDF5 product, with its SI unit."""

    values: Array
    unit: str = ""
    long_name: str = ""


Table = Mapping[str, StoredVariable]
Store = Mapping[str, Table]
"""The groups of an HDF5 product by their path ("" for the root), each with its variables."""


@dataclass(frozen=True)
class Last:
    """The stand's test before by date, with those of its JSON products that are there."""

    id: str
    date: datetime.date | None
    products: Mapping[str, Product]


@dataclass(frozen=True)
class Notes:
    """What the team wrote that day, in Markdown, and its photos: their names and their JPEG, small and without what a
    camera writes beside a picture."""

    text: str = ""
    photos: tuple[tuple[str, bytes], ...] = ()


@dataclass(frozen=True)
class Material:
    """All that the page shows.

    ``products``: the JSON products by the name of their file without its ending (``"calibration"``); ``stores``: the
    HDF5 products likewise; ``absent``: by the same names, why one is not there; ``rules``: the team's own limits;
    ``notes``: what the team wrote and photographed that day.
    """

    definition: TestDefinition
    log: TestLog
    products: Mapping[str, Product]
    stores: Mapping[str, Store] = field(default_factory=dict)
    absent: Mapping[str, str] = field(default_factory=dict)
    last: Last | None = None
    rules: tuple[Rule, ...] = ()
    notes: Notes = Notes()

    def get(self, kind: type[P]) -> P | None:
        """A JSON product; None where there is none."""
        found = self.products.get(kind.file.removesuffix(".json"))
        return found if isinstance(found, kind) else None

    def need(self, kind: type[P]) -> P:
        """A JSON product. Raises AbsentError where there is none, with the reason."""
        found = self.get(kind)
        if found is None:
            raise AbsentError(self.why_not(kind.file.removesuffix(".json")))
        return found

    def table(self, store: str, group: str = "") -> Table:
        """A group of an HDF5 product; empty where there is none."""
        return (self.stores.get(store) or {}).get(group) or {}

    def has(self, name: str) -> bool:
        """Whether a product is there."""
        return name in self.products or name in self.stores

    def why_not(self, name: str) -> str:
        """Why a product is not there."""
        return self.absent.get(name) or f"{name.replace('_', ' ')}: not made for this test"

    @cached_property
    def reasons(self) -> list[Doubt]:
        """Why channels are doubted, in the order of their numbers on the page."""
        health = self.get(Health)
        return [] if health is None else reasons(health.channels)

    @property
    def included(self) -> tuple[AdoptedEffect, ...]:
        """The adopted effects of the model; empty where there are none."""
        products = (self.get(Validation), self.get(Calibration), self.get(Flight))
        return next((product.effects for product in products if product and product.effects), ())

    @property
    def adopted(self) -> str:
        """The same in a sentence; empty where there are none."""
        return adopted_in_words(self.included, called)

    @property
    def fired(self) -> bool:
        """Whether the opening of the valve was found."""
        return self.event("t_open") is not None

    @property
    def opening(self) -> float:
        """The instant of the opening [s, log time]; 0 where the log has none, so that charts show log time."""
        return self.event("t_open") or 0.0

    def event(self, name: str) -> float | None:
        """An event's instant [s after the opening; t_open in log time]."""
        segments = self.get(Segments)
        return None if segments is None else segments.quantities[name].value


def window(material: Material) -> tuple[float, float]:
    """The stretch of time that the charts show [s after the opening]: the firing, or the whole log without one."""
    clocks = [c.time[np.isfinite(c.time)] for c in material.log.channels.values()]
    clocks = [clock for clock in clocks if clock.size] or [np.zeros(1)]
    first = min(float(clock.min()) for clock in clocks) - material.opening
    last = max(float(clock.max()) for clock in clocks) - material.opening
    if not material.fired:
        return first, max(last, first + 1.0)
    times = [t for name in EVENTS if (t := material.event(name)) is not None]
    end = max(times) + _AFTER if material.event("t_end") is not None else max([*times, 10.0]) * 1.5 + _AFTER
    return max(first, -_BEFORE), min(last, end)


def event_list(material: Material) -> list[Event]:
    """The events that the test has."""
    segments = material.get(Segments)
    if segments is None or not material.fired:
        return []
    found = [Event(0.0, segments.t_open.std or 0.0, EVENT_LABELS["t_open"])]
    for name, event in segments.events.items():
        if event.value is not None:
            found.append(Event(event.value, event.std or 0.0, EVENT_LABELS.get(name, name)))
    return found


def phase_list(material: Material) -> list[Phase]:
    """What flows between one event and the next: the line filling, liquid, vapor, nitrogen; they may overlap."""
    end = material.event("t_end")
    if not material.fired or end is None:
        return []
    names = ("t_feed", "t_v", "t_purge")
    inner = sorted(t for name in names if (t := material.event(name)) is not None and 0.0 < t < end)
    edges = [0.0, *inner, end]
    return [_phase(material, a, b) for a, b in itertools.pairwise(edges) if b > a]


def _phase(material: Material, start: float, end: float) -> Phase:
    middle = 0.5 * (start + end)
    feed, dry, purge = (material.event(name) for name in ("t_feed", "t_v", "t_purge"))
    nitrogen = purge is not None and middle >= purge
    if feed is not None and middle < feed:
        return Phase(start, end, "line filling", "fill")
    if dry is None or middle < dry:
        return Phase(start, end, "liquid + N₂" if nitrogen else "liquid", "liquid")
    return Phase(start, end, "vapor + N₂" if nitrogen else "vapor", "nitrogen" if nitrogen else "vapor")


def read_store(path: Path) -> Store:
    """All one-dimensional variables of an HDF5 file, by group; those without a dimension become arrays of one."""
    import h5py

    found: dict[str, dict[str, StoredVariable]] = {}

    def keep(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.ndim <= 1 and item.dtype.kind in "fiu":
            group, _, variable = name.rpartition("/")
            found.setdefault(group, {})[variable] = _column(item)

    with h5py.File(path, "r") as file:
        file.visititems(keep)
    return found


def _column(item: Any) -> StoredVariable:
    unit, long_name = (str(item.attrs.get(key, "")) for key in ("units", "long_name"))
    return StoredVariable(np.atleast_1d(np.asarray(item[()], dtype=float)), unit, long_name)


def required(table: Table, *names: str) -> list[Array]:
    """Variables of one table, each (n,) in the unit that the table has for it.

    Raises :class:`AbsentError` naming one that it has not.
    """
    for name in names:
        if name not in table or not np.isfinite(table[name].values).any():
            raise AbsentError(f"the products hold no {name.replace('_', ' ')}")
    return [table[name].values for name in names]
