"""The unsteady engine (report, chapter 3): from ignition to burn-out, and on through cold gas where asked.

The equations are in :mod:`hfanalysis.engine.model`, the integration in :mod:`hfanalysis.engine.phases`; here an engine
in plain numbers becomes what they read, and their steps become histories.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hfanalysis.arrays import Array
from hfanalysis.engine import phases
from hfanalysis.engine.chamber import LEAST_GAS, chamber_volume
from hfanalysis.engine.effect import Active, Composition, compose
from hfanalysis.engine.equations import (
    COMPRESSIBILITY,
    CONSTANTS,
    O_AMBIENT,
    O_CHAMBER_PRESSURE,
    OUTPUTS,
    STATES,
    Equations,
    nothing_kept,
)
from hfanalysis.engine.feed_line import NO_STATED_LOSSES, FeedSystem, line_flow
from hfanalysis.engine.grain import Grain, flux_power, oxidizer_flux
from hfanalysis.engine.model import PAD, rates
from hfanalysis.engine.phases import RunHistory
from hfanalysis.engine.sites import ENVIRONMENT, SITES
from hfanalysis.engine.tank import nitrogen_pressure
from hfanalysis.rocket.vehicle import Vehicle
from hfanalysis.thermo.air import air
from hfanalysis.thermo.combustion import FORMATION_OFFSET
from hfanalysis.thermo.combustion_table import CombustionTable, gas_at, temperatures
from hfanalysis.thermo.saturation import Property, Saturation

__all__ = ["OUTPUTS", "PAD", "STATES", "Burn", "Engine", "burn", "check", "flux_power", "vapor_compressibility"]

ACCURACY = 3e-5
"""Default relative tolerance of a run [-]. Evidence: with 1e-8 no number that is reported of the design point moves by
1e-4 (tests/engine/test_unsteady.py)."""

NO_DRAG = np.zeros((2, 1))
"""Drag table of an engine without a vehicle [-]. Source: by definition, none."""

POINTS_PER_STEP = 4
"""Points of the histories per step of the solver, where no times are asked for."""


@dataclass(frozen=True)
class Engine:
    """An engine in SI units: what an engine file states.

    ``oxidizer_enthalpy`` on the formation scale [J/kg]: one number for the whole run (the report), or None for that of
    the liquid or vapor leaving the tank. ``spare_web`` [m] of fuel behind the grain's wall burns on (for fits in which
    the end of the fuel is an observation of its own), and at ``fuel_end`` [s] the fire is out whatever web is left (for
    fits in which that instant is known). ``nitrogen_mass`` [kg] presses on the liquid from the start. An engine without
    a ``vehicle`` stands at ``ambient_pressure`` [Pa].
    """

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
    vehicle: Vehicle | None = None
    ambient_pressure: float | None = None
    oxidizer_enthalpy: float | None = None
    spare_web: float = 0.0
    fuel_end: float = inf
    nitrogen_mass: float = 0.0
    effects: tuple[Active, ...] = field(default=())

    @property
    def grain(self) -> Grain:
        """The fuel grain."""
        return Grain(self.grain_length, self.outer_radius, self.fuel_density, self.a, self.n)

    @property
    def tank_pressure(self) -> float:
        """At ignition [Pa]: that of the saturated liquid, and of the nitrogen above it."""
        return float(self.saturation.pressure(self.temperature)) + nitrogen_pressure(
            self.saturation, self.feed.volume, self.oxidizer_mass, self.temperature, self.nitrogen_mass
        )

    @property
    def port_radius(self) -> float:
        """Initial port radius [m]."""
        return self.grain.port_radius(self.fuel_mass)

    @property
    def ambient(self) -> float:
        """Ambient pressure at ignition [Pa]."""
        if self.vehicle is not None:
            return float(air(self.vehicle.launch_altitude)[0])
        if self.ambient_pressure is None:
            raise ValueError("an engine without a vehicle needs an ambient pressure")
        return self.ambient_pressure

    def equations(self, composition: Composition) -> Equations:
        """What compiled code reads [SI], with scratch of its own."""
        drag = NO_DRAG if self.vehicle is None else self.vehicle.drag_table
        return Equations(
            rates.address, phases.event_values.address, self.saturation.kernel_table, self.combustion.kernel, drag,
            composition.constants, composition.terms, np.zeros(len(ENVIRONMENT)), np.zeros(len(SITES)),
            nothing_kept(),
        )  # fmt: skip


@dataclass(frozen=True)
class Steps:
    """The solver's steps as :func:`hfanalysis.engine.phases.integrate` returns them, and what they were made with.

    ``last`` keeps what was asked for last and before that: residuals and their slopes ask at the same instants.
    """

    history: RunHistory
    engine: Engine
    composition: Composition
    last: list[tuple[Array, Array, Array]] = field(default_factory=list, compare=False, repr=False)

    @property
    def times(self) -> Array:
        """Start and end of every step [s], (n, 2)."""
        return self.history.times

    @property
    def begin(self) -> Array:
        """States [SI] at the start of every step, (n, states)."""
        return self.history.begin

    @property
    def end(self) -> Array:
        """States [SI] at the end of every step, before an event changes them, (n, states)."""
        return self.history.end

    @property
    def events(self) -> NDArray[np.int64]:
        """The event at the end of every step (-1: none), (n,)."""
        return self.history.events

    def at(self, times: ArrayLike) -> tuple[Array, Array]:
        """States (n, states) and outputs (n, outputs) [SI] at increasing ``times`` (n,) [s]; the ends are held."""
        where = np.ascontiguousarray(times, dtype=np.float64)
        for asked, states, outputs in self.last:
            if np.array_equal(asked, where):
                return states, outputs
        states, outputs = phases.sample(where, self.history, self.engine.equations(self.composition))
        states.flags.writeable = outputs.flags.writeable = False
        self.last[:] = [(where.copy(), states, outputs), *self.last[:1]]
        return states, outputs


@dataclass(frozen=True)
class Burn:
    """A run: its ``steps``, histories at ``time``, and events in seconds.

    ``burn_time`` is where the fuel was gone if ``fuel_out``, else where the run ended. ``unchoked``: when the nozzle
    last unchoked (None: it did not).
    """

    time: Array
    liquid_out: float | None
    burn_time: float
    steps: Steps
    fuel_out: bool = True
    unchoked: float | None = None

    @property
    def states(self) -> Array:
        """As STATES [SI], (n, 15 and those of effects), found when they are first asked for."""
        return self._histories[0]

    @property
    def outputs(self) -> Array:
        """As OUTPUTS [SI], (n, 16), found when they are first asked for."""
        return self._histories[1]

    @cached_property
    def _histories(self) -> tuple[Array, Array]:
        return self.steps.at(self.time)

    def output(self, name: str) -> Array:
        """One of OUTPUTS over time [SI], (n,); raises ValueError for a name that is none."""
        return self.outputs[:, OUTPUTS.index(name)]

    def last(self, name: str) -> float:
        """One of OUTPUTS at the end of the run [SI]; raises ValueError for a name that is none."""
        return float(self.steps.history.outputs[-1, 1, OUTPUTS.index(name)])

    def state(self, name: str) -> Array:
        """One of STATES over time [SI], (n,); raises ValueError for a name that is none."""
        return self.states[:, STATES.index(name)]

    def chamber_temperature(self) -> Array:
        """Temperature of the burnt gas [K], (n,)."""
        nitrogen = self.state("chamber_nitrogen")
        share = nitrogen / np.maximum(self.state("chamber_oxidizer") + nitrogen, LEAST_GAS)
        ln_p, ln_r = np.log(self.output("chamber_pressure")), np.log(self.output("of_ratio"))
        gas = self.steps.engine.combustion.kernel
        return temperatures(gas, ln_p, ln_r, self.output("oxidizer_enthalpy"), share)


def constants(e: Engine) -> Array:
    """The engine's numbers [SI] in the order of CONSTANTS, (27,)."""
    liquid_loss, vapor_loss = e.feed.constant_losses or NO_STATED_LOSSES
    v = e.vehicle
    exponent = np.nan if e.polytropic_exponent is None else e.polytropic_exponent
    enthalpy = np.nan if e.oxidizer_enthalpy is None else e.oxidizer_enthalpy
    rocket = (1.0, 0.0, 1.0, 0.0)
    if v is not None:
        rocket = (v.dry_mass, v.frontal_area, float(np.cos(v.launch_angle)), v.launch_altitude)
    values = (
        e.feed.volume, e.feed.area, e.feed.loss_factor, exponent, liquid_loss, vapor_loss, e.grain_length, e.a, e.n,
        e.dead_volume, e.fuel_density, e.throat_area, e.exit_area, e.outer_radius, enthalpy, *rocket,
        e.ambient, float(v is not None), e.fuel_mass, e.oxidizer_mass, e.temperature, e.spare_web,
        e.fuel_end, e.nitrogen_mass,
    )  # fmt: skip
    out = np.array(values)
    assert out.size == len(CONSTANTS)
    return out


def initial(e: Engine, composition: Composition) -> Array:
    """States at ignition [SI], (states,).

    The chamber starts full of equilibrium gas at ambient pressure and at the O/F that enters (0/0 in the report).
    """
    ambient = e.ambient
    p_t = e.tank_pressure
    density = float(e.saturation.liquid_density(e.temperature))
    stated = (e.feed.constant_losses or NO_STATED_LOSSES)[0]
    flow = line_flow(e.feed.area, e.feed.loss_factor, stated, density, p_t - ambient)
    r = e.port_radius
    ratio = flow / (e.grain.ring(r) * e.a * oxidizer_flux(flow, r) ** e.n)
    enthalpy = e.oxidizer_enthalpy
    if enthalpy is None:
        enthalpy = FORMATION_OFFSET + float(e.saturation.energy(Property.LIQUID_ENTHALPY, e.temperature)[0])
    rt, _ = gas_at(e.combustion.kernel, np.log(ambient), np.log(ratio), enthalpy, 0.0)
    mass = ambient * chamber_volume(e.dead_volume, r, e.grain_length) / rt
    oxidizer, burnt = mass * ratio / (1.0 + ratio), mass / (1.0 + ratio)
    altitude = 0.0 if e.vehicle is None else e.vehicle.launch_altitude
    own = [e.nitrogen_mass, 0.0, oxidizer * enthalpy, 0.0, 0.0, 1.0, 1.0]
    base = [e.oxidizer_mass, e.temperature, r, oxidizer, burnt, altitude, 0.0, 0.0, *own]
    return np.concatenate([base, composition.initial(e)])


def check(engine: Engine) -> None:
    """Raise ValueError, with the reason, for an engine that cannot be lit."""
    e, s = engine, engine.saturation
    sizes = {
        "the tank's volume": e.feed.volume, "the injector's area": e.feed.area, "the oxidizer": e.oxidizer_mass,
        "the fuel": e.fuel_mass, "the grain's length": e.grain_length, "the grain's radius": e.outer_radius,
        "the fuel's density": e.fuel_density, "a": e.a, "the throat": e.throat_area, "the ambient pressure": e.ambient,
        "the dry mass": 1.0 if e.vehicle is None else e.vehicle.dry_mass,
    }  # fmt: skip
    if not e.fuel_end > 0.0:
        raise ValueError(f"the fuel has to end after ignition, not at {e.fuel_end} s")
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
    full = e.grain.fuel(0.0)
    if e.fuel_mass >= full:
        raise ValueError(f"{e.fuel_mass:.3f} kg of fuel do not fit a grain that is full at {full:.3f} kg")
    loss = e.feed.constant_losses[0] if e.feed.constant_losses is not None else 0.0
    pressure = e.tank_pressure - loss
    if pressure <= e.ambient:
        raise ValueError(f"nothing flows: {pressure:.0f} Pa behind the feed line against {e.ambient:.0f} Pa outside")


def burn(
    engine: Engine,
    longest: float = 120.0,
    rtol: float = ACCURACY,
    run_on: bool = False,
    times: Sequence[float] | Array | None = None,
    keep_idle: bool = False,
) -> Burn:
    """From ignition until fuel or pressure are gone, or if it is to ``run_on`` to ``longest`` [s], cold gas too.

    The histories are on POINTS_PER_STEP points of each of the solver's steps, or at increasing ``times`` (n,) [s] (then
    the ends are held). Effects of strength 0 are left out unless ``keep_idle``. Raises ValueError for an engine that
    cannot be, ArithmeticError where the solver gives up.
    """
    check(engine)
    composition = compose(engine.effects, constants(engine), len(STATES), keep_idle)
    y = initial(engine, composition)
    scales = np.concatenate([phases.SCALES, composition.scales])
    equations = engine.equations(composition)
    ending, history, happened = phases.integrate(y, float(longest), bool(run_on), rtol, scales, equations, True, True)
    if ending == phases.GIVEN_UP or not len(history.times):
        reached = history.times[-1, 1] if len(history.times) else 0.0
        raise ArithmeticError(f"the engine cannot be integrated beyond {reached:.4f} s: the solver hardly advances")
    steps = Steps(history, engine, composition)
    time = _refined(steps.times) if times is None else np.ascontiguousarray(times, dtype=np.float64)
    outputs = history.outputs[-1, 1]
    out, fuel = happened[phases.LIQUID_OUT], happened[phases.FUEL_OUT]
    end = float(steps.times[-1, 1])
    unchoked = happened[phases.CHOKING] if outputs[O_CHAMBER_PRESSURE] < 2.0 * outputs[O_AMBIENT] else np.nan
    return Burn(
        time, _or_none(out), float(fuel) if np.isfinite(fuel) else end, steps,
        bool(np.isfinite(fuel)), _or_none(unchoked),
    )  # fmt: skip


def _or_none(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _refined(times: Array) -> Array:
    share = np.arange(POINTS_PER_STEP) / POINTS_PER_STEP
    inner = times[:, :1] + share * (times[:, 1:] - times[:, :1])
    return np.append(inner.ravel(), times[-1, 1])


def vapor_compressibility(engine: Engine, burnt: Burn) -> float | None:
    """Z of the vapor [-] when the liquid runs out; None where it does not."""
    if burnt.liquid_out is None:
        return None
    return float(burnt.steps.end[-1, COMPRESSIBILITY])
