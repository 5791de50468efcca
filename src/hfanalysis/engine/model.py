"""The governing equations of the unsteady engine as one compiled right-hand side (report, chapter 3).

Tank, feed line, injector, grain, chamber, nozzle and the rocket's ascent. The chamber pressure follows from the stored
masses by the gas law. Every equation has its sites (:mod:`hfanalysis.engine.sites`); with no terms active they are the
neutral element and the equations are the report's.

Beyond the report: nitrogen in tank and chamber (only terms bring it in), the enthalpy of the nitrous oxide that is in
the chamber, and, after burn-out, gas that enters unburnt and cold.
"""

from __future__ import annotations

from hfanalysis.arrays import Array
from hfanalysis.compiled import compiled, inlined, separate
from hfanalysis.engine import equations as eq
from hfanalysis.engine import sites as at
from hfanalysis.engine.chamber import chamber, chamber_rates
from hfanalysis.engine.equations import EVALUATION, Equations, equations_at
from hfanalysis.engine.feed_line import feed
from hfanalysis.engine.grain import fuel_around, grain
from hfanalysis.engine.nozzle import nozzle
from hfanalysis.engine.sites import call_term
from hfanalysis.engine.tank import tank_pressure, tank_rates
from hfanalysis.rocket.vehicle import EARTH_RADIUS, STANDARD_GRAVITY, drag
from hfanalysis.thermo.air import air

PAD = 1e-3
"""Height [m] above which a rocket has left its pad."""


@compiled
def neutral(site: Array) -> None:
    """Sources to 0 [Pa, W, kg/s], factors to 1 [-]; ``site`` (SITES,)."""
    site[:] = 0.0
    site[at.FEED_FACTOR] = site[at.INJECTOR_FACTOR] = site[at.REGRESSION_FACTOR] = 1.0
    site[at.TEMPERATURE_FACTOR] = site[at.THROAT_FACTOR] = site[at.THRUST_FACTOR] = 1.0


@inlined
def act(hook: int, t: float, y: Array, m: Equations, dy: Array) -> None:
    """Every active term at one hook, at ``t`` [s]; ``y`` and ``dy`` (states,) [SI, SI/s]."""
    for k in range(m.terms.shape[0]):
        p_at, x_at = m.terms[k, at.PARAMETERS_AT], m.terms[k, at.STATES_AT]
        call_term(m.terms[k, at.ADDRESS], hook, t, m.env, m.c, p_at, y, x_at, m.site, dy)  # type: ignore[call-arg]


@separate(EVALUATION)
def rates(t: float, y: Array, liquid: bool, burning: bool, model: int, dy: Array, out: Array) -> None:
    """dy/dt and OUTPUTS in one phase; ENVIRONMENT and SITES keep what was found on the way.

    ``t`` after ignition [s]; ``y`` (states,) as STATES and those of effects [SI]; fills ``dy`` (states,) [SI/s] and
    ``out`` (outputs,) [SI].
    """
    m = equations_at(model)
    upstream(t, y, liquid, burning, m, dy)
    chamber(y, m)
    act(at.AT_CHAMBER, t, y, m, dy)
    m.env[at.P_CHAMBER] *= m.site[at.TEMPERATURE_FACTOR]
    m.env[at.RT_CHAMBER] *= m.site[at.TEMPERATURE_FACTOR]
    act(at.AT_FLOW, t, y, m, dy)
    feed(liquid, m)
    regression, surface = grain(y, burning, m)
    act(at.RATES, t, y, m, dy)
    regression *= m.site[at.REGRESSION_FACTOR]
    m.env[at.FUEL_FLOW] = surface * regression + m.site[at.FUEL_SOURCE]
    dy[eq.RADIUS] = regression
    ejected, thrust = nozzle(m)
    dy[eq.IMPULSE] = thrust
    tank_rates(y, liquid, m, dy)
    chamber_rates(y, burning, ejected, m, dy)
    ascent(y, thrust, m, dy)
    report(ejected, thrust, dy, m, out)


@inlined
def upstream(t: float, y: Array, liquid: bool, burning: bool, m: Equations, dy: Array) -> None:
    """All that is known before the flow is: surroundings and tank; rates and sites without anything in them.

    At ``t`` [s]; ``y`` and ``dy`` (states,) [SI, SI/s].
    """
    neutral(m.site)
    for i in range(y.size):
        dy[i] = 0.0
    surroundings(y, liquid, burning, m)
    tank_pressure(y, liquid, m)
    act(at.AT_TANK, t, y, m, dy)
    m.env[at.P_TANK] += m.site[at.TANK_PRESSURE]


@inlined
def surroundings(y: Array, liquid: bool, burning: bool, m: Equations) -> None:
    """Phase, ambient pressure [Pa], and what terms may read of the state ``y`` (states,) [SI]."""
    env = m.env
    env[at.IS_LIQUID], env[at.IS_BURNING] = (1.0 if liquid else 0.0), (1.0 if burning else 0.0)
    env[at.P_AMBIENT] = air(y[eq.ALTITUDE])[0] if m.c[eq.FLIES] > 0.0 else m.c[eq.AMBIENT_PRESSURE]
    env[at.T_TANK], env[at.M_TANK], env[at.M_NITROGEN] = y[eq.TEMPERATURE], y[eq.TANK], y[eq.NITROGEN]
    env[at.PORT_RADIUS] = y[eq.RADIUS]


@inlined
def ascent(y: Array, thrust: float, m: Equations, dy: Array) -> None:
    """The rocket climbs (report, eq. 2.17 to 2.21); on its pad it stands, and what lifts it is the ``thrust`` alone
    [N].

    ``y`` (states,) [SI]; fills altitude and speed of ``dy`` (states,) [m/s, m/s^2].
    """
    c = m.c
    if not c[eq.FLIES] > 0.0:
        return
    fuel = fuel_around(y[eq.RADIUS], c[eq.OUTER_RADIUS], c[eq.GRAIN_LENGTH], c[eq.FUEL_DENSITY])
    total = c[eq.DRY_MASS] + y[eq.TANK] + y[eq.NITROGEN] + fuel + m.env[at.M_CHAMBER]
    pull = total * STANDARD_GRAVITY * (EARTH_RADIUS / (EARTH_RADIUS + y[eq.ALTITUDE])) ** 2 * c[eq.CLIMB]
    net = thrust - drag(y[eq.ALTITUDE], y[eq.SPEED], c[eq.DRAG_AREA], m.drag) - pull
    stands = y[eq.ALTITUDE] <= c[eq.LAUNCH_ALTITUDE] + PAD
    dy[eq.ALTITUDE] = y[eq.SPEED] * c[eq.CLIMB]
    dy[eq.SPEED] = 0.0 if stands and net <= 0.0 else net / total


@inlined
def report(ejected: float, thrust: float, dy: Array, m: Equations, out: Array) -> None:
    """OUTPUTS [SI] into ``out`` (outputs,), with the nozzle's flow ``ejected`` [kg/s] and ``thrust`` [N]."""
    env, site = m.env, m.site
    out[eq.O_TANK_PRESSURE], out[eq.O_CHAMBER_PRESSURE] = env[at.P_TANK], env[at.P_CHAMBER]
    out[eq.O_RT] = env[at.RT_CHAMBER]
    out[eq.O_THRUST], out[eq.O_OXIDIZER_FLOW], out[eq.O_FUEL_FLOW] = thrust, env[at.OXIDIZER_FLOW], env[at.FUEL_FLOW]
    out[eq.O_NOZZLE_FLOW], out[eq.O_OF], out[eq.O_ACCELERATION] = ejected, env[at.OF_RATIO], dy[eq.SPEED]
    out[eq.O_RUN_PRESSURE], out[eq.O_GAMMA] = env[at.P_RUN], env[at.GAMMA_CHAMBER]
    out[eq.O_ENTHALPY] = env[at.H_CHAMBER]
    out[eq.O_SHARE], out[eq.O_AMBIENT] = env[at.NITROGEN_SHARE], env[at.P_AMBIENT]
    out[eq.O_NITROGEN_INFLOW], out[eq.O_OUTFLOW] = site[at.NITROGEN_INFLOW], env[at.OXIDIZER_FLOW] + site[at.TANK_LEAK]
