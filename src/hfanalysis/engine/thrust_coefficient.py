"""What thrust over p_c A_t a nozzle can have, whatever burns in front of it."""

from __future__ import annotations

from hfanalysis.engine.nozzle import area_ratio, expand, mach_at_area, mach_at_pressure, pressure_ratio

GAMMAS = (1.14, 1.35)
"""Heat capacity ratio [-] of burnt nitrous oxide and paraffin, with room on both sides. Evidence: equilibrium, frozen
in the nozzle, at 20 bar has 1.31 at O/F 3 and 1.24 from 7 on."""

TOLERANCE = 0.08
"""Relative error of the thrust coefficient that nozzle losses, burning and alignment may make on either side. Evidence:
MRT-HF3.1 has 0.58 where a nozzle gives 1.16 to 1.34; HF4 and HF5 stay within (docs/validation.md)."""


SEPARATED = 0.2
"""Exit over ambient pressure below which a nozzle does not flow full. Source: Summerfield's criterion has 0.4; 0.2
leaves room for its scatter."""


def flows_full(pressure: float, ambient: float, ratio: float) -> bool:
    """Whether the flow fills an exit of ``ratio`` times the throat's area [-], at a chamber ``pressure`` [Pa] over
    ``ambient`` [Pa].

    >>> flows_full(20e5, 1e5, 2.7), flows_full(20e5, 1e5, 270.0)
    (True, False)
    """
    at_exit = [pressure * pressure_ratio(mach_at_area(ratio, g, True), g) for g in GAMMAS]
    return sum(at_exit) / len(at_exit) > SEPARATED * ambient


def possible(pressure: float, ambient: float, throat: float, exit_area: float | None) -> tuple[float, float]:
    """Least and largest thrust coefficient F/(p_c A_t) [-] at a chamber ``pressure`` [Pa] over ``ambient`` [Pa].

    Of a nozzle with this ``throat`` and ``exit_area`` [m^2]; where the exit is not known, from convergent to fully
    expanded. Isentropic, with the heat capacity ratios GAMMAS.

    >>> low, high = possible(20e5, 1e5, 1.7e-3, 4.6e-3)
    >>> round(low, 2), round(high, 2)
    (1.38, 1.41)
    """
    if exit_area is not None:
        found = [expand(g, 1e6, pressure, ambient, throat, exit_area)[1] / (pressure * throat) for g in GAMMAS]
        return min(found), max(found)
    low = min(expand(g, 1e6, pressure, ambient, throat, throat)[1] / (pressure * throat) for g in GAMMAS)
    return low, max(_fully_expanded(g, pressure, ambient) for g in GAMMAS)


def _fully_expanded(gamma: float, pressure: float, ambient: float) -> float:
    """Thrust coefficient with the exit at ambient pressure."""
    ratio = area_ratio(mach_at_pressure(ambient / pressure, gamma), gamma)
    return float(expand(gamma, 1e6, pressure, ambient, 1.0, ratio)[1] / pressure)
