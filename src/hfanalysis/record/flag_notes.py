"""What there is to say about flagged samples: once, where they are the same in several channels."""

from __future__ import annotations

import hashlib
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from hfanalysis.record.log import Flag, Flags


@dataclass(frozen=True)
class Flagged:
    """The samples that carry one flag in one file's channels: how many of how many, and a digest of which."""

    file: str
    flag: str
    count: int
    samples: int
    places: bytes


def flagged(file: str, flags: Flags) -> Iterator[Flagged]:
    """What a channel's flags hold. Time stamps that do not run are told of their clock, not of its channels."""
    met = int(np.bitwise_or.reduce(flags)) & ~Flag.TIME
    for flag in (flag for flag in Flag if met & flag):
        places = np.flatnonzero(flags & flag)
        name = str(flag.name).lower()
        yield Flagged(file, name, len(places), len(flags), hashlib.sha256(places.tobytes()).digest())


def flag_warnings(found: Iterable[tuple[str, Flagged]], channels: Counter[str]) -> Iterator[str]:
    """One line for each set of flagged samples.

    Args:
        found: channel and what was found in it.
        channels: how many channels each file has.
    """
    together: dict[Flagged, list[str]] = defaultdict(list)
    for channel, what in found:
        together[what].append(channel)
    for what, names in together.items():
        yield with_flag(_whose(names, what, channels), what.flag)


def of_one(channel: str, samples: str) -> str:
    """Samples ("3 of 100 samples") of one channel."""
    return f"channel {channel}: {samples}"


def with_flag(whose: str, flag: str) -> str:
    """That these carry a flag."""
    return f"{whose} flagged {flag}"


def _whose(names: Sequence[str], what: Flagged, channels: Counter[str]) -> str:
    samples = f"{what.count} of {what.samples} samples"
    if len(names) == 1:
        return of_one(names[0], samples)
    if len(names) < channels[what.file]:
        return f"channels {', '.join(names)}: the same {samples}"
    return f"{what.file}: {samples} of all {len(names)} channels"
