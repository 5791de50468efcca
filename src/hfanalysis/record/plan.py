"""Where in the log files each channel's numbers and time stamps are."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass

from hfanalysis.errors import InputError
from hfanalysis.record.definition import ChannelSpec, TestDefinition, TimeSpec
from hfanalysis.record.readers import Source, find_column, open_log
from hfanalysis.record.readers.base import tidy


@dataclass(frozen=True)
class Plan:
    """A channel's file, column and time column (both from 0; no time column: sample rate), and how to read them."""

    spec: ChannelSpec
    file: str
    column: int
    stamps: int | None
    time: TimeSpec
    label: str

    @property
    def clock(self) -> Hashable:
        """What channels on one clock share."""
        return (self.file, self.stamps, self.time)


def open_files(definition: TestDefinition) -> dict[str, Source]:
    """Every log file, opened by the reader of its format."""
    return {spec.file: open_log(definition.folder / spec.file, spec) for spec in definition.log.files}


def make_plans(definition: TestDefinition, sources: Mapping[str, Source]) -> list[Plan]:
    """A plan per channel; raises :class:`InputError` for a column that is not there, or is there for two channels."""
    plans = [_plan(definition, spec, sources) for spec in definition.channels.values()]
    seen: dict[tuple[str, int], str] = {}
    for plan in plans:
        first = seen.setdefault((plan.file, plan.column), plan.spec.name)
        if first != plan.spec.name:
            where = f"{definition.path}, channels.{plan.spec.name}.column"
            raise InputError(f"{where}: column {plan.spec.column!r} is already {first}; expected every column once")
    return plans


def _plan(definition: TestDefinition, spec: ChannelSpec, sources: Mapping[str, Source]) -> Plan:
    where = f"{definition.path}, channels.{spec.name}"
    file = spec.file or _only_file(spec, sources, where)
    column = find_column(sources[file], spec.column, f"{where}.column")
    label = sources[file].columns[column] or f"column {column + 1}"
    time = spec.time or definition.log.named(file).time
    if time is None:
        return Plan(spec, file, column, *_own_time(sources[file], column, str(definition.path)), label)
    key = f"{where}.time.column" if spec.time else f"{definition.path}, log.time.column"
    stamps = None if time.column is None else find_column(sources[file], time.column, key)
    if stamps == column:
        raise InputError(f"{where}.column: {spec.column!r} is the column of the time stamps; expected one of readings")
    return Plan(spec, file, column, stamps, time, label)


def _own_time(source: Source, column: int, path: str) -> tuple[int, TimeSpec]:
    """The time that the format itself gives a column."""
    stamps = source.stamps_of(column)
    if stamps is None:
        named = ", ".join(repr(tidy(name)) for name in source.columns[:30] if name) or "columns by number"
        raise InputError(
            f"{path}, log.time: missing; expected the column of {source.name}'s time stamps, among {named}"
        )
    return stamps, TimeSpec(column=stamps + 1)


def _only_file(spec: ChannelSpec, sources: Mapping[str, Source], where: str) -> str:
    """The file that holds a channel that does not name one."""
    if len(sources) == 1:
        return next(iter(sources))
    wanted = tidy(str(spec.column))
    found = [name for name, source in sources.items() if wanted in map(tidy, source.columns)]
    if not found:  # another row of the header may call it so
        found = [n for n, source in sources.items() if any(wanted in map(tidy, row) for row in source.others)]
    if len(found) != 1:
        which = f"column {spec.column!r} is in {len(found) or 'none'} of the log's files"
        raise InputError(f"{where}: {which}; expected file = one of {', '.join(found or sources)}")
    return found[0]
