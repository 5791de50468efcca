"""diagnosis.h5: sources over time with their bands, and the residuals without and with them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.diagnose.localise import Localisation
from hfanalysis.diagnose.of_test import raw_residuals

Array = NDArray[np.float64]


def write_histories(path: Path, found: Localisation, provenance: Mapping[str, Any]) -> None:
    """Groups ``sources/SITE`` {time, mean, std} and ``residuals/CHANNEL`` {time, before, after, noise_std}."""
    import h5py

    before, after = (raw_residuals(f, found.observed) for f in (found.base, found.final))
    with h5py.File(path, "w", libver="latest") as file:
        file.attrs["provenance"] = json.dumps(provenance, sort_keys=True)
        for source in found.sources:
            group = file.create_group(f"sources/{source.site.name}")
            group.attrs["equation"] = source.site.equation
            _write(group, source.site.unit, time=source.time, mean=source.mean, std=source.std)
        for channel in found.observed.channels:
            unit = "N" if channel.name == "thrust" else "Pa"
            columns = {"before": before[channel.name], "after": after[channel.name], "noise_std": channel.noise_std}
            _write(file.create_group(f"residuals/{channel.name}"), unit, time=channel.time, **columns)


def _write(group: Any, unit: str, **columns: Array) -> None:
    for name, values in columns.items():
        data = group.create_dataset(name, data=values, track_times=False)
        data.attrs["units"] = "s" if name == "time" else unit
