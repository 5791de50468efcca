"""The engine of :mod:`simulated.blind.kernel` with the laws of a world in its equations."""

from __future__ import annotations

from math import pi

import numpy as np
from numba import njit
from numpy.typing import NDArray
from simulated.blind import kernel, nitrous
from simulated.blind import slots as s
from simulated.blind.closures import BAR, burning_share, critical_flux, heat_in, injector_factor, regression_factor
from simulated.blind.kernel import LEANEST, STEP, root
from simulated.worlds.laws import (
    DYER,
    EXPONENT_SLOPE,
    ISENTROPIC,
    LOSS_POWER,
    MIXING,
    OPENING,
    PORT_POWER,
    PRESSURE_POWER,
    RATIO_SLOPE,
    REYNOLDS,
    SAG,
    TAIL,
    THRUST_LOSS,
    TOTAL_FLUX,
    UNIFORM_WEB,
    VAPOR_AREA,
    ZONE_LAG,
)

Array = NDArray[np.float64]

FLUX = 3e4
"""Flow of an injector over its area [kg/(m^2 s)], at which laws have no say."""


@njit(cache=True)
def hidden_factor(e: Array, w: Array, y: Array, now: Array, t: float, critical: float) -> float:
    """Flow over that of the orifice by what is hidden: by the closures of the blind generator, or by others."""
    liquid, p_run, p_c = y[s.Y_LIQUID] > 0.0, y[s.Y_P_RUN], y[s.Y_P_C]
    drop = max(p_run - p_c, 1.0)
    if liquid and e[s.TWO_PHASE] != 0.0 and w[DYER] > 0.0:
        # Dyer et al. (2007): a weight between the orifice and the critical flow
        weight = 1.0 / (1.0 + np.sqrt(drop / max(now[s.N_P_VAPOR] - p_c, 1.0)))
        orifice = np.sqrt(2.0 * now[s.N_LIQUID_DENSITY] * drop)
        mixed = (1.0 - weight) + weight * min(critical / orifice, 1.0)
        return float(1.0 + min(e[s.TWO_PHASE], 1.0) * (mixed - 1.0))
    if not liquid and e[s.VAPOR_CHOKING] != 0.0 and w[ISENTROPIC] > 0.0:
        ratio = max(p_c / max(p_run, 1.0), 0.5457)  # critical ratio of gamma 1.3
        nozzle = np.sqrt(2.0 * 1.3 / 0.3 * (ratio ** (2.0 / 1.3) - ratio ** (2.3 / 1.3)))
        free = np.sqrt(2.0 * max(1.0 - p_c / max(p_run, 1.0), 1e-9))
        return float(1.0 + min(e[s.VAPOR_CHOKING], 1.0) * (min(nozzle / free, 1.0) - 1.0))
    return float(injector_factor(e, t, liquid, p_run, p_c, now[s.N_LIQUID_DENSITY], critical))


@njit(cache=True)
def lawful_factor(c: Array, w: Array, y: Array, now: Array, t: float, flow: float) -> float:
    """Effective area over its nominal one by the world's injector, and by its valve."""
    f = 1.0
    if w[REYNOLDS] != 0.0:
        f -= w[REYNOLDS] * (np.sqrt(FLUX * c[s.AREA] / max(flow, 0.02 * FLUX * c[s.AREA])) - 1.0)
    f += w[RATIO_SLOPE] * (y[s.Y_P_C] / max(y[s.Y_P_RUN], 1.0) - 0.4)
    if y[s.Y_LIQUID] == 0.0:
        f += w[VAPOR_AREA]
    return float(f * min((t + STEP) / w[OPENING], 1.0) if w[OPENING] > 0.0 else f)


@njit(cache=True)
def feed(c: Array, e: Array, w: Array, tab: Array, y: Array, now: Array, t: float, opened: bool) -> None:
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
    density, p_t, p_c = now[s.N_DENSITY], now[s.N_P_TANK], y[s.Y_P_C]
    flow = c[s.AREA] * FLUX
    for _ in range(4 if t < 2.0 * STEP else 2):
        area = c[s.AREA] * hidden_factor(e, w, y, now, t, critical) * lawful_factor(c, w, y, now, t, flow)
        loss = c[s.K_LOSS] * kernel.feed_factor(e, t, y[s.Y_LIQUID] > 0.0, y[s.Y_P_RUN], p_t)
        loss *= (max(flow, 1e-3) / (c[s.AREA] * FLUX)) ** w[LOSS_POWER]
        flow = float(np.sqrt(density / (loss + 0.5 / (area * area))) * root(p_t - p_c))
        y[s.Y_P_RUN] = p_t - loss * flow * flow / density
    filled = 1.0 - np.exp(-(y[s.Y_DRAWN] + 2e-5) / e[s.LINE]) if e[s.LINE] > 0.0 else 1.0
    now[s.N_TANK_FLOW], now[s.N_INJECTED], now[s.N_P_RUN_SEEN] = flow, flow * filled, y[s.Y_P_RUN]
    if filled != 1.0:
        now[s.N_P_RUN_SEEN] = p_c + filled * filled * (y[s.Y_P_RUN] - p_c)
    y[s.Y_CLOSED] = now[s.N_P_RUN_SEEN]


@njit(cache=True)
def grain(c: Array, e: Array, w: Array, y: Array, now: Array, t: float, left: Array) -> float:
    """Regression and fuel flow; the instant at which the port reaches the wall, or nan.

    ``left``: what burnt last [kg/s], and for how long the fuel has been gone [s]: what is left in pores and on walls
    goes on for a time (TAIL).
    """
    port, outer = y[s.Y_PORT], c[s.OUTER]
    flow = now[s.N_INJECTED] + w[TOTAL_FLUX] * now[s.N_FUEL]
    flux = flow / (pi * port * port)
    plain = c[s.REGRESSION_A] * flux ** c[s.REGRESSION_N] * (port / c[s.PORT]) ** w[PORT_POWER] if flux > 0.0 else 0.0
    factor = regression_factor(e, t, y[s.Y_P_C], flux, port, c)
    if e[s.PRESSURE_BURNING] != 0.0 and w[PRESSURE_POWER] > 0.0:
        factor = (max(y[s.Y_P_C], 0.5 * BAR) / e[s.REFERENCE_PRESSURE]) ** e[s.PRESSURE_BURNING]
    speed = plain * factor
    if e[s.SLIVER] > 0.0 and w[UNIFORM_WEB] > 0.0:  # webs of one thickness as many as of another
        burning = min(max((outer + 1.5 * e[s.SLIVER] - port) / (3.0 * e[s.SLIVER]), 0.0), 1.0)
    else:
        burning = burning_share(e, port, outer, speed * STEP)
    now[s.N_FUEL] = 2.0 * pi * min(port, outer + 4.0 * e[s.SLIVER]) * c[s.LENGTH] * c[s.FUEL_DENSITY] * speed * burning
    now[s.N_FUEL_PLAIN], now[s.N_SPEED] = now[s.N_FUEL], speed if burning > 1e-6 else 0.0
    if burning == 1.0 or e[s.SLIVER] > 0.0:
        left[0] = now[s.N_FUEL]
    else:
        now[s.N_FUEL] = max(now[s.N_FUEL], left[0] * np.exp(-left[1] / w[TAIL]))
        left[1] += STEP
    return t + (outer - port) / speed if speed > 0.0 and port < outer <= port + speed * STEP else np.nan


@njit(cache=True)
def breathe(c: Array, w: Array, y: Array, now: Array) -> None:
    """The chamber's gas: exponential of in- and outflow; without a flame what enters turns it cold within MIXING."""
    p_c, chamber, leaving, ambient = y[s.Y_P_C], y[s.Y_CHAMBER], now[s.N_LEAVING], c[s.AMBIENT]
    slope = leaving / chamber
    if p_c <= 1.3 * ambient:
        slope *= 0.5 * (p_c - 0.5 * ambient) / max(p_c - ambient, 1e-3 * ambient)
    slope = max(slope, 1e-6)
    injected, inflow = now[s.N_INJECTED], now[s.N_INJECTED] + now[s.N_FUEL] + now[s.N_EXTRA]
    new = chamber + (inflow - leaving) * (1.0 - np.exp(-slope * STEP)) / slope
    mix = 1.0 - np.exp(-inflow * STEP / chamber)
    if injected > LEANEST * now[s.N_FUEL]:
        y[s.Y_COLD] += (1.0 - y[s.Y_COLD]) * min(mix, 1.0 - np.exp(-STEP / w[MIXING]))
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
def tank(c: Array, e: Array, w: Array, tab: Array, y: Array, now: Array, t: float, opened: bool, m: float) -> float:
    """The tank's pressure and what would leave; the instant at which the liquid is gone, or nan."""
    gone = np.nan
    if y[s.Y_LIQUID] > 0.0:
        cold = y[s.Y_TEMPERATURE]
        y[s.Y_TEMPERATURE] = nitrous.flash(tab, y[s.Y_ENERGY], y[s.Y_MASS], c[s.VOLUME], cold)
        wet = nitrous.liquid_mass(tab, y[s.Y_TEMPERATURE], y[s.Y_MASS], c[s.VOLUME])
        if wet <= 0.0:
            gone = kernel.leave_liquid(c, tab, y, wet, cold, t, opened)
        else:
            y[s.Y_WET], y[s.Y_MASS_BEFORE] = wet, y[s.Y_MASS]
    if y[s.Y_LIQUID] > 0.0:
        kernel.wet_tank(c, e, tab, y, now)
        if w[ZONE_LAG] > 0.0 and e[s.LAG] == 0.0:  # what is drawn leaves room that vapor fills late
            made = 1.2 * now[s.N_P_VAPOR] * now[s.N_TANK_FLOW] / now[s.N_DENSITY] / now[s.N_FULL]
            part = 1.0 - np.exp(-STEP / w[ZONE_LAG])
            y[s.Y_DEFICIT] += (made * w[ZONE_LAG] - y[s.Y_DEFICIT]) * part
    else:
        c[s.POLYTROPE] = m + w[EXPONENT_SLOPE] * (1.0 - y[s.Y_MASS] / y[s.Y_M_V])
        kernel.dry_tank(c, tab, y, now)
    return float(gone)


@njit(cache=True)
def run(constants: Array, e: Array, w: Array, tab: Array, gas: Array, count: int) -> tuple[Array, Array]:
    """Traces (count, TRACES) from the opening in steps of STEP, and events: t_v, t_purge, t_fuel_out (nan if none)."""
    c, m = constants.copy(), constants[s.POLYTROPE]
    out, events, y = np.zeros((count, s.TRACES)), np.full(3, np.nan), kernel.start(c, tab)
    now, g, before, left = np.zeros(s.NOWS), np.zeros(s.SLOW), np.zeros(s.SLOW), np.zeros(2)
    for k in range(count):
        t = k * STEP
        opened = t < c[s.CLOSING]
        gone = tank(c, e, w, tab, y, now, t, opened, m)
        if not np.isnan(gone):
            events[0] = gone
        kernel.other_gases(c, e, y, now)
        if kernel.purge_line(c, e, y, now, opened) and np.isnan(events[1]):
            events[1] = t
        if now[s.N_BLOWN] == 0.0 and opened and not np.isnan(events[1]):
            y[s.Y_P_PURGE] -= w[SAG] * BAR * (1.0 - np.exp(events[1] - t))
        feed(c, e, w, tab, y, now, t, opened)
        out_at = grain(c, e, w, y, now, t, left)
        if np.isnan(events[2]):
            events[2] = out_at
        kernel.chamber_state(c, e, gas, y, now, t)
        kernel.expansion(c, e, y, now)
        now[s.N_THRUST] *= 1.0 - w[THRUST_LOSS] * (15.0 * BAR / max(y[s.Y_P_C], BAR)) ** 0.2
        wet = y[s.Y_WET] / c[s.MASS]
        blanket, conducted = heat_in(c, e, t, wet, y[s.Y_WALL], y[s.Y_TEMPERATURE], y[s.Y_LIQUID] > 0.0)
        kernel.record(c, y, now, blanket + conducted, opened, out[k])
        kernel.rates(c, e, tab, y, now, blanket, conducted, g)
        kernel.advance(y, g, before)
        y[s.Y_PORT] += STEP * now[s.N_SPEED]
        if e[s.LAG] != 0.0 and y[s.Y_LIQUID] > 0.0:
            kernel.boil(e, y, now)
        if e[s.EROSION] != 0.0 and g[s.Y_HEAT] > 0.0:
            y[s.Y_THROAT] += STEP * e[s.EROSION] * g[s.Y_HEAT] ** 0.8 * (1.0 - np.exp(-((t / e[s.EROSION_DELAY]) ** 2)))
        breathe(c, w, y, now)
    return out, events
