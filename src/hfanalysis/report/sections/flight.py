"""The rocket's flight on the measured thrust, and its static margin in winds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from markupsafe import Markup

from hfanalysis.charts.chart import Chart, Series, around
from hfanalysis.charts.colors import STYLES
from hfanalysis.charts.svg import Event
from hfanalysis.products.flight import Check, Flight, Stability
from hfanalysis.quantity import Quantity
from hfanalysis.report import html
from hfanalysis.report.material import Material, Table
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import in_words, ordered

_CURVES = {"height": ("Height above ground", "m"), "speed": ("Speed", "m/s"), "acceleration": ("Acceleration", "m/s^2")}
_WAYS_DOWN = (
    ("drogue", "under the drogue", "p_purge"),
    ("main", "under the main", "p_fill"),
    ("ballistic", "without parachutes", "p_chamber"),
)
"""Groups of flight.h5 after the apogee, what they are called, and their colors."""
_SIGNS = {"passed": "good", "failed": "bad"}
_TIME = "time of flight [s]"

_GEOMETRY = Markup(
    " Add it to test.toml with <code>nose, body, fins, structure, tank_position, chamber_position</code>. Tank and "
    "grain need their sizes, too."
)


def render(material: Material) -> Iterator[Block]:
    """The numbers with their bands, the checks, the way up, and the margin."""
    product = material.need(Flight)
    caption = html.switchable(
        f"Thrust {product.thrust_basis}, {product.thrust}. One standard deviation and 95 % interval from flights that "
        f"differ in what is uncertain. That is {product.band_covers}."
    )
    columns = ("quantity", ">value", ">95 % interval", "remark")
    found = ordered(product.flown) | ordered(product.stability.quantities)
    yield html.table("Flight", caption, columns, (_row(*item, material) for item in found.items()))
    yield html.bullets((_check(*item) for item in product.checks.items()), "plain")
    for name, (title, unit) in _CURVES.items():
        yield _curve(material, name, title, unit)
    yield _margin(material) or _without_margin(product.stability)
    for note in product.notes:
        yield html.paragraph(html.switchable(note))


def _row(name: str, quantity: Quantity, material: Material) -> tuple[Any, ...]:
    remark = html.judged(quantity, material.reasons)
    return in_words(name), html.value(quantity, name), html.interval(quantity, name), remark


def _check(name: str, check: Check) -> Markup:
    kind = _SIGNS.get(check.result, "open")
    badge = Markup('<span class="verdict {}"><span aria-hidden="true">{}</span> {}</span>')
    limit = html.amount(check.limit, check.unit)
    why = Markup(' <span class="because">{}</span>').format(check.why) if check.why else Markup()
    words = Markup("{} {}: {} {}{}")
    return words.format(badge.format(kind, html.MARKS[kind], check.result), in_words(name), check.side, limit, why)


def _curve(material: Material, name: str, title: str, unit: str) -> Chart | None:
    ascent, bands = material.table("flight", "ascent"), material.table("flight", "bands")
    if name not in ascent:
        return None
    time, values = ascent["time"].values, ascent[name].values
    series = [Series("ascent", "p_tank", time, values)]
    if f"{name}_low" in bands:
        low, high = (bands[f"{name}_{side}"].values for side in ("low", "high"))
        series.insert(0, Series("95 % of the flights", "p_tank", bands["time"].values, low, "band", high))
    ways_down = list(_down(material, name))
    caption: str | Markup = ""
    limit = _rail_limit(material)
    if name == "speed" and limit is not None:
        series.append(Series("least at the rail's end", "zero", time[[0, -1]], np.full(2, limit), "level"))
        caption = Markup("Dashed: the {} that a rocket should have when it leaves the rail.")
        caption = caption.format(html.amount(limit, "m/s"))
    span = around([line.time for line in (*series[:2], *ways_down)])
    return _over_flight(material, f"flight-{name}", (title, name, unit), [*series, *ways_down], span, caption)


def _down(material: Material, name: str) -> Iterator[Series]:
    """The ways down beside the way up: under the parachutes, and without them."""
    for group, label, style in _WAYS_DOWN:
        table = material.table("flight", group)
        if name in table:
            yield Series(label, style, table["time"].values, table[name].values, dashed=group == "ballistic")


def _rail_limit(material: Material) -> float | None:
    check = material.need(Flight).checks.get("rail_departure_velocity")
    return check.limit if check else None


def _over_flight(
    material: Material,
    key: str,
    about: tuple[str, str, str],
    series: list[Series],
    span: tuple[float, float],
    caption: str | Markup,
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
        events=tuple(_events(material)),
        x_label=_TIME,
        height=height,
        value_span=value_span,
        clock="flight",
    )


def _events(material: Material) -> Iterator[Event]:
    """The end of the rail, where the flight is as fast as it leaves it, and of the burn."""
    product, ascent = material.need(Flight), material.table("flight", "ascent")
    departure, burn = product.rail_departure_velocity.value, product.burn_time.value
    if departure is not None and "speed" in ascent:
        fast = np.flatnonzero(ascent["speed"].values >= departure)
        if fast.size:
            yield Event(float(ascent["time"].values[fast[0]]), 0.0, "off the rail")
    if burn is not None:
        yield Event(burn, 0.0, "burn out")


def _margin(material: Material) -> Chart | None:
    """The static margin in every wind: mean and two standard deviations over gusts, beside its limits."""
    said = material.need(Flight).stability
    winds = [(wind.wind, material.table("flight", f"stability/{i}")) for i, wind in enumerate(said.winds)]
    if not winds or said.limits is None or not all("margin_mean" in table for _, table in winds):
        return None
    low, high = said.limits
    bands, lines = zip(*(_in_wind(wind, table, STYLES[i % len(STYLES)]) for i, (wind, table) in enumerate(winds)),
                       strict=True)  # fmt: skip
    times = [line.time for line in lines]
    ends = np.array([min(float(time[0]) for time in times), max(float(time[-1]) for time in times)])
    limits = [Series(f"limit {limit:g}", "zero", ends, np.full(2, limit), "level") for limit in (low, high)]
    seen = [value for band in bands for value in (np.nanmin(band.values), np.nanmax(band.upper))]
    span = (min(0.0, *seen), 1.05 * max(high, *seen))
    speeds = Markup(", ").join(html.amount(wind, "m/s", 2) for wind, _ in winds)
    caption = Markup(
        "From the end of the rail until the rocket is as slow again. Lines: mean over flights in gusts of {:.0f} % in "
        "head winds of {}; bands: two standard deviations. Dashed: the limits of {:g} and {:g} calibers; below, a gust "
        "may turn the rocket over, above, it turns far into the wind."
    ).format(100.0 * said.gust_intensity, speeds, low, high)
    about = ("Static margin in wind", "margin", "calibers")
    return _over_flight(
        material, "flight-margin", about, [*bands, *lines, *limits], around(times), caption, span, 320.0
    )


def _in_wind(wind: float, table: Table, style: str) -> tuple[Series, Series]:
    """Band and line of one wind [m/s]."""
    time, mean, std = (table[name].values for name in ("time", "margin_mean", "margin_std"))
    name = f"wind {wind:.1f} m/s"
    return (
        Series(f"{name}: two std", style, time, mean - 2.0 * std, "band", mean + 2.0 * std),
        Series(name, style, time, mean),
    )


def _without_margin(stability: Stability) -> Markup | None:
    """Why no margin is drawn, and what to add."""
    reason = stability.margin_at_rail_departure.reason
    if not reason:
        return None
    stated = Markup(" State it in test.toml.") if "not given" in reason else Markup()
    add = _GEOMETRY if "[rocket.geometry]" in reason else stated
    return html.paragraph(html.switchable(f"No static margin is drawn: {reason}.") + add)


SECTION = Section("Flight", 78, ("flight",), render, folded=True)
