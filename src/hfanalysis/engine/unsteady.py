"""The unsteady engine (report, chapter 3): tank, feed, grain, chamber, nozzle and the rocket's ascent in one system.

State: tank mass, tank temperature, port radius, oxidizer and fuel stored in the chamber, altitude, speed, impulse. The
chamber pressure follows from the stored masses by the gas law. Phases change by events of the solver: the liquid runs
out, the fuel is gone. The right-hand side is compiled; CVODE (BDF) integrates, for the chamber's time constant is
milliseconds.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numba import njit
from numpy.typing import NDArray

from hfanalysis.engine.blowdown import FeedSystem
from hfanalysis.engine.injector import mass_flow, mass_flow_with_feed
from hfanalysis.engine.nozzle import expand
from hfanalysis.engine.tank import compressibility, liquid_mass, temperature_rate
from hfanalysis.flight.constant_thrust import EARTH_RADIUS, STANDARD_GRAVITY, Vehicle
from hfanalysis.thermo.atmosphere import HIGHEST
from hfanalysis.thermo.combustion import PROPEP_OXIDIZER_ENTHALPY
from hfanalysis.thermo.combustion_table import CombustionTable, Grid, chamber_pressure, gas_at
from hfanalysis.thermo.constants import AIR_MOLAR_MASS, GAS_CONSTANT
from hfanalysis.thermo.saturation import LIQUID_VOLUME, LN_PRESSURE, Saturation, evaluate

Array = NDArray[np.float64]
Table = tuple[Array, float, float, float]

STATES = ("tank_mass", "tank_temperature", "port_radius", "chamber_oxidizer", "chamber_fuel", "altitude", "speed",
          "impulse")  # fmt: skip
TANK, TEMPERATURE, RADIUS, OXIDIZER, FUEL, ALTITUDE, SPEED, IMPULSE = range(8)
OUTPUTS = (
    "tank_pressure",
    "chamber_pressure",
    "chamber_temperature_by_mass",
    "thrust",
    "oxidizer_flow",
    "fuel_flow",
    "nozzle_flow",
    "of_ratio",
    "acceleration",
)


PAD = 1e-3
"""Height [m] above which a rocket has left its pad."""

SMALL_FLUX = 0.01
"""Oxidizer flux [kg/(m^2 s)] below which regression is bent to a finite slope."""

MOST_CALLS = 150_000
"""Evaluations of the right-hand side after which an engine is given up; a burn takes about a thousand."""


@dataclass(frozen=True)
class Engine:
    """An engine in SI units: what an engine file states."""

    saturation: Saturation
    combustion: CombustionTable
    feed: FeedSystem
    oxidizer_mass: float
    temperature: float
    polytropic_exponent: float | None
    fuel_mass: float
    grain_length: float
    outer_radius: float
    fuel_density: float
    a: float
    n: float
    dead_volume: float
    throat_area: float
    exit_area: float
    vehicle: Vehicle
    oxidizer_enthalpy: float = PROPEP_OXIDIZER_ENTHALPY

    @property
    def port_radius(self) -> float:
        """Initial port radius [m]."""
        return sqrt(self.outer_radius**2 - self.fuel_mass / (pi * self.fuel_density * self.grain_length))


@dataclass(frozen=True)
class Burn:
    """Histories on the solver's steps: ``states`` (n, 8) as STATES, ``outputs`` (n, 9) as OUTPUTS; events in seconds.

    ``burn_time`` is where the integration ended: the fuel is gone if ``fuel_out``.
    """

    time: Array
    states: Array
    outputs: Array
    liquid_out: float | None
    burn_time: float
    steps: int = 0
    fuel_out: bool = True

    def output(self, name: str) -> Array:
        """One of OUTPUTS over time."""
        return self.outputs[:, OUTPUTS.index(name)]

    def state(self, name: str) -> Array:
        """One of STATES over time."""
        return self.states[:, STATES.index(name)]


@njit(cache=True)
def air(altitude: float) -> tuple[float, float]:
    """Pressure [Pa] and density [kg/m^3] of the atmosphere model (report, appendix A.2), held above 30 km."""
    z = min(altitude, HIGHEST)
    if z < 11_000.0:
        t = -0.00649 * z + 288.19
        p = 101_290.0 * (t / 288.08) ** 5.256
    elif z < 25_000.0:
        t = 216.69
        p = 22_650.0 * np.exp(1.73 - 0.000157 * z)
    else:
        t = 0.00299 * z + 141.94
        p = 2488.0 * (t / 216.6) ** -11.388
    return p, p * AIR_MOLAR_MASS / (GAS_CONSTANT * t)


@njit(cache=True)
def flux_power(flux: float, n: float) -> float:
    """G^n, below SMALL_FLUX the parabola that joins it smoothly and ends in 0 with a finite slope."""
    if flux >= SMALL_FLUX:
        return float(flux**n)
    x = max(flux, 0.0) / SMALL_FLUX
    return float(SMALL_FLUX**n * x * (2.0 - n - (1.0 - n) * x))


@njit(cache=True)
def rates(y: Array, liquid: bool, sat: Table, gas: Grid, c: Array, dy: Array, out: Array) -> None:
    """Right-hand side; ``c`` holds the engine's constants in the order of :func:`_constants`."""
    volume, area, factor, constant = c[0], c[1], c[2], c[4] >= 0.0
    ambient, rho = air(y[5])
    port = y[2]
    chamber_volume = c[9] + pi * port * port * c[6]
    mass = max(y[3] + y[4], 1e-9)
    ratio = min(max(y[3], 1e-9) / max(y[4], 1e-9), 1e4)
    p_c, rt, gamma = chamber_pressure(gas, mass, chamber_volume, np.log(ratio), c[20], 0.0, ambient)
    if liquid:
        p_t = np.exp(evaluate(*sat, LN_PRESSURE, y[1])[0])
        density = 1.0 / evaluate(*sat, LIQUID_VOLUME, y[1])[0]
        loss = c[4]
    else:
        p_t = c[14] * (y[0] / c[15]) ** c[3]
        density = y[0] / volume
        loss = c[5]
    if constant:
        flow = mass_flow(area, density, p_t - loss - p_c)
    else:
        flow = mass_flow_with_feed(area, factor, density, p_t - p_c)
    opening = c[7] * flux_power(flow / (pi * port * port), c[8])
    fuel_flow = c[10] * 2.0 * pi * port * c[6] * opening
    nozzle, thrust, _, _, _ = expand(gamma, rt, p_c, ambient, c[11], c[12])
    dy[0] = -flow
    dy[1] = temperature_rate(sat, volume, y[0], y[1], flow, 0.0) if liquid else y[1] * (c[3] - 1.0) * -flow / y[0]
    dy[2] = opening
    dy[3] = flow - nozzle * y[3] / mass
    dy[4] = fuel_flow - nozzle * y[4] / mass
    total = c[16] + y[0] + c[10] * pi * c[6] * (c[13] * c[13] - port * port) + y[3] + y[4]
    pull = total * STANDARD_GRAVITY * (EARTH_RADIUS / (EARTH_RADIUS + y[5])) ** 2 * c[18]
    net = thrust - 0.5 * c[17] * rho * y[6] * abs(y[6]) - pull
    # on its pad the rocket stands; what lifts it is the thrust alone
    stands = y[5] <= c[19] + PAD
    dy[5] = y[6] * c[18]
    dy[6] = 0.0 if stands and net <= 0.0 else net / total
    dy[7] = thrust
    out[0], out[1], out[2], out[3] = p_t, p_c, rt, thrust
    out[4], out[5], out[6], out[7] = flow, fuel_flow, nozzle, ratio
    out[8] = dy[6]


def _constants(e: Engine) -> Array:
    liquid_loss, vapor_loss = e.feed.constant_losses or (-1.0, -1.0)
    v = e.vehicle
    return np.array(
        [
            e.feed.volume, e.feed.area, e.feed.loss_factor, e.polytropic_exponent or np.nan, liquid_loss, vapor_loss,
            e.grain_length, e.a, e.n, e.dead_volume, e.fuel_density, e.throat_area, e.exit_area, e.outer_radius,
            0.0, 0.0, v.dry_mass, v.drag_coefficient * v.frontal_area, np.cos(v.launch_angle),
            v.launch_altitude, e.oxidizer_enthalpy,
        ]
    )  # fmt: skip


def _initial(e: Engine, c: Array) -> Array:
    """The chamber starts full of equilibrium gas at ambient pressure and at the O/F that enters (0/0 in the report)."""
    ambient, _ = air(e.vehicle.launch_altitude)
    p_t = float(e.saturation.pressure(e.temperature))
    density = float(e.saturation.liquid_density(e.temperature))
    if c[4] >= 0.0:
        flow = mass_flow(c[1], density, p_t - c[4] - ambient)
    else:
        flow = mass_flow_with_feed(c[1], c[2], density, p_t - ambient)
    r = e.port_radius
    fuel = e.fuel_density * 2.0 * pi * r * e.grain_length * e.a * (flow / (pi * r * r)) ** e.n
    ratio = flow / fuel
    rt, _ = gas_at(e.combustion.kernel, np.log(ambient), np.log(ratio), e.oxidizer_enthalpy, 0.0)
    mass = ambient * (e.dead_volume + pi * r * r * e.grain_length) / rt
    stored = (mass * ratio / (1.0 + ratio), mass / (1.0 + ratio))
    return np.array([e.oxidizer_mass, e.temperature, r, *stored, e.vehicle.launch_altitude, 0.0, 0.0])


def check(engine: Engine) -> None:
    """Raise ValueError, with the reason, for an engine that cannot be lit."""
    e, s = engine, engine.saturation
    sizes = {
        "the tank's volume": e.feed.volume, "the injector's area": e.feed.area, "the oxidizer": e.oxidizer_mass,
        "the fuel": e.fuel_mass, "the grain's length": e.grain_length, "the grain's radius": e.outer_radius,
        "the fuel's density": e.fuel_density, "a": e.a, "the throat": e.throat_area, "the dry mass": e.vehicle.dry_mass,
    }  # fmt: skip
    for name, value in sizes.items():
        if not 0.0 < value < np.inf:
            raise ValueError(f"{name} has to be positive, not {value}")
    if e.exit_area < e.throat_area:
        raise ValueError(
            f"the nozzle's exit ({e.exit_area:.3g} m^2) is smaller than the throat ({e.throat_area:.3g} m^2)"
        )
    if not s.t_min < e.temperature < s.t_max:
        raise ValueError(
            f"no saturated tank at {e.temperature} K: the properties hold from {s.t_min:.2f} to {s.t_max:.2f} K"
        )
    least, most = (
        e.feed.volume * float(rho) for rho in (s.vapor_density(e.temperature), s.liquid_density(e.temperature))
    )
    if not least < e.oxidizer_mass < most:
        raise ValueError(
            f"a saturated tank holds {least:.3f} to {most:.3f} kg at {e.temperature} K, not {e.oxidizer_mass:.3f} kg"
        )
    full = pi * e.outer_radius**2 * e.grain_length * e.fuel_density
    if e.fuel_mass >= full:
        raise ValueError(f"{e.fuel_mass:.3f} kg of fuel do not fit a grain that is full at {full:.3f} kg")
    loss = e.feed.constant_losses[0] if e.feed.constant_losses is not None else 0.0
    pressure, ambient = float(s.pressure(e.temperature)) - loss, air(e.vehicle.launch_altitude)[0]
    if pressure <= ambient:
        raise ValueError(f"nothing flows: {pressure:.0f} Pa behind the feed line against {ambient:.0f} Pa outside")


def burn(engine: Engine, longest: float = 120.0, rtol: float = 1e-7) -> Burn:
    """From ignition until the fuel is gone (or ``longest`` seconds).

    Raises ValueError for an engine that cannot be, ArithmeticError where the solver gives up.
    """
    check(engine)
    c = _constants(engine)
    y = _initial(engine, c)
    sat, gas = engine.saturation.kernel_table, engine.combustion.kernel
    times, states = [0.0], [y.copy()]
    t, liquid_out, done, fuel_out, liquid = 0.0, None, False, False, True
    wet_until = 0
    while not done:
        part_t, part_y, event = _phase(y, t, longest, liquid, sat, gas, c, rtol)
        times.extend(part_t[1:])
        states.extend(part_y[1:])
        t, y = float(part_t[-1]), np.array(part_y[-1])
        if event == 0 and liquid:
            liquid, liquid_out, wet_until = False, t, len(times)
            _begin_vapor(engine, c, y)
            done = fuel_out = bool(y[RADIUS] >= engine.outer_radius)
        elif event == 2:
            y[ALTITUDE], y[SPEED] = c[19], 0.0
        else:
            done, fuel_out = True, event == 1
    outputs = _outputs(np.array(states), wet_until if liquid_out is not None else len(times), sat, gas, c)
    return Burn(np.array(times), np.array(states), outputs, liquid_out, t, len(times), fuel_out)


def _begin_vapor(engine: Engine, c: Array, y: Array) -> None:
    c[14], c[15] = float(engine.saturation.pressure(y[TEMPERATURE])), y[TANK]
    if engine.polytropic_exponent is None:
        cv, cp = engine.saturation.heat_capacities(y[TEMPERATURE])
        c[3] = float(cp / cv)


def _phase(
    y: Array, start: float, longest: float, liquid: bool, sat: Table, gas: Grid, c: Array, rtol: float
) -> tuple[Array, Array, int]:
    """Integrate one phase; event 0: liquid gone, 1: fuel gone, 2: fallen to the ground, -1: none."""
    from sksundae.cvode import CVODE

    out = np.empty(len(OUTPUTS))
    calls = 0

    def rhs(t: float, state: Array, dy: Array) -> None:
        nonlocal calls
        calls += 1
        if calls > MOST_CALLS:
            raise ArithmeticError(f"the engine cannot be integrated beyond {t:.3f} s: the solver hardly advances")
        rates(state, liquid, sat, gas, c, dy, out)

    def events(t: float, state: Array, values: Array) -> None:
        values[0] = liquid_mass(sat, c[0], state[0], state[1]) if liquid else 1.0
        values[1] = c[13] - state[2]
        values[2] = state[5] - c[19] + PAD

    events.terminal = [True, True, True]  # type: ignore[attr-defined]
    scale = np.array([1e-3, 1e-2, 1e-5, 1e-7, 1e-7, 1e-2, 1e-3, 1e-1])
    options = {"eventsfn": events, "num_events": 3, "max_num_steps": 100_000}
    solver = CVODE(rhs, method="BDF", rtol=rtol, atol=rtol * scale * 10.0, **options)
    solution = solver.solve(np.array([start, longest]), y)
    if not solution.success and solution.status < 0:
        raise ArithmeticError(f"the engine cannot be integrated beyond {solution.t[-1]:.3f} s: {solution.message}")
    hit = solution.i_events[-1] if solution.i_events is not None and len(solution.i_events) else None
    event = -1 if hit is None else int(np.flatnonzero(hit)[0])
    return solution.t, solution.y, event


@njit(cache=True)
def _outputs(states: Array, wet_until: int, sat: Table, gas: Grid, c: Array) -> Array:
    """OUTPUTS of every state; the tank holds liquid in the first ``wet_until`` of them."""
    out = np.empty((len(states), len(OUTPUTS)))
    scratch = np.empty(8)
    for i in range(len(states)):
        rates(states[i], i < wet_until, sat, gas, c, scratch, out[i])
    return out


def vapor_compressibility(engine: Engine, burnt: Burn) -> float | None:
    """Z of the vapour when the liquid runs out; None where it does not."""
    if burnt.liquid_out is None:
        return None
    i = int(np.searchsorted(burnt.time, burnt.liquid_out))
    y = burnt.states[i]
    p = float(engine.saturation.pressure(y[TEMPERATURE]))
    return compressibility(p, engine.feed.volume, float(y[TANK]), float(y[TEMPERATURE]))
