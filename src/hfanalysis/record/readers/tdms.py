"""National Instruments' .tdms: channels by ``GROUP.CHANNEL``, on the clock of their waveform where they have one."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.table import LogSeries, Table

_UNITS = ("unit_string", "NI_UnitDescription", "Unit")
"""Properties in which a channel's unit is stated."""


def open_source(path: Path, spec: FileSpec) -> Table:
    """The file's channels of numbers and of instants; raises :class:`InputError` where it cannot be read."""
    from nptdms import TdmsFile

    try:
        with path.open("rb") as file:  # by its name the library would take up a .tdms_index beside it, of any content
            channels = [channel for group in TdmsFile.read(file).groups() for channel in group.channels()]
        found = list(_series(channels))
    except Exception as error:  # damaged files fail in every way that there is
        raise InputError(f"{path}: cannot be read as a TDMS file: {error or type(error).__name__}") from None
    return Table(path, found)


def _series(channels: list[Any]) -> Iterator[LogSeries]:
    starts = [start for channel in channels if (start := channel.properties.get("wf_start_time")) is not None]
    for channel in channels:
        numbers = channel[:]
        name = f"{channel.group_name}.{channel.name}"
        if numbers.dtype.kind == "M" and len(numbers):
            yield LogSeries(name, (numbers - numbers[0].astype("M8[D]")) / np.timedelta64(1, "s"), "s")
        elif numbers.dtype.kind in "fiub" and len(numbers):
            yield LogSeries(name, numbers.astype(np.float64), _unit(channel), _time(channel, min(starts, default=None)))


def _unit(channel: Any) -> str:
    return next((str(unit) for key in _UNITS if (unit := channel.properties.get(key))), "")


def _time(channel: Any, first: Any) -> Array | None:
    """Seconds since the first waveform of the file began; None where the channel is no waveform."""
    step = channel.properties.get("wf_increment")
    if not step:
        return None
    start = channel.properties.get("wf_start_time")
    late = 0.0 if start is None or first is None else float((start - first) / np.timedelta64(1, "s"))
    time: Array = late + channel.properties.get("wf_start_offset", 0.0) + step * np.arange(len(channel))
    return time
