"""The model against the measurement, mode by mode, and what is left between them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import Markup

from hfanalysis.charts.chart import Chart, Series, around
from hfanalysis.charts.colors import style_of
from hfanalysis.errors import AbsentError
from hfanalysis.products.validation import Validation
from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.report import html
from hfanalysis.report.material import Material, Table, required, window
from hfanalysis.report.sections import Block, Section
from hfanalysis.report.time_charts import over_time
from hfanalysis.wording.numbers import in_words

MODES: dict[str, str] = {
    "tank_free": "Tank alone: the measured chamber pressure goes in",
    "chamber_forced": "Chamber and nozzle alone: the measured chamber pressure goes in, thrust comes out",
    "full": "Whole engine: nothing measured goes in",
}
_UNTIL_NITROGEN = ("tank_free",)
"""Modes that know nothing of the nitrogen, drawn until it enters."""

_WEIGHT = 0.2
"""Beside the log's own charts, which show the same samples."""

_NUMBERS = ("measured", "model", "residual", "noise_std")


def render(material: Material) -> Iterator[Block]:
    """Two charts for each mode and channel, then the gaps as a table."""
    groups, validation = material.stores["residuals"], material.get(Validation)
    if not groups:
        absent = validation.absent.values() if validation is not None else ()
        raise AbsentError(next(iter(absent), "no mode of validation ran"))
    for mode in sorted({name.partition("/")[0] for name in groups}, key=_order):
        yield Markup('<h3 class="mode">{}</h3>').format(MODES.get(mode, in_words(mode)))
        for name, table in groups.items():
            if name.startswith(f"{mode}/"):
                yield from _charts(material, mode, name.partition("/")[2], table)
    if validation is None:
        return
    yield _gaps(validation)
    for mode, reason in validation.absent.items():
        if mode in MODES:
            yield html.paragraph(Markup("{}: {}").format(in_words(mode).capitalize(), html.switchable(reason)))


def _order(mode: str) -> tuple[int, str]:
    return (list(MODES).index(mode) if mode in MODES else len(MODES), mode)


def _charts(material: Material, mode: str, channel: str, table: Table) -> Iterator[Chart | None]:
    time, *columns = required(table, "time", *_NUMBERS[:3])
    noise = np.broadcast_to(table["noise_std"].values, time.shape) if "noise_std" in table else np.zeros_like(time)
    start, end = _stretch(material, mode)
    part = (time >= start) & (time <= end)
    if np.count_nonzero(part) < 2:
        return
    measured, model, residual = (column[part] for column in columns)
    time, noise, unit = time[part], noise[part], table["measured"].unit
    key, words, span = f"{mode}-{channel}".replace("_", "-"), LONG_NAMES.get(channel, channel), around([time])
    lines = [
        Series("measured", style_of(channel), time, measured),
        Series("model", "model", time, model, dashed=True),
    ]
    title = f"{words.capitalize()}: model against measurement"
    yield over_time(material, key, title, (words, unit), lines, _known(mode), span=span, height=250.0, weight=_WEIGHT)
    band = Series("noise, 95 %", "noise", time, -1.96 * noise, "band", 1.96 * noise)
    zero = Series("zero", "zero", time[[0, -1]], np.zeros(2), "level")
    left = [band, Series("residual", "residual", time, residual), zero]
    caption = "Measured less model. The gray band is what noise alone would do in 95 % of the samples."
    title, axis = f"{words.capitalize()}: residual", ("measured − model", unit)
    yield over_time(
        material,
        f"{key}-residual",
        title,
        axis,
        left,
        caption,
        span=span,
        height=200.0,
        difference=True,
        weight=_WEIGHT,
    )


def _stretch(material: Material, mode: str) -> tuple[float, float]:
    start, end = window(material)
    purge = material.event("t_purge") if mode in _UNTIL_NITROGEN else None
    return start, end if purge is None else min(end, purge)


def _known(mode: str) -> str:
    return "Drawn until nitrogen enters, which this model leaves out." if mode in _UNTIL_NITROGEN else ""


def _gaps(validation: Validation) -> Markup | None:
    caption = "Root mean square and mean of measured less model, beside the noise of a sample."
    columns = ("mode", "channel", "phase", ">rms", ">bias", ">noise")
    rows = [
        (
            in_words(mode),
            LONG_NAMES.get(channel, channel),
            phase,
            *(html.amount(size, g.unit, 3, True) for size in (g.rms, g.bias, g.noise)),
        )
        for mode, channels in validation.gap.items()
        for channel, phases in channels.items()
        for phase, g in phases.items()
    ]
    return html.table("Gaps", caption, columns, rows) if rows else None


SECTION = Section("Model against measurement", 60, ("residuals",), render, folded=True)
