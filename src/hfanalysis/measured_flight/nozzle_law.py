"""Which law of the nozzle a log follows, and by which its thrust is taken to altitude.

Below some 6 bar the flow no longer fills a nozzle at the stand. There the one-dimensional law, a normal shock that
moves in, has far less thrust than a flow that separates from the wall: the thrust coefficient against the chamber
pressure tells which of them the log has.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.engine.separation import LAWS, ONE_DIMENSIONAL, SEPARATED, Law, thrusts
from hfanalysis.sentences import said, text

Mask = NDArray[np.bool_]

CHOKES = 2.0
"""Chamber over ambient pressure [-] from which on a throat chokes by either law."""

APART = 0.02
"""Relative difference of the two laws' thrusts [-] from which on a sample tells them apart."""

FEW = 20
"""Samples, of a thousand over the burn, that tell the laws apart from which on they are asked. Source: by choice, a
fiftieth of the burn."""

SURE = 4.0
"""Difference of the sums of squares from which on the better law is taken. Source: two standard deviations."""

LOSSES = 0.03
"""Standard deviation [-] of how a nozzle's losses change with its pressure, and of the one scale that all samples
share where none is known. Evidence: thrust over the law's is
1.02 at 12 bar and 1.00 to 1.01 from 2 to 5 bar in HF5, 0.99 to 1.03 at 8 to 10 bar in HF4."""


@dataclass(frozen=True)
class Followed:
    """The law by which the thrust is corrected, why, whether the two differ at all where thrust counts, and whether it
    is ``known`` that the stand's thrust follows it."""

    law: Law
    why: str
    matters: bool
    known: bool = False


def followed(
    measured: tuple[Array, Array, Array],
    ambient: float,
    areas: tuple[float, float],
    thrust_std: float,
    stated: Law | None,
    usual: Law,
) -> Followed:
    """By which law: as ``stated``, as the log has it, or the ``usual`` one.

    ``measured``: chamber pressure [Pa], its gas's gamma [-], and thrust [N] on the stand, (n,) each; ``ambient`` [Pa]
    there; ``areas`` of throat and exit [m^2]; ``thrust_std``: of the thrust's zero [N].
    """
    pressure, gamma, _ = measured
    one, off = (thrusts(law, gamma, pressure, ambient, *areas) for law in (ONE_DIMENSIONAL, SEPARATED))
    choked = pressure > CHOKES * ambient
    matters = bool(np.sum(np.abs(off - one)) > 1e-3 * np.sum(np.maximum(one, 0.0)))
    if stated is not None:
        return Followed(stated, "as stated in [model] nozzle", matters, True)
    if not matters:
        return Followed("one-dimensional", "the nozzle flows full while thrust counts", False, True)
    telling = choked & (np.abs(off - one) > APART * np.maximum(one, 1.0))
    if telling.sum() < FEW:
        return Followed(usual, "the log does not tell: too little thrust where the laws differ", True)
    return _told(measured, (one, off), choked, telling, thrust_std, usual)


def _told(
    measured: tuple[Array, Array, Array], laws: tuple[Array, Array], choked: Mask, telling: Mask, zero: float,
    usual: Law,
) -> Followed:  # fmt: skip
    """What thrust against chamber pressure says, in units of what it may be off."""
    force, full = measured[2], choked & ~telling
    scale = float(force[full].sum() / laws[0][full].sum()) if full.sum() >= FEW else 1.0
    seen = float(force[telling].mean())
    means = [scale * float(law[telling].mean()) for law in laws]
    std = float(np.hypot(zero, LOSSES * seen))
    off = [(seen - mean) / std for mean in means]
    best = int(abs(off[SEPARATED]) < abs(off[ONE_DIMENSIONAL]))
    numbers = text(
        "where they differ the log has {seen} on average, the one-dimensional law {one}, a separated flow {off}",
        seen=said(seen, "N", ".0f"), one=said(means[0], "N", ".0f"), off=said(means[1], "N", ".0f"),
    )  # fmt: skip
    if abs(off[0] ** 2 - off[1] ** 2) < SURE:
        return Followed(usual, f"the log does not tell: {numbers}", True)
    return Followed(LAWS[best], f"as the log has it: {numbers}", True, True)
