"""What an engine can do at best and at worst: bounds of thrust coefficient, c* and specific impulse.

They are wide on purpose: outside of them no engine of nitrous oxide and a hydrocarbon is, however well or badly it
burns.
"""

from __future__ import annotations

from hfanalysis.engine.thrust_coefficient import TOLERANCE, flows_full, possible

SEPARATED = 0.15
"""Part of a convergent nozzle's thrust that one whose exit is not known may lose [-]. Source: Sutton, Rocket Propulsion
Elements: correction factors of thrust 0.92 to 1.0; a fifth part beyond it for separated flow."""
SLOWEST_FIRE, FASTEST_FIRE = 800.0, 1720.0
"""c* [m/s] of a fire that hardly burns, and of the best. Source: equilibrium of nitrous oxide and paraffin, 1640 m/s at
its best at 20 bar, and 5 %."""
SLOWEST_COLD = 250.0
"""c* [m/s] of cold nitrous oxide gas, least. Source: sqrt(R T) / Gamma at 180 K, 273 m/s."""
BALANCE = (1350.0, 1680.0)
"""c* [m/s] by which propellant and the integral of p_c give a throat that is not stated, on either side. Evidence:
equilibrium, frozen in the nozzle, at 20 bar has 1318 at O/F 3, 1546 at 6 to 7 and 1514 at 9 (oxidizer of 1.5 MJ/kg);
test_detectors.py."""
GOOD_FIRE = 1000.0
"""c* [m/s] of a fire that burns so badly that it is worth a word [m/s]. Source: two thirds of equilibrium."""
RICHEST = 1.7
"""All propellant over oxidizer where the fuel is not known [-]. Source: O/F 1.4, richer than any hybrid burns."""

Range = tuple[float, float]


def thrust_coefficients(pressure: float, ambient: float, throat: float = 1.0, exit_area: float | None = None) -> Range:
    """F / (p_c A_t) that a nozzle can have at a chamber ``pressure`` [Pa, absolute], losses included.

    Of this ``throat`` and ``exit_area`` [m^2]; without an exit, or with one that the flow would not fill, from
    convergent to fully expanded.
    """
    if exit_area is not None and not (exit_area > throat and flows_full(pressure, ambient, exit_area / throat)):
        exit_area = None
    low, high = possible(pressure, ambient, throat, exit_area)
    lost = SEPARATED if exit_area is None else TOLERANCE
    return max(low, 0.0) * (1.0 - lost), high * (1.0 + TOLERANCE)


def choked(pressure: float, ambient: float) -> bool:
    """Whether a nozzle is choked at a chamber ``pressure`` [Pa, absolute], with room."""
    return pressure > 2.2 * ambient
