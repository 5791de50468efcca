"""A slow channel: it follows what others show at once, as through a filter of first order.

Chamber pressure and thrust go together; a full line is between tank and chamber. Where a channel fits what the others
give only after they are delayed, by one time constant at the opening and at the end alike, it is the slow one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate
from math import hypot

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.health.firing import STEP, own_zero, usable
from hfanalysis.health.seen import Seen, SeenTest
from hfanalysis.health.shape import stretches
from hfanalysis.products.health import Finding
from hfanalysis.record.quiet import in_blocks
from hfanalysis.sentences import said, text

CONSTANTS = tuple(0.05 * 2.0 ** (0.5 * k) for k in range(13))
"""[s] that are tried, 0.05 to 3.2 s."""
SLOWEST = 0.1
"""[s] from which on a time constant is worth a word. Source: a tube of a meter to a gauge takes 10 ms, a filter of
10 Hz 16 ms."""
STEPS = 4.0
"""Steps between samples that a time constant lasts at least: below, how a logger samples looks the same."""
QUICK = ("p_run", "p_chamber", "thrust")
"""Channels that an opening valve moves within a second; a tank falls slowly anyway."""
PRESSED = ("p_run", "p_chamber", "p_tank", "thrust")
"""Channels whose noise at rest is compared."""
EARLY = 1.5
"""[s] after the opening in which a line's gauge that is late still reads too little. Evidence: lines are full after 0.1
to 0.9 s, and a chamber is never fed from below its own pressure."""
SURE = 3.0
"""Deviations of both accuracies by which it has to [-]."""
BETTER = 3.0
"""Times by which the sum of squares has to fall with the delay [-]. Evidence: benchmarks/health_rates.py."""
FITS = 0.08
"""Part of a channel's variance that may be left [-]: what does not fit with a delay either is not slow."""
MARGIN = 1.0
"""[s] before the firing and after it that are looked at."""
MOST = 1200
"""Instants at which channels are compared."""


MEANS = "a slow sensor, a long or blocked tube to it, or a filter: what it dates is late or early by as much"


@dataclass(frozen=True)
class Delay:
    """Time constant [s], how many times worse the fit is without it [-], and what is left with it [-]."""

    constant: float
    better: float
    left: float

    @property
    def sure(self) -> bool:
        """Whether the delay explains the channel, and nothing else does."""
        return self.better > BETTER and self.left < FITS


def find(test: SeenTest) -> Iterator[Finding]:
    """By what others show, by a line that comes after its chamber, by noise that is smooth."""
    slow: list[str] = []
    for name, other in (("p_chamber", "thrust"), ("thrust", "p_chamber")):
        delay = _delay(test, name, (other,)) if other not in slow else None
        step = 1.0 / max(min(test.channels[n].coarse.rate for n in (name, other)), 1e-9) if delay else 0.0
        if delay is not None and delay.sure and delay.constant > max(SLOWEST, STEPS * step):
            slow.append(name)
            yield _finding(test.channels[name], (other,), delay)
    if "p_run" in test.channels and (found := _behind(test)) is not None:
        slow.append("p_run")
        yield found
    for name in QUICK:
        seen = test.get(name)
        if seen is not None and name not in slow and (found := _smooth(test, seen)) is not None:
            yield found


def _behind(test: SeenTest) -> Finding | None:
    """A line that reads less than its chamber for a while after the opening, and more from then on."""
    sampled = _sampled(test, ("p_run", "p_chamber"))
    if sampled is None or test.fire is None:
        return None
    time, (run, chamber) = sampled
    early = (time > test.fire[0]) & (time < test.fire[0] + EARLY)
    sure = SURE * hypot(*(test.channels[n].channel.accuracy for n in ("p_run", "p_chamber")))
    below = (run - chamber < -sure) & early
    parts = [(a, b) for a, b in stretches(below) if time[b - 1] - time[a] > SLOWEST]
    later = (time > test.fire[0] + EARLY) & (time < test.fire[0] + 2.0 * EARLY)
    if not parts or not later.any() or float(np.median((run - chamber)[later])) < sure:
        return None
    end = float(time[parts[-1][1] - 1]) - test.fire[0]
    evidence = text(
        "reads less than the chamber that it feeds for {end} after the opening, by up to {most}, and more from then on",
        end=said(end, "s", ".2f"), most=said(float((chamber - run)[below].max()), "bar", ".2g"),
    )  # fmt: skip
    return test.channels["p_run"].finding("lag", "suspect", evidence=evidence, means=MEANS, cure=None, delay=end)


def _smooth(test: SeenTest, seen: Seen) -> Finding | None:
    """Noise at rest that hardly changes from sample to sample, where that of other channels does: it is averaged, and
    so is what the firing does; the steepest rise takes as long."""
    held = _correlation_time(test, seen)
    others = [_correlation_time(test, o) for n in PRESSED if n != seen.name and (o := test.get(n)) is not None]
    known = [t for t in others if t is not None]
    if held is None or held < SLOWEST or not known or min(known) > held / 4.0:
        return None
    rise = _rise_time(test, seen)
    if rise is None or rise < held:
        return None
    evidence = text(
        "its noise at rest holds for {held}, that of others for {other}, and its steepest rise takes {rise}",
        held=said(held, "s", ".2g"), other=said(min(known), "s", ".2g"), rise=said(rise, "s", ".2g"),
    )  # fmt: skip
    return seen.finding("lag", "suspect", evidence=evidence, means=MEANS, cure=None, delay=rise)


def _correlation_time(test: SeenTest, seen: Seen) -> float | None:
    """For how long [s] the noise at rest keeps half of its correlation; None where there is no noise to tell by."""
    rest = seen.coarse.rest
    if rest is None or rest.span[1] - rest.span[0] < 1.0:
        return None
    trace = usable(test, seen).between(*rest.span)
    n = len(trace.values)
    if n < 60:
        return None
    x = (trace.time - trace.time.mean()) / float(np.ptp(trace.time))
    noise = trace.values - np.polyval(np.polyfit(x, trace.values, 1), x)
    if float(np.std(noise)) < 3.0 * seen.coarse.quantum or not np.std(noise) > 0.0:
        return None
    spectrum = np.abs(np.fft.rfft(noise, 2 * n)) ** 2
    correlation = np.fft.irfft(spectrum)[: n // 2] / np.arange(n, n - n // 2, -1)
    below = np.flatnonzero(correlation < 0.5 * correlation[0])
    step = float(np.median(np.diff(trace.time)))
    return float(below[0]) * step if len(below) else None


def _rise_time(test: SeenTest, seen: Seen) -> float | None:
    """The shortest time [s] in which the channel covers half of its range in the firing."""
    sampled = _sampled(test, (seen.name,))
    if sampled is None:
        return None
    time, (values,) = sampled
    half = 0.5 * float(np.ptp(np.percentile(values, (1.0, 99.0))))
    step = float(time[1] - time[0])
    for k in range(1, len(values) // 2):
        if float(np.max(np.abs(values[k:] - values[:-k]))) >= half:
            return k * step
    return None


def _delay(test: SeenTest, name: str, others: tuple[str, ...]) -> Delay | None:
    sampled = _sampled(test, (name, *others))
    if sampled is None:
        return None
    time, values = sampled
    step = float(time[1] - time[0])
    left = {0.0: _left(values[0], values[1:])}
    for constant in (c for c in CONSTANTS if c > 0.5 * step):
        left[constant] = _left(values[0], [_delayed(v, step / constant) for v in values[1:]])
    best = min(left, key=left.__getitem__)
    return Delay(best, left[0.0] / max(left[best], 1e-12), left[best]) if best > 0.0 else None


def _sampled(test: SeenTest, names: tuple[str, ...]) -> tuple[Array, list[Array]] | None:
    """The channels (n,) [SI] at even instants (n,) [s] of firing and margin."""
    channels = [test.get(name) for name in names]
    if test.fire is None or any(c is None for c in channels):
        return None
    start, end = test.fire[0] - MARGIN, test.fire[1] + MARGIN
    traces = [in_blocks(usable(test, c).between(start, end), STEP) for c in channels if c is not None]
    if min(len(t.time) for t in traces) < 30:
        return None
    step = max(STEP, (end - start) / MOST, *(float(np.median(np.diff(t.time))) for t in traces))
    time = np.arange(max(t.time[0] for t in traces), min(t.time[-1] for t in traces), step)
    if len(time) < 30:
        return None
    zeros = [own_zero(c) for c in channels if c is not None]
    return time, [np.interp(time, t.time, t.values) - z for t, z in zip(traces, zeros, strict=True)]


def _delayed(values: Array, share: float) -> Array:
    """Through a filter of first order: ``share`` of a time constant passes between samples."""
    part = 1.0 - float(np.exp(-share))
    return np.array(list(accumulate(values.tolist(), lambda held, new: held + part * (new - held))))


def _left(y: Array, others: list[Array]) -> float:
    """Part of the variance that a straight line in the others leaves [-]."""
    a = np.column_stack([*others, np.ones(len(y))])
    scale = float(np.sum((y - y.mean()) ** 2))
    solution = np.linalg.lstsq(a, y, rcond=None)[0]
    return float(np.sum((y - a @ solution) ** 2)) / scale if scale > 0.0 else 1.0


def _finding(seen: Seen, others: tuple[str, ...], delay: Delay) -> Finding:
    evidence = text(
        "follows {others} with a time constant of {constant}: without a delay they leave {better:.0f} times as much of "
        "it unexplained",
        others=" and ".join(others), constant=said(delay.constant, "s", ".2g"), better=delay.better,
    )  # fmt: skip
    return seen.finding("lag", "suspect", evidence=evidence, means=MEANS, cure=None, delay=delay.constant)
