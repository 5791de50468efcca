"""The tank alone, emptied through feed line and injector against a given chamber pressure.

The engine's own equations from the tank to the injector, with every site that effects have there; the chamber's
pressure, and the feed loss where that is given too, take the place of what is modeled behind. Fixed steps of the
classical Runge-Kutta method: the tank's time scales are seconds, a step is milliseconds, and the end of the liquid is
located inside its step by the secant rule, so that no step straddles the change of equations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.arrays import Array, Integers
from hfanalysis.compiled import compiled, inlined, separate
from hfanalysis.engine import equations as eq
from hfanalysis.engine import sites as at
from hfanalysis.engine.effect import Active, Composition, compose
from hfanalysis.engine.equations import EVALUATION, OUTPUTS, STATES, Equations, address_of, equations_at, rates_at
from hfanalysis.engine.feed_line import FeedSystem, feed
from hfanalysis.engine.injector import flow_resistance, mass_flows
from hfanalysis.engine.model import act, report, upstream
from hfanalysis.engine.tank import liquid_mass, run_dry, tank_rates
from hfanalysis.engine.unsteady import Engine, constants
from hfanalysis.thermo.combustion_table import CombustionTable
from hfanalysis.thermo.saturation import Saturation

NO_GAS = CombustionTable((np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((1, 1, 1, 1)), 0.0))
"""A tank alone burns nothing."""

GIVEN = ("since", "pressure", "pressure_slope", "loss", "loss_slope", "heat")
SINCE, PRESSURE, PRESSURE_SLOPE, LOSS, LOSS_SLOPE, HEAT = range(len(GIVEN))
"""What is given from ``since`` on [s, SI], the last of the constants: the chamber's pressure, the feed loss (NaN: the
engine's own) and heat into the saturated tank."""


@separate(EVALUATION)
def rates_alone(t: float, y: Array, liquid: bool, burning: bool, model: int, dy: Array, out: Array) -> None:
    """As :func:`hfanalysis.engine.model.rates`, from the tank to the injector.

    ``t`` [s]; ``y`` and ``dy`` (states,) as STATES [SI, SI/s]; ``out`` (outputs,) as OUTPUTS [SI].
    """
    m = equations_at(model)
    given = m.c[m.c.size - len(GIVEN) :]
    upstream(t, y, liquid, burning, m, dy)
    m.env[at.P_CHAMBER] = given[PRESSURE] + given[PRESSURE_SLOPE] * (t - given[SINCE])
    act(at.AT_FLOW, t, y, m, dy)
    if not np.isnan(given[LOSS]):
        m.site[at.FEED_LOSS] = lacking_loss(given[LOSS] + given[LOSS_SLOPE] * (t - given[SINCE]), m)
    feed(liquid, m)
    act(at.RATES, t, y, m, dy)
    if liquid:
        m.site[at.TANK_HEAT] += given[HEAT]
    tank_rates(y, liquid, m, dy)
    report(0.0, 0.0, dy, m, out)


@inlined
def lacking_loss(whole: float, m: Equations) -> float:
    """Pressure [Pa] that has to be lost beside the line's own loss, which effects may ask for, to make a ``whole`` one
    [Pa]."""
    c, env, site = m.c, m.env, m.site
    if c[eq.LIQUID_LOSS] >= 0.0:
        return float(whole - (c[eq.LIQUID_LOSS] if env[at.IS_LIQUID] > 0.0 else c[eq.VAPOR_LOSS]))
    factor = c[eq.LOSS_FACTOR] * site[at.FEED_FACTOR]
    share = factor / flow_resistance(c[eq.AREA], factor) * site[at.INJECTOR_FACTOR] * site[at.INJECTOR_FACTOR]
    return float((whole - share * (env[at.P_TANK] - env[at.P_CHAMBER])) / (1.0 - share))


@dataclass(frozen=True)
class TankRun:
    """Histories at ``time`` [s]: ``states`` and ``outputs`` as the engine has them; ``t_v``: liquid gone (NaN: not)."""

    time: Array
    states: Array
    outputs: Array
    t_v: float

    @property
    def pressure(self) -> Array:
        """In the tank [Pa], (n,)."""
        return self.outputs[:, eq.O_TANK_PRESSURE]

    @property
    def run_pressure(self) -> Array:
        """Before the injector [Pa], (n,)."""
        return self.outputs[:, eq.O_RUN_PRESSURE]

    @property
    def flow(self) -> Array:
        """Through the injector [kg/s], (n,)."""
        return self.outputs[:, eq.O_OXIDIZER_FLOW]

    @property
    def nitrogen_share(self) -> Array:
        """Of nitrogen in the flow, by mass [-], (n,)."""
        return self.outputs[:, eq.O_SHARE]

    @property
    def leak(self) -> Array:
        """Out of the tank by another way [kg/s], (n,)."""
        return np.asarray(self.outputs[:, eq.O_OUTFLOW] - self.outputs[:, eq.O_OXIDIZER_FLOW])

    @property
    def mass(self) -> Array:
        """Of nitrous oxide and nitrogen in the tank [kg], (n,)."""
        return np.asarray(self.states[:, eq.TANK] + self.states[:, eq.NITROGEN])

    @property
    def temperature(self) -> Array:
        """Of the tank [K], (n,)."""
        return self.states[:, eq.TEMPERATURE]

    def injector_factor(self, area: float, density: Array) -> Array:
        """Flow over A sqrt(2 rho (p_run - p_c)) [-], (n,); 1 where nothing flows.

        ``area`` A [m^2], ``density`` [kg/m^3] of what flows, (n,).
        """
        plain = mass_flows(area, density, self.run_pressure - self.outputs[:, eq.O_CHAMBER_PRESSURE])
        return np.where(plain > 0.0, self.flow / np.where(plain > 0.0, plain, 1.0), 1.0)


@dataclass(frozen=True)
class TankAlone:
    """An engine's tank, ready to be run; ``state`` is where its runs start."""

    engine: Engine
    composition: Composition
    equations: Equations
    state: Array

    @classmethod
    def of(cls, engine: Engine) -> TankAlone:
        """The tank of an engine as its temperature [K] and load [kg] have it."""
        composition = compose(engine.effects, constants(engine), len(STATES))
        c = np.concatenate([composition.constants, np.zeros(len(GIVEN))])
        state = np.zeros(len(STATES))
        state[[eq.TANK, eq.TEMPERATURE, eq.RADIUS]] = engine.oxidizer_mass, engine.temperature, engine.port_radius
        state[eq.NITROGEN] = engine.nitrogen_mass
        state = np.concatenate([state, composition.initial(engine)])
        equations = engine.equations(composition)._replace(rates=rates_alone.address, c=c)
        return cls(engine, composition, equations, state)

    def at(self, own: Array | None = None, **changes: float) -> TankAlone:
        """The same tank in another state: STATES by their names [SI], and ``own`` (own states,) [SI], those that
        effects bring along.

        Raises ValueError for a name that is none of STATES.
        """
        state = self.state.copy()
        for name, value in changes.items():
            state[STATES.index(name)] = value
        if own is not None:
            state[len(STATES) :] = own
        return replace(self, state=state)

    def with_feed(self, volume: float, area: float) -> TankAlone:
        """The same tank of another volume [m^3], behind another effective injector area [m^2]."""
        equations = self.equations._replace(c=self.equations.c.copy())
        equations.c[eq.VOLUME], equations.c[eq.AREA] = volume, area
        return replace(self, equations=equations)

    @property
    def moving(self) -> Integers:
        """Places of the states that change while the tank empties."""
        own = range(len(STATES), self.state.size)
        return np.array([eq.TANK, eq.TEMPERATURE, eq.NITROGEN, *own], dtype=np.int64)

    def run(
        self, time: Array, chamber: Array, loss: Array | None = None, vapor: bool = False, heat: float = 0.0
    ) -> TankRun:
        """Empty the tank against ``chamber`` [Pa], given at increasing ``time`` [s], both (n,), and linear between.

        ``loss`` [Pa], (n,): a given feed loss in place of the engine's own; ``heat`` [W]: into the saturated tank,
        beside that of effects. ``vapor``: there is no liquid, and ``vapor_compressibility`` and ``vapor_exponent`` are
        in the state.
        """
        self.equations.c[HEAT - len(GIVEN)] = heat
        columns = (time, chamber, np.full(np.size(time), np.nan) if loss is None else loss)
        t, p, given = (np.ascontiguousarray(column, dtype=np.float64) for column in columns)
        return TankRun(t, *march(self.equations, self.moving, self.state, t, p, given, vapor))


def tank_alone(
    saturation: Saturation, feed: FeedSystem, mass: float, temperature: float, polytropic_exponent: float,
    ambient: float = 101325.0, effects: Sequence[Active] = (),
) -> TankAlone:  # fmt: skip
    """A tank with ``mass`` [kg] at ``temperature`` [K], of which the engine behind the injector is not known.

    ``polytropic_exponent`` [-] of its vapor; ``ambient``: pressure [Pa] around it.
    """
    engine = Engine(
        saturation, NO_GAS, feed, mass, temperature, polytropic_exponent, fuel_mass=1.0, grain_length=0.5,
        outer_radius=0.04, fuel_density=900.0, a=1e-4, n=0.5, dead_volume=1e-3, throat_area=1e-3, exit_area=3e-3,
        ambient_pressure=ambient, oxidizer_enthalpy=0.0, effects=tuple(effects),
    )  # fmt: skip
    return TankAlone.of(engine)


def blow_down(
    saturation: Saturation, feed: FeedSystem, mass: float, temperature: float, time: Array, chamber_pressure: Array,
    polytropic_exponent: float, heat: float = 0.0,
) -> TankRun:  # fmt: skip
    """Empty a saturated tank (report, eq. 3.1 to 3.16) from ``mass`` [kg] and ``temperature`` [K].

    ``time`` [s] is increasing, ``chamber_pressure`` [Pa] is given at these times, both (n,), and taken linear between
    them. After the liquid is gone p = p_v (M/M_v)^m with Z held. ``heat`` [W] goes into the saturated tank.
    """
    alone = tank_alone(saturation, feed, mass, temperature, polytropic_exponent)
    return alone.run(time, chamber_pressure, heat=heat)


@compiled
def _step(
    m: Equations, moving: Integers, y: Array, t: float, h: float, liquid: bool, rates: Array, out: Array, trial: Array
) -> Array:
    """The state after one Runge-Kutta step; ``rates`` (4, states) hold those of its start, ``trial`` is scratch."""
    for k in range(1, 4):
        trial[:] = y
        ahead = h if k == 3 else 0.5 * h
        for i in moving:
            trial[i] += ahead * rates[k - 1, i]
        rates_at(t + ahead, trial, liquid, True, address_of(m), rates[k], out)
    after = y.copy()
    for i in moving:
        after[i] += h * (rates[0, i] + 2.0 * rates[1, i] + 2.0 * rates[2, i] + rates[3, i]) / 6.0
    return after


@compiled
def march(
    m: Equations, moving: Integers, start: Array, time: Array, chamber: Array, loss: Array, vapor: bool
) -> tuple[Array, Array, float]:
    """States (n, states) and outputs (n, outputs) [SI] at every ``time`` (n,) [s], and when the liquid was gone [s].

    The states ``moving`` go on from ``start`` (states,) [SI] against ``chamber`` pressure and feed ``loss`` [Pa], (n,)
    each; ``vapor``: there is no liquid.
    """
    given, y, t_v = m.c[m.c.size - len(GIVEN) :], start.copy(), np.nan
    states, outputs = np.empty((time.size, y.size)), np.empty((time.size, len(OUTPUTS)))
    rates, trial, out = np.zeros((4, y.size)), np.empty(y.size), np.zeros(len(OUTPUTS))
    left = 0.0 if vapor else liquid_mass(m.saturation, m.c[eq.VOLUME], y[eq.TANK], y[eq.TEMPERATURE])
    if not vapor and left <= 0.0:
        t_v = time[0]
        run_dry(m, y)
    for i in range(time.size):
        if i > 0:
            h = time[i] - time[i - 1]
            given[SINCE], given[PRESSURE], given[LOSS] = time[i - 1], chamber[i - 1], loss[i - 1]
            given[PRESSURE_SLOPE], given[LOSS_SLOPE] = (chamber[i] - chamber[i - 1]) / h, (loss[i] - loss[i - 1]) / h
            after = _step(m, moving, y, time[i - 1], h, left > 0.0, rates, out, trial)
            if left > 0.0:
                remaining = liquid_mass(m.saturation, m.c[eq.VOLUME], after[eq.TANK], after[eq.TEMPERATURE])
                if remaining <= 0.0:
                    part = left / (left - remaining)
                    after = _step(m, moving, y, time[i - 1], part * h, True, rates, out, trial)
                    t_v = time[i - 1] + part * h
                    run_dry(m, after)
                    rates_at(t_v, after, False, True, address_of(m), rates[0], out)
                    after = _step(m, moving, after, t_v, (1.0 - part) * h, False, rates, out, trial)
                left = remaining
            y = after
        given[SINCE], given[PRESSURE], given[LOSS] = time[i], chamber[i], loss[i]
        given[PRESSURE_SLOPE] = given[LOSS_SLOPE] = 0.0
        rates_at(time[i], y, left > 0.0, True, address_of(m), rates[0], out)
        states[i], outputs[i] = y, out
    return states, outputs, t_v
