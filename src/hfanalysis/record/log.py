"""The ingested log: channels in SI with a quality flag per sample, and how they came to be."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import IntFlag
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis import sentences
from hfanalysis.arrays import Array
from hfanalysis.errors import AbsentError, InputError
from hfanalysis.sentences import text
from hfanalysis.units import near

Flags = NDArray[np.uint8]


class Flag(IntFlag):
    """Why a sample is not to be trusted; the bits of a channel's ``flags``."""

    DROPOUT = 1
    """No number: missing, text, or a reading that stands for none."""
    STUCK = 2
    """Repeats the reading before it for longer than this channel ever does when alive."""
    SATURATED = 4
    """At the end of the sensor's or the logger's range."""
    SPIKE = 8
    """One to three samples far from their neighbors on both sides."""
    TIME = 16
    """Its time stamp is not later than that of an earlier sample."""
    EXCLUDED = 32
    """In a stretch that the engineer excluded."""
    UNUSABLE = 64
    """In a stretch in which the channel's health says that it means nothing."""


@dataclass(frozen=True)
class Channel:
    """One channel of the log, on its own clock.

    ``time`` [s, log time] and ``values`` [``unit``] keep the log's order and every sample; values are NaN where there
    is no number, and corrected for zero and tare. ``accuracy`` is one standard deviation of the bias [SI]. ``zero``:
    what was subtracted at the zero [SI]; ``zero_std``: standard deviation of the bias that is left, None where no zero
    was taken (then it is ``accuracy``). ``drift``: total drift removed between the two zeros. ``raw``: values before
    zero and tare, None where neither was applied. ``doubt``: what of ``accuracy`` and ``zero_std`` [SI] is there for
    what the channel's health may mean, added in squares.
    """

    name: str
    unit: str
    time: Array
    values: Array
    flags: Flags
    accuracy: float
    accuracy_stated: bool
    label: str
    zero: float = 0.0
    zero_std: float | None = None
    drift: float = 0.0
    raw: Array | None = None
    history: tuple[str, ...] = ()
    doubt: float = 0.0

    @property
    def good(self) -> NDArray[np.bool_]:
        """Samples that carry no flag and are finite, (n,) as ``values`` [``unit``]; their ``time`` [s] increases
        strictly.
        """
        good: NDArray[np.bool_] = (self.flags == 0) & np.isfinite(self.values)
        return good

    def between(self, start: float, end: float) -> Channel:
        """The samples with start <= time < end [s, log time]."""
        kept = (self.time >= start) & (self.time < end)
        raw = None if self.raw is None else self.raw[kept]
        return replace(self, time=self.time[kept], values=self.values[kept], flags=self.flags[kept], raw=raw)


@dataclass(frozen=True)
class TestLog:
    """All channels of one test; ``unusable`` says of those that its health left out why they are not there."""

    channels: dict[str, Channel]
    warnings: tuple[str, ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)
    unusable: Mapping[str, str] = field(default_factory=dict)

    def between(self, start: float | None, end: float | None) -> TestLog:
        """The log from ``start`` up to ``end`` [s, log time]; None: as far as it goes."""
        if start is None and end is None:
            return self
        first, last = -np.inf if start is None else start, np.inf if end is None else end
        return replace(self, channels={name: c.between(first, last) for name, c in self.channels.items()})

    def get(self, name: str) -> Channel | None:
        """The channel, or None where the log has none of that name."""
        return self.channels.get(name)

    def __getitem__(self, name: str) -> Channel:
        """The channel; raises :class:`AbsentError` naming it where there is none."""
        if name in self.unusable:
            raise AbsentError(self.lacks(name))
        if name not in self.channels:
            offer = near(name, self.channels) or f"; it holds {', '.join(self.channels)}"
            raise AbsentError(f"the log holds no channel {name!r}{offer}")
        return self.channels[name]

    def __contains__(self, name: str) -> bool:
        return name in self.channels

    def lacks(self, name: str) -> str:
        """Why a channel is not there."""
        if name not in self.unusable:
            return f"the log has no {name}"
        return text("the log has no usable {name}: {why}", name=name, why=self.unusable[name])


def read_log(path: Path) -> TestLog:
    """The log in an ingest.h5 as :func:`hfanalysis.record.ingest.ingest` wrote it."""
    import h5py

    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise InputError(f"{path}: cannot be read as HDF5 ({error}); expected a product of ingest") from None
    with file:
        channels = {name: _channel(file, name) for name in json.loads(file.attrs["channels"])}
        quoted = sentences.from_json(json.loads(file.attrs.get("quoted", "{}")))
        warnings = tuple(sentences.revived(json.loads(file.attrs["warnings"]), quoted))
        return TestLog(channels, warnings, json.loads(file.attrs["provenance"]))


def _channel(file: Any, name: str) -> Channel:
    data = file[name]
    about = data.attrs
    raw = file[f"{name}_raw"][:] if f"{name}_raw" in file else None
    return Channel(
        name,
        str(about["units"]),
        file[str(about["clock"])][:],
        data[:],
        file[f"{name}_flags"][:],
        float(about["accuracy"]),
        bool(about["accuracy_stated"]),
        str(about["label"]),
        zero=float(about["zero"]),
        zero_std=float(about["zero_std"]) if "zero_std" in about else None,
        drift=float(about["drift"]),
        raw=raw,
        history=tuple(json.loads(about["history"])),
    )
