"""What the gas loses between the chamber's head and the nozzle, where the port is not much wider than the throat.

At the head the gas is at rest; along the port heat and fuel come in, neither with momentum along it, and friction is
left out beside that. It leaves at the Mach number M_2, so that (Hill and Peterson, Mechanics and Thermodynamics of
Propulsion, chapter 3: heat and mass at constant area)

    p_head = p_2 (1 + gamma M_2^2)

Behind the grain the flow widens into the post-chamber, of area A_c, before it goes to the throat. Between two limits:
it widens without loss, and M_2 is that of A_p / A_t; or it is a jet that mixes (Borda and Carnot),

    p_2 A_c + mdot u_2 = p_3 A_c (1 + gamma M_3^2),   M_3 that of A_c / A_t

A port that would need M_2 > 1 chokes: it, and no longer the throat, sets the flow.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.engine.nozzle import mach_at_area, pressure_ratio


@compiled
def head_over_nozzle(gamma: float, port: float, chamber: float, recovery: float) -> float:
    """Pressure at the head over the stagnation pressure before the nozzle [-].

    ``port`` and ``chamber``: their areas over the throat's [-]; ``recovery``: how much of the way the widening goes
    from a jet that mixes (0) to a flow without loss (1).

    >>> round(head_over_nozzle(1.24, 1.3, 2.87, 1.0), 2), round(head_over_nozzle(1.24, 1.3, 2.87, 0.0), 2)
    (1.14, 1.18)
    """
    smooth = _smooth(gamma, port)
    return float(smooth + (1.0 - recovery) * (_mixed(gamma, port, max(chamber, port, 1.0)) - smooth))


@compiled
def stagnation_over_static(gamma: float, chamber: float) -> float:
    """Stagnation over static pressure [-] where the area is ``chamber`` times the throat's [-], of a choked nozzle.

    >>> round(stagnation_over_static(1.24, 2.87), 3)
    1.028
    """
    return 1.0 / pressure_ratio(mach_at_area(max(chamber, 1.0), gamma, False), gamma)


@compiled
def _smooth(gamma: float, port: float) -> float:
    """Widening without loss; a choked port loses what it takes to pass the flow by a wider throat."""
    mach = mach_at_area(max(port, 1.0), gamma, False)
    return (1.0 + gamma * mach * mach) * pressure_ratio(mach, gamma) / min(port, 1.0)


@compiled
def _mixed(gamma: float, port: float, chamber: float) -> float:
    """Widening as a jet that mixes: mass and momentum over the step give M_2 by a quadratic in its square."""
    half, wide = 0.5 * (gamma - 1.0), chamber / port
    third = mach_at_area(chamber, gamma, False)
    carried = third * sqrt(1.0 + half * third * third) * wide
    sum_ = wide * (1.0 + gamma * third * third) / carried
    # (wide + gamma x) = sum_ sqrt(x (1 + half x)), x = M_2^2
    a, b, c = gamma * gamma - sum_ * sum_ * half, 2.0 * gamma * wide - sum_ * sum_, wide * wide
    under = b * b - 4.0 * a * c
    x = 2.0 * c / (-b + sqrt(under)) if under >= 0.0 and -b > 0.0 else 1.0
    x = min(x, 1.0)
    second = carried / sqrt(x * (1.0 + half * x))
    return (1.0 + gamma * x) * second * pressure_ratio(third, gamma)


def heads_over_nozzle(gamma: Array, port: Array, chamber: float, recovery: float) -> Array:
    """:func:`head_over_nozzle` along a history, (n,): ``gamma`` and ``port`` (n,) [-]; NaN where either is."""
    return _along(np.ascontiguousarray(gamma), np.ascontiguousarray(port), chamber, recovery)


@compiled
def _along(gamma: Array, port: Array, chamber: float, recovery: float) -> Array:
    out = np.full(gamma.size, np.nan)
    for i in range(gamma.size):
        if gamma[i] > 1.0 and port[i] > 0.0:
            out[i] = head_over_nozzle(gamma[i], port[i], chamber, recovery)
    return out
