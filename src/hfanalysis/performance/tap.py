"""Where the chamber's gauge sits, and what that makes of its reading: the stagnation pressure before the nozzle.

A gauge at the head reads more than the nozzle has, where the port is not much wider than the throat; one behind the
grain reads the static pressure of moving gas. Where nobody says which, the reading is taken as it is, and what follows
from it may lie to one side.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.engine.port import heads_over_nozzle, stagnation_over_static
from hfanalysis.engine.unsteady import Engine
from hfanalysis.products.beyond import Beyond
from hfanalysis.quantity import Quantity
from hfanalysis.record.definition import TestDefinition
from hfanalysis.sentences import text

NARROW = 2.0
"""Port over throat area [-] below which the head stands so far above the nozzle that it is worth a warning. Source:
:mod:`hfanalysis.engine.port`: at 2 it is 6 %, more than a gauge errs."""

CHOKES = 1.0
"""Port over throat area [-] below which the port and not the throat sets the flow. Source: continuity at M = 1."""

SOURCE = "momentum of a flow that takes up heat and mass at constant area: Hill and Peterson, chapter 3"

SMOOTH, MIDDLE, MIXED = 1.0, 0.5, 0.0
"""How the flow widens behind the grain (``recovery`` of :mod:`hfanalysis.engine.port`)."""


class Chamber(Protocol):
    """An engine, as far as what lies before its nozzle goes."""

    @property
    def throat_area(self) -> float:
        """[m^2]."""

    @property
    def outer_radius(self) -> float:
        """Of the grain [m]."""


def tap_of(definition: TestDefinition) -> str | None:
    """``head`` or ``aft``, as [channels.p_chamber] states; None where it does not."""
    channel = definition.channels.get("p_chamber")
    return None if channel is None else channel.tap


@dataclass(frozen=True)
class Before:
    """Stagnation pressure before the nozzle over the gauge's reading [-], (n,): as taken, and between what it lies.

    ``head``: the head's pressure over it [-], at most.
    """

    factor: Array
    low: Array
    high: Array
    head: Array

    def mean(self, part: NDArray[np.bool_]) -> tuple[float, float]:
        """Low and high over what is taken [-], mean of the samples ``part`` (n,)."""
        return float(np.mean((self.low / self.factor)[part])), float(np.mean((self.high / self.factor)[part]))


def before_nozzle(tap: str | None, port: Array, gamma: Array, engine: Chamber) -> Before:
    """By the place of the ``tap``, for a ``port`` [m] and gas of ``gamma`` [-], (n,) each.

    Where gamma is not known nothing is corrected.
    """
    one, throat = np.ones(port.size), engine.throat_area
    area, chamber = pi * port**2 / throat, pi * engine.outer_radius**2 / throat
    smooth, middle, mixed = (
        np.nan_to_num(1.0 / heads_over_nozzle(gamma, area, chamber, r), nan=1.0) for r in (SMOOTH, MIDDLE, MIXED)
    )
    if tap == "aft":
        known = np.isfinite(gamma)
        static = [stagnation_over_static(g, chamber) if there else 1.0 for g, there in zip(gamma, known, strict=True)]
        factor = np.array(static)
        return Before(factor, factor, factor, 1.0 / mixed)
    return Before(*((middle, mixed, smooth) if tap == "head" else (one, mixed, one)), 1.0 / mixed)


def narrow(tap: str | None, engine: Engine, found: Before, burning: NDArray[np.bool_]) -> Iterator[Beyond]:
    """The warning of a port that is not much wider than the throat at ignition; ``burning``: samples that count."""
    ratio = pi * engine.port_radius**2 / engine.throat_area
    if ratio >= NARROW or not burning.any():
        return
    limit = CHOKES if ratio < CHOKES else NARROW
    heads = 100.0 * (found.head[burning] - 1.0)
    reads = {
        "head": "the gauge reads the head: c* and C_F take the stagnation pressure before the nozzle, lower by that",
        "aft": "the gauge reads behind the grain: the injector has the head's higher pressure behind it",
        None: "where the gauge sits is not stated ([channels.p_chamber] tap): if at the head, c* and its efficiency "
        "are lower by that, C_F higher, and a and n with them",
    }
    chokes = ", so that it chokes before the throat does," if ratio < CHOKES else ""
    words = text(
        "the port has {ratio:.2f} of the throat's area at ignition, below {limit:.0f}{chokes} and the head may stand "
        "up to {most:.0f} % above the nozzle at first, {least:.0f} % at the burn's end; by {source}; {reads}",
        ratio=ratio, limit=limit, chokes=chokes, most=float(heads.max()), least=float(heads.min()), source=SOURCE,
        reads=reads[tap],
    )  # fmt: skip
    yield Beyond(name="port_to_throat", value=Quantity(ratio), limit=limit, source=SOURCE, text=words)
