"""A one-dimensional nozzle: choked or not, full, shocked or separated."""

from __future__ import annotations

import numpy as np
from numba import njit

SEPARATION = 0.4
"""Flow separates where it expands below this share of the ambient pressure (Summerfield, Foster and Swan 1954)."""


@njit(cache=True)
def exit_mach(ratio: float, gamma: float, supersonic: bool) -> float:
    """Mach number at A_e/A_t on one branch, by fixed Newton steps on the area-Mach relation."""
    power = 0.5 * (gamma + 1.0) / (gamma - 1.0)
    mach = 1.0 + 1.1 * np.sqrt(ratio - 1.0) if supersonic else 0.6 / ratio
    for _ in range(40):
        b = (1.0 + 0.5 * (gamma - 1.0) * mach * mach) * 2.0 / (gamma + 1.0)
        f = b**power / mach - ratio
        slope = b**power * (1.0 / (b * 1.0) - 1.0 / (mach * mach))
        step = f / slope
        new = mach - step
        new = max(new, 0.5 * (1.0 + mach)) if supersonic else min(max(new, 0.5 * mach), 0.5 * (1.0 + mach))
        if abs(new - mach) < 1e-13:
            break
        mach = new
    return mach


@njit(cache=True)
def first_ratio(ratio: float, gamma: float) -> float:
    """p_e/p_c of the flow that is just choked and subsonic behind the throat."""
    m = exit_mach(ratio, gamma, False)
    return float((1.0 + 0.5 * (gamma - 1.0) * m * m) ** (-gamma / (gamma - 1.0)))


@njit(cache=True)
def outflow(p: float, rt: float, gamma: float, throat: float, area: float, ambient: float) -> float:
    """Mass flow [kg/s] out of a chamber."""
    if p <= ambient:
        return 0.0
    if p > 1.3 * ambient or ambient / p < first_ratio(area / throat, gamma):
        power = 0.5 * (gamma + 1.0) / (gamma - 1.0)
        return float(throat * p * np.sqrt(gamma / rt) * (2.0 / (gamma + 1.0)) ** power)
    return _subsonic(p, rt, gamma, area, ambient)[0]


@njit(cache=True)
def _subsonic(p: float, rt: float, gamma: float, area: float, ambient: float) -> tuple[float, float]:
    t = (ambient / p) ** ((gamma - 1.0) / gamma)
    speed = np.sqrt(2.0 * gamma / (gamma - 1.0) * rt * (1.0 - t))
    flow = ambient / (rt * t) * speed * area
    return flow, flow * speed


@njit(cache=True)
def thrust(p: float, rt: float, gamma: float, throat: float, area: float, ambient: float, separated: float) -> float:
    """Thrust [N]; ``separated`` of the way from a shock inside to free separation (Summerfield's criterion)."""
    if p <= ambient:
        return 0.0
    ratio = area / throat
    if p <= 1.3 * ambient and ambient / p >= first_ratio(ratio, gamma):
        return _subsonic(p, rt, gamma, area, ambient)[1]
    flow = outflow(p, rt, gamma, throat, area, ambient)
    m = exit_mach(ratio, gamma, True)
    t = 1.0 / (1.0 + 0.5 * (gamma - 1.0) * m * m)
    p_e = p * t ** (gamma / (gamma - 1.0))
    if ambient < p_e * (1.0 + 2.0 * gamma / (gamma + 1.0) * (m * m - 1.0)):
        f = flow * m * np.sqrt(gamma * rt * t) + (p_e - ambient) * area
    else:
        f = flow * _speed_at(flow, rt, gamma, area, ambient)
    if separated == 0.0 or p_e >= SEPARATION * ambient:
        return f
    p_s = SEPARATION * ambient
    x = (p_s / p) ** ((gamma - 1.0) / gamma)
    speed = np.sqrt(2.0 * gamma / (gamma - 1.0) * rt * (1.0 - x))
    cut = flow * rt * x / (p_s * speed)
    return f + separated * (flow * speed + (p_s - ambient) * cut - f)


@njit(cache=True)
def _speed_at(flow: float, rt: float, gamma: float, area: float, pressure: float) -> float:
    """Speed [m/s] of a flow [kg/s] that leaves an area subsonically at a pressure; total temperature is kept."""
    g = flow * rt / (pressure * area)
    h = 2.0 * gamma / (gamma - 1.0) * rt
    # g (1 - v^2/h) = v
    return (np.sqrt(1.0 + 4.0 * g * g / h) - 1.0) * h / (2.0 * g)
