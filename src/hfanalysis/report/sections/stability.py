"""Whether it burnt smoothly: the verdict, the oscillations, and the spectrogram of the chamber's pressure."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator
from typing import Any

import numpy as np
from markupsafe import Markup

from hfanalysis.charts import svg
from hfanalysis.charts.chart import TIME
from hfanalysis.errors import AbsentError
from hfanalysis.performance.stability.fluctuation import fluctuation
from hfanalysis.performance.stability.spectrum import Spectrum, spectra
from hfanalysis.products.segments import Segments
from hfanalysis.products.stability import Line, Stability
from hfanalysis.products.validation import Validation
from hfanalysis.record.signals import Signal
from hfanalysis.report import html
from hfanalysis.report.material import Material
from hfanalysis.report.sections import Block, Section
from hfanalysis.wording.numbers import in_words, tidy

_SHOWN = 0.5
"""[s]: the windows of the spectrogram; of those that the analysis uses."""

_HIGHEST = 300.0
"""[Hz] up to which it is drawn: hybrids' low frequencies and most of their chambers' modes lie below."""

_DEPTH = 40.0
"""Decibels from its strongest to its faintest color."""

_COLUMNS = ("frequency", ">amplitude (rms)", "phase", "from … to", "course", "channels", "what it can be")
_CAPTION = "Oscillations that stand out of the broadband noise; amplitude as share of the first channel's mean."


def render(material: Material) -> Iterator[Block]:
    """The verdict with its reason, the lines, and the spectrogram."""
    validation = material.need(Validation)
    found = validation.stability
    if found is None:
        raise AbsentError(validation.absent.get("stability", "nothing burns in this test"))
    yield html.paragraph(_verdict(found), "said")
    if found.lines:
        yield html.table("Oscillations", _CAPTION, _COLUMNS, map(_row, found.lines))
    limit = found.detection_limit
    if limit is not None and limit.value is not None:
        yield html.paragraph(
            f"An oscillation of {tidy(100.0 * limit.value, 2)} % of the mean chamber pressure (rms) that lasts through "
            "the liquid phase would have been found."
        )
    yield _spectrogram(material)


def _verdict(found: Stability) -> str:
    return f"{in_words(found.verdict).capitalize()}: {found.why}."


def _row(line: Line) -> tuple[Any, ...]:
    low, high = line.frequency.interval or (0.0, 0.0)
    return (
        f"{tidy(line.frequency.value or 0.0, 3)} Hz ({tidy(low, 3)} to {tidy(high, 3)})",
        f"{tidy(100.0 * (line.amplitude.value or 0.0), 2)} %",
        line.phase,
        f"{html.seconds(line.start, 1)} … {html.seconds(line.end, 1)}",
        line.course,
        ", ".join(map(in_words, line.channels)),
        line.cause,
    )


def _spectrogram(material: Material) -> Markup | None:
    """Of the chamber's pressure, as a picture; None where its rate is too low for one."""
    channel = material.log.get("p_chamber")
    segments = material.get(Segments)
    if channel is None or segments is None:
        return None
    signal = Signal.of(channel).shifted(segments.t_open.value or 0.0)
    end = segments.time("t_end") or (float(signal.time[-1]) if signal.time.size else 0.0)
    found = fluctuation(signal, -1.0, end + 1.0)
    shown = next((s for s in spectra(found) if abs(s.length - _SHOWN) < 0.1 * _SHOWN), None) if found else None
    return _drawn(shown) if shown is not None else None


def _drawn(found: Spectrum) -> Markup:
    kept = found.frequency <= _HIGHEST
    power = 10.0 * np.log10(np.maximum(found.power[:, kept], np.finfo(float).tiny))
    half, top = 0.25 * found.length, float(found.frequency[kept][-1])
    plot = svg.new_plot((found.time[0] - half, found.time[-1] + half), (float(found.frequency[0]), top), 300.0)
    left, right, bottom = svg.LEFT, svg.WIDTH - svg.RIGHT, plot.height - svg.BOTTOM
    plot.parts.append(
        f'<image x="{left:.1f}" y="{svg.TOP:.1f}" width="{right - left:.1f}" height="{bottom - svg.TOP:.1f}" '
        f'preserveAspectRatio="none" href="data:image/png;base64,{_png(power.T[::-1])}"/>'
    )
    svg.axes(plot, TIME, "frequency [Hz]")
    title = "Spectrogram of the chamber pressure"
    words = f"How strongly the chamber pressure swings at each frequency up to {top:.0f} Hz, over time."
    picture = svg.render(plot, "spectrogram", title, words)
    caption = f"{words} The brightest color is {_DEPTH:.0f} dB above the darkest."
    return Markup("<figure>{}<figcaption>{}</figcaption></figure>").format(picture, caption)


def _png(decibels: np.ndarray[Any, np.dtype[np.float64]]) -> str:
    """A picture (rows, columns) of values [dB], in base64."""
    from matplotlib.image import imsave

    out = io.BytesIO()
    high = float(decibels.max())
    imsave(out, decibels, vmin=high - _DEPTH, vmax=high, cmap="magma")
    return base64.b64encode(out.getvalue()).decode("ascii")


SECTION = Section("Stability", 33, ("validation",), render, folded=True)
