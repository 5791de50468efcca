"""diagnosis.h5: sources over time with their bands, and the residuals without and with them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.diagnosis import Diagnosed
from hfanalysis.inference.gap import residuals_of
from hfanalysis.record.channels import unit_of


def write_histories(path: Path, found: Diagnosed, provenance: Mapping[str, Any]) -> None:
    """Groups ``sources/SITE`` {time [s after the opening], mean, low90, high90 [the source's unit]},
    ``residuals/CHANNEL`` {time [s], measured, before, after, noise_std [SI]}; all (n,).

    A second source at a site is ``sources/SITE 2``.
    """
    from hfanalysis.products.hdf5 import created

    observed = found.naming.bench.observed
    before, after = (residuals_of(f, observed) for f in (found.naming.base.fit, found.verdict.chosen.fit))
    with created(path, libver="latest") as file:
        file.attrs["provenance"] = json.dumps(provenance, sort_keys=True)
        rows = found.product.localisation
        for name, row in zip(numbered([row.site for row in rows]), rows, strict=True):
            group = file.create_group(f"sources/{name}")
            group.attrs["equation"] = row.equation
            history = row.history
            assert history is not None
            columns = {key: np.array(getattr(history, key)) for key in ("time", "mean", "low90", "high90")}
            _write(group, history.unit, **columns)
        for channel in observed.channels:
            burning = ~channel.resting
            columns = {
                "time": channel.time[burning],
                "measured": channel.value[burning],
                "before": before[channel.name][burning],
                "after": after[channel.name][burning],
                "noise_std": channel.noise_std[burning],
            }
            _write(file.create_group(f"residuals/{channel.name}"), unit_of(channel.name), **columns)


def numbered(names: Sequence[str]) -> list[str]:
    """The names, each different: an effect and an unknown source beside it may have the same.

    >>> numbered(["tank_heat", "valve", "tank_heat"])
    ['tank_heat', 'valve', 'tank_heat 2']
    """
    return [
        name if (nth := names[: place + 1].count(name)) == 1 else f"{name} {nth}" for place, name in enumerate(names)
    ]


def write_empty(path: Path, provenance: Mapping[str, Any]) -> None:
    """The file of a test for which no model could be run."""
    from hfanalysis.products.hdf5 import created

    with created(path, libver="latest") as file:
        file.attrs["provenance"] = json.dumps(provenance, sort_keys=True)


def _write(group: Any, unit: str, **columns: Array) -> None:
    for name, values in columns.items():
        data = group.create_dataset(name, data=values, track_times=False)
        data.attrs["units"] = "s" if name == "time" else unit
