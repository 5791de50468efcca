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
from hfanalysis.products.hdf5 import created
from hfanalysis.record.log import Channel, Flag

_FLAG_MEANINGS = " ".join(flag.name.lower() for flag in Flag if flag.name)
_FLAG_MASKS = np.array([int(flag) for flag in Flag], dtype=np.uint8)


class Store:
    """Writes channels one at a time, so that only one is in memory."""

    def __init__(self, path: Path) -> None:
        self._opened = created(path, track_order=False)
        self._file = self._opened.__enter__()
        self._names: list[str] = []

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._opened.__exit__(kind, error, at)

    def clock(self, name: str, time: NDArray[np.float64]) -> None:
        """A dimension: the stamps (n,) [s, log time] of the channels on it."""
        data = self._dataset(name, time)
        data.attrs["units"] = "s"
        data.attrs["long_name"] = "log time"
        data.make_scale(name)

    def channel(self, channel: Channel, clock: str, long_name: str) -> None:
        """A channel with its flags, and its values before zero and tare where either was applied."""
        data = self._variable(channel.name, channel.values, clock, channel.unit, long_name)
        data.attrs.update(_attributes(channel, clock))
        flags = self._variable(f"{channel.name}_flags", channel.flags, clock, "1", f"{long_name}: quality")
        flags.attrs["flag_masks"] = _FLAG_MASKS
        flags.attrs["flag_meanings"] = _FLAG_MEANINGS
        if channel.raw is not None:
            self._variable(f"{channel.name}_raw", channel.raw, clock, channel.unit, f"{long_name} before zero and tare")
        self._names.append(channel.name)

    def about(self, warnings: Sequence[str], provenance: Mapping[str, Any]) -> None:
        """What holds for the whole log."""
        self._file.attrs["channels"] = json.dumps(self._names)
        self._file.attrs["warnings"] = json.dumps(list(warnings))
        if quoted := sentences.quoted_in(warnings):
            self._file.attrs["quoted"] = json.dumps(sentences.to_json(quoted))
        self._file.attrs["provenance"] = json.dumps(provenance, sort_keys=True)

    def _dataset(self, name: str, data: NDArray[Any]) -> Any:
        if data.dtype != np.uint8 or not len(data):
            return self._file.create_dataset(name, data=data, track_times=False)
        packed = {"compression": "gzip", "compression_opts": 1, "track_times": False}
        if data.any():
            return self._file.create_dataset(name, data=data, **packed)
        # a channel without a flag needs no bytes: HDF5 gives the fill value, zero
        return self._file.create_dataset(name, data.shape, data.dtype, fillvalue=0, **packed)

    def _variable(self, name: str, data: NDArray[Any], clock: str, unit: str, long_name: str) -> Any:
        made = self._dataset(name, data)
        made.dims[0].attach_scale(self._file[clock])
        made.attrs["units"] = unit
        made.attrs["long_name"] = long_name
        return made


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
