"""From a log as the logger wrote it to channels in SI with a quality flag per sample.

The files are read once, in chunks, into temporary columns; then one channel at a time is in memory.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import hfanalysis
from hfanalysis.errors import InputError
from hfanalysis.testdata.channels import LONG_NAMES, default_accuracy
from hfanalysis.testdata.clocks import Clock, read_clock
from hfanalysis.testdata.definition import ChannelSpec, Exclusion, TestDefinition, TimeSpec
from hfanalysis.testdata.flags import flag_readings
from hfanalysis.testdata.log import Channel, Flag, Flags, Floats
from hfanalysis.testdata.quiet import REFERENCES, Firing, Trace, find_firing
from hfanalysis.testdata.readers import Source, find_column, open_log
from hfanalysis.testdata.spool import Spool
from hfanalysis.testdata.store import Store
from hfanalysis.testdata.zero import Zero, ambient_zero, tare
from hfanalysis.units import si_unit

Progress = Callable[[str, float], None]
"""Called now and then with the file's name and the share of it that has been read."""


@dataclass(frozen=True)
class Plan:
    """Where a channel's numbers are: file, column (from 0), time column (None: sample rate) and how to read it."""

    spec: ChannelSpec
    file: str
    column: int
    stamps: int | None
    time: TimeSpec

    @property
    def clock(self) -> tuple[Any, ...]:
        """What channels on one clock share."""
        return (self.file, self.stamps, self.time)


def ingest(definition: TestDefinition, out: Path, progress: Progress = lambda name, share: None) -> None:
    """Read the log that ``definition`` describes and write it to ``out`` (an ingest.h5).

    Raises :class:`InputError` naming file and column where the log does not hold what test.toml says.
    """
    with ExitStack() as stack:
        run = _Ingest(definition, _plans(definition), out.parent)
        stack.callback(run.close)
        run.read(progress)
        with Store(out) as store:
            run.write(store)


def _plans(definition: TestDefinition) -> list[Plan]:
    sources = {spec.file: open_log(definition.folder / spec.file, spec) for spec in definition.log.files}
    return [_plan(definition, spec, sources) for spec in definition.channels.values()]


def _plan(definition: TestDefinition, spec: ChannelSpec, sources: dict[str, Source]) -> Plan:
    where = f"{definition.path}, channels.{spec.name}"
    file = spec.file or _only_file(spec, sources, where)
    source = sources[file]
    column = find_column(source, spec.column, f"{where}.column")
    time = spec.time or definition.log.named(file).time
    if time is None:
        stamps, time = source.stamps_of(column), TimeSpec(column=1)
        if stamps is None:
            raise InputError(f"{definition.path}, log.time: missing; expected the column of the time stamps of {file}")
        return Plan(spec, file, column, stamps, time)
    key = f"{where}.time.column" if spec.time else f"{definition.path}, log.time.column"
    stamps = None if time.column is None else find_column(source, time.column, key)
    return Plan(spec, file, column, stamps, time)


def _only_file(spec: ChannelSpec, sources: dict[str, Source], where: str) -> str:
    """The file that holds a channel that does not name one."""
    if len(sources) == 1:
        return next(iter(sources))
    found = [name for name, source in sources.items() if spec.column in source.columns]
    if len(found) != 1:
        which = f"column {spec.column!r} is in {len(found)} of the files"
        raise InputError(f"{where}: {which}; expected file = one of {', '.join(found or sources)}")
    return found[0]


@dataclass
class _Ingest:
    """One run: plans, temporary columns, clocks."""

    definition: TestDefinition
    plans: list[Plan]
    folder: Path

    def __post_init__(self) -> None:
        self.spools: dict[str, Spool] = {}
        self.clocks: dict[tuple[Any, ...], Clock] = {}
        self.warnings: list[str] = list(self.definition.warnings)

    def close(self) -> None:
        for spool in self.spools.values():
            spool.close()

    def read(self, progress: Progress) -> None:
        """Every file once, then the clocks."""
        for file in dict.fromkeys(plan.file for plan in self.plans):
            self._read_file(file, [plan for plan in self.plans if plan.file == file], progress)
        for plan in self.plans:
            if plan.clock not in self.clocks:
                self.clocks[plan.clock] = self._clock(plan)

    def _read_file(self, file: str, plans: list[Plan], progress: Progress) -> None:
        source = open_log(self.definition.folder / file, self.definition.log.named(file))
        spool = self.spools[file] = Spool(source, self.folder)
        stamps = sorted({plan.stamps for plan in plans if plan.stamps is not None})
        spool.fill(sorted({plan.column for plan in plans}), stamps, lambda share: progress(file, share))

    def _clock(self, plan: Plan) -> Clock:
        spool = self.spools[plan.file]
        rows = len(spool.take(plan.column))
        if rows < 2:
            raise InputError(f"{self.definition.folder / plan.file}: found {rows} samples; expected a log")
        clock = read_clock(spool, plan.stamps, plan.time, rows, str(self.definition.folder / plan.file))
        self.warnings += clock.warnings
        return clock

    def write(self, store: Store) -> None:
        """Clocks, then channel after channel."""
        names = {key: f"time_{i}" if i else "time" for i, key in enumerate(self.clocks)}
        for key, clock in self.clocks.items():
            store.clock(names[key], clock.time)
        firing = self._firing()
        for plan in self.plans:
            store.channel(self._channel(plan, firing), names[plan.clock], _long_name(plan.spec))
        store.about(self.warnings, _provenance(self.definition))

    def _firing(self) -> Firing | None:
        stated = self.definition.segments.get("t_open")
        by_name = {plan.spec.name: plan for plan in self.plans}
        traces = (({name: self._trace(*self._samples(by_name[name]))}) for name in REFERENCES if name in by_name)
        found = next((firing for trace in traces if (firing := find_firing(trace))), None)
        if stated is None:
            return found
        return replace(found, start=stated.value) if found else Firing(stated.value, np.inf, "test.toml")

    def _samples(self, plan: Plan) -> tuple[Floats, Floats, Flags]:
        """Time [s], readings in SI (without zero and tare) and flags of a channel."""
        clock, spec = self.clocks[plan.clock], plan.spec
        readings = self.spools[plan.file].take(plan.column)
        if clock.keep is not None:
            readings = readings[clock.keep]
        if not np.isfinite(readings).any():
            raise InputError(self._no_numbers(plan))
        flags = flag_readings(readings, spec.dimension, spec.missing)
        flags[clock.stale] |= np.uint8(Flag.TIME)
        _exclude(flags, clock.time, spec.name, self.definition.exclude)
        readings[(flags & Flag.DROPOUT) != 0] = np.nan
        scale, offset = spec.factor
        readings *= scale
        readings += offset + (self.definition.ambient_pressure.value if spec.gauge else 0.0)
        return clock.time, readings, flags

    def _no_numbers(self, plan: Plan) -> str:
        text = self.spools[plan.file].text.get(plan.column)
        found = f"line {text.line} has {text.first!r}" if text else "the column is empty"
        where = f"{self.definition.folder / plan.file}, column {plan.spec.column!r} ({plan.spec.name})"
        return f"{where}: not one number: {found}; expected numbers"

    def _trace(self, time: Floats, values: Floats, flags: Flags) -> Trace:
        good = flags == 0
        return Trace(time[good], values[good])

    def _channel(self, plan: Plan, firing: Firing | None) -> Channel:
        time, values, flags = self._samples(plan)
        spec = plan.spec
        self.warnings += self._counted(plan, flags)
        accuracy = spec.accuracy.value if spec.accuracy else default_accuracy(spec.dimension, _largest(values))
        zero = self._zero(spec, self._trace(time, values, flags), firing, accuracy)
        self.warnings += zero.warnings
        corrected = values - zero.at(time) if zero.std is not None else values
        return Channel(
            spec.name, si_unit(spec.dimension), time, corrected, flags, accuracy, spec.accuracy is not None,
            str(spec.column), zero.value, zero.std, zero.drift, values if zero.std is not None else None,
            (*_history(self.definition, plan), *zero.history),
        )  # fmt: skip

    def _zero(self, spec: ChannelSpec, trace: Trace, firing: Firing | None, accuracy: float) -> Zero:
        if spec.zero == "ambient":
            return ambient_zero(spec, trace, firing, self.definition.ambient_pressure, accuracy)
        return tare(spec, trace, firing, accuracy) if spec.tare != "none" else Zero()

    def _counted(self, plan: Plan, flags: Flags) -> Iterator[str]:
        """How many samples carry which flag."""
        for flag in Flag:
            count = int(np.count_nonzero(flags & flag))
            if count and flag is not Flag.TIME:
                yield f"channel {plan.spec.name}: {count} of {len(flags)} samples flagged {(flag.name or '').lower()}"


def _exclude(flags: Flags, time: Floats, name: str, exclusions: tuple[Exclusion, ...]) -> None:
    for stretch in exclusions:
        if not stretch.channels or name in stretch.channels:
            flags[(time >= stretch.start.value) & (time <= stretch.end.value)] |= np.uint8(Flag.EXCLUDED)


def _largest(values: Floats) -> float:
    return float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0


def _long_name(spec: ChannelSpec) -> str:
    return LONG_NAMES.get(spec.name, spec.name)


def _history(definition: TestDefinition, plan: Plan) -> Iterator[str]:
    spec = plan.spec
    yield f"read: column {spec.column!r} of {plan.file} in {spec.unit or 'no unit'}"
    if spec.scale != 1.0 or spec.offset:
        yield f"scaled: {spec.scale:g} * reading + {spec.offset:g}"
    if spec.gauge:
        yield f"gauge: ambient pressure {definition.ambient_pressure.value:.6g} Pa added"


def _provenance(definition: TestDefinition) -> dict[str, Any]:
    return {
        "test": definition.test.id,
        "source": definition.test.source,
        "raw": {spec.file: _sha256(definition.folder / spec.file) for spec in definition.log.files},
        "test.toml": definition.sha256,
        "version": hfanalysis.__version__,
    }


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
