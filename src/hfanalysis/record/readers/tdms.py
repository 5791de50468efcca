"""National Instruments' .tdms: channels by ``GROUP.CHANNEL``, on the clock of their waveform where they have one."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.logspec import FileSpec
from hfanalysis.record.readers.series import seconds_of, series
from hfanalysis.record.readers.table import LogSeries, Table
from hfanalysis.record.readers.tdms_segments import Waveform, waveforms

_UNITS = ("unit_string", "NI_UnitDescription", "Unit")
"""Properties in which a channel's unit is stated."""


def open_source(path: Path, spec: FileSpec) -> Table:
    """The file's channels of numbers and of instants; raises :class:`InputError` where it cannot be read."""
    from nptdms import TdmsFile

    logging.getLogger("nptdms").setLevel(logging.ERROR)  # what is cut is told below
    try:
        with path.open("rb") as file:  # by its name the library would take up a .tdms_index beside it, of any content
            channels = [channel for group in TdmsFile.read(file).groups() for channel in group.channels()]
            file.seek(0)
            resumed, is_cut = waveforms(file)
        found = list(_series(channels, resumed))
    except Exception as error:  # damaged files fail in every way that there is
        raise InputError(f"{path}: cannot be read as a TDMS file: {error or type(error).__name__}") from None
    cut = f"{path.name}: its last part is not whole (the recording was interrupted)"
    return Table(path, found, [cut] if is_cut else [])


def _series(channels: list[Any], resumed: dict[str, list[Waveform]]) -> Iterator[LogSeries]:
    clocks = {channel.path: resumed.get(channel.path) or _as_stated(channel) for channel in channels}
    starts = [one.start for clock in clocks.values() for one in clock if one.start is not None and one.step]
    first = min(starts, default=None)
    epoch = None if first is None else float((first - np.datetime64(0, "s")) / np.timedelta64(1, "us")) * 1e-6
    for channel in channels:
        numbers, name = channel[:], f"{channel.group_name}.{channel.name}"
        if numbers.dtype.kind == "M" and len(numbers):
            seconds, midnight = seconds_of(numbers)
            yield LogSeries(name, seconds, "s", epoch=midnight, written=True)
        elif numbers.dtype.kind in "fiub" and len(numbers):
            time = _time(clocks[channel.path], len(numbers), first)
            absolute = time is not None and clocks[channel.path][0].start is not None
            yield LogSeries(name, numbers.astype(np.float64), _unit(channel), time, epoch if absolute else None)
        elif numbers.dtype.kind in "OUS" and len(numbers) > 1:
            found = series(name, [str(one) for one in numbers])
            yield from [found] if found is not None else []


def _unit(channel: Any) -> str:
    return next((str(unit) for key in _UNITS if (unit := channel.properties.get(key))), "")


def _as_stated(channel: Any) -> list[Waveform]:
    """The waveform by the channel's properties, which are those of the file's last segment."""
    about = channel.properties
    return [Waveform(0, about.get("wf_start_time"), about.get("wf_increment"), about.get("wf_start_offset", 0.0))]


def _time(pieces: list[Waveform], count: int, first: Any) -> Array | None:
    """Seconds since the first waveform of the file began; None where the channel is no waveform."""
    if not all(one.step for one in pieces):
        return None
    time = np.empty(count)
    for one, end in zip(pieces, [*(later.index for later in pieces[1:]), count], strict=True):
        known = one.start is not None and first is not None
        late = float((one.start - first) / np.timedelta64(1, "ns")) * 1e-9 if known else 0.0
        assert one.step is not None
        time[one.index : end] = late + one.offset + one.step * np.arange(max(end - one.index, 0))
    return time
