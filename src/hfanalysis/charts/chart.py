"""A chart as data: series over time in SI. How it is drawn, sent to the page and written to files is elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from markupsafe import Markup

from hfanalysis.arrays import Array
from hfanalysis.charts.envelope import Envelope, envelope
from hfanalysis.charts.svg import Event, Phase
from hfanalysis.wording.scales import Scale, scale

TIME = "time after the valve opens [s]"
LOG_TIME = "log time [s]"


@dataclass(frozen=True)
class Series:
    """One line over time, in the SI unit of its chart.

    ``style`` names its color and ``label`` what people read; ``kind`` is "line", "band" (``values`` and ``upper`` are
    its edges) or "level" (a constant, drawn across the whole chart).
    """

    label: str
    style: str
    time: Array
    values: Array
    kind: str = "line"
    upper: Array | None = None
    dashed: bool = False
    faint: bool = False
    """Drawn thin, and no part of what sets the value axis: what a sensor reads that nobody believes."""

    @property
    def css(self) -> str:
        """The classes that draw it."""
        return " ".join([self.style, *["dashed"] * self.dashed, *["faint"] * self.faint])

    def reduced(self, start: float, end: float, bins: int) -> Envelope:
        """The line from ``start`` to ``end`` [s] with at most ``bins`` points, in the chart's unit [SI]."""
        return envelope(self.time, self.values, start, end, bins)

    @property
    def finite(self) -> bool:
        """Whether there is anything to draw."""
        return bool(np.isfinite(self.values).any())


@dataclass(frozen=True)
class Chart:
    """Series over one time axis with what people need to read them."""

    key: str
    title: str
    quantity: str
    unit: str
    series: tuple[Series, ...]
    span: tuple[float, float]
    caption: str | Markup = ""
    phases: tuple[Phase, ...] = ()
    events: tuple[Event, ...] = ()
    x_label: str = TIME
    height: float = 300.0
    with_zero: bool = True
    value_span: tuple[float, float] | None = None
    """Of the value axis [SI], where the data themselves should not set it."""
    clock: str = "test"
    """Charts of one clock are zoomed together."""
    weight: float = 1.0
    """The share of a page's detail that its lines ask for, beside the others."""
    repeats: bool = False
    """Whether another chart of the page shows its lines as well, so that files and comparisons go without it."""
    difference: bool = False
    """Whether the values are differences, which the zero point of a unit does not concern."""

    def scale(self, system: str = "si") -> Scale:
        """How its values are shown in a system of units."""
        found = scale(self.unit, system)
        return replace(found, zero=0.0) if self.difference else found

    @property
    def lines(self) -> list[Series]:
        """The series that are lines."""
        return [series for series in self.series if series.kind == "line"]


def around(times: Sequence[Array]) -> tuple[float, float]:
    """A little more than the stretch [s] that the times, each (n,) [s], cover.

    >>> around([np.array([0.0, 10.0])])
    (-0.4, 10.4)
    """
    first = min(float(time[0]) for time in times if time.size)
    last = max(float(time[-1]) for time in times if time.size)
    air = 0.04 * (last - first) or 0.5
    return first - air, last + air
