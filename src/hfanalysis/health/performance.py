"""What an engine can do at best and at worst: bounds of thrust coefficient, c* and specific impulse.

They are wide on purpose: outside of them no engine of nitrous oxide and a hydrocarbon is, however well or badly it
burns.
"""

from __future__ import annotations

from hfanalysis.engine.thrust_coefficient import possible

NOZZLE = (0.85, 1.08)
"""Losses of a nozzle at worst, and what alignment of a cell may add at best [-]. Source: Sutton, Rocket Propulsion
Elements: correction factors of thrust 0.92 to 1.0; a fifth part beyond it for separated flow."""
SLOWEST_FIRE, FASTEST_FIRE = 800.0, 1720.0
"""c* [m/s] of a fire that hardly burns, and of the best. Source: equilibrium of nitrous oxide and paraffin, 1640 m/s at
its best at 20 bar, and 5 %."""
SLOWEST_COLD = 250.0
"""c* [m/s] of cold nitrous oxide gas, least. Source: sqrt(R T) / Gamma at 180 K, 273 m/s."""
GOOD_FIRE = 1000.0
"""c* [m/s] of a fire that burns so badly that it is worth a word [m/s]. Source: two thirds of equilibrium."""
RICHEST = 1.7
"""All propellant over oxidizer where the fuel is not known [-]. Source: O/F 1.4, richer than any hybrid burns."""

Range = tuple[float, float]


def thrust_coefficients(pressure: float, ambient: float) -> Range:
    """F / (p_c A_t) that a nozzle can have at a chamber ``pressure`` [Pa, absolute]: from convergent to fully expanded,
    losses included.
    """
    low, high = possible(pressure, ambient, 1.0, None)
    return max(low, 0.0) * NOZZLE[0], high * NOZZLE[1]


def choked(pressure: float, ambient: float) -> bool:
    """Whether a nozzle is choked at a chamber ``pressure`` [Pa, absolute], with room."""
    return pressure > 2.2 * ambient
