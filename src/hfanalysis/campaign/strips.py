"""A number as several tests have it: a dot and its 95 % interval for each, and the band of what they say together."""

from __future__ import annotations

from collections.abc import Mapping

from markupsafe import Markup, escape

from hfanalysis.charts.svg import Axis, lettering, nice_ticks, shortened, tick_text
from hfanalysis.quantity import Quantity
from hfanalysis.wording.numbers import exponent_of, in_words
from hfanalysis.wording.scales import reading_unit, scale, superscript

WIDTH, LEFT, RIGHT, TOP, ROW, BOTTOM = 640.0, 130.0, 24.0, 8.0, 26.0, 44.0
"""[px] of a picture; ``ROW`` is the height of a test's."""


def strip(name: str, found: Mapping[str, Quantity], together: Quantity) -> Markup:
    """The picture of a quantity [SI] by test, as people read it; empty where fewer than two tests have a value."""
    known = {test: q for test, q in found.items() if q.value is not None}
    if len(known) < 2:
        return Markup()
    given = next(iter(known.values()))
    shown = scale(reading_unit(name, given.unit))
    ends = {test: [shown(x) for x in (*(q.interval or ()), q.value or 0.0)] for test, q in known.items()}
    band = [shown(x) for x in together.interval or ()]
    low, high = min(map(min, ends.values())), max(map(max, ends.values()))
    exponent = exponent_of(max(abs(low), abs(high)))
    size = 10.0**exponent
    room = 0.06 * (high - low) or 0.1 * abs(high) or 1.0
    axis = Axis((low - room) / size, (high + room) / size, LEFT, WIDTH - RIGHT)
    height = TOP + ROW * len(known) + BOTTOM
    parts = list(_band(axis, [x / size for x in band], height)) + list(_ticks(axis, height))
    for i, (test, values) in enumerate(ends.items()):
        parts += _test(axis, TOP + ROW * (i + 0.5), test, [x / size for x in values])
    power = f"×10{superscript(exponent)} " if exponent else ""
    words, unit = in_words(name), f"{power}{shown.unit}".strip()
    parts.append(lettering(0.5 * (LEFT + WIDTH - RIGHT), height - 6, f"{words}{f' [{unit}]' if unit else ''}", "label"))
    label = f"{words} of {', '.join(known)} with 95 % intervals"
    return Markup(
        f'<svg class="chart" viewBox="0 0 {WIDTH:.0f} {height:.0f}" role="img" aria-label="{escape(label)}">'
        f"{''.join(parts)}</svg>"
    )


def _band(axis: Axis, ends: list[float], height: float) -> list[str]:
    """What the tests say together, as far as it is within the picture."""
    if not ends:
        return []
    left, right = (axis(min(max(x, axis.low), axis.high)) for x in ends)
    tall = height - TOP - BOTTOM
    return [f'<rect class="band C_i" x="{left:.1f}" y="{TOP:.1f}" width="{right - left:.1f}" height="{tall:.1f}"/>']


def _ticks(axis: Axis, height: float) -> list[str]:
    ticks, bottom = nice_ticks(axis.low, axis.high, 7), height - BOTTOM
    parts = [f'<path class="axis" d="M{axis.start:.1f} {bottom:.1f}H{axis.end:.1f}"/>']
    for value in ticks:
        x = axis(value)
        parts.append(f'<path class="grid" d="M{x:.1f} {TOP:.1f}V{bottom:.1f}"/>')
        parts.append(lettering(x, bottom + 17, tick_text(value, ticks), "tick"))
    return parts


def _test(axis: Axis, y: float, test: str, values: list[float]) -> list[str]:
    *ends, value = values
    bar = [f'<path class="line C_i" d="M{axis(ends[0]):.1f} {y:.1f}H{axis(ends[1]):.1f}"/>'] if ends else []
    dot = f'<circle class="dot C_i" cx="{axis(value):.1f}" cy="{y:.1f}" r="4.5"/>'
    return [lettering(LEFT - 12, y + 4, shortened(test), "tick", "end"), *bar, dot]
