"""The engine in steps of a millisecond: a flash for the tank, two-step Adams for what is slow, an exponential step.

Liquid phase: mass M and internal energy U of the tank are integrated; temperature and pressure follow from a flash at
constant volume. Vapour phase: p = p_v (M/M_v)^m exp(X), a polytrope, with X the integral of what heats the gas. The
chamber's mass, whose time constant is milliseconds, is advanced by the exponential of its linearised outflow; its
composition likewise. Events (liquid gone) split a step. Every effect's term is exactly neutral at strength zero.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numba import njit
from numpy.typing import NDArray

from . import nitrous, nozzle
from . import slots as s
from .closures import (
    BAR,
    burning_share,
    critical_flux,
    feed_factor,
    heat_in,
    hot_gas,
    injector_factor,
    regression_factor,
)

Array = NDArray[np.float64]

STEP = 1e-3
"""Time step [s]."""
NITROGEN_GAS, NITROUS_GAS = 296.8, 188.9
"""Gas constants [J/(kg K)]."""
LEANEST = 100.0
"""O/F at entry above which there is no flame: what enters stays cold. Without fuel, nitrous oxide does not burn."""


@njit(cache=True)
def root(drop: float) -> float:
    """sqrt(dp), with a finite slope at zero."""
    return float(drop / np.sqrt(drop + 5.0)) if drop > 0.0 else 0.0


@njit(cache=True)
def start(c: Array, tab: Array) -> Array:
    """The state before the valve opens."""
    y = np.zeros(s.STATES)
    y[s.Y_MASS], y[s.Y_TEMPERATURE], y[s.Y_WALL] = c[s.MASS], c[s.TEMPERATURE], c[s.TEMPERATURE]
    y[s.Y_ENERGY] = nitrous.internal_energy(tab, c[s.TEMPERATURE], c[s.MASS], c[s.VOLUME])
    liquid = nitrous.liquid_mass(tab, c[s.TEMPERATURE], c[s.MASS], c[s.VOLUME])
    y[s.Y_ULLAGE] = c[s.VOLUME] - liquid / nitrous.saturated(tab, nitrous.RHO_L, c[s.TEMPERATURE])
    y[s.Y_PORT], y[s.Y_THROAT], y[s.Y_NUCLEI] = c[s.PORT], c[s.THROAT_RADIUS], 0.12
    y[s.Y_CHAMBER], y[s.Y_RATIO], y[s.Y_P_C], y[s.Y_P_RUN] = -1.0, 1.0, c[s.AMBIENT], c[s.AMBIENT]
    y[s.Y_WET], y[s.Y_LIQUID], y[s.Y_FRESH] = liquid, 1.0, 1.0
    y[s.Y_ENTHALPY] = nitrous.saturated(tab, nitrous.H_L, c[s.TEMPERATURE]) + c[s.FORMATION]
    y[s.Y_M_V], y[s.Y_T_V], y[s.Y_GRUENEISEN] = 1.0, c[s.TEMPERATURE], 0.3
    return y


@njit(cache=True)
def leave_liquid(c: Array, tab: Array, y: Array, wet: float, cold: float, t: float, opened: bool) -> float:
    """Begin the vapour phase where the last liquid left within the step just taken; that instant.

    Histories are linear within the step; ``cold`` is the temperature before it, ``wet`` the (negative) liquid after it.
    """
    part = y[s.Y_WET] / (y[s.Y_WET] - wet)
    y[s.Y_M_V] = y[s.Y_MASS_BEFORE] + part * (y[s.Y_MASS] - y[s.Y_MASS_BEFORE])
    y[s.Y_T_V] = cold + part * (y[s.Y_TEMPERATURE] - cold)
    p_v = nitrous.saturated(tab, nitrous.P, y[s.Y_T_V])
    y[s.Y_P_V] = p_v - y[s.Y_DEFICIT]
    y[s.Y_GRUENEISEN] = nitrous.saturated(tab, nitrous.GRUENEISEN, y[s.Y_T_V])
    # for the rest of the step vapour flows, not liquid
    series = c[s.K_LOSS] + 0.5 / (c[s.AREA] * c[s.AREA])
    flow = np.sqrt(y[s.Y_M_V] / c[s.VOLUME] / series) * root(p_v - y[s.Y_P_C]) if opened else 0.0
    y[s.Y_MASS] = y[s.Y_M_V] - flow * (1.0 - part) * STEP
    y[s.Y_LIQUID], y[s.Y_TEMPERATURE], y[s.Y_FRESH], y[s.Y_WET] = 0.0, y[s.Y_T_V], 1.0, 0.0
    return t - STEP + part * STEP


@njit(cache=True)
def wet_tank(c: Array, e: Array, tab: Array, y: Array, now: Array) -> None:
    """Pressure, and what leaves, while there is liquid."""
    temperature, wet = y[s.Y_TEMPERATURE], y[s.Y_WET]
    density = nitrous.saturated(tab, nitrous.RHO_L, temperature)
    now[s.N_FULL] = max(c[s.VOLUME] - wet / density, 1e-5)
    now[s.N_P_VAPOR] = nitrous.saturated(tab, nitrous.P, temperature)
    now[s.N_P_TANK] = now[s.N_P_VAPOR] - y[s.Y_DEFICIT]
    if e[s.LAYER] != 0.0:
        layer = e[s.LAYER] * np.exp(-((y[s.Y_DRAWN] / e[s.LAYER_VOLUME]) ** 1.3))
        now[s.N_P_TANK] = nitrous.saturated(tab, nitrous.P, temperature + layer) - y[s.Y_DEFICIT]
    now[s.N_LIQUID_DENSITY] = density
    now[s.N_DENSITY], now[s.N_ENTHALPY] = density, nitrous.saturated(tab, nitrous.H_L, temperature)
    if e[s.INGESTION] > 0.0 and wet / density < e[s.INGESTION]:
        void = 0.8 * (1.0 - wet / density / e[s.INGESTION]) ** 1.5
        vapor = nitrous.saturated(tab, nitrous.RHO_V, temperature)
        now[s.N_DENSITY] = void * vapor + (1.0 - void) * density
        gain = nitrous.saturated(tab, nitrous.H_V, temperature) - now[s.N_ENTHALPY]
        now[s.N_ENTHALPY] += void * vapor / now[s.N_DENSITY] * gain


@njit(cache=True)
def dry_tank(c: Array, tab: Array, y: Array, now: Array) -> None:
    """Pressure, and what leaves, when there is vapour alone."""
    share, warmed = y[s.Y_MASS] / y[s.Y_M_V], np.exp(y[s.Y_EXPONENT])
    now[s.N_P_VAPOR] = y[s.Y_P_V] * share ** c[s.POLYTROPE] * warmed
    y[s.Y_TEMPERATURE] = y[s.Y_T_V] * share ** (c[s.POLYTROPE] - 1.0) * warmed
    now[s.N_P_TANK], now[s.N_FULL], now[s.N_LIQUID_DENSITY] = now[s.N_P_VAPOR], c[s.VOLUME], 0.0
    now[s.N_DENSITY] = (y[s.Y_MASS] + y[s.Y_NITROGEN]) / c[s.VOLUME]
    now[s.N_ENTHALPY] = nitrous.saturated(tab, nitrous.H_V, y[s.Y_TEMPERATURE])


@njit(cache=True)
def other_gases(c: Array, e: Array, y: Array, now: Array) -> None:
    """Pressure of what is in the tank beside nitrous oxide; its share of what leaves as gas."""
    liquid = y[s.Y_LIQUID] > 0.0
    if y[s.Y_NITROGEN] > 0.0:
        warmth = y[s.Y_TEMPERATURE] if liquid else y[s.Y_T_V]
        now[s.N_P_TANK] += y[s.Y_NITROGEN] * NITROGEN_GAS * warmth / now[s.N_FULL]
    if e[s.DISSOLVED] != 0.0:
        spread = (y[s.Y_ULLAGE] / now[s.N_FULL]) ** 0.4
        now[s.N_P_TANK] += e[s.DISSOLVED] * (spread if liquid else spread * y[s.Y_MASS] / y[s.Y_M_V])
    now[s.N_GAS_SHARE] = 0.0 if liquid else y[s.Y_NITROGEN] / (y[s.Y_MASS] + y[s.Y_NITROGEN])


@njit(cache=True)
def purge_line(c: Array, e: Array, y: Array, now: Array, opened: bool) -> bool:
    """The purge line follows the tank through its check valve; whether nitrogen could enter."""
    above = c[s.SUPPLY] - c[s.CRACKING] - now[s.N_P_TANK]
    now[s.N_BLOWN] = 0.0
    if above <= 0.0:
        y[s.Y_P_PURGE] = c[s.SUPPLY]
        return False
    if not opened:
        return False
    y[s.Y_P_PURGE] = now[s.N_P_TANK] + c[s.CRACKING]
    if e[s.NITROGEN_FLOW] != 0.0:
        now[s.N_BLOWN] = e[s.NITROGEN_FLOW] * (above / (10.0 * BAR)) ** 0.6
        y[s.Y_P_PURGE] += above * e[s.NITROGEN_FLOW] / (e[s.NITROGEN_FLOW] + 0.03)
    return True


@njit(cache=True)
def through(c: Array, e: Array, y: Array, now: Array, t: float, critical: float) -> float:
    """Flow through feed line and injector [kg/s]; sets p_run, on whose last value the factors depend."""
    liquid, p_t, p_c, density = y[s.Y_LIQUID] > 0.0, now[s.N_P_TANK], y[s.Y_P_C], now[s.N_DENSITY]
    area = c[s.AREA] * injector_factor(e, t, liquid, y[s.Y_P_RUN], p_c, density, critical)
    loss = c[s.K_LOSS] * feed_factor(e, t, liquid, y[s.Y_P_RUN], p_t)
    flow = np.sqrt(density / (loss + 0.5 / (area * area))) * root(p_t - p_c)
    y[s.Y_P_RUN] = p_t - loss * flow * flow / density
    return float(flow)


@njit(cache=True)
def feed(c: Array, e: Array, tab: Array, y: Array, now: Array, t: float, opened: bool, first: bool) -> None:
    """What leaves the tank, what reaches the chamber, and p_run as seen."""
    now[s.N_TANK_FLOW], now[s.N_INJECTED], now[s.N_P_C_THERE] = 0.0, 0.0, y[s.Y_P_C]
    now[s.N_LEAK] = e[s.LEAK] * (now[s.N_P_TANK] / (50.0 * BAR)) ** 0.9 if e[s.LEAK] != 0.0 else 0.0
    if not opened:
        fallen = np.exp(-(t - c[s.CLOSING]) / 0.12)
        now[s.N_P_RUN_SEEN] = c[s.AMBIENT] + (y[s.Y_CLOSED] - c[s.AMBIENT]) * fallen
        return
    critical = 1.0
    if e[s.TWO_PHASE] != 0.0 and y[s.Y_LIQUID] > 0.0:
        critical = critical_flux(tab, y[s.Y_TEMPERATURE], now[s.N_P_VAPOR], now[s.N_LIQUID_DENSITY])
    flow = through(c, e, y, now, t, critical)
    if first:  # there was no p_run before
        flow = through(c, e, y, now, t, critical)
    filled = 1.0 - np.exp(-(y[s.Y_DRAWN] + 2e-5) / e[s.LINE]) if e[s.LINE] > 0.0 else 1.0
    now[s.N_TANK_FLOW], now[s.N_INJECTED] = flow, flow * filled
    now[s.N_P_RUN_SEEN] = y[s.Y_P_RUN]
    if filled != 1.0:
        now[s.N_P_RUN_SEEN] = y[s.Y_P_C] + filled * filled * (y[s.Y_P_RUN] - y[s.Y_P_C])
    y[s.Y_CLOSED] = now[s.N_P_RUN_SEEN]


@njit(cache=True)
def grain(c: Array, e: Array, y: Array, now: Array, t: float) -> float:
    """Regression and fuel flow, with and without effects; the instant at which the port reaches the wall, or nan."""
    port, outer = y[s.Y_PORT], c[s.OUTER]
    flux = now[s.N_INJECTED] / (pi * port * port)
    plain = c[s.REGRESSION_A] * flux ** c[s.REGRESSION_N] if flux > 0.0 else 0.0
    speed = plain * regression_factor(e, t, y[s.Y_P_C], flux, port, c)
    burning = burning_share(e, port, outer, speed * STEP)
    perimeter = 2.0 * pi * min(port, outer + 4.0 * e[s.SLIVER]) * c[s.LENGTH] * c[s.FUEL_DENSITY]
    whole = burning if e[s.SLIVER] == 0.0 else (1.0 if port < outer else 0.0)
    now[s.N_FUEL], now[s.N_FUEL_PLAIN] = perimeter * speed * burning, perimeter * plain * whole
    now[s.N_SPEED] = speed if burning > 1e-6 else 0.0
    return t + (outer - port) / speed if speed > 0.0 and port + speed * STEP >= outer else np.nan


@njit(cache=True)
def chamber_state(c: Array, e: Array, gas: Array, y: Array, now: Array, t: float) -> None:
    """Chamber pressure from the mass stored; R T, gamma, and the power missing."""
    port, inflow = y[s.Y_PORT], now[s.N_INJECTED] + now[s.N_FUEL]
    room = c[s.DEAD_VOLUME] + pi * min(port, c[s.OUTER]) ** 2 * c[s.LENGTH]
    if y[s.Y_CHAMBER] < 0.0:  # full of equilibrium gas at ambient pressure and the ratio that enters
        y[s.Y_RATIO] = now[s.N_INJECTED] / max(now[s.N_FUEL], 1e-9)
        rt = hot_gas(gas, e, y[s.Y_ENTHALPY], y[s.Y_SHARE], c[s.AMBIENT], y[s.Y_RATIO], inflow, 1.0, t)[0]
        y[s.Y_CHAMBER] = c[s.AMBIENT] * room / rt
    burnt = min(port / c[s.PORT], c[s.OUTER] / c[s.PORT])
    rt, gamma, lost = hot_gas(gas, e, y[s.Y_ENTHALPY], y[s.Y_SHARE], y[s.Y_P_C], y[s.Y_RATIO], inflow, burnt, t)
    if y[s.Y_COLD] > 0.0:
        constant = NITROUS_GAS + now[s.N_GAS_SHARE] * (NITROGEN_GAS - NITROUS_GAS)
        rt += y[s.Y_COLD] * (constant * y[s.Y_TEMPERATURE] - rt)
        gamma += y[s.Y_COLD] * (1.3 - gamma)
        lost *= 1.0 - y[s.Y_COLD]
    y[s.Y_P_C] = y[s.Y_CHAMBER] * rt / room
    if y[s.Y_P_C] < c[s.AMBIENT]:  # air comes back in
        y[s.Y_P_C], y[s.Y_CHAMBER] = c[s.AMBIENT], c[s.AMBIENT] * room / rt
    now[s.N_RT], now[s.N_GAMMA], now[s.N_LOST], now[s.N_ROOM] = rt, gamma, lost, room
    now[s.N_EXTRA] = 0.0
    if e[s.IGNITION] != 0.0:
        now[s.N_EXTRA] = e[s.IGNITION] * t / e[s.IGNITION_TIME] ** 2 * np.exp(-t / e[s.IGNITION_TIME])


@njit(cache=True)
def expansion(c: Array, e: Array, y: Array, now: Array) -> None:
    """Outflow and thrust, and the thrust of the nozzle as built on the same gas."""
    p_c, rt, gamma, ambient, area = y[s.Y_P_C], now[s.N_RT], now[s.N_GAMMA], c[s.AMBIENT], c[s.EXIT_AREA]
    now[s.N_THROAT] = y[s.Y_THROAT]
    if e[s.DEPOSIT] != 0.0:
        x = y[s.Y_HEAT] / e[s.DEPOSIT_TIME]
        narrowed = y[s.Y_THROAT] - e[s.DEPOSIT] * (1.0 - np.exp(-x)) * np.exp(-0.3 * x)
        now[s.N_THROAT] = max(narrowed, 0.5 * y[s.Y_THROAT])
    at, built = pi * now[s.N_THROAT] ** 2, pi * c[s.THROAT_RADIUS] ** 2
    now[s.N_LEAVING] = nozzle.outflow(p_c, rt, gamma, at, area, ambient)
    now[s.N_THRUST] = nozzle.thrust(p_c, rt, gamma, at, area, ambient, e[s.SEPARATED])
    now[s.N_THRUST_PLAIN] = now[s.N_THRUST]
    if e[s.SEPARATED] != 0.0 or at != built:
        now[s.N_THRUST_PLAIN] = nozzle.thrust(p_c, rt, gamma, built, area, ambient, 0.0)
    if e[s.DIVERGENCE] != 0.0 and p_c > ambient:
        now[s.N_THRUST] *= 1.0 - e[s.DIVERGENCE] * (1.0 + 0.2 * np.sqrt(min(10.0 * BAR / p_c, 10.0)))


@njit(cache=True)
def record(c: Array, y: Array, now: Array, heat: float, opened: bool, o: Array) -> None:
    """One row of traces; the base laws of line and injector are taken at what is really there."""
    o[s.P_TANK], o[s.P_RUN], o[s.P_CHAMBER] = now[s.N_P_TANK], now[s.N_P_RUN_SEEN], y[s.Y_P_C]
    o[s.P_PURGE], o[s.THRUST], o[s.M_TANK] = y[s.Y_P_PURGE], now[s.N_THRUST], y[s.Y_MASS] + y[s.Y_NITROGEN]
    o[s.FLOW], o[s.FUEL], o[s.FUEL_BASE] = now[s.N_INJECTED], now[s.N_FUEL], now[s.N_FUEL_PLAIN]
    if opened:
        clean = now[s.N_LIQUID_DENSITY] if y[s.Y_LIQUID] > 0.0 else now[s.N_DENSITY]
        drop = now[s.N_P_RUN_SEEN] - now[s.N_P_C_THERE]
        o[s.FLOW_BASE] = c[s.AREA] * np.sqrt(2.0 * clean) * root(drop)
        o[s.LOSS] = now[s.N_P_TANK] - now[s.N_P_RUN_SEEN]
        o[s.LOSS_BASE] = c[s.K_LOSS] * now[s.N_INJECTED] * now[s.N_INJECTED] / now[s.N_DENSITY]
    o[s.CHAMBER_SOURCE], o[s.CHAMBER_POWER], o[s.THRUST_BASE] = now[s.N_EXTRA], -now[s.N_LOST], now[s.N_THRUST_PLAIN]
    o[s.TANK_HEAT], o[s.TANK_SOURCE], o[s.T_TANK] = heat, now[s.N_BLOWN] - now[s.N_LEAK], y[s.Y_TEMPERATURE]
    o[s.LIQUID], o[s.RADIUS], o[s.CHAMBER_MASS] = y[s.Y_WET], y[s.Y_PORT], y[s.Y_CHAMBER]
    o[s.NOZZLE_FLOW], o[s.THROAT] = now[s.N_LEAVING], now[s.N_THROAT]
    o[s.TANK_FLOW], o[s.OUT_ENTHALPY] = now[s.N_TANK_FLOW], now[s.N_ENTHALPY]


@njit(cache=True)
def rates(c: Array, e: Array, tab: Array, y: Array, now: Array, blanket: float, conducted: float, g: Array) -> None:
    """Rates of the first states, which are slow."""
    own, flow, leak = 1.0 - now[s.N_GAS_SHARE], now[s.N_TANK_FLOW], now[s.N_LEAK]
    g[s.Y_MASS] = -flow * own - leak * own
    g[s.Y_ENERGY] = -flow * now[s.N_ENTHALPY] + blanket + conducted
    if leak != 0.0:
        g[s.Y_ENERGY] -= leak * nitrous.saturated(tab, nitrous.H_V, y[s.Y_TEMPERATURE])
    g[s.Y_EXPONENT] = 0.0
    if y[s.Y_LIQUID] == 0.0:
        g[s.Y_EXPONENT] = y[s.Y_GRUENEISEN] * (blanket + conducted) / (now[s.N_P_TANK] * c[s.VOLUME])
    g[s.Y_WALL] = -conducted / max(e[s.WALL_CAPACITY], 1.0)
    g[s.Y_DRAWN] = flow / now[s.N_DENSITY]
    g[s.Y_NITROGEN] = now[s.N_BLOWN] - now[s.N_GAS_SHARE] * (flow + leak)
    g[s.Y_HEAT] = y[s.Y_P_C] / (10.0 * BAR) if y[s.Y_P_C] > 1.5 * BAR else 0.0


@njit(cache=True)
def advance(y: Array, g: Array, before: Array) -> None:
    """Adams-Bashforth of second order; after an event, one step of Euler."""
    if y[s.Y_FRESH] > 0.0:
        before[:] = g
        y[s.Y_FRESH] = 0.0
    for i in range(s.SLOW):
        y[i] += STEP * (1.5 * g[i] - 0.5 * before[i])
    y[s.Y_MASS], y[s.Y_NITROGEN] = max(y[s.Y_MASS], 1e-4), max(y[s.Y_NITROGEN], 0.0)
    before[:] = g


@njit(cache=True)
def boil(e: Array, y: Array, now: Array) -> None:
    """Boiling behind the pressure: the ullage expands at once, vapour comes as bubbles have grown."""
    sink = y[s.Y_NUCLEI] / e[s.LAG_TIME]
    source = e[s.LAG] * 1.2 * now[s.N_P_VAPOR] * now[s.N_TANK_FLOW] / now[s.N_DENSITY] / now[s.N_FULL]
    y[s.Y_DEFICIT] = source / sink + (y[s.Y_DEFICIT] - source / sink) * np.exp(-sink * STEP)
    grown = y[s.Y_NUCLEI] + STEP * (y[s.Y_DEFICIT] / (3.0 * BAR) + 0.1) / e[s.LAG_NUCLEATION]
    y[s.Y_NUCLEI] = min(grown, 3.0)


@njit(cache=True)
def breathe(c: Array, y: Array, now: Array) -> None:
    """The chamber's gas: exponential of in- and outflow linearised about the present mass; its composition likewise."""
    p_c, chamber, leaving, ambient = y[s.Y_P_C], y[s.Y_CHAMBER], now[s.N_LEAVING], c[s.AMBIENT]
    slope = leaving / chamber
    if p_c <= 1.3 * ambient:
        at, step = pi * now[s.N_THROAT] ** 2, 1e-4
        more = nozzle.outflow(p_c * (1.0 + step), now[s.N_RT], now[s.N_GAMMA], at, c[s.EXIT_AREA], ambient)
        slope = max((more - leaving) / (step * chamber), 1e-3)
    injected, inflow = now[s.N_INJECTED], now[s.N_INJECTED] + now[s.N_FUEL]
    if injected > 0.0:
        slope += 0.5 * injected / max(now[s.N_P_TANK] - now[s.N_P_C_THERE], 5.0) * now[s.N_RT] / now[s.N_ROOM]
    new = chamber + (inflow + now[s.N_EXTRA] - leaving) * (1.0 - np.exp(-slope * STEP)) / slope
    mix = 1.0 - np.exp(-inflow * STEP / chamber)
    if injected > LEANEST * now[s.N_FUEL]:
        y[s.Y_COLD] += (1.0 - y[s.Y_COLD]) * mix
    elif inflow > 1e-7:
        y[s.Y_COLD] -= y[s.Y_COLD] * mix
        y[s.Y_ENTHALPY] += (now[s.N_ENTHALPY] + c[s.FORMATION] - y[s.Y_ENTHALPY]) * mix
        part = y[s.Y_RATIO] / (1.0 + y[s.Y_RATIO])
        part += (injected / inflow - part) * mix
        y[s.Y_RATIO] = min(max(part / max(1.0 - part, 1e-9), 1e-3), 1e6)
        y[s.Y_SHARE] += (now[s.N_GAS_SHARE] - y[s.Y_SHARE]) * mix if injected > 0.0 else 0.0
    y[s.Y_CHAMBER] = max(new, 1e-7)
    y[s.Y_P_C] = max(y[s.Y_CHAMBER] * now[s.N_RT] / now[s.N_ROOM], ambient)


@njit(cache=True)
def run(c: Array, e: Array, tab: Array, gas: Array, count: int) -> tuple[Array, Array]:
    """Traces (count, TRACES) from the opening in steps of STEP, and events: t_v, t_purge, t_fuel_out (nan if none)."""
    out, events, y = np.zeros((count, s.TRACES)), np.full(3, np.nan), start(c, tab)
    now, g, before = np.zeros(s.NOWS), np.zeros(s.SLOW), np.zeros(s.SLOW)
    for k in range(count):
        t = k * STEP
        opened = t < c[s.CLOSING]
        if y[s.Y_LIQUID] > 0.0:
            cold = y[s.Y_TEMPERATURE]
            y[s.Y_TEMPERATURE] = nitrous.flash(tab, y[s.Y_ENERGY], y[s.Y_MASS], c[s.VOLUME], cold)
            wet = nitrous.liquid_mass(tab, y[s.Y_TEMPERATURE], y[s.Y_MASS], c[s.VOLUME])
            if wet <= 0.0:
                events[0] = leave_liquid(c, tab, y, wet, cold, t, opened)
            else:
                y[s.Y_WET], y[s.Y_MASS_BEFORE] = wet, y[s.Y_MASS]
        if y[s.Y_LIQUID] > 0.0:
            wet_tank(c, e, tab, y, now)
        else:
            dry_tank(c, tab, y, now)
        other_gases(c, e, y, now)
        if purge_line(c, e, y, now, opened) and np.isnan(events[1]):
            events[1] = t
        feed(c, e, tab, y, now, t, opened, k == 0)
        gone = grain(c, e, y, now, t)
        if np.isnan(events[2]):
            events[2] = gone
        chamber_state(c, e, gas, y, now, t)
        expansion(c, e, y, now)
        share = y[s.Y_WET] / c[s.MASS]
        blanket, conducted = heat_in(c, e, t, share, y[s.Y_WALL], y[s.Y_TEMPERATURE], y[s.Y_LIQUID] > 0.0)
        record(c, y, now, blanket + conducted, opened, out[k])
        rates(c, e, tab, y, now, blanket, conducted, g)
        advance(y, g, before)
        y[s.Y_PORT] += STEP * now[s.N_SPEED]
        if e[s.LAG] != 0.0 and y[s.Y_LIQUID] > 0.0:
            boil(e, y, now)
        if e[s.EROSION] != 0.0 and g[s.Y_HEAT] > 0.0:
            y[s.Y_THROAT] += STEP * e[s.EROSION] * g[s.Y_HEAT] ** 0.8 * (1.0 - np.exp(-((t / e[s.EROSION_DELAY]) ** 2)))
        breathe(c, y, now)
    return out, events
