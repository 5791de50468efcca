"""A hypothesis: the engine of a test with named parameters that may move, each with its prior.

The calibrated constants are nuisances here: what they swallowed in calibration they must be free to give back. Above
all the polytropic exponent, which is a property of nitrous oxide and lies between 1.0 and 1.3, whatever a calibration
says.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hfanalysis.calibrate.engine_of_test import ASSUMED_EXPONENT
from hfanalysis.diagnose.probe import Splines
from hfanalysis.engine.effect import Active
from hfanalysis.engine.injector import mass_flow_with_feed
from hfanalysis.engine.unsteady import Engine

Array = NDArray[np.float64]


USUAL_N = (0.5, 0.15)
"""Flux exponent of hybrid fuels and its spread (Karabeyoglu et al. find 0.62 for paraffin with oxygen)."""


@dataclass(frozen=True)
class Free:
    """A parameter that may move: Gaussian prior about ``center`` with ``std``, of its logarithm if ``positive``."""

    name: str
    center: float
    std: float
    positive: bool = False

    def value(self, x: float) -> float:
        """The parameter [SI] at ``x`` standard deviations of its prior."""
        return self.center * float(np.exp(self.std * x)) if self.positive else self.center + self.std * x

    def slope(self, x: float) -> float:
        """Derivative of :meth:`value`."""
        return self.value(x) * self.std if self.positive else self.std


@dataclass(frozen=True)
class Block:
    """Coefficients of an unknown source: ``matrix`` times independent N(0, 1) numbers; ``sensor`` names a channel whose
    reading it adds to, else the coefficients are parameters of an effect of the engine."""

    names: tuple[str, ...]
    matrix: Array
    splines: Splines
    sensor: str | None = None


@dataclass(frozen=True)
class Hypothesis:
    """An engine and what may move in it; ``x`` below counts prior standard deviations, so that its prior is N(0, 1)."""

    engine: Engine
    free: tuple[Free, ...]
    blocks: tuple[Block, ...] = ()

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
        return (*(f.name for f in self.free), *(n for b in self.blocks if b.sensor is None for n in b.names))

    def places(self) -> list[tuple[Block, slice]]:
        """Where the blocks are among the parameters."""
        out, at = [], len(self.free)
        for block in self.blocks:
            out.append((block, slice(at, at + len(block.names))))
            at += len(block.names)
        return out

    def values(self, x: Array) -> dict[str, float]:
        """Parameters by name [SI]."""
        found = {f.name: f.value(float(v)) for f, v in zip(self.free, x, strict=False)}
        for block, place in self.places():
            found.update(zip(block.names, (block.matrix @ x[place]).tolist(), strict=True))
        return found

    def at(self, x: Array) -> Engine:
        """The engine with its parameters at ``x``."""
        engine_names = set(self.of_engine)
        values = {n: v for n, v in self.values(x).items() if n in engine_names}
        feed: dict[str, Any] = {n: values.pop(n) for n in ("volume", "area", "loss_factor") if n in values}
        own: dict[str, Any] = {n: v for n, v in values.items() if "." not in n}
        of_effects = {n: v for n, v in values.items() if "." in n}
        engine = replace(self.engine, feed=replace(self.engine.feed, **feed), **own)
        return replace(engine, effects=_moved(engine.effects, of_effects))

    def jacobian(self, x: Array) -> Array:
        """Derivatives (parameters, x) of the parameters [SI] with ``x``."""
        out = np.zeros((self.size, self.size))
        k = len(self.free)
        out[:k, :k] = np.diag([f.slope(float(v)) for f, v in zip(self.free, x, strict=False)])
        for block, place in self.places():
            out[place, place] = block.matrix
        return out

    def offset(self, channel: str, x: Array, times: Array) -> Array:
        """What unknown sources add to a sensor's reading."""
        total = np.zeros(times.size)
        for block, place in self.places():
            if block.sensor == channel:
                total += block.splines.at(times) @ (block.matrix @ x[place])
        return total

    def with_block(self, block: Block, active: Active | None = None) -> Hypothesis:
        """The same with an unknown source more."""
        engine = self.engine
        if active is not None:
            engine = replace(engine, effects=(*engine.effects, active))
        return Hypothesis(engine, self.free, (*self.blocks, block))


def _mid_flux(engine: Engine) -> float:
    """Oxidizer flux [kg/(m^2 s)] half-way through the web at two thirds of the tank's pressure across the injector."""
    pressure = float(engine.saturation.pressure(engine.temperature))
    density = float(engine.saturation.liquid_density(engine.temperature))
    flow = mass_flow_with_feed(engine.feed.area, engine.feed.loss_factor, density, pressure / 1.5)
    return float(flow / (pi * (0.5 * (engine.port_radius + engine.outer_radius)) ** 2))


def _moved(effects: tuple[Active, ...], values: Mapping[str, float]) -> tuple[Active, ...]:
    out = []
    for active in effects:
        names = [f"{active.effect.name}.{p.name}" for p in active.effect.parameters]
        out.append(Active(active.effect, tuple(values.get(n, v) for n, v in zip(names, active.values, strict=True))))
    return tuple(out)


def base_hypothesis(engine: Engine, calibration: Mapping[str, Any]) -> Hypothesis:
    """The report's model with its calibrated constants free."""
    exponent, spread = ASSUMED_EXPONENT
    loaded = calibration.get("oxidizer_mass") or {}
    free = [
        Free("area", engine.feed.area, 0.2, positive=True),
        Free("polytropic_exponent", exponent, spread),
        Free("oxidizer_mass", engine.oxidizer_mass, max(float(loaded.get("std") or 0.0), 0.005 * engine.oxidizer_mass)),
        Free("temperature", engine.temperature, 1.5),
        Free("a", engine.a * _mid_flux(engine) ** (engine.n - USUAL_N[0]), 1.0, positive=True),
        Free("n", *USUAL_N),
    ]
    if engine.feed.constant_losses is None and engine.feed.loss_factor > 0.0:
        free.insert(1, Free("loss_factor", engine.feed.loss_factor, 0.5, positive=True))
    return Hypothesis(replace(engine, polytropic_exponent=exponent), tuple(free))
