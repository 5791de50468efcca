"""When each part of a .tdms file's channels began: a file that is resumed states it anew in a later segment.

Source: National Instruments, "TDMS File Format Internal Structure": lead-in, metadata, raw data of a segment.
"""

from __future__ import annotations

import struct
from collections import defaultdict
from dataclasses import dataclass, field, replace
from typing import IO, Any

import numpy as np

LEAD_IN = 28
"""Bytes before a segment's metadata [B]. Source: the same."""
METADATA, NEW_LIST, BIG_ENDIAN, DAQMX = 1 << 1, 1 << 2, 1 << 6, 1 << 7
"""Bits that say what a segment has. Source: the same."""
UNKNOWN = 0xFFFFFFFFFFFFFFFF
"""Length of a segment that was being written when the file was last open. Source: the same."""
NONE, SAME, SCALERS = 0xFFFFFFFF, 0, (0x69120000, 0x69130000)
"""Lengths of an object's raw data index that stand for none, the one before, and those of DAQmx. Source: the same."""
SIZES = {1: 1, 2: 2, 3: 4, 4: 8, 5: 1, 6: 2, 7: 4, 8: 8, 9: 4, 10: 8, 0x19: 4, 0x1A: 8, 0x21: 1, 0x44: 16,
         0x08000C: 8, 0x10000D: 16}  # fmt: skip
"""Bytes of a value by its type [B]. Source: the same."""
STRING, INSTANT, DOUBLE = 0x20, 0x44, 10
"""Types of values. Source: the same."""
BEFORE_1970 = 2082844800
"""Seconds from the beginning of 1904, where instants count from, to that of 1970 [s].
Source: 66 years, 17 of them leap years."""


@dataclass(frozen=True)
class Waveform:
    """From reading ``index`` on: when it began (None: not stated), the step [s] (None: no waveform), an offset [s]."""

    index: int
    start: Any
    step: float | None
    offset: float = 0.0


@dataclass
class _Walk:
    """What has been met on the way through the segments."""

    counts: dict[str, int] = field(default_factory=lambda: defaultdict(int))
    chunk: dict[str, tuple[int, int]] = field(default_factory=dict)
    """Channels of the segment at hand: readings and bytes in a chunk."""
    active: list[str] = field(default_factory=list)
    stated: dict[str, dict[str, Any]] = field(default_factory=lambda: defaultdict(dict))
    found: dict[str, list[Waveform]] = field(default_factory=lambda: defaultdict(list))
    is_cut: bool = False
    """Whether the last segment is not whole."""


def waveforms(file: IO[bytes]) -> tuple[dict[str, list[Waveform]], bool]:
    """By channel path its waveforms, in order, empty where the segments cannot be followed (DAQmx, damage); and whether
    the file was interrupted.
    """
    walk, size = _Walk(), file.seek(0, 2)
    place = 0
    try:
        while place + LEAD_IN <= size:
            place = _segment(file, place, size, walk)
    except _Unfollowed:
        return {}, False
    except (struct.error, KeyError, OverflowError, ValueError):
        return {}, True
    return dict(walk.found), walk.is_cut


class _Unfollowed(Exception):
    """A segment is not of the kind that is followed here."""


def _segment(file: IO[bytes], place: int, size: int, walk: _Walk) -> int:
    """Takes in one segment; returns the place of the next."""
    file.seek(place)
    tag, toc, _, length, raw = struct.unpack("<4sIIQQ", file.read(LEAD_IN))
    if tag != b"TDSm" or toc & (BIG_ENDIAN | DAQMX):
        raise _Unfollowed
    end = size if length == UNKNOWN else place + LEAD_IN + length
    walk.is_cut |= length == UNKNOWN or end > size
    anew: set[str] = set()
    if toc & METADATA:
        if toc & NEW_LIST:
            walk.active = []
        anew = _metadata(_Bytes(file.read(raw)), walk)
    for path in anew:
        about = walk.stated[path]
        one = Waveform(
            walk.counts[path], about.get("wf_start_time"), about.get("wf_increment"), about.get("wf_start_offset", 0.0)
        )
        before = walk.found[path][-1] if walk.found[path] else None
        if before is None or replace(before, index=one.index) != one:
            walk.found[path].append(one)
    bytes_of_chunk = sum(walk.chunk[path][1] for path in walk.active)
    chunks = (min(end, size) - place - LEAD_IN - raw) // bytes_of_chunk if bytes_of_chunk else 0
    for path in walk.active:
        walk.counts[path] += chunks * walk.chunk[path][0]
    return end


@dataclass
class _Bytes:
    """Metadata as it is read."""

    data: bytes
    at: int = 0

    def number(self) -> int:
        return int(self.take("<I"))

    def take(self, form: str) -> Any:
        value = struct.unpack_from(form, self.data, self.at)[0]
        self.at += struct.calcsize(form)
        return value

    def text(self) -> str:
        length = self.number()
        self.at += length
        return self.data[self.at - length : self.at].decode()

    def value(self) -> Any:
        kind = self.number()
        if kind == STRING:
            return self.text()
        if kind == INSTANT:
            fraction, seconds = struct.unpack_from("<Qq", self.data, self.at)
            self.at += 16
            micro = round(fraction / 2**64 * 1e6)
            return np.datetime64((seconds - BEFORE_1970) * 1_000_000 + micro, "us")
        if kind not in SIZES:
            raise _Unfollowed
        if kind == DOUBLE:
            return self.take("<d")
        self.at += SIZES[kind]
        return None


def _metadata(data: _Bytes, walk: _Walk) -> set[str]:
    """Takes in the objects of a segment; the paths of those that state when they began."""
    anew = set()
    for _ in range(data.number()):
        path, length = data.text(), data.number()
        if length in SCALERS:
            raise _Unfollowed
        if length not in (NONE, SAME):
            kind, _, count = data.number(), data.number(), data.take("<Q")
            size = data.take("<Q") if kind == STRING else SIZES.get(kind, 0) * count
            walk.chunk[path] = (count, size)
        if length != NONE and path not in walk.active:
            walk.active.append(path)
        about = {}
        for _ in range(data.number()):
            name = data.text()
            about[name] = data.value()
        walk.stated[path].update(about)
        if "wf_start_time" in about or "wf_increment" in about:
            anew.add(path)
    return anew
