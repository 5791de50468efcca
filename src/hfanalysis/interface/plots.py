"""Figures of a firing for notebooks, in the units of a test stand."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from hfanalysis.errors import AbsentError
from hfanalysis.wording.scales import scale

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hfanalysis.arrays import Array
    from hfanalysis.interface.firing import Firing

PRESSURES = ("p_tank", "p_run", "p_chamber", "p_purge")
"""Channels that are drawn together."""


class Plots:
    """What can be drawn of a firing; each method returns a figure of matplotlib."""

    def __init__(self, firing: Firing) -> None:
        self._firing = firing

    def pressures(self) -> Figure:
        """Tank, run line, chamber and purge pressure [bar], with the phases; raises AbsentError without any."""
        return self._channels([name for name in PRESSURES if name in self._firing.log], "pressure")

    def thrust(self) -> Figure:
        """The thrust [N] as logged, its zero taken off; raises AbsentError without it."""
        return self._channels([name for name in ("thrust",) if name in self._firing.log], "thrust")

    def residuals(self, mode: str = "full") -> Figure:
        """Measured and model of every channel in a mode of the validation, one above the other."""
        tree = self._firing.residuals
        if mode not in tree.children:
            raise AbsentError(f"{self._firing.name}: no model ran as {mode!r}; there is {', '.join(tree.children)}")
        nodes = tree.children[mode].children
        figure = _figure(2.2 * len(nodes) + 0.8)
        for i, (name, node) in enumerate(nodes.items(), 1):
            axes = figure.add_subplot(len(nodes), 1, i)
            _compared(axes, str(name), node.to_dataset())
        axes.set_xlabel("time after the valve opening [s]")
        return figure

    def _channels(self, names: list[str], what: str) -> Figure:
        if not names:
            raise AbsentError(f"{self._firing.name}: the log has no {what}")
        log, origin = self._firing.log, self._firing.segments.t_open.value or 0.0
        figure = _figure(3.6)
        axes = figure.add_subplot()
        for name in names:
            self._line(axes, log[name], log[f"{name}_flags"], origin)
        self._phases(axes)
        axes.set_xlabel("time after the valve opening [s]")
        axes.set_ylabel(f"{what} [{scale(str(log[names[0]].attrs['units'])).unit}]")
        axes.legend(loc="upper right")
        axes.set_title(self._firing.name + self._generated(), loc="left", pad=42.0)
        return figure

    def _line(self, axes: Axes, channel: xr.DataArray, flags: xr.DataArray, origin: float) -> None:
        unit = scale(str(channel.attrs["units"]))
        time = channel[str(channel.dims[0])].to_numpy() - origin
        values: Array = np.where(flags.to_numpy() == 0, channel.to_numpy(), np.nan)
        axes.plot(time, unit.factor * values, label=str(channel.attrs["long_name"]), linewidth=1.0)

    def _phases(self, axes: Axes) -> None:
        """A line at each event, its name above; the view is the firing's, with a second on either side."""
        names: dict[float, list[str]] = {}
        for name, event in self._firing.segments.events.items():
            if event.value is not None:
                names.setdefault(round(event.value, 1), []).append(name)
        for at, together in names.items():
            axes.axvline(at, color="0.6", linewidth=0.8, zorder=0)
            place: dict[str, Any] = {"xycoords": ("data", "axes fraction"), "rotation": 35, "fontsize": 8}
            axes.annotate(", ".join(together), (at, 1.01), **place)
        axes.set_xlim(-1.0, max(names, default=10.0) + 1.0)

    def _generated(self) -> str:
        source = self._firing.definition.test.source
        return "" if source == "measured" else f" ({source}: generated, not measured)"


def _figure(height: float) -> Figure:
    from matplotlib.figure import Figure

    class Shown(Figure):
        """A figure that a notebook shows without being told to."""

        def _repr_png_(self) -> bytes:
            self.savefig(out := BytesIO(), format="png", dpi=100)
            return out.getvalue()

    return Shown(figsize=(8.0, height), layout="constrained")


def _compared(axes: Axes, name: str, data: xr.Dataset) -> None:
    unit = scale(str(data["measured"].attrs["units"]))
    for what, width in (("measured", 0.8), ("model", 1.4)):
        axes.plot(data["time"], unit.factor * data[what], linewidth=width, label=what)
    axes.set_ylabel(f"{name} [{unit.unit}]")
    axes.legend(loc="upper right")
