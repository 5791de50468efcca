"""What a line can be: the feed, the combustion, the chamber's gas, the stand, the mains, or something faster."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from hfanalysis.inference.oscillations.lines import Track
from hfanalysis.performance.stability.modes import Mode

MAINS = (50.0, 60.0)
"""[Hz] of the world's mains."""

MULTIPLES = 5
"""Of the mains' frequency that are looked at. Source: rectifiers hum at its even ones, transformers at its odd ones."""

MAINS_WANDER = 0.004
"""Of the mains' frequency. Source: EN 50160 keeps it within 1 % for 99.5 % of a year; it is usually within 0.4 %."""

ALIKE = 2.0
"""Factor within which an amplitude at rest and one in the burn are the same."""

FEED = "coupled with the feed: run line and chamber swing together (chugging)"
FOLLOWED = "the feed, or the combustion and the run line follows it"
STAND = "the stand: the thrust swings and the chamber's pressure does not"
UNTOLD = "cannot be told"


DRIVES, FOLLOWS, APART = "drives", "follows", "apart"
"""How the run line swings with the chamber: more than the chamber makes it, or against it; as much as that; or not at a
fixed phase."""


@dataclass(frozen=True)
class Seen:
    """A line in one channel: the ``track``, and the ``share`` of the channel's mean that its rms is [-]."""

    channel: str
    track: Track
    share: float


@dataclass(frozen=True)
class Shown:
    """What else is known where a line is: which channels could show it, and what is there at rest.

    ``limits``: by channel the rms that would be seen at this frequency, as share of its mean [-]; infinite where its
    rate is too low. ``rest``: by channel the lines before the opening. ``rest_limits``: rms [SI] that would be seen
    there. ``run_line``: how run line and chamber swing together. ``sampling`` [Hz] of the line's channel.
    """

    limits: dict[str, float]
    rest: dict[str, list[Track]]
    rest_limits: dict[str, float]
    run_line: str
    sampling: float


def cause(seen: Sequence[Seen], shown: Shown, modes: Iterable[Mode] | None) -> str:
    """In words what a line, as the channels of ``seen`` show it, can be; ``modes``: those of the engine, where they are
    known."""
    channels = {s.channel for s in seen}
    if all(_at_rest(s, shown) for s in seen):
        hum = _mains(seen[0], shown.sampling)
        return f"{hum}: it is there at rest, too" if hum else "the sensors or their supply: it is there at rest, too"
    if {"p_run", "p_chamber"} <= channels and shown.run_line == DRIVES:
        return FEED
    if channels == {"thrust"} and shown.limits.get("p_chamber", np.inf) < 0.5 * seen[0].share:
        return STAND
    possible = _possible(seen, shown, modes)
    if modes is None:
        possible.append("a mode of the engine, whose state is not known")
    if len(possible) == 1 and possible != [FOLLOWED]:
        return possible[0]
    return f"{UNTOLD}: {_or(possible)}" if possible else UNTOLD


def _possible(seen: Sequence[Seen], shown: Shown, modes: Iterable[Mode] | None) -> list[str]:
    """What the channels do not exclude."""
    first = seen[0]
    channels, track = {s.channel for s in seen}, first.track
    out = []
    if "p_run" in channels:
        out.append(FOLLOWED if "p_chamber" in channels else "the feed")
    elif "p_run" not in shown.limits or shown.limits["p_run"] > first.share:
        out.append("the feed, which the run line's channel could not show")
    if channels == {"thrust"}:
        out.append("the stand")
    hum = _mains(first, shown.sampling)
    rest_shows = shown.rest_limits.get(first.channel, np.inf) < track.rms
    if hum and not rest_shows:
        out.append(hum)
    for mode in modes or ():
        if mode.has(track.frequency, track.reach):
            out.append(mode.name)
        elif any(mode.has(f, track.reach) for f in _faster(track.frequency, shown.sampling, mode.highest)):
            out.append(f"{mode.name}, faster than this rate shows")
    return out


def _at_rest(seen: Seen, shown: Shown) -> bool:
    """Whether a channel has the same line, as large, at rest."""
    track = seen.track
    return any(
        abs(own.frequency - track.frequency) < own.reach + track.reach + 1.0 / max(own.end - own.start, 0.5)
        and 1.0 / ALIKE < own.rms / track.rms < ALIKE
        for own in shown.rest.get(seen.channel, ())
    )


def _mains(seen: Seen, sampling: float) -> str:
    """The mains' frequency of which a line is a multiple, as it appears at this sampling rate [Hz]; "" where none."""
    for mains in MAINS:
        for multiple in range(1, MULTIPLES + 1):
            true = multiple * mains
            if abs(aliased(true, sampling) - seen.track.frequency) < seen.track.reach + MAINS_WANDER * true:
                times = "" if multiple == 1 else f"{multiple} times "
                return f"{times}the mains' {mains:.0f} Hz"
    return ""


def aliased(frequency: float, sampling: float) -> float:
    """The frequency [Hz] at which another one is seen at a ``sampling`` rate [Hz].

    >>> aliased(60.0, 100.0)
    40.0
    """
    return abs(frequency - sampling * round(frequency / sampling))


def _faster(frequency: float, sampling: float, highest: float) -> list[float]:
    """Frequencies [Hz] up to ``highest`` that look the same at this rate."""
    count = int(highest // sampling) + 1
    return [k * sampling + sign * frequency for k in range(1, count + 1) for sign in (-1.0, 1.0)]


def _or(names: Sequence[str]) -> str:
    return " or ".join((", ".join(names[:-1]), names[-1])) if len(names) > 1 else names[0]
