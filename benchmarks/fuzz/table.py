"""A log as columns, and what was done to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REPOSITORY = Path(__file__).resolve().parents[2]
STANDS = ("HF5", "HF4")
CHANNELS = ("p_tank", "p_run", "p_chamber", "p_purge", "thrust", "m_tank")
UNITS = ("psi", "psi", "psi", "psi", "lbf", "kg")
EVERY = 20
"""Rows of the replicas' log of which one is taken: 50 Hz of 1 kHz."""


@dataclass(frozen=True)
class Log:
    """Time [s] and the channels (n,) as the logger wrote them; ``names``: of the columns, in order, time first."""

    time: Array
    channels: Mapping[str, Array]
    names: Mapping[str, str]

    @property
    def columns(self) -> list[tuple[str, Array]]:
        """Names and numbers in the order of the file."""
        return [(self.names["time"], self.time), *((self.names[name], self.channels[name]) for name in self.channels)]

    def put(self, **channels: Array) -> Log:
        """The log with other numbers in some channels."""
        return replace(self, channels={**self.channels, **channels})

    def rows(self, index: NDArray[np.intp]) -> Log:
        """The log of these rows."""
        return replace(self, time=self.time[index], channels={k: v[index] for k, v in self.channels.items()})


@dataclass
class Case:
    """One test to be: its log, the text of its test.toml, and by whom it was hit.

    ``hit``: what a message has to name for it to point to the cause; ``harmless`` mutations change no answer.
    """

    number: int
    stand: str
    format: str
    log: Log
    toml: dict[str, object]
    mutators: list[str] = field(default_factory=list)
    hit: set[str] = field(default_factory=set)
    content: bytes = b""
    text: str = ""


@lru_cache
def base_log(stand: str) -> Log:
    """A replica's log at 50 Hz."""
    path = REPOSITORY / "raw_tests" / stand / "log.csv"
    numbers = np.genfromtxt(path, delimiter=",", skip_header=1)[::EVERY]
    channels = dict(zip(CHANNELS, numbers.T[1:], strict=True))
    return Log(numbers[:, 0], channels, {name: name for name in ("time", *CHANNELS)})
