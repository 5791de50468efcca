"""A thrust curve and the rocket's mass on an even clock, as the flight models take them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled
from hfanalysis.engine.nozzle import SUBSONIC, mach_at_area
from hfanalysis.engine.separation import LAWS, Law, expand_by

STEPS = 1000
"""Steps of a burn: 17 ms of a long one, 3 ms of a short one. Evidence: impulse is kept whatever their number; the
design point leaves its rail as its own system of equations has it to 1e-4 (docs/flight.md)."""

AMBIENTS = 33
"""Ambient pressures between which the nozzle's gain is taken linear. Evidence: it is exactly so while the nozzle flows
full."""

HIGHEST_AMBIENT = 1.1e5
"""Highest ambient pressure of the table [Pa]. Source: sea level has 101,325 Pa; no launch site has more than this."""


@dataclass(frozen=True)
class Curve:
    """Thrust [N] and the rocket's mass [kg] every ``step`` [s] from ignition to burn-out, (n + 1) each.

    ``mass_after``: what coasts [kg]. ``gain`` (n + 1, k): thrust [N] to add at the k ambient pressures that start at
    and follow by ``ambients`` [Pa]; one column of zeros where the thrust is what it is at the altitude. ``law``: of
    several that may hold, the number of that by which it was made.
    """

    step: float
    thrust: Array
    mass: Array
    mass_after: float
    gain: Array = field(default_factory=lambda: np.zeros((1, 1)))
    ambients: tuple[float, float] = (0.0, 1.0)
    law: int = 0

    @property
    def time(self) -> Array:
        """From ignition [s], (n + 1,)."""
        return np.asarray(self.step * np.arange(self.thrust.size), dtype=np.float64)

    @property
    def burn_time(self) -> float:
        """From ignition to burn-out [s]."""
        return self.step * (self.thrust.size - 1)

    @property
    def impulse(self) -> float:
        """Of the thrust without gain [N s]."""
        return float(np.trapezoid(self.thrust, dx=self.step))


def even_curve(time: Array, impulse: Array, mass: Array, mass_after: float, steps: int = STEPS) -> Curve:
    """The curve of which the impulse [N s] and the mass [kg] are known at increasing times [s], (n,) each, from the
    first on.

    ``mass_after``: what coasts [kg]. Thrust is the mean over a step's width about each node: the impulse is kept to
    rounding. Raises ValueError for a burn that takes no time.
    """
    burn = float(time[-1] - time[0])
    if not burn > 0.0:
        raise ValueError(f"a burn of {burn} s is none")
    step = burn / steps
    nodes = time[0] + step * np.arange(steps + 1)
    edges = np.concatenate(([time[0]], 0.5 * (nodes[1:] + nodes[:-1]), [time[-1]]))
    thrust = np.diff(np.interp(edges, time, impulse)) / np.diff(edges)
    return Curve(step, thrust, np.interp(nodes, time, mass), mass_after)


def accumulated(time: Array, thrust: Array) -> Array:
    """Impulse [N s] until each time [s], (n,), the thrust [N], (n,), taken linear between them.

    >>> accumulated(np.array([0.0, 1.0, 3.0]), np.array([0.0, 100.0, 100.0])).tolist()
    [0.0, 50.0, 250.0]
    """
    return np.concatenate(([0.0], np.cumsum(0.5 * (thrust[1:] + thrust[:-1]) * np.diff(time))))


def altitude_gain(
    gamma: Array,
    pressure: Array,
    stand: float,
    throat_area: float,
    exit_area: float,
    law: Law = "one-dimensional",
) -> tuple[Array, tuple[float, float]]:
    """Thrust [N] gained over the stand's ``stand`` ambient [Pa], (n, ambients), and those pressures: first and step
    [Pa].

    From the nozzle model on the chamber's ``pressure`` [Pa] and heat capacity ratio ``gamma`` [-], (n,) each; areas
    [m^2]; ``law`` of the nozzle, which finds where the flow separates at each of the two pressures. While the nozzle
    flows full it is (p_stand - p_a) A_e. A throat that does not choke at the stand gains
    nothing: what such a chamber holds at altitude is not what it holds there.
    """
    step = HIGHEST_AMBIENT / (AMBIENTS - 1)
    ambients: Array = step * np.arange(AMBIENTS, dtype=np.float64)
    gained = _gain(LAWS.index(law), gamma, pressure, stand, ambients, throat_area, exit_area)
    return gained, (0.0, step)


@compiled
def _gain(
    law: int, gamma: Array, pressure: Array, stand: float, ambients: Array, throat: float, exit_area: float
) -> Array:
    gained = np.zeros((pressure.size, ambients.size))
    for i in range(pressure.size):
        # thrust does not depend on the gas temperature: any R T will do
        _, here, _, _, regime = expand_by(law, gamma[i], 1e6, pressure[i], stand, throat, exit_area)
        if regime == SUBSONIC:
            continue
        full = mach_at_area(exit_area / throat, gamma[i], True)
        for k in range(ambients.size - 1, -1, -1):
            _, there, mach, _, _ = expand_by(law, gamma[i], 1e6, pressure[i], ambients[k], throat, exit_area)
            gained[i, k] = there - here
            if mach == full:  # and it flows full in thinner air, too
                gained[i, :k] = gained[i, k] + (ambients[k] - ambients[:k]) * exit_area
                break
    return gained
