"""t_fuel_out, t_fuel_gone: the solid fuel runs out; chamber pressure and thrust fall together while the feed does not
change, at once or over a second or two."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.record.signals import Signal
from hfanalysis.segment.fade import Fade, find_fade
from hfanalysis.segment.fire import GAP, GRID, SMOOTH, WINDOW, Response, response_of, thrust_falls
from hfanalysis.segment.fuel_at_once import Sudden, sudden_end

FADE_THRUST = 0.1
"""Least part of the thrust that has to go with it: a third of the pressure's, for the cell drifts with heat. Evidence:
a chamber that fades while the thrust does not is no end of the fuel (test_events.py)."""

STARTS = 0.4
"""Seconds after the line is full in which a chamber may start hard: no part of how a fire settles."""

BEFORE_LIQUID_END = 0.1
"""Seconds before t_v, and before its deviation, that say nothing of a fade: the last liquid leaves as froth."""


@dataclass(frozen=True)
class FuelEnd:
    """When the fade begins [s] and when it has ended, with their deviations; ``gone`` None: ``hidden`` says why.

    ``at_once``: a sudden fall, no fade.
    """

    time: float
    std: float
    gone: float | None
    gone_std: float
    hidden: str = ""
    at_once: bool = False


def find_fuel_end(
    signals: Mapping[str, Signal],
    ambient: float,
    t_feed: float,
    t_v: tuple[float, float] | None,
    end: float,
) -> FuelEnd | str:
    """When the fuel runs out, from signals with time counted from the opening; else the reason why it does not show.

    The chamber's response to the feed is (p_c - p_a) / sqrt(p_run - p_c): steady while the fire burns, two to five
    times smaller without it. At the end of the liquid (``t_v``) the feed itself changes, and windows do not reach
    across; from 0.08 s on either side of it a sudden fall is told from that of the liquid.

    Args:
        signals: p_chamber and p_run [Pa], thrust [N] where it is measured.
        ambient: pressure [Pa] as the chamber's sensor reads it.
        t_feed: the line is full [s].
        t_v: the liquid is gone [s], and its standard deviation [s]; None where that is not known.
        end: until when it is looked for [s].
    """
    if "p_run" not in signals:
        return "without p_run a fall of the chamber pressure cannot be told from one of the feed"
    response = response_of(signals, ambient, end, SMOOTH, GRID)
    if response is None:
        return "the chamber pressure is not above ambient for long enough"
    sudden = sudden_end(signals, response, ambient, t_feed, t_v, end)
    fade = None
    if t_v is not None:
        until = t_v[0] - BEFORE_LIQUID_END - t_v[1]
        fade = _fade(signals, response, t_feed, until if sudden is None else min(until, sudden.time - GAP))
    if fade is not None:
        return _faded(fade, sudden, t_v[0] if t_v is not None else np.inf)
    if sudden is not None:
        return FuelEnd(sudden.time, sudden.std, sudden.gone, sudden.gone_std, at_once=True)
    last = float(response.time[-1])
    return (
        f"chamber pressure and thrust do not fall against the feed up to {last:.1f} s, where the chamber nears ambient"
    )


def _faded(fade: Fade, sudden: Sudden | None, t_v: float) -> FuelEnd:
    """A fade's beginning and end; what is left of the fire may go out later, at once."""
    if fade.gone is not None:
        return FuelEnd(fade.begin, fade.begin_std, fade.gone, fade.gone_std)
    if sudden is not None:
        return FuelEnd(fade.begin, fade.begin_std, sudden.gone, sudden.gone_std)
    hidden = f"the fade from {fade.begin:.2f} s goes on to the end of the liquid at {t_v:.2f} s, which hides its own"
    return FuelEnd(fade.begin, fade.begin_std, None, np.inf, hidden)


def _fade(signals: Mapping[str, Signal], response: Response, t_feed: float, until: float) -> Fade | None:
    """A fade up to an instant [s] that the thrust, where it is measured, shares."""
    part = (response.time > t_feed + STARTS) & (response.time < until)
    fade = find_fade(response.time[part], response.value[part])
    if fade is None:
        return None
    blurred = response.width / np.sqrt(12.0)
    fade = replace(
        fade, begin_std=float(np.hypot(fade.begin_std, blurred)), gone_std=float(np.hypot(fade.gone_std, blurred))
    )
    late = until if fade.gone is None else min(fade.gone + WINDOW, until)
    shared = thrust_falls(signals, (fade.begin - WINDOW, fade.begin), (late - WINDOW, late), FADE_THRUST)
    return fade if shared else None
