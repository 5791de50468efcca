"""A hypothesis: the engine of a test with named parameters that may move, each with its prior.

The calibrated constants are nuisances here: what they swallowed in calibration they must be free to give back. Above
all the polytropic exponent, which is a property of nitrous oxide and lies between 1.0 and 1.3, whatever a calibration
says.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import asinh, cosh, exp, log, sinh
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.assembly.calibrated import ASSUMED_EXPONENT
from hfanalysis.engine.effect import Active, Effect
from hfanalysis.engine.grain import USUAL_N, oxidizer_flux
from hfanalysis.engine.injector import mass_flow_with_feed
from hfanalysis.engine.unsteady import Engine
from hfanalysis.inference.fitting.laws import LAWS, engine_by_laws
from hfanalysis.inference.splines import Splines
from hfanalysis.products.calibration import Calibration
from hfanalysis.quantity import STATED

M_RANGE = 2.0
"""Standard deviations that the polytropic exponent may be off. Source: 0.95 to 1.35 bounds what nitrous oxide can do
near saturation; what a calibration found beyond that is an effect, and has to be found as one."""

LEAST_MASS_ERROR = 0.01
"""Least part of the loaded mass that it may be off, however well it was weighed. Evidence: a practice case without an
effect (P03), from another generator, has 10.7 for an unknown source where the 10 g that are stated are believed, and
would be claimed: what a tank of that mass does goes by the table of nitrous oxide as well. The price: without it heat
into the tank would gain 0.6 to 7.3 in log evidence (calibration cases C010007, C010031, C020032, C020118)."""

N_RANGE = 2.5
"""Standard deviations that n may be off. Source: -0.05 to 0.95, for a flux exponent below 0 or above 1 is no regression
law of a fuel."""


DEPARTURE = "departure: "
"""How the names of parameters begin that are departures from what a hypothesis says."""

OF_TABLE, OF_LAW, OF_COURSE = f"{DEPARTURE}table: ", f"{DEPARTURE}law: ", f"{DEPARTURE}course "
"""How those of a table, of a law, and of the course of an effect begin."""


@dataclass(frozen=True)
class Free:
    """A parameter that may move, as a function of x, whose prior is N(0, 1) between ``least`` and ``most``.

    ``shape``: "normal", center + std x; "positive", center exp(std x); "wide", center + std sinh(x), whose tails are
    long enough for an effect thirty times as large as a typical one. It is not ``unsure`` where a test states it.
    """

    name: str
    center: float
    std: float
    shape: Literal["normal", "positive", "wide"] = "normal"
    least: float = -np.inf
    most: float = np.inf
    unsure: bool = True

    def value(self, x: float) -> float:
        """The parameter [SI] at ``x`` (in prior standard deviations)."""
        if self.shape == "positive":
            return self.center * exp(self.std * x)
        return self.center + self.std * (sinh(x) if self.shape == "wide" else x)

    def slope(self, x: float) -> float:
        """Derivative of :meth:`value` [SI] with ``x``."""
        if self.shape == "positive":
            return self.value(x) * self.std
        return self.std * (cosh(x) if self.shape == "wide" else 1.0)

    def place(self, value: float) -> float:
        """The x at which the parameter has a value [SI], in prior standard deviations.

        >>> heat = Free("tank_heat.power", 0.0, 1000.0, "wide")
        >>> round(heat.value(2.0)), round(heat.place(heat.value(2.0)), 6)
        (3627, 2.0)
        """
        if self.shape == "positive":
            return log(value / self.center) / self.std
        scaled = (value - self.center) / self.std
        return asinh(scaled) if self.shape == "wide" else scaled


def free_parameters(effect: Effect) -> tuple[Free, ...]:
    """What may move in an effect: strengths with long tails, the rest about what is typical.

    What a test states (``given``) may move by its own uncertainty, which is ``typical`` of it.
    """
    out = []
    for i, p in enumerate(effect.parameters):
        name = f"{effect.name}.{p.name}"
        if i < effect.strengths:
            free = Free(name, 0.0, p.typical, "wide")
        elif p.low > 0.0 and p.typical > 0.4 * p.center:
            free = Free(name, p.center, log(1.0 + p.typical / p.center), "positive")
        else:
            free = Free(name, p.center, p.typical)
        least = free.place(p.low) if np.isfinite(p.low) and (free.shape != "positive" or p.low > 0) else -np.inf
        most = free.place(p.high) if np.isfinite(p.high) else np.inf
        out.append(
            replace(free, least=max(least, -FARTHEST_PARAMETER), most=min(most, FARTHEST_PARAMETER), unsure=not p.given)
        )
    return tuple(out)


MEASURED = 0.15
"""Of the spread that a parameter of an effect has among stands, what is left where the test itself states it."""

FARTHEST_PARAMETER = 5.0
"""Standard deviations of its prior that a parameter may be off."""


@dataclass(frozen=True)
class Block:
    """Coefficients of an unknown source: ``matrix`` (coefficients, numbers) times independent N(0, 1) numbers.

    ``sensor`` names a channel whose reading it adds to [SI], else the coefficients are parameters of an effect of the
    engine.
    """

    names: tuple[str, ...]
    matrix: Array
    splines: Splines
    sensor: str | None = None


@dataclass(frozen=True)
class Departures:
    """What a run reads more where tables and laws depart, by a standard deviation of each (departures,).

    ``reads``: by channel (points, departures) [SI], on the common grid; ``later`` (departures,) [s]: the end of the
    liquid; ``wider`` (departures,) [m]: the port at the end of the fuel. ``run``: whether the engine is run by the laws
    themselves; these are then for tables alone.
    """

    reads: Mapping[str, Array]
    later: Array
    wider: Array
    run: bool = False


@dataclass(frozen=True)
class Hypothesis:
    """An engine and what may move in it; ``x`` below counts prior standard deviations, so that its prior is N(0, 1)."""

    engine: Engine
    free: tuple[Free, ...]
    blocks: tuple[Block, ...] = ()
    departures: Departures | None = None

    @property
    def size(self) -> int:
        """Number of parameters."""
        return len(self.free) + sum(len(b.names) for b in self.blocks)

    @property
    def names(self) -> tuple[str, ...]:
        """Of all parameters."""
        return (*(f.name for f in self.free), *(n for b in self.blocks for n in b.names))

    @property
    def of_engine(self) -> tuple[str, ...]:
        """Names of those on which the engine depends."""
        own = (f.name for f in self.free if not f.name.startswith(DEPARTURE))
        return (*own, *(n for b in self.blocks if b.sensor is None for n in b.names))

    @property
    def of_departures(self) -> list[int]:
        """Where among the parameters the departures of the table of nitrous oxide and of laws are."""
        return [i for i, f in enumerate(self.free) if f.name.startswith((OF_TABLE, OF_LAW))]

    @property
    def of_courses(self) -> list[int]:
        """Where among the parameters the courses of effects are."""
        return [i for i, f in enumerate(self.free) if f.name.startswith(OF_COURSE)]

    @property
    def of_laws(self) -> list[int]:
        """Where among the parameters the departures of laws are."""
        return [i for i, f in enumerate(self.free) if f.name.startswith(OF_LAW)]

    def places(self) -> list[tuple[Block, slice]]:
        """Where the blocks are among the parameters."""
        out, at = [], len(self.free)
        for block in self.blocks:
            out.append((block, slice(at, at + len(block.names))))
            at += len(block.names)
        return out

    def values(self, x: Array) -> dict[str, float]:
        """Parameters by name, each in its SI unit, at ``x`` (parameters,) in prior standard deviations."""
        found = {f.name: f.value(float(v)) for f, v in zip(self.free, x, strict=False)}
        for block, place in self.places():
            found.update(zip(block.names, (block.matrix @ x[place]).tolist(), strict=True))
        return found

    def at(self, x: Array) -> Engine:
        """The engine with its parameters at ``x`` (parameters,), in prior standard deviations."""
        engine_names = set(self.of_engine)
        values = {n: v for n, v in self.values(x).items() if n in engine_names}
        feed: dict[str, Any] = {n: values.pop(n) for n in ("volume", "area", "loss_factor") if n in values}
        own: dict[str, Any] = {n: v for n, v in values.items() if "." not in n}
        of_effects = {n: v for n, v in values.items() if "." in n}
        engine = replace(self.engine, feed=replace(self.engine.feed, **feed), **own)
        return replace(engine, effects=_moved(engine.effects, of_effects))

    @property
    def runs_laws(self) -> bool:
        """Whether the engine is run by laws that depart, not what they add taken as linear."""
        return self.departures is not None and self.departures.run

    def linear(self, x: Array) -> Array:
        """The departures (departures,) whose additions are linear, in standard deviations; 0 for those of a run."""
        off = x[self.of_departures]
        if self.runs_laws:
            off[-len(LAWS.parameters) :] = 0.0
        return off

    def as_run(self, x: Array) -> Engine:
        """The engine that is run at ``x`` (parameters,): :meth:`at`, by its laws if these are run."""
        return engine_by_laws(self.at(x), x[self.of_laws]) if self.runs_laws else self.at(x)

    @property
    def of_run(self) -> tuple[str, ...]:
        """Names of all that a run's slopes are by: :attr:`of_engine`, and the laws if these are run."""
        laws = (f"{LAWS.name}.{law.name}" for law in LAWS.parameters)
        return (*self.of_engine, *laws) if self.runs_laws else self.of_engine

    def jacobian(self, x: Array) -> Array:
        """Derivatives (parameters, x) of the parameters [SI] with ``x``."""
        out = np.zeros((self.size, self.size))
        k = len(self.free)
        out[:k, :k] = np.diag([f.slope(float(v)) for f, v in zip(self.free, x, strict=False)])
        for block, place in self.places():
            out[place, place] = block.matrix
        return out

    def offset(self, channel: str, x: Array, times: Array) -> Array:
        """What unknown sources add to a sensor's reading [SI], at ``times`` (n,) [s after the opening] and ``x``
        (parameters,); shape (n,)."""
        total = np.zeros(times.size)
        for block, place in self.places():
            if block.sensor == channel:
                total += block.splines.at(times) @ (block.matrix @ x[place])
        return total

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Least and most of x (parameters,), in prior standard deviations."""
        loose = np.full(self.size - len(self.free), np.inf)
        least, most = ([getattr(f, side) for f in self.free] for side in ("least", "most"))
        return np.concatenate([least, -loose]), np.concatenate([most, loose])

    @property
    def nuisances(self) -> int:
        """How many of the parameters belong to the base model."""
        return sum("." not in f.name for f in self.free)

    @property
    def strengths(self) -> list[NDArray[np.int64]]:
        """Where among the parameters the strengths of each effect are that may move: those with long tails."""
        wide = [i for i, f in enumerate(self.free) if f.shape == "wide"]
        effect = [self.free[i].name.partition(".")[0] for i in wide]
        return [
            np.array([i for i, own in zip(wide, effect, strict=True) if own == name]) for name in dict.fromkeys(effect)
        ]

    @property
    def named(self) -> tuple[str, ...]:
        """The effects whose parameters may move."""
        return tuple(dict.fromkeys(f.name.partition(".")[0] for f in self.free if "." in f.name))

    def with_effect(self, effect: Effect, **stated: float) -> Hypothesis:
        """The same with an effect more, its parameters about their prior or what a test has ``stated`` [SI]."""
        free = tuple(
            replace(f, center=stated[own], std=MEASURED * f.std)
            if (own := f.name.partition(".")[2]) in stated and f.shape == "normal"
            else f
            for f in free_parameters(effect)
        )
        return self.with_active(effect.at(**stated), free)

    def with_active(self, active: Active, free: tuple[Free, ...]) -> Hypothesis:
        """The same with an effect more, and what may move in it."""
        engine = replace(self.engine, effects=(*self.engine.effects, active))
        return replace(self, engine=engine, free=(*self.free, *free))

    def without(self, name: str) -> Hypothesis:
        """The same without an effect."""
        effects = tuple(a for a in self.engine.effects if a.effect.name != name)
        free = tuple(f for f in self.free if f.name.partition(".")[0] != name)
        return replace(self, engine=replace(self.engine, effects=effects), free=free)

    def with_block(self, block: Block, active: Active | None = None) -> Hypothesis:
        """The same with an unknown source more."""
        engine = self.engine
        if active is not None:
            engine = replace(engine, effects=(*engine.effects, active))
        return replace(self, engine=engine, blocks=(*self.blocks, block))


def mid_flux(engine: Engine) -> float:
    """Oxidizer flux [kg/(m^2 s)] half-way through the web at two thirds of the tank's pressure across the injector."""
    pressure = float(engine.saturation.pressure(engine.temperature))
    density = float(engine.saturation.liquid_density(engine.temperature))
    flow = mass_flow_with_feed(engine.feed.area, engine.feed.loss_factor, density, pressure / 1.5)
    return float(oxidizer_flux(flow, 0.5 * (engine.port_radius + engine.outer_radius)))


def _moved(effects: tuple[Active, ...], values: Mapping[str, float]) -> tuple[Active, ...]:
    out = []
    for active in effects:
        names = [f"{active.effect.name}.{p.name}" for p in active.effect.parameters]
        out.append(Active(active.effect, tuple(values.get(n, v) for n, v in zip(names, active.values, strict=True))))
    return tuple(out)


def base_hypothesis(engine: Engine, calibration: Calibration, follow: bool = True) -> Hypothesis:
    """The report's model with its calibrated constants free.

    ``follow``: the oxidizer enters the chamber with the enthalpy that the tank's content has at that moment.
    """
    exponent, spread = ASSUMED_EXPONENT
    mass = engine.oxidizer_mass
    free = [
        Free("area", engine.feed.area, 0.5, "positive"),
        Free("polytropic_exponent", exponent, spread, least=-M_RANGE, most=M_RANGE),
        Free("oxidizer_mass", mass, max(calibration.oxidizer_mass.std or 0.0, LEAST_MASS_ERROR * mass)),
        Free("temperature", engine.temperature, 5.0),
        Free("a", engine.a * mid_flux(engine) ** (engine.n - USUAL_N[0]), 1.0, "positive"),
        Free("n", *USUAL_N, least=-N_RANGE, most=N_RANGE),
    ]
    if engine.feed.constant_losses is None and engine.feed.loss_factor > 0.0:
        free.insert(1, Free("loss_factor", engine.feed.loss_factor, 1.0, "positive"))
    free = [_as_stated(f, engine, calibration) for f in free]
    exponent = next(f.center for f in free if f.name == "polytropic_exponent")
    enthalpy = None if follow else engine.oxidizer_enthalpy
    return Hypothesis(replace(engine, polytropic_exponent=exponent, oxidizer_enthalpy=enthalpy), tuple(free))


CONSTANTS = {"area": "C_i", "loss_factor": "K_loss", "polytropic_exponent": "m", "a": "a", "n": "n"}
"""The constants of a calibration behind what may move."""

TIGHT = 1e-4
"""Part of a stated constant that it may be off where no deviation is stated: next to nothing."""


def _as_stated(free: Free, engine: Engine, calibration: Calibration) -> Free:
    """What may move, within what test.toml states where its constant is held."""
    held = getattr(calibration, CONSTANTS.get(free.name, "C_i"))
    if free.name not in CONSTANTS or held.verdict != STATED or not held.value:
        return free
    relative = max((held.std or 0.0) / held.value, TIGHT)
    if free.shape == "positive":
        center = {"area": engine.feed.area, "loss_factor": engine.feed.loss_factor}.get(free.name, held.value)
        return replace(free, center=center, std=relative, unsure=False)
    return replace(free, center=held.value, std=relative * held.value, unsure=False)
