"""t_v: the liquid is gone. The knee of the tank pressure, where it agrees with mass and energy of a saturated tank.

While liquid boils off, the tank pressure falls slowly; once only vapor is left the same valve empties it several times
faster. Valve openings, rebounds of late boiling, nitrogen and the end of the fuel bend the pressure too, so that every
downward knee is a candidate and is weighed against the pressure at which an adiabatic saturated tank of this volume and
load runs dry.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.engine.tank import mass_along_blowdown, split
from hfanalysis.record.noise import Noise
from hfanalysis.record.signals import Signal
from hfanalysis.segment.breaks import Break
from hfanalysis.segment.falls import abrupt_falls
from hfanalysis.segment.refine import refine_knee, refine_step
from hfanalysis.segment.sanity import anywhere_in
from hfanalysis.thermo.saturation import Saturation

STEEPER = 1.25
"""A knee is a fall at least this much steeper after than before, and more where mass and energy do not expect it.
Evidence: test_events.py: of two knees the one at the dry pressure is taken, a tank without a knee shows none."""

LEAST_LOSS = 0.05
"""By the end of the liquid a tank has lost at least this part of its pressure."""

GAS_EMPTIES = 0.25
"""Least rate at which the pressure falls by its own part once the liquid is gone, times t_v [-]: what is left is gas
and leaves by the same injector. That number is m (m_l / m_v) (mdot_v / mdot_l): liquid over vapor 1.5 to 7 for tanks
filled by 20 to 85 %, flow of the vapor 0.2 of the liquid's or more. The opening's own drop and the end of late boiling
have 0.1 and less. Source: choked flow of nitrous oxide vapor against that of its liquid (CoolProp), at 25 to 45 bar."""

DRY_PRESSURE_SPREAD = 0.2
"""Standard deviation of ln(p) about the adiabatic value at which real tanks run dry: heat, mass, stratification."""

WIDE_KNEE = 0.9
"""Seconds on either side of a knee that only the tank pressure shows. Evidence: on public records the last liquid
leaves as froth, 0.1 to 0.2 s apart in tank and run line."""

LINE_REACH = 0.15
"""Seconds over which the run line's slope is taken on either side of its fall."""

SHARP = 0.04
"""Chamber and thrust count as sharp, and then date the event, where they relax faster than this [s]. Evidence:
test_events.py: they fall with the liquid and date it best."""


SEEN = 4.0
"""Standard deviations of the difference of two slopes above which it is a knee [-]. Source: of some hundred differences
of noise the largest is three."""

WIDER = 4
"""How often the slopes are taken over twice as long, until a knee stands above the noise."""

STEP_AFTER = 0.15
"""Seconds after a fall of chamber pressure or thrust that are looked at, and how far from the knee it may be."""

BESIDE_FALL = 0.04
"""Seconds that a fall of chamber pressure or thrust takes, and within which it is found."""


@dataclass(frozen=True)
class LiquidEnd:
    """t_v [s] with its standard deviation [s], the channels that date it, and the ``other_times`` [s] others show."""

    time: float
    std: float
    channels: tuple[str, ...]
    other_times: dict[str, float]


def dry_pressure(saturation: Saturation, volume: float, mass: float, pressure: float) -> float | None:
    """Tank pressure [Pa] at which an adiabatic saturated tank runs out of liquid (None where it cannot be saturated).

    ``volume`` [m^3] holds ``mass`` [kg]; ``pressure`` [Pa] is that of the full tank. Found by following the blowdown
    upwards from trial end temperatures.
    """
    start = float(saturation.temperature(pressure))
    if not np.isfinite(start) or split(saturation, volume, mass, start).vapor < 0.0:
        return None
    ends = np.linspace(max(saturation.t_min, start - 60.0), start - 0.05, 60)
    masses = np.array([mass_along_blowdown(saturation, volume, e, np.array([start]))[0] for e in ends])
    order = np.argsort(masses)
    if not masses.min() <= mass <= masses.max():
        return None
    return float(saturation.pressure(np.interp(mass, masses[order], ends[order])))


def find_liquid_end(
    signals: Mapping[str, Signal],
    end: float,
    expected: float | None,
    impossible: Callable[[float], bool] = lambda _: False,
) -> LiquidEnd | None:
    """t_v from signals with time from the opening, searched up to ``end`` [s]; ``expected``: the dry pressure [Pa].

    None where the tank pressure shows no knee. A knee that is ``impossible`` [s] leaves its place to the next best.
    """
    tank = signals["p_tank"]
    found = _rough_knee(tank, end, expected, impossible)
    if found is None:
        return None
    rough, wider = found
    noise = Noise.of(tank, tank.between(-3.0, -0.05))
    for start, unseen_to in tank.holes(rough, rough):
        return LiquidEnd(*anywhere_in(rough, 0.0, start, unseen_to), ("p_tank",), {})
    half = min(wider * max(0.3, 15.0 * tank.step), max(0.8 * rough, 6.0 * tank.step))
    reach = wider * max(0.12, 4.0 * tank.step)
    knee = refine_knee(tank, rough, min(half + reach, rough), half + reach, reach, noise)
    if knee is None or not _steeper(tank, knee.time, half):
        return LiquidEnd(rough, 0.5 * reach, ("p_tank",), {})
    dated = _dated_by_steps(signals, knee, half)
    if dated.channels != ("p_tank",):
        return dated
    return _rounded(signals, knee, min(WIDE_KNEE, 0.8 * rough), noise, dated.other_times)


def _rounded(
    signals: Mapping[str, Signal], knee: Break, wide: float, noise: Noise, other_times: dict[str, float]
) -> LiquidEnd:
    """A knee without a sharp step: the last liquid leaves as froth, and tank and run line show it 0.1 to 0.2 s apart.

    The run line, after a bump, falls the more sharply of the two; the middle between both is taken, and half their
    distance is the least uncertainty.
    """
    tank = signals["p_tank"]
    line = _run_line_fall(signals["p_run"], knee.time, wide) if "p_run" in signals else None
    if line is None:
        found = refine_knee(tank, knee.time, wide, wide, 0.5 * wide, noise) or knee
        return LiquidEnd(found.time, found.std, ("p_tank",), other_times)
    near = max(0.35, 8.0 * tank.step)
    found = refine_knee(tank, line, 2.0 * near, 2.0 * near, near, noise) or knee
    std = max(found.std, 0.5 * abs(found.time - line), 0.5 * LINE_REACH)
    return LiquidEnd(0.5 * (found.time + line), std, ("p_tank", "p_run"), {**other_times, "p_run": line})


def _run_line_fall(run: Signal, about: float, wide: float) -> float | None:
    """Where the run line's slope drops most within [about - wide, about + wide/3]; None where it hardly does."""
    width = max(LINE_REACH, 5.0 * run.step)
    times = np.arange(max(about - wide, 1.5 * width), about + wide / 3.0, 0.2 * width)
    if times.size == 0:
        return None
    drop = np.array([_slope(run, t - width, t) - _slope(run, t, t + width) for t in times])
    usual = _slope(run, about - 2.0 * wide, about - wide)
    best = int(np.nanargmax(drop)) if np.isfinite(drop).any() else 0
    return float(times[best]) if np.isfinite(drop[best]) and drop[best] > 0.5 * abs(usual) else None


def _rough_knee(
    tank: Signal, end: float, expected: float | None, impossible: Callable[[float], bool]
) -> tuple[float, float] | None:
    """The likeliest knee [s], and how many times wider than usual the slopes were that saw it [-].

    As wide as it takes to see a fall above the noise: a wide slope blurs a knee, a narrow one makes knees of noise.
    """
    narrow = float(np.clip(0.05 * end, max(0.1, 5 * tank.step), max(0.4, 8 * tank.step)))
    for wider in 2.0 ** np.arange(WIDER):
        times, score = _knees(tank, end, expected, float(wider * narrow))
        for k in np.argsort(-score):
            if score[k] > 0.0 and not impossible(float(times[k])):
                return float(times[k]), float(wider)
    return None


def _knees(tank: Signal, end: float, expected: float | None, width: float) -> tuple[Array, Array]:
    """Instants [s] and how much each looks like the end of the liquid (0: it does not), by slopes over a width [s]."""
    coarse = tank.reduced(max(0.01, tank.step))
    times = np.arange(0.5 * width, end - 0.4 * width, 0.25 * width)
    if times.size == 0:
        return times, times
    start, after_hole = _beside_holes(times, tank.holes(0.0, end))
    before = np.array([_slope(coarse, t - width if t > 1.2 * width else 0.2 * width, t) for t in start])
    after = np.array([_slope(coarse, t, t + width) for t in after_hole])
    fall = before - after
    pressure = np.maximum(coarse.at(times), 1.0)
    lost = coarse.at(np.zeros(1))[0] - coarse.at(times + 0.4 * width) > LEAST_LOSS * pressure
    unlikely = np.ones_like(times)
    if expected is not None:
        unlikely = np.exp(0.5 * (np.log(pressure / expected) / DRY_PRESSURE_SPREAD) ** 2)
    typical = float(np.nanmedian(np.abs(before[np.isfinite(before)]))) if np.isfinite(before).any() else 0.0
    # of two slopes by least squares
    uncertain = SEEN * tank.noise * np.sqrt(24.0 * tank.step / width) / width
    steeper = after < STEEPER * unlikely * np.minimum(before, -0.2 * typical)
    empties = -after * times > GAS_EMPTIES * pressure
    score = np.where(steeper & lost & empties & (before < 0.0) & (fall > uncertain), fall / unlikely, 0.0)
    return times, np.nan_to_num(score)


def _steeper(tank: Signal, instant: float, width: float) -> bool:
    """Whether the pressure falls faster after an instant [s] than before it, over ``width`` [s] each: in a slow log the
    best corner near a knee may be the next one, where nitrogen holds the pressure up."""
    return _slope(tank, instant - width, instant) > _slope(tank, instant, instant + width)


def _beside_holes(times: Array, holes: Array) -> tuple[Array, Array]:
    """Up to when [s] the fall before each of the times (n,) [s] shows, and from when on the fall after it: in a hole
    (k, 2) [s] the liquid may go unseen, and what is on either side of it tells."""
    before, after = times.copy(), times.copy()
    for start, end in holes:
        inside = (times > start) & (times < end)
        before[inside], after[inside] = start, end
    return before, after


def _slope(signal: Signal, start: float, end: float) -> float:
    part = signal.between(start, end)
    if part.time.size < 4:
        return float("nan")
    x = part.time - part.time.mean()
    return float(x @ part.value / (x @ x))


def _dated_by_steps(signals: Mapping[str, Signal], knee: Break, half: float) -> LiquidEnd:
    """Chamber pressure and thrust fall within milliseconds when the liquid ends: where they do, they date it best."""
    steps: list[Break] = []
    others: list[Break] = []
    for name in ("p_chamber", "thrust"):
        found = _sudden_fall(signals[name], knee, half) if name in signals else None
        if found is None:
            continue
        if found.relaxation <= SHARP and abs(found.time - knee.time) < 4.0 * np.hypot(knee.std, found.std) + 0.06:
            steps.append(found)
        else:
            others.append(found)
    other_times = {one.channels[0]: one.time for one in others}
    if not steps:
        return LiquidEnd(knee.time, knee.std, ("p_tank",), other_times)
    time, std = _weighted(steps)
    doubt = max(0.5 * (abs(one.time - time) - 2.0 * one.std) for one in (knee, *others))
    channels = ("p_tank", *(s.channels[0] for s in steps))
    return LiquidEnd(time, float(np.hypot(std, max(doubt, 0.0))), channels, other_times)


def _weighted(steps: list[Break]) -> tuple[float, float]:
    weight = np.array([1.0 / s.std**2 for s in steps])
    time = float(weight @ np.array([s.time for s in steps]) / weight.sum())
    spread = float(np.ptp([s.time for s in steps])) if len(steps) > 1 else 0.0
    return time, float(np.hypot(1.0 / np.sqrt(weight.sum()), 0.5 * spread))


def _sudden_fall(signal: Signal, knee: Break, half: float) -> Break | None:
    if (single := _own_fall(signal, knee, half)) is not None:
        return single
    before = signal.mean(knee.time - half, knee.time - 0.1)
    after = signal.mean(knee.time + 0.1, knee.time + half)
    scatter = signal.between(knee.time - half, knee.time - 0.1).value.std() if np.isfinite(before) else np.inf
    if not before - after > max(4.0 * scatter, 0.05 * abs(before)):
        return None
    reach = max(STEP_AFTER, 4 * knee.std, 3 * signal.step)
    return refine_step([signal], knee.time, min(half, 0.3) + reach, STEP_AFTER + reach, reach)


def _own_fall(signal: Signal, knee: Break, half: float) -> Break | None:
    """The nearest of several abrupt falls near a knee: the others are of the fuel. None where there are not several."""
    quiet = signal.between(-3.0, -0.05).value
    floor = float(np.median(quiet)) if quiet.size else 0.0
    falls = abrupt_falls(signal, floor, knee.time - half - STEP_AFTER, knee.time + half + STEP_AFTER)
    if len(falls) < 2:
        return None
    own = min(falls, key=lambda t: abs(t - knee.time))
    earlier = [own - t for t in falls if t < own]
    later = [t - own for t in falls if t > own]
    least = 4.0 * signal.step
    before = max(min([half, *(gap - 0.5 * BESIDE_FALL for gap in earlier)]), least)
    after = max(min([STEP_AFTER, *(gap - 0.25 * BESIDE_FALL for gap in later)]), least)
    return refine_step([signal], own, before, after, min(0.5 * before, 0.5 * after, BESIDE_FALL))
