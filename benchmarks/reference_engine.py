"""The report's unsteady model written down plainly (scipy, equilibrium inside the right-hand side), beside ours.

Nothing is tabulated, compiled or rearranged: moles of vapor and liquid with the report's three linear equations, the
chamber pressure as a state with the report's dp_c/dt, forward differences of T_c and W_c, the nozzle's equations solved
iteratively. With ``hfanalysis.engine.unsteady`` it shares the properties of nitrous oxide and constants of nature, no
equation.

Prints events, totals and states of both side by side, at times aligned by the events, and the ratio of the run times.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from math import cos, pi, sqrt
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from simulated.engines import hf5_like, maelstrom

from hfanalysis.engine.unsteady import Burn, Engine, burn
from hfanalysis.rocket.vehicle import gravity
from hfanalysis.thermo import atmosphere
from hfanalysis.thermo.combustion import Gas, equilibrium
from hfanalysis.thermo.constants import GAS_CONSTANT, OXIDIZER_MOLAR_MASS
from hfanalysis.thermo.saturation import Property

Array = NDArray[np.float64]

LEAST_PRESSURE = 0.3e5
"""Pressure [Pa] below which equilibrium is taken as at this one: the little burnt gas that is left hardly counts."""

COLD_GAMMA = 1.3
STATES = ("n_v", "n_l", "T", "r_f", "m_o", "m_f", "p_c", "z", "v", "impulse", "ejected", "m_x", "e_x")
SCALE = np.array([1e-3, 1e-2, 1.0, 1e-3, 1e-4, 1e-4, 1e4, 1.0, 1.0, 100.0, 0.1, 1e-4, 1e1])
"""What counts as small of each state: absolute tolerances are the relative one times this."""

COMPARED = (
    "tank_mass",
    "tank_temperature",
    "port_radius",
    "chamber_oxidizer",
    "chamber_fuel",
    "altitude",
    "speed",
    "impulse",
)


def area_ratio(mach: float, g: float) -> float:
    """A/A* (report, eq. for A_e/A_t)."""
    return (2.0 / (g + 1.0) * (1.0 + 0.5 * (g - 1.0) * mach**2)) ** (0.5 * (g + 1.0) / (g - 1.0)) / mach


def stagnation_over_static(mach: float, g: float) -> float:
    """p_0/p of isentropic flow."""
    return float((1.0 + 0.5 * (g - 1.0) * mach**2) ** (g / (g - 1.0)))


def over_shock(mach: float, g: float) -> float:
    """p_0y/p_0x of a normal shock."""
    first = (2.0 * g * mach**2 - (g - 1.0)) / (g + 1.0)
    second = (g + 1.0) * mach**2 / (2.0 + (g - 1.0) * mach**2)
    return float(first ** (-1.0 / (g - 1.0)) * second ** (g / (g - 1.0)))


def exit_behind_shock(mach_x: float, ratio: float, g: float) -> tuple[float, float]:
    """M_e and p_e/p_c behind a shock at M_x, from the report's equations for p_0y, A_y* and M_e."""
    recovered = over_shock(mach_x, g)
    mach = float(brentq(lambda m: area_ratio(m, g) - ratio * recovered, 1e-6, 1.0, xtol=1e-15))
    return mach, recovered / stagnation_over_static(mach, g)


def nozzle(gas: Gas, p_c: float, p_a: float, throat: float, exit_area: float) -> tuple[float, float]:
    """Mass flow [kg/s] and thrust [N], regime by regime with the report's equations, each solved by bracketing."""
    if p_c <= p_a:
        return 0.0, 0.0
    g, ratio, mach_t = gas.gamma, exit_area / throat, 1.0
    first = float(brentq(lambda m: area_ratio(m, g) - ratio, 1e-6, 1.0, xtol=1e-15))
    last = float(brentq(lambda m: area_ratio(m, g) - ratio, 1.0, 50.0, xtol=1e-15))
    p_2x = p_c / stagnation_over_static(last, g)
    if p_a >= p_c / stagnation_over_static(first, g):
        p_e = p_a
        mach = float(brentq(lambda m: stagnation_over_static(m, g) - p_c / p_e, 0.0, 1.0, xtol=1e-15))
        choked = exit_area / area_ratio(mach, g)
        mach_t = float(brentq(lambda m: area_ratio(m, g) - max(throat / choked, 1.0), 1e-9, 1.0, xtol=1e-15))
    elif p_a >= p_2x * (2.0 * g * last**2 - (g - 1.0)) / (g + 1.0):
        p_e = p_a
        shock = brentq(lambda m: exit_behind_shock(m, ratio, g)[1] - p_e / p_c, 1.0, last, xtol=1e-15)
        mach = exit_behind_shock(float(shock), ratio, g)[0]
    else:
        p_e, mach = p_2x, last
    velocity = mach * sqrt(g * gas.gas_constant * gas.temperature / (1.0 + 0.5 * (g - 1.0) * mach**2))
    flux = mach_t * (1.0 + 0.5 * (g - 1.0) * mach_t**2) ** (-0.5 * (g + 1.0) / (g - 1.0))
    flow = throat * p_c * flux * sqrt(g / (gas.gas_constant * gas.temperature))
    return flow, flow * velocity + (p_e - p_a) * exit_area


@dataclass
class Reference:
    """The right-hand side of one engine; ``m`` and ``p_v``, ``n_v`` hold once the liquid is gone, ``burnt_of`` (O/F of
    what is left of the burnt gas) once the fuel is."""

    engine: Engine
    liquid: bool = True
    burning: bool = True
    m: float = float("nan")
    p_v: float = float("nan")
    n_v: float = float("nan")
    burnt_of: float = float("nan")
    calls: int = 0

    def tank_pressure(self, n_v: float, temperature: float) -> float:
        """p_sat, or p nu^m = const along the vapor's expansion [Pa]."""
        if self.liquid:
            return float(self.engine.saturation.pressure(temperature))
        return self.p_v * (n_v / self.n_v) ** self.m

    def oxidizer_flow(self, x: Array, p_c: float) -> float:
        """ndot_o [kmol/s] through feed and injector."""
        e, w = self.engine, OXIDIZER_MOLAR_MASS
        molar_volume = float(e.saturation.liquid_volume(x[2])[0]) * w if self.liquid else e.feed.volume / x[0]
        losses = e.feed.constant_losses
        drop = self.tank_pressure(x[0], x[2]) - p_c - (0.0 if losses is None else losses[0 if self.liquid else 1])
        if drop <= 0.0:
            return 0.0
        if losses is not None:
            return e.feed.area * sqrt(2.0 * drop / (w * molar_volume))
        # the line's loss K mdot^2 / rho and the injector's in series, found as the report would: iteratively
        rho = w / molar_volume
        most = e.feed.area * sqrt(2.0 * rho * drop)
        lost = brentq(
            lambda flow: flow - e.feed.area * sqrt(2.0 * rho * max(drop - e.feed.loss_factor * flow**2 / rho, 0.0)),
            0.0,
            most,
        )
        return float(lost) / w

    def tank_rates(self, x: Array, flow: float) -> tuple[float, float, float]:
        """dn_v/dt, dn_l/dt, dT/dt: A x' = b of the report while there is liquid, else its explicit equations."""
        if not self.liquid:
            return -flow, 0.0, x[2] * (self.m - 1.0) / x[0] * -flow
        s, w = self.engine.saturation, OXIDIZER_MOLAR_MASS
        nu_l, nu_l_slope = (w * float(q) for q in s.liquid_volume(x[2]))
        nu_v, nu_v_slope = (w * float(q) for q in s.vapor_volume(x[2]))
        u_l, u_l_slope = (w * float(q) for q in s.energy(Property.LIQUID_ENERGY, x[2]))
        u_v, u_v_slope = (w * float(q) for q in s.energy(Property.VAPOR_ENERGY, x[2]))
        h = w * float(s.energy(Property.LIQUID_ENTHALPY, x[2])[0])
        a = np.array(
            [
                [1.0, 1.0, 0.0],
                [nu_v, nu_l, x[0] * nu_v_slope + x[1] * nu_l_slope],
                [u_v, u_l, x[0] * u_v_slope + x[1] * u_l_slope],
            ]
        )
        n_v, n_l, temperature = np.linalg.solve(a, np.array([-flow, 0.0, -flow * h]))
        return float(n_v), float(n_l), float(temperature)

    def __call__(self, _t: float, x: Array) -> list[float]:
        self.calls += 1
        if not self.burning:
            return self.cold(x)
        e = self.engine
        radius, m_o, m_f, p_c, altitude, speed = x[3:9]
        flow = self.oxidizer_flow(x, p_c)
        dn_v, dn_l, d_temperature = self.tank_rates(x, flow)
        mdot_o = OXIDIZER_MOLAR_MASS * flow
        opening = e.a * (mdot_o / (pi * radius**2)) ** e.n
        growth = 2.0 * pi * radius * e.grain_length * opening
        mdot_f = e.fuel_density * growth
        of = m_o / m_f
        gas = equilibrium(p_c, of)
        p_a = e.ambient if e.vehicle is None else atmosphere.pressure(altitude)
        ejected, thrust = nozzle(gas, p_c, p_a, e.throat_area, e.exit_area)
        dm_o, dm_f = mdot_o - ejected / (1.0 + 1.0 / of), mdot_f - ejected / (1.0 + of)
        d_of = (dm_o - of * dm_f) / m_f
        by_of, by_p = self.sensitivities(gas, p_c, of)
        volume = e.dead_volume + pi * radius**2 * e.grain_length
        dp_c = ((dm_o + dm_f) / (m_o + m_f) - growth / volume + d_of * by_of) / (1.0 / p_c - by_p)
        v = e.vehicle
        if v is None:
            return [dn_v, dn_l, d_temperature, opening, dm_o, dm_f, dp_c, 0.0, 0.0, thrust, ejected, 0.0, 0.0]
        mass = v.dry_mass + OXIDIZER_MOLAR_MASS * (x[0] + x[1]) + m_o + m_f
        mass += pi * e.fuel_density * e.grain_length * (e.outer_radius**2 - radius**2)
        drag = 0.5 * v.drag_coefficient * v.frontal_area * atmosphere.density(altitude) * speed**2
        push = (thrust - drag) / mass - gravity(altitude) * cos(v.launch_angle)
        if altitude <= v.launch_altitude + 1e-3:
            push = max(push, 0.0)
        climb = speed * cos(v.launch_angle)
        return [dn_v, dn_l, d_temperature, opening, dm_o, dm_f, dp_c, climb, push, thrust, ejected, 0.0, 0.0]

    def held(self, x: Array) -> tuple[float, Gas]:
        """Pressure of a chamber that holds burnt gas and gas that came in cold, and their mixture."""
        e, hot = self.engine, float(x[4] + x[5])
        volume = e.dead_volume + pi * x[3] ** 2 * e.grain_length
        of, partial = self.burnt_of, float(x[6])
        gas = equilibrium(max(partial, LEAST_PRESSURE), of)
        for _ in range(50):
            gas = equilibrium(max(partial, LEAST_PRESSURE), of)
            new = hot * gas.gas_constant * gas.temperature / volume
            if abs(new - partial) < 1e-9 * max(new, 1.0):
                break
            partial = new
        pressure, mass = partial + x[12] / volume, hot + x[11]
        gamma = (hot * gas.gamma + x[11] * COLD_GAMMA) / mass
        return pressure, Gas(pressure * volume / mass / GAS_CONSTANT * gas.molar_mass, gas.molar_mass, gamma)

    def cold(self, x: Array) -> list[float]:
        """Rates after burn-out: what enters stays as cold as the tank and mixes with what is left."""
        e = self.engine
        p_c, gas = self.held(x)
        flow = self.oxidizer_flow(x, p_c)
        dn_v, dn_l, d_temperature = self.tank_rates(x, flow)
        entering = OXIDIZER_MOLAR_MASS * flow
        ejected, thrust = nozzle(gas, p_c, e.ambient, e.throat_area, e.exit_area)
        leaving = ejected / (x[4] + x[5] + x[11])
        d_energy = entering * GAS_CONSTANT / OXIDIZER_MOLAR_MASS * x[2] - leaving * x[12]
        chamber = [-leaving * x[4], -leaving * x[5], 0.0]
        return [
            dn_v,
            dn_l,
            d_temperature,
            0.0,
            *chamber,
            0.0,
            0.0,
            thrust,
            ejected,
            entering - leaving * x[11],
            d_energy,
        ]

    @staticmethod
    def sensitivities(gas: Gas, p_c: float, of: float, step: float = 1e-4) -> tuple[float, float]:
        """d ln(T_c/W_c) by O/F and by p_c, by forward differences."""
        here = np.log(gas.temperature / gas.molar_mass)
        richer, denser = equilibrium(p_c, of * (1.0 + step)), equilibrium(p_c * (1.0 + step), of)
        by_of = (np.log(richer.temperature / richer.molar_mass) - here) / (of * step)
        by_p = (np.log(denser.temperature / denser.molar_mass) - here) / (p_c * step)
        return float(by_of), float(by_p)


@dataclass(frozen=True)
class Run:
    """The reference's phases as solutions with dense output."""

    phases: tuple[Any, ...]
    calls: int
    reference: Reference

    @property
    def events(self) -> tuple[float, ...]:
        """When each phase ended [s]."""
        return tuple(float(p.t[-1]) for p in self.phases)

    @property
    def end(self) -> Array:
        """Last state."""
        return np.asarray(self.phases[-1].y[:, -1])


def start(engine: Engine) -> Array:
    """Saturated tank; chamber filled with equilibrium gas at ambient pressure and the entering O/F."""
    r, e, w = engine.port_radius, engine, OXIDIZER_MOLAR_MASS
    s = e.saturation
    volumes = np.array(
        [[1.0, 1.0], [float(s.vapor_volume(e.temperature)[0]), float(s.liquid_volume(e.temperature)[0])]]
    )
    vapor, liquid = np.linalg.solve(volumes, np.array([e.oxidizer_mass, e.feed.volume]))
    p_a = e.ambient
    altitude = 0.0 if e.vehicle is None else e.vehicle.launch_altitude
    x = np.array([vapor / w, liquid / w, e.temperature, r, 0, 0, p_a, altitude, 0, 0, 0, 0, 0], dtype=float)
    mdot_o = Reference(e).oxidizer_flow(x, p_a) * w
    of = mdot_o / (e.fuel_density * 2.0 * pi * r * e.grain_length * e.a * (mdot_o / (pi * r**2)) ** e.n)
    gas = equilibrium(p_a, of)
    mass = p_a * (e.dead_volume + pi * r**2 * e.grain_length) / (gas.gas_constant * gas.temperature)
    x[4:6] = mass * of / (1.0 + of), mass / (1.0 + of)
    return x


def solve(engine: Engine, rtol: float = 1e-6, longest: float = 120.0, run_on: bool = False) -> Run:
    """From ignition until the fuel is gone, or on through cold gas for an engine on its stand."""
    reference, x, t, phases = Reference(engine), start(engine), 0.0, []

    def dry(_t: float, y: Array) -> float:
        return float(y[1]) if reference.liquid else 1.0

    def burnt(_t: float, y: Array) -> float:
        return engine.outer_radius - float(y[3]) if reference.burning else 1.0

    dry.terminal = burnt.terminal = True  # type: ignore[attr-defined]
    while True:
        phase = solve_ivp(
            reference,
            (t, longest),
            x,
            method="BDF",
            events=(dry, burnt),
            rtol=rtol,
            atol=rtol * SCALE,
            dense_output=True,
        )
        if not phase.success:
            raise ArithmeticError(phase.message)
        phases.append(phase)
        t, x = float(phase.t[-1]), phase.y[:, -1].copy()
        if phase.t_events[1].size and run_on:
            reference.burning, reference.burnt_of = False, float(x[4] / x[5])
            continue
        if not phase.t_events[0].size:
            return Run(tuple(phases), reference.calls, reference)
        capacities = engine.saturation.heat_capacities(x[2])
        reference.p_v, reference.n_v = reference.tank_pressure(x[0], x[2]), float(x[0])
        reference.m = engine.polytropic_exponent or float(capacities[1] / capacities[0])
        reference.liquid, x[1] = False, 0.0


def in_our_states(x: Array) -> Array:
    """The reference's states (rows) as the engine's: COMPARED, then the chamber pressure."""
    tank = OXIDIZER_MOLAR_MASS * (x[0] + x[1])
    return np.array([tank, x[2], x[3], x[4], x[5], x[7], x[8], x[9], x[6]])


def differences(ours: Burn, run: Run) -> dict[str, float]:
    """Largest difference of every state in its range, at times that are the same fraction of the same phase."""
    borders = [0.0, ours.liquid_out, ours.burn_time] if ours.liquid_out is not None else [0.0, ours.burn_time]
    if len(run.phases) == len(borders):
        borders.append(float(ours.time[-1]))
    theirs = [0.0, *run.events]
    mine = np.vstack([ours.state(name) for name in COMPARED] + [ours.output("chamber_pressure")])
    reference = np.empty_like(mine)
    for k, phase in enumerate(run.phases):
        low, high = borders[k], borders[k + 1]
        inside = (ours.time >= low) & (ours.time <= high)
        share = (ours.time[inside] - low) / (high - low)
        states = phase.sol(theirs[k] + share * (theirs[k + 1] - theirs[k]))
        reference[:, inside] = in_our_states(states)
        if k == 2:  # the pressure of the cold chamber is no state
            reference[8, inside] = [run.reference.held(x)[0] for x in states.T]
    span = np.ptp(reference, axis=1)
    worst = np.abs(mine - reference).max(axis=1)
    names = (*COMPARED, "chamber_pressure")
    return {name: float(w / s) for name, w, s in zip(names, worst, span, strict=True) if s > 1e-9}


def compare(title: str, engine: Engine, repeats: int, longest: float = 120.0, run_on: bool = False) -> None:
    """Print both runs of an engine side by side, and the ratio of their times."""
    burn(engine, longest, run_on=run_on)
    slow, fast = [], []
    for _ in range(3):
        started = perf_counter()
        run = solve(engine, longest=longest, run_on=run_on)
        slow.append(perf_counter() - started)
    for _ in range(max(repeats, 1) * 4):
        started = perf_counter()
        ours = burn(engine, longest, run_on=run_on)
        fast.append(perf_counter() - started)
    last = in_our_states(run.end)
    print(f"{title:28}{'engine':>14}{'reference':>14}{'difference':>12}")
    rows = [
        ("liquid out [s]", ours.liquid_out or np.nan, run.events[0]),
        ("burn time [s]", ours.burn_time, run.events[1]),
    ]
    rows += [(f"{name}, end", ours.state(name)[-1], last[i]) for i, name in enumerate(COMPARED)]
    for name, mine, theirs in rows:
        if theirs > 1e-6:
            print(f"{name:28}{mine:14.6f}{theirs:14.6f}{mine / theirs - 1.0:12.1e}")
    print("\nlargest difference of a state over the run, in its range")
    for name, worst in differences(ours, run).items():
        print(f"{name:28}{worst:12.1e}")
    ratio = median(slow) / median(fast)
    times = f"engine {1e3 * median(fast):.2f} ms, reference {median(slow):.2f} s"
    print(f"\n{times} ({run.calls} evaluations): {ratio:.0f} times faster\n")


def main(repeats: int = 5) -> int:
    """Print the comparisons."""
    compare("design point", maelstrom(), repeats)
    compare("like HF5, 17 s, cold gas", hf5_like(), repeats, longest=17.0, run_on=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
