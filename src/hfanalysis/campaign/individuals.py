"""A number of many tests in the order of their dates, with its natural limits, and below it how far each is from the
one before."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from statistics import median

from markupsafe import Markup, escape

from hfanalysis.campaign.family import natural_limits
from hfanalysis.charts.svg import Axis, lettering, nice_ticks, shortened, tick_text
from hfanalysis.quantity import Quantity
from hfanalysis.wording.numbers import exponent_of, in_words
from hfanalysis.wording.scales import reading_unit, scale, superscript

WIDTH, LEFT, RIGHT = 640.0, 70.0, 24.0
"""[px] of a picture."""

UPPER, LOWER = (14.0, 174.0), (196.0, 256.0)
"""[px] from the top: between which the numbers are drawn, and how far each is from the one before."""

HEIGHT = 290.0

ROOM = 60
"""Tests up to which each one's interval is drawn; those of more run into each other."""


def individuals(name: str, in_order: Mapping[str, Quantity]) -> Markup:
    """The picture of a quantity [SI] by test, in the order of their dates, as people read it; empty where it has no
    natural limits."""
    known = {test: q for test, q in in_order.items() if q.value is not None}
    own = natural_limits([q.value or 0.0 for q in known.values()])
    if own is None:
        return Markup()
    shown = scale(reading_unit(name, next(iter(known.values())).unit))
    values = [shown(q.value or 0.0) for q in known.values()]
    limits = (shown(own[0]), shown(own[1]))
    exponent = exponent_of(max(map(abs, (*values, *limits))))
    values, limits = [x / 10.0**exponent for x in values], (limits[0] / 10.0**exponent, limits[1] / 10.0**exponent)
    moves = [abs(b - a) for a, b in pairwise(values)]
    x = Axis(-0.5, len(values) - 0.5, LEFT, WIDTH - RIGHT)
    room = 0.08 * (max(*values, *limits) - min(*values, *limits))
    y = Axis(min(*values, *limits) - room, max(*values, *limits) + room, UPPER[1], UPPER[0])
    below = Axis(0.0, 1.1 * max(moves), LOWER[1], LOWER[0])
    bars = [[shown(end) / 10.0**exponent for end in q.interval or ()] for q in known.values()]
    parts = [
        *_ticks(y), *_ticks(below, 3), *_level(y, median(values), "middle"),
        *(part for limit in limits for part in _level(y, limit, "")), *_level(below, median(moves), ""),
        *(_bars(x, y, bars) if len(values) <= ROOM else ()),
        *_numbers(x, y, list(known), values, limits), *_moves(x, below, moves),
        *_names(x, list(known)),
    ]  # fmt: skip
    power = f"×10{superscript(exponent)} " if exponent else ""
    words, unit = in_words(name), f"{power}{shown.unit}".strip()
    parts.append(lettering(LEFT, UPPER[0] - 4, f"{words}{f' [{unit}]' if unit else ''}", "label", "start"))
    parts.append(lettering(LEFT, LOWER[0] - 6, "from the one before", "label", "start"))
    label = f"{words} of {len(known)} tests in order, with natural limits"
    return Markup(
        f'<svg class="chart" viewBox="0 0 {WIDTH:.0f} {HEIGHT:.0f}" role="img" aria-label="{escape(label)}">'
        f"{''.join(parts)}</svg>"
    )


def _ticks(y: Axis, most: int = 5) -> Iterator[str]:
    ticks = nice_ticks(y.low, y.high, most)
    for value in ticks:
        yield f'<path class="grid" d="M{LEFT:.1f} {y(value):.1f}H{WIDTH - RIGHT:.1f}"/>'
        yield lettering(LEFT - 8, y(value) + 4, tick_text(value, ticks), "tick", "end")


def _level(y: Axis, value: float, kind: str) -> Iterator[str]:
    """A line across: solid for the middle of all, dashed for a limit."""
    yield f'<path class="{"axis" if kind else "level"}" d="M{LEFT:.1f} {y(value):.1f}H{WIDTH - RIGHT:.1f}"/>'


def _bars(x: Axis, y: Axis, bars: list[list[float]]) -> Iterator[str]:
    for i, ends in enumerate(bars):
        if ends:
            low, high = (y(min(max(end, y.low), y.high)) for end in ends)
            yield f'<path class="line C_i" d="M{x(i):.1f} {low:.1f}V{high:.1f}"/>'


def _numbers(x: Axis, y: Axis, tests: list[str], values: list[float], limits: tuple[float, float]) -> Iterator[str]:
    """A dot for each test; the name beside one that is beyond the limits."""
    for i, (test, value) in enumerate(zip(tests, values, strict=True)):
        beyond = not limits[0] <= value <= limits[1]
        yield f'<circle class="dot C_i" cx="{x(i):.1f}" cy="{y(value):.1f}" r="{4.5 if beyond else 2.5}"/>'
        if beyond:
            near_end = i > 0.8 * len(tests)
            yield lettering(x(i) + (-8 if near_end else 8), y(value) + 4, shortened(test), "tick",
                            "end" if near_end else "start")  # fmt: skip


def _moves(x: Axis, y: Axis, moves: list[float]) -> Iterator[str]:
    for i, move in enumerate(moves, start=1):
        yield f'<path class="line C_i" d="M{x(i):.1f} {y(0.0):.1f}V{y(move):.1f}"/>'


def _names(x: Axis, tests: list[str]) -> Iterator[str]:
    """The first, the middle and the last."""
    yield f'<path class="axis" d="M{LEFT:.1f} {LOWER[1]:.1f}H{WIDTH - RIGHT:.1f}"/>'
    for i, anchor in ((0, "start"), (len(tests) // 2, "middle"), (len(tests) - 1, "end")):
        yield lettering(x(i), LOWER[1] + 17, shortened(tests[i]), "tick", anchor)
