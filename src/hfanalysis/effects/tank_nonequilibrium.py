"""Boiling that starts late: after opening the tank's pressure falls below saturation, and rebounds as bubbles come.

How far it rebounds is a parameter: the boiling that makes up for the outflow needs some superheat all along.
"""

from __future__ import annotations

from math import exp

from hfanalysis.engine.effect import Believable, Effect, OwnState, Parameter
from hfanalysis.engine.sites import AT_TANK, P_TANK, TANK_PRESSURE, term

DEPTH, DELAY, SUSTAINED = range(3)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_TANK:
        s = t / p[DELAY]
        dip, lasting = s * exp(1.0 - s), 1.0 - exp(-s)
        # in proportion to the pressure: what expands when the liquid is gone starts from the lower one
        depth = p[DEPTH] * env[P_TANK] / x[0]
        site[TANK_PRESSURE] -= depth * (dip + p[SUSTAINED] * (lasting - dip))


EFFECT = Effect(
    name="tank_nonequilibrium",
    plain_name="boiling that comes late",
    equation="tank_volume",
    meaning="vapor is made late: the tank's pressure dips below that of saturation after opening, and rebounds",
    reference="Zimmerman, Waxman, Cantwell and Zilliac, Review and Evaluation of Models for Self-Pressurizing "
    "Propellant Tank Dynamics, AIAA 2013-4045: superheat of the liquid until bubbles are there. The dip is that "
    "of two equal lags in a row (bubbles, then vapor); the superheat that goes on driving the boiling stays",
    formula="p_T = p_sat - dp (p_sat / p_sat(T_0)) ((1 - w) (t/tau) exp(1 - t/tau) + w (1 - exp(-t/tau)))",
    sites=("tank_pressure",),
    parameters=(
        Parameter("depth", "Pa", "lowest pressure below saturation", typical=2e5, low=0.0, high=2e6),
        Parameter("delay", "s", "when it is lowest", 0.35, center=0.25, low=0.02, high=3.0),
        Parameter("sustained", "-", "part of the depth that does not rebound", 0.3, center=0.2, low=0.0, high=1.0),
    ),
    phases=("liquid", "vapor"),
    term=_term,
    states=(
        OwnState(
            "pressure_at_rest", "Pa", 1e2, lambda engine, values: float(engine.saturation.pressure(engine.temperature))
        ),
    ),
    twins=("tank_stratification",),
    decisive="a thermocouple in the tank's liquid, which stays warmer than saturation while the boiling lags",
    believable=Believable(
        "depth",
        14e5,
        "14 bar below saturation at 20 degC is as far as a liquid can be superheated (Lienhard 1976)",
        unit="bar",
        factor=1e-5,
    ),
)
