"""t_purge: nitrogen enters the tank, seen as the moment when the purge line, quiet until then, starts to sag."""

from __future__ import annotations

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal
from hfanalysis.segment.breaks import Break, kink
from hfanalysis.segment.crossing import BENT, BENT_BY_WANDER, usual_noise
from hfanalysis.segment.refine import refine_kink
from hfanalysis.sentences import said, text

SMALLEST_SAG = 0.01
"""The line has to lose at least this part of its pressure before a sag is believed. Evidence: test_events.py: a line
that keeps its pressure lets no nitrogen in."""

FINEST = 0.02
"""Block means of the line over this time [s], unless noise asks for longer ones."""

SAG_LASTS = 0.4
"""Seconds over which a sag must go on. Evidence: test_events.py: valve hammer is no nitrogen."""

SAG_SHARES = (1.0, 0.7, 0.5, 0.35, 0.25, 0.18)
"""Parts of the window after the kink that are tried until a parabola fits what is in it."""


WORSE = 3.0
"""Times by which a date from less of the sag may be less sure: a narrow window is preferred for what it leaves out."""

AT_END = 0.7
"""Part of the reach beyond which a kink counts as at its end: it lies further off. Evidence: noise ten times a sensor's
hides a sag for up to two seconds, and t_purge was up to eleven deviations late (test_events.py)."""

MOVES = 30
"""How often at most the search moves on [-]; by AT_END of the reach each."""

KNEE_AWAY = 0.05
"""Seconds between two corners of the line from which on they are told apart. Evidence: the corner at the end of the
liquid took t_purge along by up to 0.15 s (test_events.py)."""


def find_nitrogen(
    purge: Signal, end: float, tank: Signal | None, knee: float | None = None
) -> tuple[float, float] | str:
    """t_purge [s] and its standard deviation [s], time counted from the opening, searched up to ``end`` [s]; else the
    reason.

    ``purge`` and ``tank`` are pressures [Pa]: the check valve cannot have opened while the tank stands above the purge
    line. At ``knee`` [s], the end of the liquid, the tank's fall has a corner of its own, and with it the line's.
    """
    quiet = purge.between(-3.0, -0.02)
    if quiet.time.size < 8:
        return "the log has no quiet purge line before the opening"
    level = float(np.median(quiet.value))
    coarse = _quiet_enough(purge.between(-1.0, end), SMALLEST_SAG * abs(level))
    rough = _start_of_sag(coarse, level, max(6.0 * coarse.noise, SMALLEST_SAG * abs(level)))
    if rough is None:
        return "the purge line keeps its pressure to the end of the log"
    if tank is not None and (obstacle := _held_shut(tank, level, rough)):
        return obstacle
    window = max(0.35, 15.0 * purge.step)
    reach = max(0.2, 6.0 * purge.step)
    rough, found, noise = _within_reach(purge, rough, window, reach)
    if found is not None and knee is not None and found.time < knee < rough + window + reach:
        found = _before_knee(purge, found, knee, window, reach, noise)
    return (found.time, found.std) if found else (rough, reach)


def _within_reach(purge: Signal, rough: float, window: float, reach: float) -> tuple[float, Break | None, Noise]:
    """The kink, the instant [s] it was looked for around, and the line's noise.

    A kink at the end of the reach is looked for again from there.
    """
    for _ in range(MOVES):
        noise = Noise.of(purge, purge.between(-np.inf, rough - reach))
        found = _kink(purge, rough, window + reach, reach, noise)
        if found is None or abs(found.time - rough) < AT_END * reach:
            break
        rough = found.time
    return rough, found, noise


def _kink(purge: Signal, rough: float, window: float, reach: float, noise: Noise) -> Break | None:
    """The kink with as much of the sag after it as a parabola fits: a tank's own corners bend the line again later."""
    best: Break | None = None
    middle = rough
    for share in SAG_SHARES:
        after = max(share * window, 1.5 * reach)
        found = refine_kink(purge, middle, window, after, reach, flat=True, noise=noise)
        if found is None:
            break
        best = found if best is None or found.std < WORSE * best.std else best
        if not _bent(purge.between(middle - window, middle + after), found.time, noise):
            break
        middle, reach = best.time, max(min(reach, 4.0 * best.std), 6.0 * purge.step)
    return best


def _bent(part: Signal, instant: float, noise: Noise) -> bool:
    """Whether what follows an instant [s] is clearly bent more than a parabola is."""
    left = [_left(kink(order, before=0)(part.time, instant), part.value) for order in (2, 4)]
    usual = max(noise.white, usual_noise(part.value)) ** 2 + BENT_BY_WANDER * part.time.size * noise.flicker
    return left[0] - left[1] > BENT * usual


def _left(x: Array, value: Array) -> float:
    """Sum of squares that the columns (n, m) leave of a value (n,)."""
    residual = value - x @ np.linalg.lstsq(x, value, rcond=None)[0]
    return float(residual @ residual)


def _before_knee(purge: Signal, found: Break, knee: float, window: float, reach: float, noise: Noise) -> Break:
    """The break, fitted again to what lies before the knee, which took it along: the first of these fits looks from
    further back."""
    for back in (0.5 * reach, 0.0):
        middle = min(found.time, knee - KNEE_AWAY) - back
        away = knee - middle
        again = refine_kink(purge, middle, window + reach, away, min(reach, 0.8 * away), flat=True, noise=noise)
        if again is None:
            break
        found = again
    return found


def _quiet_enough(purge: Signal, drop: float) -> Signal:
    """Block means as long as it takes for the noise not to hide a ``drop`` [Pa], within half of a sag."""
    width = max(FINEST, purge.step)
    while 6.0 * (coarse := purge.reduced(width)).noise > drop and width < 0.5 * SAG_LASTS:
        width *= 2.0
    return coarse


def _start_of_sag(coarse: Signal, level: float, drop: float) -> float | None:
    low = coarse.value < level - drop
    lasting = max(round(SAG_LASTS / coarse.step), 2)
    for i in np.flatnonzero(low & (coarse.time > 0.0)):
        if low[i : i + lasting].mean() > 0.9:
            return _traced_back(coarse, int(i), level, drop)
    return None


def _traced_back(coarse: Signal, index: int, level: float, drop: float) -> float:
    """The line through the first part of the sag, back to the quiet level."""
    ahead = slice(index, index + max(round(0.2 / coarse.step), 3))
    slope = _line(coarse.time[ahead], coarse.value[ahead])
    back = drop / max(-slope, 1e-9)
    return float(coarse.time[index] - min(back, 0.5))


def _line(time: Array, value: Array) -> float:
    x = time - time.mean()
    return float(x @ value / max(x @ x, 1e-12))


def _held_shut(tank: Signal, level: float, time: float) -> str | None:
    standing = tank.mean(time - 0.05, time + 0.05 + 2.0 * tank.step)
    if standing > 1.1 * level:
        return text(
            "the purge line sags at {time:.2f} s, but the tank ({standing}) stands above it ({level}): no nitrogen can "
            "enter",
            time=time,
            standing=said(standing, "bar", ".1f"),
            level=said(level, "bar", ".1f"),
        )
    return None
