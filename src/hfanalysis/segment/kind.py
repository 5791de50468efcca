"""What kind of run a log holds: a hot fire, a cold flow, or a firing that did not light."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.record.signals import Signal
from hfanalysis.sentences import said, text

COLDEST_FIRE = 700.0
"""Apparent c* [m/s] below which nothing burns: cold nitrous oxide gives 250 to 400, poor combustion 1000 and more.
Source: c* = sqrt(R T / W) / Gamma(gamma) of nitrous oxide gas is 273 to 359 m/s at 180 to 300 K (CoolProp)."""

BRIEFEST_FIRE = 1.0
"""Seconds that a fire lasts at least whose fuel is gone early in the liquid phase; an igniter is out before. Evidence:
test_events.py: a fire that is out early in the liquid phase is one, an igniter is none."""

COLD_PRESSURE_SHARE = 0.18
"""Chamber over run-line pressure, above ambient, below which the flow is cold, where the geometry is unknown."""


@dataclass(frozen=True)
class Kind:
    """``name``: hot_fire or cold_flow; ``why``: from which figure; ``misfire``: stated as a fire, but did not light."""

    name: str
    why: str
    misfire: bool = False


def recognise(
    signals: Mapping[str, Signal],
    stated: str,
    ambient: float,
    span: tuple[float, float],
    mean_flow: float | None,
    throat_area: float | None,
) -> Kind:
    """Decide from the chamber pressure over the liquid phase ``span`` [s]; ``ambient`` [Pa] as the chamber reads it.

    The last three fifths of it, or where nothing burns there the fiercest second: fuel may be gone before the liquid.
    ``mean_flow`` is the oxidizer's mean flow [kg/s] where mass and times give it, ``throat_area`` [m^2].
    """
    if "p_chamber" not in signals:
        return Kind(stated, "as stated: the log has no chamber pressure to tell by")

    def judged(start: float, end: float) -> tuple[bool, str]:
        excess = signals["p_chamber"].mean(start, end) - ambient
        if mean_flow is not None and throat_area is not None:
            return _by_velocity(excess + ambient, mean_flow, throat_area, excess > 0.9 * ambient)
        if "p_run" in signals:
            return _by_share(excess, signals["p_run"].mean(start, end) - ambient)
        return excess > ambient, text("the chamber stands {excess} above ambient", excess=said(excess, "bar", ".1f"))

    start, end = span[0] + 0.4 * (span[1] - span[0]), span[1]
    if not np.isfinite(signals["p_chamber"].mean(start, end)):
        return Kind(stated, "as stated: no good samples of the chamber pressure in the liquid phase")
    burning, why = judged(start, end)
    if burning:
        return Kind("hot_fire", why)
    if (brief := _fiercest(signals["p_chamber"], span)) is not None:
        burning, of_brief = judged(*brief)
        if burning:
            return Kind("hot_fire", f"{of_brief}, from {brief[0] - span[0]:.1f} to {brief[1] - span[0]:.1f} s")
    return Kind("cold_flow", why, misfire=stated == "hot_fire")


def _fiercest(chamber: Signal, span: tuple[float, float]) -> tuple[float, float] | None:
    """Of the stretch of BRIEFEST_FIRE in which the chamber's pressure is held highest, the weaker half; None where the
    span holds none."""
    half = 0.5 * BRIEFEST_FIRE
    begins = np.arange(span[0], span[1] - BRIEFEST_FIRE, 0.2 * half)
    means = np.array([[chamber.mean(t, t + half), chamber.mean(t + half, t + 2.0 * half)] for t in begins])
    held = means.min(axis=1, initial=np.inf) if begins.size else np.empty(0)
    if not np.isfinite(held).any():
        return None
    best = int(np.nanargmax(held))
    begin = float(begins[best]) + half * float(np.argmin(means[best]))
    return begin, begin + half


def _by_velocity(pressure: float, flow: float, throat_area: float, choked: bool) -> tuple[bool, str]:
    velocity = pressure * throat_area / flow
    side = "above" if velocity > COLDEST_FIRE else "below"
    why = f"apparent c* of {velocity:.0f} m/s at {flow:.2f} kg/s, {side} the {COLDEST_FIRE:.0f} m/s of any fire"
    return velocity > COLDEST_FIRE and choked, why


def _by_share(excess: float, run: float) -> tuple[bool, str]:
    share = excess / run if run > 0.0 else 0.0
    side = "above" if share > COLD_PRESSURE_SHARE else "below"
    return (
        share > COLD_PRESSURE_SHARE,
        f"chamber at {100 * share:.0f} % of the run-line pressure, {side} {100 * COLD_PRESSURE_SHARE:.0f} %",
    )
