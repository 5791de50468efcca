"""What kind of run a log holds: a hot fire, a cold flow, or a firing that did not light."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hfanalysis.segment.signals import Signal

COLDEST_FIRE = 700.0
"""Apparent c* [m/s] below which nothing burns: cold nitrous oxide gives 250 to 400, poor combustion 1000 and more."""

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

    ``mean_flow`` is the oxidizer's mean flow [kg/s] where mass and times give it, ``throat_area`` [m^2].
    """
    if "p_chamber" not in signals:
        return Kind(stated, "as stated: the log has no chamber pressure to tell by")
    start, end = span[0] + 0.4 * (span[1] - span[0]), span[1]
    excess = signals["p_chamber"].mean(start, end) - ambient
    if not np.isfinite(excess):
        return Kind(stated, "as stated: no good samples of the chamber pressure in the liquid phase")
    if mean_flow is not None and throat_area is not None:
        burning, why = _by_velocity(excess + ambient, mean_flow, throat_area, excess > 0.9 * ambient)
    elif "p_run" in signals:
        burning, why = _by_share(excess, signals["p_run"].mean(start, end) - ambient)
    else:
        burning, why = excess > ambient, f"the chamber stands {excess / 1e5:.1f} bar above ambient"
    if burning:
        return Kind("hot_fire", why)
    return Kind("cold_flow", why, misfire=stated == "hot_fire")


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
