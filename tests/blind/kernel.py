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

from . import combustion, nitrous, nozzle
from . import slots as s

Array = NDArray[np.float64]

STEP = 1e-3
"""Time step [s]."""
NITROGEN_GAS = 296.8
"""Gas constant of nitrogen [J/(kg K)]."""
BAR = 1e5


@njit(cache=True)
def root(drop: float) -> float:
    """sqrt(dp), with a finite slope at zero."""
    return float(drop / np.sqrt(drop + 5.0)) if drop > 0.0 else 0.0


@njit(cache=True)
def heat_in(
    c: Array, e: Array, t: float, wet: float, wall: float, temperature: float, liquid: bool
) -> tuple[float, float]:
    """Heat into the tank [W]: from blankets; from the wall, by convection or boiling (power 1.25 of the difference)."""
    blanket = 0.0
    if e[s.HEAT] != 0.0:
        # blankets were on before: the layer between has warmed in part, the rest comes with a lag, and all of it fades
        blanket = e[s.HEAT] * (1.0 - 0.7 * np.exp(-t / e[s.HEAT_LAG])) * np.exp(-((t / e[s.HEAT_FADE]) ** 1.5))
    conducted = 0.0
    if e[s.WALL] != 0.0:
        d = wall - temperature
        share = 0.15 + 0.85 * wet if liquid else 0.15
        conducted = e[s.WALL] * share * d * (abs(d) / 5.0) ** 0.25
    return blanket, conducted


@njit(cache=True)
def injector_factor(
    e: Array, t: float, liquid: bool, p_run: float, p_c: float, density: float, critical: float
) -> float:
    """Flow over that of the incompressible orifice at the same p_run and p_c."""
    f = 1.0
    drop = max(p_run - p_c, 0.0)
    if liquid:
        if e[s.TWO_PHASE] != 0.0:
            ratio = 2.0 * density * drop / (critical * critical)
            f *= (1.0 + e[s.TWO_PHASE] * ratio * ratio) ** -0.25
        if e[s.FLIP] != 0.0 and t >= e[s.FLIP_START]:
            f *= 1.0 - e[s.FLIP] * (1.0 - np.exp(-(t - e[s.FLIP_START]) / 0.02))
    elif e[s.VAPOR_CHOKING] != 0.0:
        x = drop / max(p_run, 1.0)
        most = 0.9 * 0.72
        inside = min(x, most)
        valve = (1.0 - inside / (3.0 * most)) * np.sqrt(inside / max(x, 1e-12))
        f *= 1.0 + e[s.VAPOR_CHOKING] * (valve - 1.0)
    if e[s.CHUGGING] != 0.0:
        up = 1.0 / (1.0 + np.exp(-(t - e[s.CHUGGING_START]) / 0.15))
        down = 1.0 / (1.0 + np.exp((t - e[s.CHUGGING_END]) / 0.3))
        a = e[s.CHUGGING] * up * down
        f *= 1.0 + a * np.sin(2.0 * pi * e[s.CHUGGING_FREQUENCY] * t) - 0.25 * a * a
    return max(f, 0.02)


@njit(cache=True)
def feed_factor(e: Array, t: float, liquid: bool, p_run: float, p_t: float) -> float:
    """K_loss over its base value."""
    f = 1.0
    if e[s.VALVE] > 0.0 and t < e[s.VALVE]:
        opened = max(t / e[s.VALVE], 0.03)
        f += 3.0 * (1.0 / (opened * opened) - 1.0)
    if e[s.FLASHING] != 0.0 and liquid:
        f += e[s.FLASHING] * 10.0 * max(p_t - p_run, 0.0) / p_t
    return f


@njit(cache=True)
def regression_factor(e: Array, t: float, p_c: float, flux: float, port: float, c: Array) -> float:
    """Regression over a G^n."""
    f = 1.0
    if e[s.PRESSURE_BURNING] != 0.0:
        p = e[s.REFERENCE_PRESSURE]
        f += e[s.PRESSURE_BURNING] * np.tanh((p_c - p) / p)
    if e[s.ENTRAINMENT] != 0.0:
        melt = 1.0 - np.exp(-t / e[s.ENTRAINMENT_LAG])
        f += e[s.ENTRAINMENT] * melt * (max(flux, 0.0) / 300.0) ** 1.3 * c[s.PORT] / port
    if e[s.SHIFT] != 0.0:
        a = 1.0 / (1.0 + np.exp(-(t - e[s.SHIFT_START]) / 0.02))
        f += e[s.SHIFT] * a / (1.0 + np.exp((t - e[s.SHIFT_END]) / 0.02))
    return max(f, 0.05)


@njit(cache=True)
def burning_share(e: Array, port: float, outer: float, advance: float) -> float:
    """Share of the port's perimeter that still has fuel, mean over a step in which the port advances."""
    if e[s.SLIVER] > 0.0:
        return float(1.0 / (1.0 + np.exp(min((port + 0.5 * advance - outer) / (0.55 * e[s.SLIVER]), 60.0))))
    if port + advance <= outer:
        return 1.0
    return max(outer - port, 0.0) / advance if advance > 0.0 else 0.0


@njit(cache=True)
def hot_gas(
    table: Array, e: Array, enthalpy: float, share: float, p: float, ratio: float, flow: float, area: float, t: float
) -> tuple[float, float, float]:
    """R T [J/kg], gamma, and the power [W] that is missing against equilibrium."""
    rt, gamma = combustion.gas(table, enthalpy, share, p, ratio)
    lost = 0.0
    heat = gamma / (gamma - 1.0)
    if e[s.EFFICIENCY] != 0.0:
        eta = 1.0 - e[s.EFFICIENCY] * (1.0 + 0.2 * np.tanh(np.log(ratio / 6.0)))
        lost += (1.0 - eta * eta) * rt
    if e[s.CHAMBER_HEAT] != 0.0:
        q = e[s.CHAMBER_HEAT] * (max(p, 0.0) / (10.0 * BAR)) ** 0.8 * area / np.sqrt(1.0 + t / e[s.CHAMBER_HEAT_FADE])
        lost += min(q / (heat * max(flow, 0.02)), 0.5 * rt)
    return rt - lost, gamma, lost * heat * flow


@njit(cache=True)
def critical_flux(tab: Array, temperature: float, pressure: float, density: float) -> float:
    """Leung's (1986) critical mass flux [kg/(m^2 s)] of a saturated liquid: omega method, fitted eta_c."""
    h = nitrous.saturated(tab, nitrous.H_V, temperature) - nitrous.saturated(tab, nitrous.H_L, temperature)
    v = 1.0 / nitrous.saturated(tab, nitrous.RHO_V, temperature) - 1.0 / density
    c_p = nitrous.saturated(tab, nitrous.H_L, temperature + 0.5) - nitrous.saturated(
        tab, nitrous.H_L, temperature - 0.5
    )
    omega = max(density * c_p * temperature * pressure * (v / h) ** 2, 0.5)
    l = np.log(omega)  # noqa: E741
    eta = 0.55 + 0.217 * l - 0.046 * l * l + 0.004 * l**3
    return float(eta / np.sqrt(omega) * np.sqrt(pressure * density))


@njit(cache=True)
def run(c: Array, e: Array, tab: Array, gas: Array, count: int) -> tuple[Array, Array]:
    """Traces (count, TRACES) from the opening in steps of STEP, and events: t_v, t_purge, t_fuel_out (nan if none)."""
    out = np.zeros((count, s.TRACES))
    events = np.full(3, np.nan)
    dt, volume, ambient = STEP, c[s.VOLUME], c[s.AMBIENT]
    mass, temperature = c[s.MASS], c[s.TEMPERATURE]
    energy = nitrous.internal_energy(tab, temperature, mass, volume)
    port, throat, liquid, exponent = c[s.PORT], c[s.THROAT_RADIUS], True, 0.0
    wall, deficit, nuclei, drawn, nitrogen, heat = temperature, 0.0, 0.12, 0.0, 0.0, 0.0
    ullage0 = volume - nitrous.liquid_mass(tab, temperature, mass, volume) / nitrous.saturated(
        tab, nitrous.RHO_L, temperature
    )
    p_v, m_v, t_v, boost, gruen, mass_before = 0.0, 1.0, temperature, 0.0, 0.3, mass
    f1, f2, f4, f5, f6, f7, f8 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    fresh = True
    p_c, chamber, ratio, share = ambient, -1.0, 1.0, 0.0
    p_run, closed_run, wet_before = ambient, 0.0, -1.0
    for k in range(count):
        t = k * dt
        opened = t < c[s.CLOSING]
        # where the tank is
        if liquid:
            temperature = nitrous.flash(tab, energy, mass, volume, temperature)
            wet = nitrous.liquid_mass(tab, temperature, mass, volume)
            if wet <= 0.0 and k > 0:
                # the step in which the last liquid left, split where it did (all histories are linear within it)
                part = wet_before / (wet_before - wet)
                cold = out[k - 1, s.T_TANK]
                m_v, t_v = mass_before + part * (mass - mass_before), cold + part * (temperature - cold)
                events[0] = t - dt + part * dt
                p_v = nitrous.saturated(tab, nitrous.P, t_v)
                gruen = nitrous.saturated(tab, nitrous.GRUENEISEN, t_v)
                boost = -deficit
                # for the rest of the step vapour flows, not liquid
                series = c[s.K_LOSS] + 0.5 / (c[s.AREA] * c[s.AREA])
                vapor_flow = np.sqrt(m_v / volume / series) * root(p_v - p_c) if opened else 0.0
                mass = m_v - vapor_flow * (1.0 - part) * dt
                liquid, temperature, fresh = False, t_v, True
            wet_before, mass_before = wet, mass
        full = volume
        if liquid:
            density_l = nitrous.saturated(tab, nitrous.RHO_L, temperature)
            full = max(volume - wet / density_l, 1e-5)
            p_vapor = nitrous.saturated(tab, nitrous.P, temperature)
            layer = e[s.LAYER] * np.exp(-((drawn / max(e[s.LAYER_VOLUME], 1e-9)) ** 1.3)) if e[s.LAYER] != 0.0 else 0.0
            p_t = (
                nitrous.saturated(tab, nitrous.P, temperature + layer) - deficit if layer != 0.0 else p_vapor - deficit
            )
            density, enthalpy = density_l, nitrous.saturated(tab, nitrous.H_L, temperature)
            if e[s.INGESTION] > 0.0 and wet / density_l < e[s.INGESTION]:
                void = 0.8 * (1.0 - wet / density_l / e[s.INGESTION]) ** 1.5
                rho_v = nitrous.saturated(tab, nitrous.RHO_V, temperature)
                density = void * rho_v + (1.0 - void) * density_l
                x = void * rho_v / density
                enthalpy += x * (nitrous.saturated(tab, nitrous.H_V, temperature) - enthalpy)
        else:
            wet, layer = 0.0, 0.0
            p_vapor = (p_v + boost) * (mass / m_v) ** c[s.POLYTROPE] * np.exp(exponent)
            temperature = t_v * (mass / m_v) ** (c[s.POLYTROPE] - 1.0) * np.exp(exponent)
            p_t, density_l = p_vapor, 0.0
            density = (mass + nitrogen) / volume
            enthalpy = nitrous.saturated(tab, nitrous.H_V, t_v)
        if nitrogen > 0.0:
            p_t += nitrogen * NITROGEN_GAS * (temperature if liquid else t_v) / full
        if e[s.DISSOLVED] != 0.0:
            p_t += e[s.DISSOLVED] * ((ullage0 / full) ** 0.4 if liquid else (ullage0 / volume) ** 0.4 * mass / m_v)
        # purge line: it follows the tank through its check valve
        above = c[s.SUPPLY] - c[s.CRACKING] - p_t
        p_purge, blown = c[s.SUPPLY], 0.0
        if above > 0.0 and opened:
            if np.isnan(events[1]):
                events[1] = t
            p_purge = p_t + c[s.CRACKING]
            if e[s.NITROGEN_FLOW] != 0.0:
                blown = e[s.NITROGEN_FLOW] * (above / (10.0 * BAR)) ** 0.6
                p_purge += above * e[s.NITROGEN_FLOW] / (e[s.NITROGEN_FLOW] + 0.03)
        elif above > 0.0:
            p_purge = out[k - 1, s.P_PURGE]
        # feed line and injector
        flow = injected = tank_flow = 0.0
        p_there = p_c
        critical = critical_flux(tab, temperature, p_vapor, density_l) if liquid and e[s.TWO_PHASE] != 0.0 else 1.0
        filled = 1.0
        if opened:
            area = c[s.AREA] * injector_factor(e, t, liquid, p_run, p_c, density, critical)
            loss = c[s.K_LOSS] * feed_factor(e, t, liquid, p_run, p_t)
            flow = np.sqrt(density / (loss + 0.5 / (area * area))) * root(p_t - p_c)
            if k == 0:  # the factors depend on p_run, which is not there yet
                p_run = p_t - loss * flow * flow / density
                area = c[s.AREA] * injector_factor(e, t, liquid, p_run, p_c, density, critical)
                flow = np.sqrt(density / (loss + 0.5 / (area * area))) * root(p_t - p_c)
            p_run = p_t - loss * flow * flow / density
            if e[s.LINE] > 0.0:
                filled = 1.0 - np.exp(-(drawn + 2e-5) / e[s.LINE])
            tank_flow, injected = flow, flow * filled
            shown = p_run if filled == 1.0 else p_c + filled * filled * (p_run - p_c)
            closed_run = shown
        else:
            shown = ambient + (closed_run - ambient) * np.exp(-(t - c[s.CLOSING]) / 0.12)
        leak = e[s.LEAK] * (p_t / (50.0 * BAR)) ** 0.9 if e[s.LEAK] != 0.0 else 0.0
        # grain
        flux = injected / (pi * port * port)
        plain = c[s.REGRESSION_A] * flux ** c[s.REGRESSION_N] if flux > 0.0 else 0.0
        speed = plain * regression_factor(e, t, p_c, flux, port, c)
        burning = burning_share(e, port, c[s.OUTER], speed * dt)
        perimeter = 2.0 * pi * min(port, c[s.OUTER] + 4.0 * e[s.SLIVER]) * c[s.LENGTH] * c[s.FUEL_DENSITY]
        fuel = perimeter * speed * burning
        if np.isnan(events[2]) and speed > 0.0 and port + speed * dt >= c[s.OUTER]:
            events[2] = t + (c[s.OUTER] - port) / speed
        whole = burning if e[s.SLIVER] == 0.0 else (1.0 if port < c[s.OUTER] else 0.0)
        fuel_plain = perimeter * plain * whole
        gas_share = 0.0 if liquid else nitrogen / (mass + nitrogen)
        # chamber
        room = c[s.DEAD_VOLUME] + pi * min(port, c[s.OUTER]) ** 2 * c[s.LENGTH]
        extra = 0.0
        if e[s.IGNITION] != 0.0:
            extra = e[s.IGNITION] * t / e[s.IGNITION_TIME] ** 2 * np.exp(-t / e[s.IGNITION_TIME])
        if chamber < 0.0:
            ratio = injected / max(fuel, 1e-9)
            rt, gamma, lost = hot_gas(gas, e, c[s.ENTHALPY], share, ambient, ratio, injected + fuel, 1.0, t)
            chamber = ambient * room / rt
        burnt = min(port / c[s.PORT], c[s.OUTER] / c[s.PORT])
        rt, gamma, lost = hot_gas(gas, e, c[s.ENTHALPY], share, p_c, ratio, injected + fuel, burnt, t)
        p_c = chamber * rt / room
        if p_c < ambient:  # air comes back in
            p_c, chamber = ambient, ambient * room / rt
        throat_now = throat
        if e[s.DEPOSIT] != 0.0:
            stuck = 1.0 - np.exp(-heat / e[s.DEPOSIT_TIME])
            throat_now = max(throat - e[s.DEPOSIT] * stuck * np.exp(-0.3 * heat / e[s.DEPOSIT_TIME]), 0.5 * throat)
        at = pi * throat_now * throat_now
        leaving = nozzle.outflow(p_c, rt, gamma, at, c[s.EXIT_AREA], ambient)
        push = nozzle.thrust(p_c, rt, gamma, at, c[s.EXIT_AREA], ambient, e[s.SEPARATED])
        real = push
        if e[s.DIVERGENCE] != 0.0 and p_c > ambient:
            real = push * (1.0 - e[s.DIVERGENCE] * (1.0 + 0.2 * np.sqrt(min(10.0 * BAR / p_c, 10.0))))
        base_at = pi * c[s.THROAT_RADIUS] ** 2
        push_base = push
        if e[s.SEPARATED] != 0.0 or at != base_at:
            push_base = nozzle.thrust(p_c, rt, gamma, base_at, c[s.EXIT_AREA], ambient, 0.0)
        blanket, conducted = heat_in(c, e, t, wet / c[s.MASS], wall, temperature, liquid)
        o = out[k]
        o[s.P_TANK], o[s.P_RUN], o[s.P_CHAMBER], o[s.P_PURGE], o[s.THRUST] = p_t, shown, p_c, p_purge, real
        o[s.M_TANK], o[s.FLOW], o[s.FUEL], o[s.FUEL_BASE] = mass + nitrogen, injected, fuel, fuel_plain
        # p_run against the line's base law and the injector's, both at what is really there
        clean = density_l if liquid else density
        o[s.FLOW_BASE] = c[s.AREA] * np.sqrt(2.0 * clean) * root(shown - p_there) if opened else 0.0
        o[s.LOSS] = p_t - shown if opened else 0.0
        o[s.LOSS_BASE] = c[s.K_LOSS] * injected * injected / density if opened else 0.0
        o[s.CHAMBER_SOURCE], o[s.CHAMBER_POWER], o[s.THRUST_BASE] = extra, -lost, push_base
        o[s.TANK_HEAT], o[s.TANK_SOURCE], o[s.T_TANK] = blanket + conducted, blown - leak, temperature
        o[s.LIQUID], o[s.RADIUS], o[s.CHAMBER_MASS], o[s.NOZZLE_FLOW] = wet, port, chamber, leaving
        o[s.THROAT], o[s.TANK_FLOW], o[s.OUT_ENTHALPY] = throat_now, tank_flow, enthalpy
        # rates of what is slow
        own = 1.0 - gas_share
        g1 = -tank_flow * own - leak * own
        g2 = -tank_flow * enthalpy + blanket + conducted
        if leak != 0.0:
            g2 -= leak * nitrous.saturated(tab, nitrous.H_V, temperature)
        g4 = gruen * (blanket + conducted) / (p_t * volume) if not liquid else 0.0
        g5 = -conducted / max(e[s.WALL_CAPACITY], 1.0)
        g6 = tank_flow / density
        g7 = blown - gas_share * (tank_flow + leak)
        g8 = p_c / (10.0 * BAR) if p_c > 1.5 * BAR else 0.0
        if fresh:
            f1, f2, f4, f5, f6, f7, f8 = g1, g2, g4, g5, g6, g7, g8
            fresh = False
        mass = max(mass + dt * (1.5 * g1 - 0.5 * f1), 1e-4)
        energy += dt * (1.5 * g2 - 0.5 * f2)
        port += dt * speed if burning > 1e-6 else 0.0
        exponent += dt * (1.5 * g4 - 0.5 * f4)
        wall += dt * (1.5 * g5 - 0.5 * f5)
        drawn += dt * (1.5 * g6 - 0.5 * f6)
        nitrogen = max(nitrogen + dt * (1.5 * g7 - 0.5 * f7), 0.0)
        heat += dt * (1.5 * g8 - 0.5 * f8)
        f1, f2, f4, f5, f6, f7, f8 = g1, g2, g4, g5, g6, g7, g8
        if e[s.LAG] != 0.0 and liquid:
            # boiling behind the pressure: the ullage expands at once, vapour comes as bubbles have grown
            sink = nuclei / e[s.LAG_TIME]
            source = e[s.LAG] * 1.2 * p_vapor * tank_flow / density / full
            deficit = source / sink + (deficit - source / sink) * np.exp(-sink * dt)
            nuclei += dt * (deficit / (3.0 * BAR) + 0.1) / e[s.LAG_NUCLEATION]
            nuclei = min(nuclei, 3.0)
        if e[s.EROSION] != 0.0 and g8 > 0.0:
            throat += dt * e[s.EROSION] * g8**0.8 * (1.0 - np.exp(-((t / e[s.EROSION_DELAY]) ** 2)))
        # the chamber's gas: exponential of the outflow linearised about the present mass
        if p_c > 1.3 * ambient:
            slope = leaving / chamber
        else:
            step = 1e-4
            more = nozzle.outflow(p_c * (1.0 + step), rt, gamma, at, c[s.EXIT_AREA], ambient)
            slope = max((more - leaving) / (step * chamber), 1e-3)
        if injected > 0.0:
            slope += 0.5 * injected / max(p_t - p_there, 5.0) * rt / room
        entering = injected + fuel + extra
        new = chamber + (entering - leaving) * (1.0 - np.exp(-slope * dt)) / slope
        if injected + fuel > 1e-7:
            mix = 1.0 - np.exp(-(injected + fuel) * dt / chamber)
            y = ratio / (1.0 + ratio)
            y += (injected / (injected + fuel) - y) * mix
            ratio = min(max(y / max(1.0 - y, 1e-9), 1e-3), 1e6)
            share += (gas_share - share) * mix if injected > 0.0 else 0.0
        chamber = max(new, 1e-7)
    return out, events
