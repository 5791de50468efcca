"""A column's readings become samples in SI with their flags, and samples become a channel."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.record.channels import default_accuracy
from hfanalysis.record.clocks import Clock
from hfanalysis.record.definition import ChannelSpec, Exclusion, TestDefinition
from hfanalysis.record.flags import flag_impossible, flag_readings
from hfanalysis.record.log import Channel, Flag, Flags
from hfanalysis.record.plan import Plan
from hfanalysis.record.quiet import FiringSpan, Trace
from hfanalysis.record.spool import Spool
from hfanalysis.record.zero import Zero, ambient_zero, tare
from hfanalysis.units import si_unit


@dataclass(frozen=True)
class Samples:
    """Time [s, log time], values [SI] without zero and tare (NaN: no number), and flags of a channel.

    A reading that no sensor can have is flagged, and stays: what a channel does there may tell what is wrong with it.
    """

    time: Array
    values: Array
    flags: Flags

    @property
    def trace(self) -> Trace:
        """The samples without a flag."""
        if not self.flags.any():
            return Trace(self.time, self.values)
        good = self.flags == 0
        return Trace(self.time[good], self.values[good])

    @property
    def largest(self) -> float:
        """The largest reading [SI] that is not a rare one."""
        every = max(1, len(self.values) // 20_000)
        some = np.abs(self.values[::every][self.flags[::every] == 0])
        return float(np.percentile(some, 99)) if len(some) else 0.0


def read_samples(plan: Plan, spool: Spool, clock: Clock, definition: TestDefinition) -> Samples:
    """A channel's samples; raises :class:`InputError` where its column holds not one number."""
    readings, idle = spool.take(plan.column), spool.idle
    if clock.keep is not None:
        readings, idle = readings[clock.keep], None if idle is None else idle[clock.keep]
    flags = flag_readings(readings, plan.spec.dimension, plan.spec.missing)
    if not np.isfinite(readings).any():
        raise InputError(_no_numbers(plan, spool, definition))
    if idle is not None:
        flags[idle] |= np.uint8(Flag.DROPOUT)
    if clock.stale.any():
        flags[clock.stale] |= np.uint8(Flag.TIME)
    _exclude(flags, clock.time, plan.spec.name, definition.exclude)
    scale, offset = plan.spec.factor
    readings *= scale
    readings += offset + (definition.ambient_pressure.value if plan.spec.gauge else 0.0)
    if flags.any():
        readings[(flags & np.uint8(Flag.DROPOUT)) != 0] = np.nan
    flag_impossible(readings, plan.spec.dimension, flags)
    return Samples(clock.time, readings, flags)


def make_channel(
    plan: Plan, samples: Samples, firing: FiringSpan | None, definition: TestDefinition
) -> tuple[Channel, list[str]]:
    """The channel with zero and tare taken, and what there is to say about it."""
    spec = plan.spec
    accuracy = spec.accuracy.value if spec.accuracy else default_accuracy(spec.dimension, samples.largest)
    zero = _zero(spec, samples, firing, definition, accuracy)
    warnings = list(zero.warnings)
    if not np.isfinite(samples.values).any():
        warnings.append(f"channel {spec.name}: every reading is one that stands for none")
    taken = zero.std is not None
    values = samples.values - zero.at(samples.time) if taken else samples.values
    channel = Channel(
        spec.name, si_unit(spec.dimension), samples.time, values, samples.flags, accuracy, spec.accuracy is not None,
        plan.label, zero.value, zero.std, zero.drift, samples.values if taken else None,
        (*_history(definition, plan), *zero.history),
    )  # fmt: skip
    return channel, warnings


def _zero(
    spec: ChannelSpec, samples: Samples, firing: FiringSpan | None, definition: TestDefinition, accuracy: float
) -> Zero:
    if spec.zero == "ambient":
        return ambient_zero(spec, samples.trace, firing, definition.ambient_pressure, accuracy)
    return tare(spec, samples.trace, firing) if spec.tare != "none" else Zero()


def _no_numbers(plan: Plan, spool: Spool, definition: TestDefinition) -> str:
    text = spool.text.get(plan.column)
    found = f"line {text.line} has {text.first!r}" if text else "the column is empty"
    where = f"{definition.folder / plan.file}, column {plan.spec.column!r} ({plan.spec.name})"
    return f"{where}: not one number: {found}; expected numbers"


def _exclude(flags: Flags, time: Array, name: str, exclusions: tuple[Exclusion, ...]) -> None:
    for stretch in exclusions:
        if not stretch.channels or name in stretch.channels:
            flags[(time >= stretch.start.value) & (time <= stretch.end.value)] |= np.uint8(Flag.EXCLUDED)


def _history(definition: TestDefinition, plan: Plan) -> Iterator[str]:
    spec = plan.spec
    yield f"read: {plan.label!r} of {plan.file} in {spec.unit or 'no unit'}"
    if spec.scale != 1.0 or spec.offset:
        yield f"scaled: {spec.scale:g} * reading + {spec.offset:g}"
    if spec.gauge:
        yield f"gauge: ambient pressure {definition.ambient_pressure.value:.6g} Pa added"
    if spec.accuracy is None:
        yield "accuracy: not stated, the default of its class"
