"""Charts of a flight on its own clock: up, down, and the static margin in winds; of a test's or an engine's rocket."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from hfanalysis.arrays import Array
from hfanalysis.charts.chart import Chart, Series, around
from hfanalysis.charts.colors import STYLES
from hfanalysis.charts.svg import Event
from hfanalysis.products.flight import Stability
from hfanalysis.report import html

CURVES = {"height": ("Height above ground", "m"), "speed": ("Speed", "m/s"), "acceleration": ("Acceleration", "m/s^2")}

WAYS_DOWN = {
    "drogue": ("under the drogue", "p_purge"),
    "main": ("under the main", "p_fill"),
    "ballistic": ("without parachutes", "p_chamber"),
}
"""Groups of flight.h5 after the apogee, what they are called, and their colors."""
_TIME = "time of flight [s]"

EVEN = 4001
"""Times of a line. Source: by choice: 6 ms of an ascent of 25 s."""

Columns = Mapping[str, Array]
"""Of one group of flight.h5, (n,) each, by name."""


@dataclass(frozen=True)
class FlightCurves:
    """The groups of flight.h5 by name; the speed at the rail's end [m/s] and the burn time [s], where they are known;
    least speed at the rail's end [m/s], where it is to be drawn."""

    groups: Mapping[str, Columns]
    departure: float | None
    burn: float | None
    least: float | None = None

    def curve(self, name: str) -> Chart | None:
        """One of CURVES over the flight: with its band and the ways down, where they are there."""
        title, unit = CURVES[name]
        ascent, bands = self.groups.get("ascent", {}), self.groups.get("bands", {})
        if name not in ascent:
            return None
        time = ascent["time"]
        series = [Series("ascent", "p_tank", *_evenly(ascent, name))]
        if f"{name}_low" in bands:
            low, high = (bands[f"{name}_{side}"] for side in ("low", "high"))
            series.insert(0, Series("95 % of the flights", "p_tank", bands["time"], low, "band", high))
        ways_down = list(self._down(name))
        caption: str | Markup = ""
        if name == "speed" and self.least is not None:
            series.append(Series("least at the rail's end", "zero", time[[0, -1]], np.full(2, self.least), "level"))
            caption = Markup("Dashed: the {} that a rocket should have when it leaves the rail.")
            caption = caption.format(html.amount(self.least, "m/s"))
        span = around([line.time for line in (*series[:2], *ways_down)])
        return self.chart(f"flight-{name}", (title, name, unit), [*series, *ways_down], span, caption)

    def line(self, column: str, title: str, quantity: str, unit: str) -> Chart | None:
        """One column over the way up."""
        ascent = self.groups.get("ascent", {})
        if column not in ascent:
            return None
        series = [Series("ascent", "p_tank", *_evenly(ascent, column))]
        return self.chart(f"flight-{column}", (title, quantity, unit), series, around([ascent["time"]]))

    def _down(self, name: str) -> Iterator[Series]:
        """The ways down beside the way up: under the parachutes, and without them."""
        for group, (label, style) in WAYS_DOWN.items():
            table = self.groups.get(group, {})
            if name in table:
                yield Series(label, style, *_evenly(table, name), dashed=group == "ballistic")

    def chart(
        self,
        key: str,
        about: tuple[str, str, str],
        series: Iterable[Series],
        span: tuple[float, float],
        caption: str | Markup = "",
        value_span: tuple[float, float] | None = None,
        height: float = 240.0,
    ) -> Chart:
        """A chart on the flight's clock; ``about`` it: title, quantity, unit."""
        title, quantity, unit = about
        return Chart(
            key,
            title,
            quantity,
            unit,
            tuple(series),
            span,
            Markup.escape(caption),
            events=tuple(self._events()),
            x_label=_TIME,
            height=height,
            value_span=value_span,
            clock="flight",
        )

    def _events(self) -> Iterator[Event]:
        """The end of the rail, where the flight is as fast as it leaves it, and of the burn."""
        ascent = self.groups.get("ascent", {})
        if self.departure is not None and "speed" in ascent:
            fast = np.flatnonzero(ascent["speed"] >= self.departure)
            if fast.size:
                yield Event(float(ascent["time"][fast[0]]), 0.0, "off the rail")
        if self.burn is not None:
            yield Event(self.burn, 0.0, "burn out")

    def margin(self, said: Stability) -> Chart | None:
        """The static margin in every wind: mean and two standard deviations over gusts, beside its limits."""
        winds = [(wind.wind, self.groups.get(f"stability/{i}", {})) for i, wind in enumerate(said.winds)]
        if not winds or said.limits is None or not all("margin_mean" in table for _, table in winds):
            return None
        low, high = said.limits
        drawn = [_in_wind(wind, table, STYLES[i % len(STYLES)]) for i, (wind, table) in enumerate(winds)]
        bands, lines = [band for band, _ in drawn], [line for _, line in drawn]
        times = [line.time for line in lines]
        ends = np.array([min(float(time[0]) for time in times), max(float(time[-1]) for time in times)])
        limits = [Series(f"limit {limit:g}", "zero", ends, np.full(2, limit), "level") for limit in (low, high)]
        seen = [value for band in bands for value in (np.nanmin(band.values), np.nanmax(_upper(band)))]
        span = (min(0.0, *seen), 1.05 * max(high, *seen))
        speeds = Markup(", ").join(html.amount(wind, "m/s", 2) for wind, _ in winds)
        caption = Markup(
            "From the end of the rail until the rocket is as slow again. Lines: mean over flights in gusts of {:.0f} % "
            "in head winds of {}; bands: two standard deviations. Dashed: the limits of {:g} and {:g} calibers; below, "
            "a gust may turn the rocket over, above, it turns far into the wind."
        ).format(100.0 * said.gust_intensity, speeds, low, high)
        about = ("Static margin in wind", "margin", "calibers")
        return self.chart("flight-margin", about, [*bands, *lines, *limits], around(times), caption, span, 320.0)


def _evenly(table: Columns, name: str) -> tuple[Array, Array]:
    """A column and its times [s] at even distance: a line of the model is whole, however its solver stepped."""
    time = table["time"]
    clock = np.linspace(float(time[0]), float(time[-1]), EVEN)
    return clock, np.interp(clock, time, table[name])


def _upper(band: Series) -> Array:
    return band.values if band.upper is None else band.upper


def _in_wind(wind: float, table: Columns, style: str) -> tuple[Series, Series]:
    """Band and line of one wind [m/s]."""
    time, mean, std = (table[name] for name in ("time", "margin_mean", "margin_std"))
    name = f"wind {wind:.1f} m/s"
    return (
        Series(f"{name}: two std", style, time, mean - 2.0 * std, "band", mean + 2.0 * std),
        Series(name, style, time, mean),
    )


_GEOMETRY = Markup(
    " Add it to {} with <code>nose, body, fins, structure, tank_position, chamber_position</code>. Tank and grain need "
    "their sizes, too."
)


def without_margin(stability: Stability, file: str) -> Markup | None:
    """Why no margin is drawn, and what to add to the ``file``."""
    reason = stability.margin_at_rail_departure.reason
    if not reason:
        return None
    stated = Markup(" State it in {}.").format(file) if "not given" in reason else Markup()
    add = _GEOMETRY.format(file) if "[rocket.geometry]" in reason else stated
    return html.paragraph(html.switchable(f"No static margin is drawn: {reason}.") + add)
