"""A chamber pressure that is read at the head, where a port hardly wider than the throat keeps it up."""

from __future__ import annotations

from math import pi

from hfanalysis.engine.effect import Believable, Effect, Parameter
from hfanalysis.engine.equations import EXIT_AREA, OUTER_RADIUS, THROAT_AREA
from hfanalysis.engine.nozzle import expand
from hfanalysis.engine.port import head_over_nozzle
from hfanalysis.engine.sites import (
    GAMMA_CHAMBER,
    P_AMBIENT,
    P_CHAMBER,
    PORT_RADIUS,
    RATES,
    RT_CHAMBER,
    THROAT_FACTOR,
    THRUST_FACTOR,
    term,
)

WEIGHT, RECOVERY = range(2)


@term
def _term(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook != RATES or not env[GAMMA_CHAMBER] > 1.0:
        return
    gamma, rt, head, throat = env[GAMMA_CHAMBER], env[RT_CHAMBER], env[P_CHAMBER], c[THROAT_AREA]
    port, outer = env[PORT_RADIUS], c[OUTER_RADIUS]
    whole = head_over_nozzle(gamma, pi * port * port / throat, pi * outer * outer / throat, p[RECOVERY])
    above = 1.0 + p[WEIGHT] * (whole - 1.0)
    # the equations give the nozzle the head's pressure: a throat that much smaller passes the same flow
    site[THROAT_FACTOR] *= 1.0 / above
    as_read = expand(gamma, rt, head, env[P_AMBIENT], throat / above, c[EXIT_AREA])[1]
    if as_read > 0.0:
        site[THRUST_FACTOR] *= expand(gamma, rt, head / above, env[P_AMBIENT], throat, c[EXIT_AREA])[1] / as_read


EFFECT = Effect(
    name="head_end_pressure",
    plain_name="chamber pressure at the head of a narrow port",
    equation="nozzle",
    meaning="the port is hardly wider than the throat: the head, whose pressure is read and pushes back on the "
    "injector, stands above the stagnation pressure of the nozzle, the less the wider the port has burnt",
    reference="Hill and Peterson, Mechanics and Thermodynamics of Propulsion, chapter 3: heat and mass that enter a "
    "flow at constant area, p_1 = p_2 (1 + gamma M_2^2) from rest; Borda and Carnot for the step behind the grain",
    formula="p_head = p_0 (1 + w (f - 1)),  f = (1 + gamma M^2) / (1 + (gamma - 1)/2 M^2)^(gamma/(gamma - 1)), M that "
    "of A_port / A_t, where the step loses nothing (s = 1); more where the port's jet mixes (s = 0)",
    sites=("throat_factor", "thrust_factor"),
    parameters=(
        Parameter("weight", "-", "0: head and nozzle have one pressure, 1: as momentum has it", 1.0, low=0.0, high=1.5),
        Parameter("recovery", "-", "from a jet that mixes behind the grain to a flow without loss", 0.3,
                  center=0.5, low=0.0, high=1.0, given=True),
    ),
    phases=("liquid", "vapor", "nitrogen"),
    term=_term,
    twins=(),
    decisive="a second gauge behind the grain; or the throat's diameter and the fuel's mass after a firing cut short",
    believable=Believable("weight", 1.0, "1 is what the momentum of the port's gas asks for"),
)  # fmt: skip
