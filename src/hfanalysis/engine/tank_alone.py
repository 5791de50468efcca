"""The tank alone on the engine's own equations, effects included, against a given chamber pressure.

What :mod:`hfanalysis.engine.blowdown` does for the base model, with every site of tank, feed line and injector. The
chamber behind the injector stands still; its pressure, and the feed loss where that is given too, are imposed by a term
that acts after all others. Fixed steps of the classical Runge-Kutta method, the end of the liquid located inside its
step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hfanalysis.compiled import compiled
from hfanalysis.engine.effect import Composition, Effect, Parameter, compose
from hfanalysis.engine.model import (
    AREA,
    COMPRESSIBILITY,
    EXPONENT,
    LIQUID_LOSS,
    LOSS_FACTOR,
    NITROGEN,
    O_CHAMBER_PRESSURE,
    O_OUTFLOW,
    O_OXIDIZER_FLOW,
    O_RUN_PRESSURE,
    O_SHARE,
    O_TANK_PRESSURE,
    OUTPUTS,
    POLYTROPIC_EXPONENT,
    STATES,
    TANK,
    TEMPERATURE,
    VAPOR_LOSS,
    VOLUME,
    Array,
    Equations,
    Integers,
    address_of,
    call,
)
from hfanalysis.engine.sites import (
    AT_CHAMBER,
    AT_FLOW,
    FEED_FACTOR,
    FEED_LOSS,
    INJECTOR_FACTOR,
    IS_LIQUID,
    P_CHAMBER,
    P_TANK,
    PARAMETERS_AT,
    TEMPERATURE_FACTOR,
    term,
)
from hfanalysis.engine.tank import SPECIFIC_GAS_CONSTANT, liquid_mass
from hfanalysis.engine.unsteady import Engine, constants, initial
from hfanalysis.thermo.saturation import LN_PRESSURE, evaluate

GIVEN = ("kind", "since", "pressure", "slope", "loss", "loss_slope")
KIND, SINCE, PRESSURE, SLOPE, LOSS, LOSS_SLOPE = range(len(GIVEN))
CHAMBER_GIVEN, LOSS_GIVEN = 1.0, 2.0
"""Kinds: the chamber pressure alone, or the feed loss with it."""


@term
def _impose(hook, t, env, c, p, x, site, dx):  # type: ignore[no-untyped-def]
    if hook == AT_CHAMBER:
        # the model multiplies by the factor next
        env[P_CHAMBER] = (p[PRESSURE] + p[SLOPE] * (t - p[SINCE])) / site[TEMPERATURE_FACTOR]
    elif hook == AT_FLOW and p[KIND] >= LOSS_GIVEN:
        # beside the line's own loss, which effects may ask for, as much as makes up what is given
        given, drop = p[LOSS] + p[LOSS_SLOPE] * (t - p[SINCE]), env[P_TANK] - env[P_CHAMBER]
        if c[LIQUID_LOSS] >= 0.0:
            site[FEED_LOSS] = given - (c[LIQUID_LOSS] if env[IS_LIQUID] > 0.0 else c[VAPOR_LOSS])
        else:
            line = 2.0 * c[AREA] * c[AREA] * c[LOSS_FACTOR] * site[FEED_FACTOR]
            share = line / (1.0 + line) * site[INJECTOR_FACTOR] * site[INJECTOR_FACTOR]
            site[FEED_LOSS] = (given - share * drop) / (1.0 - share)


_IMPOSED = Effect(
    name="~imposed",
    equation="chamber_mass",
    meaning="what is measured behind the tank takes the place of what is modelled there",
    reference="report, section 4.2.3",
    parameters=tuple(Parameter(name, "", "imposed", 1.0) for name in GIVEN),
    phases=(),
    term=_impose,
    reads=("temperature_factor", "feed_factor", "injector_factor"),  # so that it is the last of all in canonical order
)


@dataclass(frozen=True)
class TankRun:
    """Histories at ``time`` [s]: ``states`` and ``outputs`` as the engine has them; ``t_v``: liquid gone (NaN: not)."""

    time: Array
    states: Array
    outputs: Array
    t_v: float

    @property
    def pressure(self) -> Array:
        """In the tank [Pa]."""
        return self.outputs[:, O_TANK_PRESSURE]

    @property
    def run_pressure(self) -> Array:
        """Before the injector [Pa]."""
        return self.outputs[:, O_RUN_PRESSURE]

    @property
    def flow(self) -> Array:
        """Through the injector [kg/s]."""
        return self.outputs[:, O_OXIDIZER_FLOW]

    @property
    def nitrogen_share(self) -> Array:
        """Of nitrogen in the flow, by mass."""
        return self.outputs[:, O_SHARE]

    @property
    def leak(self) -> Array:
        """Out of the tank by another way [kg/s]."""
        return np.asarray(self.outputs[:, O_OUTFLOW] - self.outputs[:, O_OXIDIZER_FLOW])

    @property
    def mass(self) -> Array:
        """Of nitrous oxide and nitrogen in the tank [kg]."""
        return np.asarray(self.states[:, TANK] + self.states[:, NITROGEN])

    @property
    def temperature(self) -> Array:
        """Of the tank [K]."""
        return self.states[:, TEMPERATURE]

    def injector_factor(self, area: float, density: Array) -> Array:
        """Flow over A sqrt(2 rho (p_run - p_c)), ``density`` [kg/m^3] of what flows; 1 where nothing does."""
        drop = np.maximum(self.run_pressure - self.outputs[:, O_CHAMBER_PRESSURE], 0.0)
        plain = area * np.sqrt(2.0 * density * drop)
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
        """The tank of an engine as its temperature and load have it."""
        given = _IMPOSED.at(kind=CHAMBER_GIVEN)
        composition = compose((*engine.effects, given), constants(engine), len(STATES))
        return cls(engine, composition, engine.equations(composition), initial(engine, composition))

    def at(self, **changes: float | Array) -> TankAlone:
        """The same tank in another state: STATES by their names, and ``own``, those that effects bring along."""
        state = self.state.copy()
        own = changes.pop("own", None)
        for name, value in changes.items():
            state[STATES.index(name)] = value
        if own is not None:
            state[len(STATES) :] = own
        return replace(self, state=state)

    def with_feed(self, volume: float, area: float) -> TankAlone:
        """The same tank of another volume [m^3], behind another effective injector area [m^2]."""
        equations = self.equations._replace(c=self.equations.c.copy())
        equations.c[VOLUME], equations.c[AREA] = volume, area
        return replace(self, equations=equations)

    def run(self, time: Array, chamber: Array, loss: Array | None = None, vapor: bool = False) -> TankRun:
        """Empty the tank against ``chamber`` [Pa], given at increasing ``time`` [s] and linear between.

        ``loss`` [Pa]: a given feed loss in place of the engine's own. ``vapor``: there is no liquid, and
        ``vapor_compressibility`` and ``vapor_exponent`` are in the state.
        """
        row = [a.effect.name for a in self.composition.active].index(_IMPOSED.name)
        imposed = int(self.composition.terms[row, PARAMETERS_AT])
        self.equations.c[imposed + KIND] = CHAMBER_GIVEN if loss is None else LOSS_GIVEN
        columns = (time, chamber, chamber if loss is None else loss)
        t, p, given = (np.ascontiguousarray(column, dtype=np.float64) for column in columns)
        states, outputs, t_v = _march(self.equations, imposed, _moving(self.state.size), self.state, t, p, given, vapor)
        return TankRun(t, states, outputs, t_v)


def _moving(size: int) -> Integers:
    """The states that change: the tank's and those of effects."""
    return np.array([TANK, TEMPERATURE, NITROGEN, *range(len(STATES), size)], dtype=np.int64)


@compiled
def _step(
    m: Equations, moving: Integers, y: Array, t: float, h: float, liquid: bool, rates: Array, out: Array, trial: Array
) -> Array:
    """The state after one Runge-Kutta step; ``rates`` (4, states) and ``trial`` are scratch."""
    for k in range(4):
        trial[:] = y
        ahead = 0.0 if k == 0 else (h if k == 3 else 0.5 * h)
        if k > 0:
            for i in moving:
                trial[i] += ahead * rates[k - 1, i]
        call(m.rates, t + ahead, trial, liquid, True, address_of(m), rates[k], out)
    after = y.copy()
    for i in moving:
        after[i] += h * (rates[0, i] + 2.0 * rates[1, i] + 2.0 * rates[2, i] + rates[3, i]) / 6.0
    return after


@compiled
def _dry(m: Equations, y: Array) -> None:
    """The constants of the vapour are set as its liquid ends."""
    table, start, step, critical = m.saturation
    pressure = np.exp(evaluate(table, start, step, critical, LN_PRESSURE, y[TEMPERATURE])[0])
    y[COMPRESSIBILITY] = pressure * m.c[VOLUME] / (y[TANK] * SPECIFIC_GAS_CONSTANT * y[TEMPERATURE])
    y[EXPONENT] = m.c[POLYTROPIC_EXPONENT]


@compiled
def _march(
    m: Equations,
    imposed: int,
    moving: Integers,
    start: Array,
    time: Array,
    chamber: Array,
    loss: Array,
    vapor: bool,
) -> tuple[Array, Array, float]:
    c, y, t_v = m.c, start.copy(), np.nan
    states, outputs = np.empty((time.size, y.size)), np.empty((time.size, len(OUTPUTS)))
    rates, trial, out = np.zeros((4, y.size)), np.empty(y.size), np.zeros(len(OUTPUTS))
    left = 0.0 if vapor else liquid_mass(m.saturation, c[VOLUME], y[TANK], y[TEMPERATURE])
    if not vapor and left <= 0.0:
        t_v = time[0]
        _dry(m, y)
    for i in range(time.size):
        if i > 0:
            h = time[i] - time[i - 1]
            c[imposed + SINCE] = time[i - 1]
            c[imposed + PRESSURE], c[imposed + SLOPE] = chamber[i - 1], (chamber[i] - chamber[i - 1]) / h
            c[imposed + LOSS], c[imposed + LOSS_SLOPE] = loss[i - 1], (loss[i] - loss[i - 1]) / h
            after = _step(m, moving, y, time[i - 1], h, left > 0.0, rates, out, trial)
            if left > 0.0:
                remaining = liquid_mass(m.saturation, c[VOLUME], after[TANK], after[TEMPERATURE])
                if remaining <= 0.0:
                    part = left / (left - remaining)
                    after = _step(m, moving, y, time[i - 1], part * h, True, rates, out, trial)
                    t_v = time[i - 1] + part * h
                    _dry(m, after)
                    after = _step(m, moving, after, t_v, (1.0 - part) * h, False, rates, out, trial)
                left = remaining
            y = after
        c[imposed + SINCE], c[imposed + PRESSURE], c[imposed + LOSS] = time[i], chamber[i], loss[i]
        c[imposed + SLOPE] = c[imposed + LOSS_SLOPE] = 0.0
        call(m.rates, time[i], y, left > 0.0, True, address_of(m), rates[0], out)
        states[i], outputs[i] = y, out
    return states, outputs, t_v
