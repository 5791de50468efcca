"""ingest.h5: one variable per channel on its clock, readable by h5py and xarray, byte-identical from run to run."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis import sentences
from hfanalysis.products import netcdf
from hfanalysis.products.hdf5 import created
from hfanalysis.record.log import Channel, Flag

_FLAGS = {
    "flag_masks": np.array([int(flag) for flag in Flag], dtype=np.uint8),
    "flag_meanings": " ".join(flag.name.lower() for flag in Flag if flag.name),
}


class Store:
    """Writes channels one at a time, so that only one is in memory."""

    def __init__(self, path: Path) -> None:
        self._opened = created(path, **netcdf.LAYOUT)
        self._file = self._opened.__enter__()
        self._names: list[str] = []

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._opened.__exit__(kind, error, at)

    def clock(self, name: str, time: NDArray[np.float64]) -> None:
        """A dimension: the stamps (n,) [s, log time] of the channels on it."""
        netcdf.axis(self._file, name, time, ("s", "log time"))

    def channel(self, channel: Channel, clock: str, long_name: str) -> None:
        """A channel with its flags, and its values before zero and tare where either was applied."""
        name, unit, about = channel.name, channel.unit, _attributes(channel, clock)
        netcdf.variable(self._file, name, channel.values, (unit, long_name), clock, **about)
        quality = ("1", f"{long_name}: quality")
        netcdf.variable(self._file, f"{name}_flags", channel.flags, quality, clock, **_FLAGS)
        if channel.raw is not None:
            before = (unit, f"{long_name} before zero and tare")
            netcdf.variable(self._file, f"{name}_raw", channel.raw, before, clock)
        self._names.append(channel.name)

    def about(self, warnings: Sequence[str], provenance: Mapping[str, Any]) -> None:
        """What holds for the whole log."""
        self._file.attrs["channels"] = json.dumps(self._names)
        self._file.attrs["warnings"] = json.dumps(list(warnings))
        if quoted := sentences.quoted_in(warnings):
            self._file.attrs["quoted"] = json.dumps(sentences.to_json(quoted))
        netcdf.describe(self._file, "the log on canonical channels", provenance)


def _attributes(channel: Channel, clock: str) -> dict[str, Any]:
    about = {
        "clock": clock,
        "label": channel.label,
        "accuracy": channel.accuracy,
        "accuracy_stated": int(channel.accuracy_stated),
        "zero": channel.zero,
        "drift": channel.drift,
        "history": json.dumps(channel.history),
    }
    return about | ({} if channel.zero_std is None else {"zero_std": channel.zero_std})
