"""Heat that the burnt gas gives to the chamber's walls."""

from __future__ import annotations

from math import erfc, exp, pi, sqrt

from hfanalysis.compiled import compiled
from hfanalysis.engine.effect import Believable, Effect, Parameter
from hfanalysis.engine.equations import THROAT_AREA
from hfanalysis.engine.nozzle import choked_flow
from hfanalysis.engine.sites import (
    AT_CHAMBER,
    GAMMA_CHAMBER,
    HOT_SHARE,
    P_CHAMBER,
    RT_CHAMBER,
    TEMPERATURE_FACTOR,
    term,
)

LOSS, EXPONENT, WARMING = range(3)
REFERENCE_PRESSURE = 10e5
"""Chamber pressure [Pa] at which the loss is stated: about the mean of a firing. Source: by definition of the loss."""


LATE = 5.0
"""Square root of time, in units of the wall's own [-], from which on the series in its inverse is taken. Source: erfc's
asymptotic series."""


@compiled
def cold_share(root: float) -> float:
    """Heat flow into a thick wall, of what a cold one takes [-]; ``root`` is sqrt(t h^2 / (k rho c)) [-].

    >>> [round(cold_share(root), 3) for root in (0.0, 1.0, 10.0)]
    [1.0, 0.428, 0.056]
    """
    if root > LATE:
        return (1.0 - 0.5 / root**2 + 0.75 / root**4) / (sqrt(pi) * root)
    return exp(root**2) * erfc(root)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != AT_CHAMBER:
        return
    gamma, rt, pressure = env[GAMMA_CHAMBER], env[RT_CHAMBER], env[P_CHAMBER]
    # the choked nozzle carries mdot c_p T
    carried = choked_flow(gamma, rt, pressure, c[THROAT_AREA]) * rt * gamma / (gamma - 1.0)
    cold = cold_share(sqrt(max(t, 0.0) / p[WARMING]))
    share = p[LOSS] * cold * (pressure / REFERENCE_PRESSURE) ** p[EXPONENT] / carried
    site[TEMPERATURE_FACTOR] *= 1.0 - env[HOT_SHARE] * share / (1.0 + share)


EFFECT = Effect(
    name="chamber_heat_loss",
    plain_name="heat lost to the chamber's walls",
    equation="chamber_energy",
    meaning="the burnt gas gives heat to the walls of the chamber, which the report takes as adiabatic",
    reference="report, section 5.1 (sources of error: adiabatic combustion chamber); turbulent convection goes with "
    "p^0.8: Bartz, Jet Propulsion 27 (1957) 49; a thick wall takes the less "
    "the warmer it is: Carslaw and Jaeger, Conduction of Heat in Solids, 1959, section 2.7",
    formula="T = T_ad / (1 + Q / (mdot c_p T_ad)),  Q = Q_10 (p_c / 10 bar)^k exp(t/tau) erfc(sqrt(t/tau))",
    sites=("temperature_factor",),
    parameters=(
        Parameter("loss", "W", "heat flow into the cold walls at 10 bar", typical=1e5, low=0.0, high=2e6),
        Parameter("exponent", "-", "power of the chamber pressure", 0.2, center=0.8, low=0.0, high=1.0, given=True),
        Parameter(
            "warming",
            "s",
            "k rho c of a thick wall over the gas's heat transfer coefficient squared",
            300.0,
            center=100.0,
            low=0.3,
            high=1e4,
        ),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    twins=("combustion_efficiency",),
    decisive="thermocouples in the chamber's wall, at two depths",
    believable=Believable("loss", 4e5, "walls of some kilogrammes take no more for seconds", unit="kW", factor=1e-3),
)
