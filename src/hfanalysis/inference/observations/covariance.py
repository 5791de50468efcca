"""What the noise of a channel's blocks is made of.

Wander and white noise of the sensor; the oscillation of the burn, which chamber and thrust share, and the shaking of
the tank's cell; offset and gain within the stated accuracy; an end of the liquid that was seen too early or too late;
and, while the line fills, the model's own error.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from hfanalysis.arrays import Array
from hfanalysis.inference.observations.alignment import share
from hfanalysis.inference.observations.blocks import TANK_AT_REST, Blocks
from hfanalysis.inference.observations.channel import ObservedChannel, averaged, range_of
from hfanalysis.inference.observations.flow_end import WITHOUT_FIRE
from hfanalysis.inference.observations.frame import BLOCK, Frame
from hfanalysis.inference.observations.oscillation import oscillation
from hfanalysis.inference.observations.recorded import LONGEST_RECORD, TOGETHER, accuracy_of
from hfanalysis.inference.observations.wander import Wander, roughness, wander_of
from hfanalysis.record.accuracy import SPAN_SHARE
from hfanalysis.record.definition import TestDefinition
from hfanalysis.record.signals import sample_noise

FILLING_ERROR, FILLING_TIME = 0.1, 0.1
"""Model-form error while the line fills, as part of a channel's range [-], and the time over which it is coherent
[s]."""

UNSTEADY_ZERO = 0.03
"""Part of its accuracy by which the zero of a sensor may move within a test, beside the wander that its quiet time
shows. A zero that moves further is an effect, and has to be found as one."""

VALVE_TIME = 1e-2
"""Standard deviation [s] of the opening itself: the model's valve opens at once, a real one over some tens of
milliseconds, in the course of which the instant lies that counts. Source: a solenoid or pneumatic valve of this size
takes 10 to 40 ms; a valve that takes longer is an unknown of its own (slow_valve.py)."""

LEAST_SHIFT = 1e-3
"""Least standard deviation [s] of the other instant on which a run is laid over the measurement, the seen end of the
liquid: a sample of a fast log. By how much a model's liquid may end at another instant is a matter of that
instant, not of the channels. Evidence: without it two of 150 calibration tests that hide nothing had 9.2 in log
evidence for a line that fills; with it they have 3.3 at most."""

SPEED_ORDER = 3
"""Order of the polynomials whose slope is a channel's speed on either side of the knee."""


def channel_of(
    blocks: Blocks, definition: TestDefinition, frame: Frame, shaken: Array | None, sensor: Array
) -> ObservedChannel:
    """The channel of these blocks with the covariance of their noise.

    ``shaken`` (grid, grid): covariance of an oscillation that it shows; ``sensor`` (blocks, blocks): that of the
    sensor's zero and span. Covariances [SI squared].
    """
    name, resting = blocks.signal.name, frame.resting[blocks.first]
    accuracy = accuracy_of(definition, name, blocks.value)
    wander = wander_of(blocks.signal, BLOCK)
    own = _own(blocks, frame, shaken, wander)
    shared = of_the_model(blocks, frame)
    covariance = own + sensor + shared @ shared.T + _filling(blocks, frame, resting)
    std = np.sqrt(own.diagonal())
    return ObservedChannel(
        name, blocks.time, blocks.value, blocks.first, blocks.count, resting, std, accuracy, covariance,
        coherence_of(own), _of_blocks(wander.slow(frame.grid, frame.width), blocks), unsure=wander.unsure, moved=shared,
    )  # fmt: skip


def of_the_model(blocks: Blocks, frame: Frame) -> Array:
    """What a channel differs by (blocks, errors) [SI] if the opening or the end of the liquid was seen a standard
    deviation late, and if more flows without fire than the model says."""
    moved = _moved_by_opening(blocks, frame), _moved_by_knee(blocks, frame)
    return np.stack([*moved, *_without_fire(blocks, frame)], axis=1)


def coherence_of(own: Array) -> float:
    """Blocks that are worth one independent value in the mean square of noise of this covariance (blocks, blocks) [SI
    squared].

    For a Gaussian the mean square has the variance 2 sum(C_ij^2)/n^2, against 2 (tr C)^2/n^3 of n independent ones.

    >>> coherence_of(np.eye(4)), coherence_of(np.ones((4, 4)))
    (1.0, 4.0)
    """
    return float(own.shape[0] * np.sum(own**2) / np.trace(own) ** 2)


def _own(blocks: Blocks, frame: Frame, shaken: Array | None, noise: Wander) -> Array:
    """By the wander of the sensor, its white noise, the oscillation, its converter's steps, and its samples' times."""
    signal = blocks.signal
    own, white = noise.covariance(frame.grid, frame.width), noise.white
    if shaken is not None:
        own = own + shaken
    else:
        fine = signal.between(frame.start, frame.end(signal.name)).reduced(BLOCK)
        rough = float(sample_noise(fine.value)) ** 2 - roughness(noise, BLOCK)
        white = max(white, max(rough, 0.0) ** 0.5)
    floor = max(white, 1e-9 * float(np.abs(blocks.value).max())) ** 2
    floor = max(floor, signal.resolution**2 / 12.0 * min(signal.step / BLOCK, 1.0))
    own[np.diag_indices_from(own)] += floor * BLOCK / np.where(frame.width > 0.0, frame.width, BLOCK)
    return _of_blocks(own, blocks) + np.diag(blocks.untimed**2)


def _of_blocks(covariance: Array, blocks: Blocks) -> Array:
    """Covariance of blocks from that of the grid's points."""
    return averaged(averaged(covariance, blocks.first, blocks.count).T, blocks.first, blocks.count)


def zero_and_span(blocks: Blocks, definition: TestDefinition, frame: Frame, zero_std: float | None) -> Array:
    """Covariance (blocks, blocks) [SI squared] by an error of the zero and by one of the span, which shows under load
    alone; a filled tank is a load.

    What a sensor reads at rest before the opening tells its zero, where that is compared; else the zero that was taken
    there leaves its own error (``zero_std`` [SI]), and what moves it under load.
    """
    resting, accuracy = frame.resting[blocks.first], accuracy_of(definition, blocks.signal.name, blocks.value)
    at_rest = resting if blocks.signal.name not in TANK_AT_REST else np.zeros_like(resting)
    loaded = np.where(at_rest, 0.0, 1.0)
    gain = SPAN_SHARE * accuracy * loaded * blocks.value / float(np.abs(blocks.value).max())
    compared = bool((at_rest & (blocks.time < 0.0)).any())
    offset = zero_std if zero_std is not None and not compared else SPAN_SHARE * accuracy
    unsteady = 0.0 if zero_std is None else UNSTEADY_ZERO * accuracy
    return np.asarray(offset**2 + unsteady**2 * np.outer(loaded, loaded) + np.outer(gain, gain))


def _filling(blocks: Blocks, frame: Frame, resting: NDArray[np.bool_]) -> Array:
    """By what the model gets wrong while the line fills."""
    size = FILLING_ERROR * range_of(blocks.time, blocks.value)
    filling = np.where((blocks.time < frame.filled) & ~resting, size, 0.0)
    lag = np.abs(blocks.time[:, None] - blocks.time[None, :])
    return np.asarray(np.exp(-lag / FILLING_TIME) * np.outer(filling, filling))


def _moved_by_opening(blocks: Blocks, frame: Frame) -> Array:
    """What a channel differs by if the opening was seen one standard deviation late.

    Times count from it: all that comes early is shifted, and what comes later less and less, up to the next instant on
    which the model is laid. A chamber that fills in tenths of a second shows a millisecond.
    """
    out = np.zeros(blocks.time.size)
    later = [instant for instant, _ in frame.changes.values()] or [frame.ends["chamber"]]
    part = ~frame.resting[blocks.first] & (blocks.time < min(later))
    if part.sum() > 2:
        t = blocks.time[part]
        out[part] = np.gradient(blocks.value[part], t, edge_order=2) * (1.0 - t / min(later))
    return np.asarray(out * max(frame.opening, VALVE_TIME))


def _moved_by_knee(blocks: Blocks, frame: Frame) -> Array:
    """What a channel differs by if the end of the liquid was seen one standard deviation late.

    The model is laid over the measurement from knee to knee: an error of t_v stretches all that comes before and shifts
    all that comes after.
    """
    if "t_v" not in frame.changes:
        return np.zeros(blocks.time.size)
    instant, deviation = frame.changes["t_v"]
    out = np.zeros(blocks.time.size)
    burning = ~frame.resting[blocks.first]
    for side in (blocks.time < instant, blocks.time >= instant):
        part = side & burning
        if part.sum() > SPEED_ORDER + 2:
            t = blocks.time[part] - instant
            speed = np.polyval(np.polyder(np.polyfit(t, blocks.value[part], SPEED_ORDER)), t)
            out[part] = speed * share(blocks.time[part], instant, instant, frame.fuel_out)
    return np.asarray(out * max(deviation, LEAST_SHIFT))


def _without_fire(blocks: Blocks, frame: Frame) -> tuple[Array, ...]:
    """What a channel differs by if the flow into the chamber without fire is WITHOUT_FIRE larger than the model's, all
    along or for a time.

    Its pressure there, and with it the flow, is nobody's model: it is no evidence for anything in injector or line. The
    tank is then empty sooner, or empties faster at first and slower later. What pressure it has with so much in it
    still tells. Where liquid is left at the end of the fire, its end is compared by itself: the model is laid over the
    measurement up to there.
    """
    if frame.fuel_out is None:
        return ()
    t_v, last = max(frame.changes.get("t_v", (0.0, 0.0))[0], frame.fuel_out), frame.ends["tank"]
    return (
        *_passed(blocks, frame, (frame.fuel_out, t_v), pinned=True),
        *_passed(blocks, frame, (t_v, last), pinned=False),
    )


def _passed(blocks: Blocks, frame: Frame, within: tuple[float, float], pinned: bool) -> list[Array]:
    """What a channel differs by (blocks,) [SI] if what passes ``within`` two instants [s] passes sooner, for each
    stretch of STRETCH seconds and for all of it; where both ends are ``pinned`` the last is no difference."""
    start, end = within
    if end - start < BLOCK:
        return []
    part = ~frame.resting[blocks.first] & (blocks.time > start) & (blocks.time < end)
    knots = np.linspace(start, end, max(int(np.ceil((end - start) / STRETCH)), 1) + 1)
    fine = np.linspace(start, end, 20 * knots.size + 1)
    unsure = np.maximum(np.exp(-(knots - (frame.fuel_out or 0.0)) / STRETCH), SETTLED)
    mores = [*np.diag(unsure), *([] if pinned else [np.ones(knots.size)])]
    columns = [np.zeros(blocks.time.size) for _ in mores]
    if part.sum() <= SPEED_ORDER + 2:
        return columns
    time = blocks.time[part]
    speed = np.polyval(np.polyder(np.polyfit(time - start, blocks.value[part], SPEED_ORDER)), time - start)
    for column, at_knots in zip(columns, mores, strict=True):
        more = np.interp(fine, knots, at_knots)
        sooner = np.concatenate([[0.0], np.cumsum(0.5 * (more[1:] + more[:-1]) * np.diff(fine))])
        sooner -= sooner[-1] * (fine - start) / (end - start) if pinned else 0.0
        column[part] = WITHOUT_FIRE * speed * np.interp(time, fine, sooner)
    return columns


STRETCH, SETTLED = 1.0, 0.2
"""Seconds over which the flow without fire is off by as much, for a chamber turns cold within up to that; and the part
of it that is left when it has. Source: a cold chamber has less than a fifth of the injector's pressure, whose flow goes
by the root of the difference."""


def oscillations(blocks: Mapping[str, Blocks], frame: Frame) -> dict[tuple[str, str], Array]:
    """Covariance (grid, grid) [SI squared] of the burn's oscillation, and of the shaking of the tank's cell, by pair of
    channels."""
    found: dict[tuple[str, str], Array] = {}
    for group in (TOGETHER, ("m_tank",)):
        shaken = {name: r for name, r in blocks.items() if name in group}
        if shaken:
            found |= _shaken(shaken, frame)
    return found


def common_of(blocks: Mapping[str, Blocks], shaken: Mapping[tuple[str, str], Array]) -> Array | None:
    """Covariance (blocks of the first, blocks of the second) [SI] of the first of TOGETHER with the second; None where
    one of them is missing.

    ``shaken`` (grid, grid): :func:`oscillations`.
    """
    found = shaken.get(TOGETHER)
    if found is None:
        return None
    one, two = (blocks[name] for name in TOGETHER)
    half = averaged(found, one.first, one.count)
    return averaged(half.T, two.first, two.count).T


def _shaken(shaken: Mapping[str, Blocks], frame: Frame) -> dict[tuple[str, str], Array]:
    usable = np.logical_and.reduce([r.good for r in shaken.values()])
    guide = next(iter(shaken.values()))
    if guide.signal.name in TOGETHER:
        level = np.interp(frame.grid[~frame.resting], guide.time, guide.value)
        quiet = guide.signal.between(-LONGEST_RECORD, -0.05).value
        zero = float(quiet.mean()) if quiet.size else float(guide.value.min())
        level = np.maximum(level - zero, 0.0) / max(float(guide.value.max()) - zero, 1e-300)
    else:
        level = np.ones(usable.size)
    stds = {name: wander_of(r.signal, BLOCK).white for name, r in shaken.items()}
    spacing = max(r.signal.step for r in shaken.values()) / BLOCK
    found = oscillation({name: r.fine for name, r in shaken.items()}, level, usable, stds, spacing)
    around = (frame.flowing.start, frame.grid.size - frame.flowing.stop)
    return {pair: np.pad(matrix, around) for pair, matrix in found.items()}
