"""The charts of a test's page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from hfanalysis.report import svg
from hfanalysis.report.envelope import Envelope, Floats, envelope
from hfanalysis.report.material import Material, Residuals, event_list, phase_list, window
from hfanalysis.report.wording import people_unit, shown, tidy
from hfanalysis.testdata.channels import LONG_NAMES
from hfanalysis.testdata.log import Channel
from hfanalysis.thermo.constants import OXIDIZER_MOLAR_MASS

PRESSURES = ("p_tank", "p_run", "p_chamber", "p_purge")
_TIME = "time after the valve opens [s]"
_LOG_TIME = "log time [s]"


@dataclass(frozen=True)
class Figure:
    """A chart with its heading and the sentence below it."""

    heading: str
    chart: Markup
    caption: str


def figures(material: Material) -> list[Figure]:
    """All charts that the products allow, in the order of the page."""
    drawn = (
        _pressures(material),
        _thrust(material),
        _mass(material),
        _content(material),
        _flow(material),
        _injector(material),
        _tank_free(material),
        _residual(material),
    )
    return [figure for figure in drawn if figure is not None]


def _time_label(material: Material) -> str:
    return _LOG_TIME if material.segments is None else _TIME


def _channel(material: Material, channel: Channel, raw: bool = False) -> Envelope:
    """A channel's good samples within the page's window, in the unit of people."""
    factor, _ = people_unit(channel.unit)
    values = channel.raw if raw and channel.raw is not None else channel.values
    good = channel.good
    return envelope(channel.time[good] - material.opening, values[good] * factor, *window(material))


def _drawn(
    material: Material,
    lines: Sequence[tuple[Envelope, str, str]],
    y_label: str,
    height: float = 320.0,
    span: tuple[float, float] | None = None,
) -> svg.Plot:
    """A chart of lines (data, style, name) over phases and events, within ``span`` or the page's window."""
    extremes = [array for data, _, _ in lines for array in (data.low, data.high)]
    plot = svg.new_plot(span or window(material), svg.value_range(extremes), height)
    svg.phases(plot, phase_list(material))
    svg.axes(plot, _time_label(material), y_label)
    svg.events(plot, event_list(material))
    for data, style, name in lines:
        svg.line(plot, data, style, name)
    return plot


def _around(time: Floats) -> tuple[float, float]:
    """A little more than the stretch that ``time`` covers."""
    air = 0.05 * float(time[-1] - time[0])
    return float(time[0]) - air, float(time[-1]) + air


def _range_words(data: Envelope, name: str, unit: str) -> str:
    if data.empty:
        return f"{name}: no good samples here"
    low, high = float(np.nanmin(data.low)), float(np.nanmax(data.high))
    return f"{name} between {low:.3g} and {high:.3g} {unit}"


def _pressures(material: Material) -> Figure | None:
    channels = [material.log.channels[name] for name in PRESSURES if name in material.log.channels]
    lines = [(_channel(material, channel), channel.name, channel.name) for channel in channels]
    lines = [line for line in lines if not line[0].empty]
    if not lines:
        return None
    plot = _drawn(material, lines, "pressure [bar, absolute]", 400.0)
    words = "; ".join(_range_words(data, LONG_NAMES[name], "bar") for data, name, _ in lines)
    chart = svg.render(plot, "pressures", "Pressures", f"{words}. {_events_in_words(material)}")
    return Figure("Pressures", chart, "Mean and, lighter, the extremes of the samples; flagged samples are left out.")


def _events_in_words(material: Material) -> str:
    found = [f"{event.name} at {event.time:.3f} s" for event in event_list(material)]
    return f"Events: {', '.join(found)}." if found else "No firing was found in this log."


def _thrust(material: Material) -> Figure | None:
    channel = material.log.get("thrust")
    if channel is None:
        return None
    return _with_raw(material, channel, "Thrust", "thrust [N]")


def _mass(material: Material) -> Figure | None:
    channel = material.log.get("m_tank")
    if channel is None:
        return None
    return _with_raw(material, channel, "Tank mass", "tank mass [kg]")


def _with_raw(material: Material, channel: Channel, heading: str, y_label: str) -> Figure | None:
    """A weighed or pushed cell: corrected, and as logged where a zero was taken off."""
    corrected = _channel(material, channel)
    lines = [(corrected, channel.name, "corrected" if channel.raw is not None else channel.name)]
    if channel.raw is not None:
        lines.insert(0, (_channel(material, channel, raw=True), "raw", "as logged"))
    if corrected.empty:
        return None
    plot = _drawn(material, lines, y_label, 280.0)
    words = _range_words(corrected, heading, channel.unit)
    caption = f"{_zero_words(channel)}{_beyond(plot, corrected, channel.unit)}"
    return Figure(heading, svg.render(plot, channel.name, heading, words), caption)


def _beyond(plot: svg.Plot, data: Envelope, unit: str) -> str:
    """What a few wild readings leave outside the chart."""
    low, high = float(np.nanmin(data.low)), float(np.nanmax(data.high))
    wild = [tidy(end, 3) for end, out in ((low, low < plot.y.low), (high, high > plot.y.high)) if out]
    return f" A few readings lie outside the chart, as far as {' and '.join(wild)} {unit}." if wild else ""


def _zero_words(channel: Channel) -> str:
    if channel.raw is None:
        return "As logged: no zero was taken."
    drift = f"; drift of {tidy(channel.drift, 3)} {channel.unit} removed, linear in time" if channel.drift else ""
    return f"Zero of {tidy(channel.zero, 3)} {channel.unit} subtracted{drift}."


MOLES_TO_KG = 1e-3 * OXIDIZER_MOLAR_MASS


def _tank_history(material: Material, *names: str) -> list[Floats] | None:
    history = (material.calibration or {}).get("tank_history") or {}
    columns = [np.asarray(history.get(name, []), dtype=float) for name in ("time", *names)]
    return columns if columns[0].size > 1 else None


def _content(material: Material) -> Figure | None:
    """Liquid and vapour in the tank while there is liquid."""
    found = _tank_history(material, "liquid", "vapor")
    if found is None:
        return None
    time, *masses = found
    named = zip(masses, ("p_tank", "T_tank"), ("liquid", "vapour"), strict=True)
    lines = [(envelope(time, m * MOLES_TO_KG, time[0], time[-1]), style, name) for m, style, name in named]
    plot = _drawn(material, lines, "oxidizer in the tank [kg]", 260.0, _around(time))
    words = "; ".join(_range_words(data, name, "kg") for data, _, name in lines)
    chart = svg.render(plot, "content", "Oxidizer in the tank", words)
    return Figure(
        "Oxidizer in the tank",
        chart,
        "From the loaded mass, less what the calibrated injector passed, at the measured pressure.",
    )


def _flow(material: Material) -> Figure | None:
    """The oxidizer's flow through the calibrated injector."""
    found = _tank_history(material, "flow")
    if found is None:
        return None
    time, flow = found
    data = envelope(time, flow, time[0], time[-1])
    plot = _drawn(material, [(data, "C_i", "flow")], "oxidizer flow [kg/s]", 260.0, _around(time))
    words = _range_words(data, "flow", "kg/s")
    chart = svg.render(plot, "flow", "Oxidizer flow", words)
    return Figure("Oxidizer flow", chart, "Through the calibrated injector, from the measured pressure drop across it.")


def _injector(material: Material) -> Figure | None:
    """C_i over the liquid phase, each instant taken for itself."""
    history = (material.calibration or {}).get("C_i_history") or {}
    time, value = (np.asarray(history.get(key, []), dtype=float) for key in ("time", "value"))
    if time.size < 2:
        return None
    std = _like(history.get("std"), time)
    data = envelope(time, value, float(time[0]), float(time[-1]))
    inner = np.isfinite(value) & (time > time[0] + 0.1 * (time[-1] - time[0]))
    limits = np.nanpercentile(value[inner] if inner.any() else value, [1, 99])
    low, high = svg.value_range([np.asarray(limits)], with_zero=False)
    air = 0.5 * (high - low)
    plot = svg.new_plot(_around(time), (max(0.0, low - air), high + air), 280.0)
    svg.phases(plot, phase_list(material))
    svg.axes(plot, _TIME, "C_i [-]")
    svg.events(plot, event_list(material))
    bounds = envelope(time, std, float(time[0]), float(time[-1])).mean
    svg.band(plot, data.time, data.mean - 1.96 * bounds, data.mean + 1.96 * bounds, "C_i")
    svg.line(plot, Envelope(data.time, data.mean, data.mean, data.mean), "C_i", "C_i(t)")
    words = _coefficient_level(material, plot)
    chart = svg.render(plot, "injector", "Injector coefficient over time", words)
    return Figure(
        "Injector coefficient over time",
        chart,
        f"{words} A coefficient that drifts says that the model lacks something.",
    )


def _coefficient_level(material: Material, plot: svg.Plot) -> str:
    quantity = (material.calibration or {}).get("C_i") or {}
    if quantity.get("value") is None:
        return "Each instant taken for itself, with its 95 % interval."
    svg.level(plot, quantity["value"], "C_i")
    text = shown(quantity)
    dashed = f"dashed: the calibrated C_i = {text.value} ± {text.std}"
    return f"Each instant taken for itself, with its 95 % interval; {dashed}."


def _like(values: object, time: Floats) -> Floats:
    if values is None:
        return np.zeros_like(time)
    return np.broadcast_to(np.asarray(values, dtype=float), time.shape)


def _shown_residuals(material: Material) -> Residuals | None:
    """The residuals up to where nitrogen enters, which the tank model alone does not know, within the page's window."""
    found = material.residuals
    if found is None:
        return None
    start, end = window(material)
    purge = material.event("t_purge")
    last = end if purge is None else min(end, purge)
    found = found.between(start, last)
    return found if found.time.size > 1 else None


def _tank_free(material: Material) -> Figure | None:
    """The tank model alone against the measurement."""
    found = _shown_residuals(material)
    if found is None:
        return None
    measured, model = (_spread(found, values * 1e-5) for values in (found.measured, found.model))
    lines = [(measured, "p_tank", "measured"), (model, "model", "model")]
    plot = _drawn(material, lines, "p_tank [bar]", 320.0, _around(found.time))
    words = f"Root mean square of the residual {_rms(found.residual)} bar, of the noise {_rms(found.noise_std)} bar."
    chart = svg.render(plot, "tank-free", "Tank model against measured tank pressure", words)
    known = "Only the measured chamber pressure goes in; drawn until nitrogen enters, which this model leaves out."
    return Figure("Tank model against measurement", chart, f"{known} {words}")


def _spread(found: Residuals, values: Floats) -> Envelope:
    return envelope(found.time, values, float(found.time[0]), float(found.time[-1]))


def _rms(values: Floats) -> str:
    return f"{float(np.sqrt(np.nanmean(values**2))) * 1e-5:.2f}"


def _residual(material: Material) -> Figure | None:
    found = _shown_residuals(material)
    if found is None:
        return None
    residual = _spread(found, found.residual * 1e-5)
    noise = _spread(found, found.noise_std * 1e-5).mean
    lines = [(residual, "residual", "residual")]
    plot = _drawn(material, lines, "measured − model [bar]", 260.0, _around(found.time))
    svg.band(plot, residual.time, -1.96 * noise, 1.96 * noise, "noise")
    svg.level(plot, 0.0, "zero")
    words = "Residual of the tank pressure; the grey band is what noise alone would do in 95 % of the samples."
    return Figure("Residual", svg.render(plot, "residual", "Residual of the tank pressure", words), words)
