"""Whether a hot fire burnt smoothly, by phase and channel: what validation.json says of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.inference.oscillations.fluctuation import SMOOTH, Fluctuation, fluctuation
from hfanalysis.inference.oscillations.lines import Track, lines
from hfanalysis.inference.oscillations.paths import EDGE, detectable
from hfanalysis.inference.oscillations.spectrum import Spectrum, spectra
from hfanalysis.performance.stability.causes import ALIKE, APART, DRIVES, FOLLOWS, Seen, Shown, cause
from hfanalysis.performance.stability.modes import Mode
from hfanalysis.products.segments import Segments
from hfanalysis.products.stability import Line, Roughness, Stability
from hfanalysis.quantity import Quantity
from hfanalysis.record.log import Channel, TestLog
from hfanalysis.record.signals import Signal
from hfanalysis.sentences import text

CHANNELS = ("p_chamber", "thrust", "p_run", "p_tank")
"""That are looked at, the one that tells most first."""

LIMIT = 0.05
"""Part of the mean chamber pressure beyond which it is not smooth, either way. Source: Sutton and Biblarz, Rocket
Propulsion Elements, on combustion stability."""

PLATEAU = 0.8
"""Part of the usual pressure from which on the chamber has risen."""

SHORTEST = 1.0
"""[s] of a phase that is looked at: shorter than that it has no spectrum to speak of."""

SLOWEST_CHUG = 10.0
"""[Hz] up to which a channel has to show oscillations for a burn to be called smooth. Source: the low frequencies of
hybrids lie between some hertz and some tens (Karabeyoglu et al., J. Propulsion and Power 21(6), 1107 (2005))."""

FEWEST_WINDOWS = 5
"""In which run line and chamber are compared."""

BY_CHANCE = 0.01
"""Probability [-] of as much coherence between two that swing each for itself. Source: of n windows it is above c with
(1 - c)^(n - 1)."""

SMOOTH_BURN, ROUGH, UNSTABLE, UNSEEN = "smooth", "rough", "unstable", "unseen"

Modes = Callable[[float, float], Iterable[Mode] | None]
"""The engine's modes between two instants [s], None where its state is not known."""


@dataclass(frozen=True)
class Stretch:
    """A channel in a phase, or at rest."""

    channel: Channel
    found: Fluctuation

    @cached_property
    def lines(self) -> list[Track]:
        """Its lines, the clearest first."""
        return lines(self.found)

    @cached_property
    def spectra(self) -> list[Spectrum]:
        """Its spectra over time."""
        return spectra(self.found)

    @property
    def level(self) -> float:
        """What shares are of [SI]: the mean of the channel, as it reads."""
        return abs(self.found.mean)


TINY = 1e-12
"""Share of its spread [-] below which a variance is none. Source: double precision."""


def stability(log: TestLog, segments: Segments, end: float, modes: Modes) -> Stability:
    """How a hot fire burnt up to its ``end`` [s after the opening]."""
    origin = segments.t_open.value or 0.0
    signals = {n: Signal.of(log[n]).shifted(origin) for n in CHANNELS if n in log}
    rest = _stretches(log, signals, _rest(signals))
    phases = {
        name: stretches
        for name, (start, stop) in _phases(segments, signals, end).items()
        if (stretches := _stretches(log, signals, (start, stop)))
    }
    found = [line for name, stretches in phases.items() for line in _lines(name, stretches, rest, modes)]
    rough = {name: {c: _roughness(s, rest.get(c)) for c, s in stretches.items()} for name, stretches in phases.items()}
    liquid = phases.get("liquid", {}).get("p_chamber")
    if liquid is None:
        why = "there is no usable chamber pressure of a second or more on its plateau"
        return Stability(verdict=UNSEEN, why=why, lines=tuple(found), roughness=rough)
    of = rough["liquid"]["p_chamber"]
    verdict, why = _judged(liquid, of, [line for line in found if "p_chamber" in line.channels])
    return Stability(
        verdict=verdict,
        why=why,
        roughness_rms=of.rms,
        roughness_peak_to_peak=of.peak_to_peak,
        bandwidth=Quantity(liquid.found.nyquist, "Hz", why="half the rate of p_chamber; its tube may pass less"),
        detection_limit=_limit(liquid),
        lines=tuple(found),
        roughness=rough,
    )


def _rest(signals: Mapping[str, Signal]) -> tuple[float, float]:
    first = min((float(s.time[0]) for s in signals.values() if s.time.size), default=0.0)
    return first, -2.0 * SMOOTH


def _phases(segments: Segments, signals: Mapping[str, Signal], end: float) -> dict[str, tuple[float, float]]:
    """From when to when [s] the chamber is on its plateau with liquid, and with vapor alone."""
    liquid_out, fade = segments.time("t_v"), segments.time("t_fuel_out")
    over = min(x for x in (liquid_out, fade, end) if x is not None)
    start = _risen(signals.get("p_chamber"), segments.time("t_feed") or 0.0, over)
    out = {"liquid": (start, over - SMOOTH)}
    if liquid_out is not None and over == liquid_out:
        last = min(x for x in (fade, segments.time("t_purge"), segments.time("t_end"), end) if x is not None)
        out["vapor"] = (liquid_out + 2.0 * SMOOTH, last - SMOOTH)
    return {name: (a, b) for name, (a, b) in out.items() if b - a >= SHORTEST}


def _risen(chamber: Signal | None, after: float, before: float) -> float:
    """When [s] the chamber's pressure has come to its plateau."""
    part = chamber.between(after, before) if chamber is not None else None
    if part is None or part.time.size < 8:
        return after + 2.0 * SMOOTH
    high = part.smooth(SMOOTH) > PLATEAU * np.median(part.value)
    return float(part.time[int(np.argmax(high))]) + 2.0 * SMOOTH


def _stretches(log: TestLog, signals: Mapping[str, Signal], between: tuple[float, float]) -> dict[str, Stretch]:
    found = {name: fluctuation(signal, *between) for name, signal in signals.items()}
    return {name: Stretch(log[name], f) for name, f in found.items() if f is not None and f.mean != 0.0}


def _roughness(stretch: Stretch, rest: Stretch | None) -> Roughness:
    """As shares of the mean, without what the sensor's own noise at rest explains."""
    of, noise = stretch.found, rest.found.variance if rest is not None else 0.0
    left = max(of.variance - noise, 0.0)
    rms = np.sqrt(left) / stretch.level
    part = np.sqrt(left / of.variance) if of.variance > 0.0 else 0.0
    range_of_it = part * of.peak_to_peak / stretch.level
    # variances of so many independent samples, of both
    spread = np.hypot(of.variance, noise) * np.sqrt(2.0 / of.value.size)
    std = min(0.5 * spread / np.sqrt(left) if left > TINY * spread else np.inf, np.sqrt(spread)) / stretch.level
    return Roughness(
        rms=Quantity(float(rms), "", float(std)),
        peak_to_peak=Quantity(float(range_of_it), "", float(std * of.peak_to_peak / max(np.sqrt(of.variance), 1e-300))),
    )


def _lines(phase: str, stretches: Mapping[str, Stretch], rest: Mapping[str, Stretch], modes: Modes) -> list[Line]:
    """The lines of a phase, those at one frequency in several channels as one."""
    seen = [Seen(name, track, track.rms / s.level) for name, s in stretches.items() for track in s.lines]
    out = []
    while seen:
        first = seen[0]
        same = [first, *(s for s in seen[1:] if s.channel != first.channel and _together(s.track, first.track))]
        seen = [s for s in seen if s not in same]
        out.append(_line(phase, same, stretches, rest, modes))
    return out


def _together(one: Track, other: Track) -> bool:
    shared = min(one.end, other.end) - max(one.start, other.start)
    near = abs(one.frequency - other.frequency) < one.reach + other.reach + one.width + other.width + 0.5
    return near and shared > 0.0


def _line(
    phase: str, seen: list[Seen], stretches: Mapping[str, Stretch], rest: Mapping[str, Stretch], modes: Modes
) -> Line:
    first = seen[0]
    track = first.track
    shown = Shown(
        limits={c: detectable(s.spectra, track.frequency) / s.level for c, s in stretches.items()},
        rest={c: s.lines for c, s in rest.items()},
        rest_limits={c: detectable(s.spectra, track.frequency) for c, s in rest.items()},
        run_line=_run_line(stretches, track),
        sampling=2.0 * stretches[first.channel].found.nyquist,
    )
    low, high = track.frequency - track.reach, track.frequency + track.reach
    share_std = track.rms_std / stretches[first.channel].level
    return Line(
        frequency=Quantity(track.frequency, "Hz", 0.5 * track.reach, (low, high)),
        width=track.width,
        amplitude=Quantity(first.share, "", share_std, why=f"of the mean of {first.channel}"),
        channels=tuple(s.channel for s in seen),
        phase=phase,
        start=track.start,
        end=track.end,
        course=track.course,
        cause=cause(seen, shown, modes(track.start, track.end)),
    )


def _run_line(stretches: Mapping[str, Stretch], track: Track) -> str:
    """How run line and chamber swing together at a line's frequency.

    A steady feed has its pressure before the injector between those of tank and chamber, so that it follows the
    chamber's a part of the way, without delay.
    """
    if not {"p_tank", "p_run", "p_chamber"} <= set(stretches):
        return APART
    tank, run, chamber = (stretches[name].found for name in ("p_tank", "p_run", "p_chamber"))
    window = max(4.0 / track.frequency, 8.0 * max(run.step, chamber.step))
    edges = np.arange(track.start, track.end, window)
    if edges.size < FEWEST_WINDOWS:
        return APART
    a, b = (_demodulated(f, track.frequency, edges) for f in (run, chamber))
    cross, power = complex(np.vdot(b, a)), float(np.vdot(b, b).real)
    coherence = abs(cross) ** 2 / max(power * float(np.vdot(a, a).real), 1e-300)
    if coherence < 1.0 - BY_CHANCE ** (1.0 / (edges.size - 2)):
        return APART
    part = (tank.mean - run.mean) / max(tank.mean - chamber.mean, 1e-300)
    gain, in_phase = abs(cross) / power, cross.real > 0.5 * abs(cross)
    return FOLLOWS if in_phase and gain < ALIKE * part else DRIVES


def _demodulated(found: Fluctuation, frequency: float, edges: Array) -> NDArray[np.complex128]:
    """Complex amplitude of a fluctuation at a frequency [Hz] between the edges [s], (edges - 1,)."""
    turned = found.value * np.exp(-2j * np.pi * frequency * found.time)
    places = np.searchsorted(found.time, edges)
    return np.array([turned[a:b].mean() if b > a else 0.0 for a, b in pairwise(places)])


def _limit(stretch: Stretch) -> Quantity:
    """Rms that a line needs to be found, as share of the mean: the largest over the frequencies that are seen."""
    seen = [f for s in stretch.spectra for f in np.geomspace(s.frequency[EDGE], s.frequency[-1], 8)]
    if not seen:
        return Quantity.absent("too few samples for a spectrum")
    worst = max(detectable(stretch.spectra, float(f)) for f in seen)
    return Quantity(worst / stretch.level, "", why="a line that lasts through the liquid phase")


def _judged(liquid: Stretch, rough: Roughness, found: list[Line]) -> tuple[str, str]:
    """The verdict, and why."""
    bandwidth = liquid.found.nyquist
    own = [line for line in found if "at rest" not in line.cause]
    for line in own:
        size = np.sqrt(2.0) * (line.amplitude.value or 0.0)
        if line.course == "grows" or size > LIMIT:
            how = "grows" if line.course == "grows" else "holds"
            why = text(
                "an oscillation at {frequency:.1f} Hz {how}: {size:.1f} % of the mean chamber pressure either way",
                frequency=line.frequency.value, how=how, size=100.0 * size,
            )  # fmt: skip
            return UNSTABLE, why
    if bandwidth < SLOWEST_CHUG:
        return UNSEEN, text(
            "{rate:.0f} samples a second show nothing above {top:.0f} Hz", rate=2.0 * bandwidth, top=bandwidth
        )
    half = 0.5 * (rough.peak_to_peak.value or 0.0)
    if half > LIMIT:
        return ROUGH, text("the chamber pressure scatters by {half:.1f} % of its mean either way", half=100.0 * half)
    return SMOOTH_BURN, text(
        "the chamber pressure stays within {half:.1f} % of its mean, up to {top:.0f} Hz",
        half=100.0 * half,
        top=bandwidth,
    )
