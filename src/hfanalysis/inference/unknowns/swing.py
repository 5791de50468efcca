"""A flow that swings at a frequency, for a while (chugging): an oscillation that run line and chamber share.

Means over a tenth of a second do not show it; the spectrum of the samples does, without a model. An oscillation of the
combustion alone is not seen by the run line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi, sin, tanh
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, median_filter

from hfanalysis.arrays import Array
from hfanalysis.engine.effect import Parameter
from hfanalysis.engine.sites import AT_FLOW, INJECTOR_FACTOR, switch, term
from hfanalysis.inference.fitting.fit import Fit
from hfanalysis.inference.fitting.hypothesis import Free, Hypothesis
from hfanalysis.inference.observations.observed import Observed
from hfanalysis.inference.oscillations.fluctuation import fluctuation
from hfanalysis.inference.oscillations.lines import lines
from hfanalysis.inference.places import SourcePlace
from hfanalysis.inference.unknown import POINTS, Described, History, Samples, nameless_effect
from hfanalysis.products import diagnosis
from hfanalysis.quantity import Quantity
from hfanalysis.record.signals import Signal
from hfanalysis.sentences import text
from hfanalysis.wording.numbers import said_of

SAMPLE_STEP = 5e-3
"""Seconds over which samples are averaged first."""

SLOWEST, FASTEST = 2.0, 25.0
"""Frequencies [Hz] that are looked at: slower ones are seen in the means, faster ones are mostly the combustion's."""

SMOOTH = 0.25
"""Seconds of the smooth course that is taken off (standard deviation of a Gaussian)."""

WINDOWS = 1.0, 2.0, 4.0
"""Seconds that are looked at at once; each begins a quarter of that after the last."""

NEIGHBORS = 12.0
"""Over the length of a window: frequencies [Hz] about one whose median is the background. A peak takes a third of
them."""

EACH = 6.0
"""Times the background that the power in run line and chamber has to reach, each. Source: the power of noise in a
spectrum is exponentially distributed; exp(-6) is one in 400 by chance, and both at once are one in 160,000."""

LOUD = 3.0
"""Times the background that the chamber's power reaches half of the time where its combustion swings by itself.
Evidence: without it, what the run line did for a moment at the combustion's frequency was a swing of the flow
(tests/inference/unknowns/test_swing.py)."""

TURNS = 4.0
"""That a swing takes at least; what comes and goes at once has a broad spectrum of its own."""

FINE = 51
"""Frequencies that are tried between those of the spectrum."""

BLUR = 0.15
"""Seconds over which its size is averaged (standard deviation of a Gaussian)."""

WILD = 10.0
"""Times the usual distance from the median of three from which on a mean is wild."""

LEAST_LOSS = 1e4
"""Loss across feed and injector [Pa] below which it says nothing of the flow."""

LEAD_IN = 0.3
"""Seconds after the opening that are left out."""

SHARE, PHASE, FREQUENCY, START, END = range(5)

EDGE = 0.1
"""Seconds in which it comes and goes."""

SURE = 0.3
"""Standard deviation of its phase, and of its size relative to itself, as the spectrum has them."""

POINTS_A_TURN = 12
"""Instants of a turn at which its history is given."""


@term
def _swinging(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_FLOW:
        there = 0.5 * (tanh((t - p[START]) / EDGE) - tanh((t - p[END]) / EDGE))
        site[INJECTOR_FACTOR] += p[SHARE] * there * sin(2.0 * pi * p[FREQUENCY] * t + p[PHASE])


@switch
def _begins(t, env, c, p, x):  # type: ignore[no-untyped-def]
    return t - p[START] + 2.0 * EDGE


EFFECT = nameless_effect(
    "swing",
    "injector",
    "a flow that swings",
    (
        Parameter("share", "-", "of the flow", 0.01),
        Parameter("phase", "-", "at the opening", 1.0),
        Parameter("frequency", "Hz", "of the swing", 1.0, center=1.0, given=True),
        Parameter("start", "s", "of the swing", 1.0, center=1.0, given=True),
        Parameter("end", "s", "of the swing", 1.0, center=1.0, given=True),
    ),
    term=_swinging,
    switch=_begins,
)
"""An injector that passes more and less by ``share``, and with it a flow that swings."""

SHARE_OF_SWING, PHASE_OF_SWING = (f"{EFFECT.name}.{p.name}" for p in EFFECT.parameters[:2])
"""Names of its size and phase in a hypothesis."""


@dataclass(frozen=True)
class Swing(Described):
    """An injector that passes more and less by ``share`` at ``frequency`` [Hz], as sin(2 pi f t + ``phase``), from
    ``start`` to ``end`` [s after the opening]."""

    share: float
    frequency: float
    phase: float
    start: float
    end: float
    log_evidence: float
    place = SourcePlace("swing of the flow", "injector", "1", 0.01)
    known_by = "frequency"

    @classmethod
    def in_samples(cls, samples: Samples) -> Swing | None:
        """The oscillation [Hz] that run line and chamber share while the flow is steady; None where they share none."""
        signals, end = samples.signals, samples.steady
        time = np.arange(LEAD_IN, end, SAMPLE_STEP)
        if not {"p_tank", "p_run", "p_chamber"} <= set(signals) or time.size * SAMPLE_STEP < WINDOWS[0]:
            return None
        if max(signals["p_run"].step, signals["p_chamber"].step) > SAMPLE_STEP:
            return None
        rough = {name: _rough(signals[name], time) for name in ("p_run", "p_chamber", "thrust") if name in signals}
        combustion = _combustion(rough)
        found: list[_Peak] = []
        trials = 0
        for length in WINDOWS:
            count = round(length / SAMPLE_STEP)
            if count <= time.size:
                frequency, spectra = _spectra(rough, count)
                trials += spectra["p_run"].power.size
                found += _peaks(frequency, spectra, time[:: count // 4], length, combustion)
        if not found:
            return None
        best = max(found, key=lambda peak: peak.evidence)
        tank, line, chamber = (float(np.median(signals[name].at(time))) for name in ("p_tank", "p_run", "p_chamber"))
        # by the feed's loss, which goes with the flow's square; the line's pressure holds a part of the swing back
        share = 0.5 * (tank - chamber) / max((tank - line) * (line - chamber), LEAST_LOSS**2)
        peak = best._replace(frequency=_line_at(signals["p_chamber"], best, end))
        swing = _swing_at(rough["p_run"], time, peak, share, float(np.log(trials)))
        return swing if (swing.end - swing.start) * swing.frequency >= TURNS else None

    def added_to(self, fitted: Fit) -> tuple[Hypothesis, Array]:
        active = EFFECT.at(**{p.name: getattr(self, p.name) for p in EFFECT.parameters})
        free = (Free(SHARE_OF_SWING, self.share, SURE * self.share), Free(PHASE_OF_SWING, self.phase, SURE))
        return fitted.hypothesis.with_active(active, free), np.zeros(2)

    def history(self, fitted: Fit, observed: Observed) -> History:
        """What the flow swings by [-], as part of it, over time [s after the opening], with points enough for its
        frequency."""
        end, share, phase = observed.last, fitted.values[SHARE_OF_SWING], fitted.values[PHASE_OF_SWING]
        time = np.linspace(0.0, end, max(POINTS, round(POINTS_A_TURN * self.frequency * end)))
        std = SURE * np.abs(self._at(time, share, phase + 0.5 * np.pi))
        sizes = {
            "source": Quantity(share, self.place.unit, fitted.stds[SHARE_OF_SWING]),
            "frequency": Quantity(self.frequency, "Hz"),
        }
        return History(self.place, time, self._at(time, share, phase), std, EDGE, sizes)

    def _at(self, time: Array, share: float, phase: float) -> Array:
        """What the injector passes more at ``time`` (n,) [s], as part of what it passes."""
        there = 0.5 * (np.tanh((time - self.start) / EDGE) - np.tanh((time - self.end) / EDGE))
        return np.asarray(share * there * np.sin(2.0 * np.pi * self.frequency * time + phase))

    @staticmethod
    def words(row: diagnosis.Place, known: Quantity, where: str, unit: str) -> str:
        return text(
            "From {start:.1f} to {end:.1f} s the flow swings by {swing} at {frequency:.2g} Hz: run line and chamber "
            "show it in opposite directions.",
            start=row.t_start.value,
            end=row.t_end.value,
            swing=said_of(row.source, unit, ".2g", ".1g"),
            frequency=known.value,
        )


class _Spectrum(NamedTuple):
    """Of every window (windows, frequencies), and its power over the background."""

    values: NDArray[np.complex128]
    power: Array


class _Peak(NamedTuple):
    """The frequency [Hz], the window [s], and the log evidence, but for the number of those that it is chosen from."""

    frequency: float
    start: float
    length: float
    evidence: float


def _combustion(rough: Mapping[str, Array]) -> Array:
    """Frequencies [Hz] at which the chamber swings most of the time and the run line does not: what that does there by
    chance, for a moment, is no swing of the flow."""
    frequency, spectra = _spectra(rough, round(WINDOWS[0] / SAMPLE_STEP))
    line, chamber = (np.median(spectra[name].power, axis=0) for name in ("p_run", "p_chamber"))
    return np.asarray(frequency[(chamber > LOUD) & (line < LOUD)])


def _peaks(
    frequency: Array, spectra: Mapping[str, _Spectrum], starts: Array, length: float, combustion: Array
) -> list[_Peak]:
    """The strongest of the frequencies at which run line and chamber swing against each other; none where none does.

    Its foothills stand out of the background as well, and may do so more clearly: the largest swing counts.
    ``combustion`` [Hz]: frequencies that the chamber has by itself.
    """
    line, chamber = spectra["p_run"], spectra["p_chamber"]
    cross = line.values * chamber.values.conj()
    own = np.abs(frequency[:, None] - combustion).min(axis=1, initial=np.inf) < 1.0 / WINDOWS[0]
    shared = (line.power > EACH) & (chamber.power > EACH) & (cross.real < 0.0) & ~own
    if not shared.any():
        return []
    row, column = np.unravel_index(int(np.argmax(np.where(shared, np.abs(cross), 0.0))), cross.shape)
    power = float(sum(spectrum.power[row, column] for spectrum in spectra.values()))
    evidence = power - len(spectra) * (1.0 + np.log(power / len(spectra)))
    return [_Peak(float(frequency[column]), float(starts[row]), length, float(evidence))]


def _rough(signal: Signal, time: Array) -> Array:
    """A signal less its smooth course; a single wild mean gets the median of its neighbors."""
    values = signal.reduced(SAMPLE_STEP).at(time)
    middle = median_filter(values, 3, mode="nearest")
    off = np.abs(values - middle)
    values = np.where(off > WILD * np.mean(off), middle, values)
    return np.asarray(values - gaussian_filter1d(values, SMOOTH / SAMPLE_STEP, mode="nearest"))


def _spectra(rough: Mapping[str, Array], count: int) -> tuple[Array, dict[str, _Spectrum]]:
    """Frequencies [Hz], and the spectrum of every window of so many samples."""
    frequency: Array = np.asarray(np.fft.rfftfreq(2 * count, SAMPLE_STEP), dtype=np.float64)
    inside = (frequency >= SLOWEST) & (frequency <= FASTEST)
    wide = 2 * round(0.5 * NEIGHBORS / (count * SAMPLE_STEP) / float(frequency[1])) + 1
    out = {}
    for name, values in rough.items():
        starts = np.arange(0, values.size - count + 1, count // 4)
        windows = np.stack([values[i : i + count] for i in starts]) * np.hanning(count)
        spectrum = np.fft.rfft(windows, 2 * count, axis=1)
        power = np.abs(spectrum) ** 2
        # a window may be quiet by chance, or loud by the oscillation itself: the background is that of all of them
        background = np.median(median_filter(power, (1, wide), mode="nearest"), axis=0) / np.log(2.0)
        out[name] = _Spectrum(spectrum[:, inside], (power / background)[:, inside])
    return frequency[inside], out


def _line_at(chamber: Signal, peak: _Peak, end: float) -> float:
    """Frequency [Hz] of the chamber's line that a peak is of, as everywhere else; its own where there is none."""
    whole = fluctuation(chamber, LEAD_IN, end)
    tracks = lines(whole) if whole is not None else []
    width = 1.0 / peak.length
    after, before = peak.start, peak.start + peak.length
    during = [track for track in tracks if track.start < before and track.end > after]
    same = [track for track in during if abs(track.frequency - peak.frequency) < width]
    if same:
        return min(same, key=lambda track: abs(track.frequency - peak.frequency)).frequency
    part = fluctuation(chamber, peak.start, peak.start + peak.length)
    if part is None:
        return peak.frequency
    near = peak.frequency + np.linspace(-0.5, 0.5, FINE) * width
    turned = part.value * np.hanning(part.value.size)
    strength = [abs(np.sum(turned * np.exp(-2j * np.pi * f * part.time))) for f in near]
    return float(near[int(np.argmax(strength))])


def _swing_at(line: Array, time: Array, peak: _Peak, by_pascal: float, price: float) -> Swing:
    """Size, phase and duration; ``by_pascal``: the injector's share for each pascal that the run line swings by."""
    inside = (time >= peak.start) & (time < peak.start + peak.length)
    frequency = peak.frequency
    turning = gaussian_filter1d(
        2.0 * line * np.exp(-2j * np.pi * frequency * time), BLUR / SAMPLE_STEP, mode="constant"
    )
    mean = complex(np.mean(turning[inside]))
    size = np.real(turning * np.conj(mean)) / abs(mean)
    strong = size > 0.5 * float(size[inside].max())
    middle = int(np.flatnonzero(inside)[int(np.argmax(size[inside]))])
    begin = middle - int(np.argmin(np.r_[strong[middle::-1], False])) + 1
    end = middle + int(np.argmin(np.r_[strong[middle:], False]))
    swing = float(np.mean(size[begin:end]))
    # more flow, more loss, less pressure in the run line: a sine of the flow is minus a sine there
    phase = (float(np.angle(mean)) - 0.5 * np.pi) % (2.0 * np.pi)
    return Swing(by_pascal * swing, frequency, phase, float(time[begin]), float(time[end - 1]), peak.evidence - price)


UNKNOWN = Swing
