"""diagnosis.h5: sources over time with their bands, and the residuals without and with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.diagnose.diagnosis import Diagnosed
from hfanalysis.inference.gap import residuals_of
from hfanalysis.record.channels import LONG_NAMES, unit_of

TITLE = "what the model lacks: sources over time, and residuals without and with them"

SOURCE = {"mean": "mean", "low90": "lower end of its 90 % band", "high90": "upper end of its 90 % band"}
"""Of a source, in words."""

RESIDUAL = {
    "measured": "measured",
    "before": "measured minus the model without what was found",
    "after": "measured minus the model with what was found",
    "noise_std": "standard deviation of a sample's noise",
}
"""Of a channel, in words."""


def write_histories(path: Path, found: Diagnosed, provenance: Mapping[str, Any]) -> None:
    """Groups ``sources/SITE`` {time [s after the opening], mean, low90, high90 [the source's unit]},
    ``residuals/CHANNEL`` {time [s], measured, before, after, noise_std [SI]}; all (n,).

    A second source at a site is ``sources/SITE 2``.
    """
    from hfanalysis.products import netcdf

    observed = found.naming.bench.observed
    before, after = (residuals_of(f, observed) for f in (found.naming.base.fit, found.verdict.chosen.fit))
    with netcdf.product(path, TITLE, provenance) as file:
        rows = found.product.localisation
        for name, row in zip(numbered([row.site for row in rows]), rows, strict=True):
            group = file.create_group(f"sources/{name}")
            group.attrs["equation"] = row.equation
            history = row.history
            assert history is not None
            columns = {key: np.array(getattr(history, key)) for key in ("time", "mean", "low90", "high90")}
            _write(group, history.unit, row.equation, SOURCE, **columns)
        for channel in observed.channels:
            burning = ~channel.resting
            columns = {
                "time": channel.time[burning],
                "measured": channel.value[burning],
                "before": before[channel.name][burning],
                "after": after[channel.name][burning],
                "noise_std": channel.noise_std[burning],
            }
            group, name = file.create_group(f"residuals/{channel.name}"), LONG_NAMES.get(channel.name, channel.name)
            _write(group, unit_of(channel.name), name, RESIDUAL, **columns)


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
    from hfanalysis.products import netcdf

    with netcdf.product(path, TITLE, provenance):
        pass


def _write(group: Any, unit: str, of: str, words: Mapping[str, str], **columns: Array) -> None:
    from hfanalysis.products import netcdf

    about = {name: (unit, f"{of.replace('_', ' ')}: {said}") for name, said in words.items()}
    netcdf.table(group, columns, {"time": netcdf.TIME} | about)
