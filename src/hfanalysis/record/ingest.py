"""From a log as the logger wrote it to channels in SI with a quality flag per sample.

The files are read once, in chunks; then a few channels at a time are in memory, converted side by side.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Hashable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from hfanalysis.arrays import Array
from hfanalysis.errors import InputError
from hfanalysis.products.disk import sha256_file
from hfanalysis.record import alignment, holes
from hfanalysis.record.channels import LONG_NAMES
from hfanalysis.record.clocks import Clock, read_clock
from hfanalysis.record.definition import TestDefinition, TimeSpec
from hfanalysis.record.flag_notes import flag_warnings, flagged
from hfanalysis.record.log import Channel
from hfanalysis.record.plan import Plan, make_plans, open_files
from hfanalysis.record.quiet import REFERENCES, FiringSpan, find_firing
from hfanalysis.record.readers import Source
from hfanalysis.record.samples import Samples, make_channel, read_samples
from hfanalysis.record.spool import Spool
from hfanalysis.record.store import Store
from hfanalysis.version import __version__

Progress = Callable[[str, float], None]
"""Called now and then with the file's name and the share of it that has been read."""
OF_A_CLOCK = (1e-5, 1e11)
"""[s] from the first stamp to the last outside of which they are of no clock, in whatever unit. Source: half a minute
in days, taken for seconds, is 3e-4, and in nanoseconds 3e10."""
SHORTEST_LOG = 0.5
"""[s] of a log below which no firing fits into it."""
WORKERS = 2
"""Channels converted at a time: bounds the memory."""


def ingest(definition: TestDefinition, out: Path, progress: Progress = lambda name, share: None) -> None:
    """Read the log that ``definition`` describes and write it to ``out`` (an ingest.h5).

    Raises :class:`InputError` naming file and column where the log does not hold what test.toml says.
    """
    sources = open_files(definition)
    plans = make_plans(definition, sources)
    with ThreadPoolExecutor(WORKERS) as pool, closing(_Ingest(definition, plans, pool, out.parent)) as run:
        run.read(sources, progress)
        firing = run.find_firing()
        with Store(out) as store:
            run.write(store, firing)
            raw = {name: source.sha256 or sha256_file(definition.folder / name) for name, source in sources.items()}
            store.about(run.warnings, _provenance(definition, raw))


@dataclass
class _Ingest:
    """One run: what is planned, the columns on their way, the clocks."""

    definition: TestDefinition
    plans: list[Plan]
    pool: ThreadPoolExecutor
    folder: Path
    spools: dict[str, Spool] = field(default_factory=dict)
    clocks: dict[Hashable, Clock] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    kept: dict[str, Samples] = field(default_factory=dict)
    """By channel, the samples looked at for the firing."""

    def close(self) -> None:
        for spool in self.spools.values():
            spool.close()

    def read(self, sources: dict[str, Source], progress: Progress) -> None:
        """Every file once, then the clocks."""
        lengths: dict[Hashable, int] = {}
        self.warnings += self.definition.warnings
        for file in dict.fromkeys(plan.file for plan in self.plans):
            self._read_file(file, sources[file], progress)
        for plan in self.plans:
            if plan.clock not in self.clocks:
                self.clocks[plan.clock] = self._clock(plan)
                lengths[plan.clock] = self.spools[plan.file].rows(
                    plan.stamps if plan.stamps is not None else plan.column
                )
            self._fits(plan, lengths[plan.clock])
        self._align()

    def _align(self) -> None:
        """The clocks on one zero: by dates, by offsets that are stated, by what the channels show together."""
        files = {plan.clock: plan.file for plan in self.plans}
        self.clocks, notes = alignment.on_one_zero(self.clocks, files)
        self.warnings += notes
        own = {plan.clock: plan.time for plan in self.plans}
        fixed = [plan for plan in self.plans if plan.time.offset is not None]
        for file in dict.fromkeys(files.values()):
            asked = [key for key in self.clocks if files[key] == file and own[key].offset is None]
            others = [plan for plan in fixed if plan.file != file]
            doubtful = [key for key in self.clocks if files[key] == file and self._is_unplaced(key, own[key])]
            if asked and others:
                self._place(file, asked, others)
            elif asked:
                raise InputError(f"{self.definition.path}: offset = 'auto' of {file}: no other file to compare it with")
            elif doubtful and file != self.plans[0].file and others:
                self._doubt(file, doubtful, [plan for plan in others if plan.file == self.plans[0].file])

    def _is_unplaced(self, key: Hashable, time: TimeSpec) -> bool:
        return self.clocks[key].epoch is None and time.offset is not None and time.offset.value == 0.0

    def _readings(self, plans: Iterable[Plan]) -> list[tuple[Array, Array]]:
        """Time [s] and readings of channels, in the order of time."""
        return [self.clocks[plan.clock].good(self.spools[plan.file].look(plan.column)) for plan in plans]

    def _offset_of(self, keys: list[Hashable], others: list[Plan]) -> alignment.Offset | None:
        mine = self._readings(plan for plan in self.plans if plan.clock in keys)
        return alignment.find_offset(self._readings(others), mine)

    def _place(self, file: str, keys: list[Hashable], others: list[Plan]) -> None:
        """Puts a file's clocks where its channels show that they belong."""
        found = self._offset_of(keys, others)
        if found is None or not found.told:
            how = "nothing changes in its channels" if found is None else found.words
            expected = 'expected offset = "... s" beside its time column'
            raise InputError(f"{self.definition.path}: offset = 'auto' of {file}: {how}; {expected}")
        for key in keys:
            self.clocks[key] = replace(self.clocks[key], time=self.clocks[key].time + found.value)
        self.warnings.append(f"{file}: {found.words}; its clock is set so, as test.toml asks")

    def _doubt(self, file: str, keys: list[Hashable], others: list[Plan]) -> None:
        """Says where a file's channels show that it belongs elsewhere than its clock puts it."""
        found = self._offset_of(keys, others) if others else None
        if found is not None and found.told and abs(found.value) > alignment.ELSEWHERE * found.std:
            cure = "if its clock is its own, state offset = 'auto' beside its time column"
            self.warnings.append(f"{file}: {found.words}, not where its stamps put it; {cure}")

    def _read_file(self, file: str, source: Source, progress: Progress) -> None:
        plans = {plan.column: plan for plan in self.plans if plan.file == file}
        stamps = sorted({plan.stamps for plan in plans.values() if plan.stamps is not None})
        spool = self.spools[file] = Spool(source, self.folder)
        spool.fill(sorted(plans), stamps, lambda share: progress(file, share))
        self.warnings += source.notes
        for column, text in spool.text.items():
            if column in plans:
                cells = f"{text.count} cells hold text, the first {text.first!r} in line {text.line}"
                self.warnings.append(f"channel {plans[column].spec.name}: {cells} of {file}")

    def _clock(self, plan: Plan) -> Clock:
        spool, path = self.spools[plan.file], self.definition.folder / plan.file
        rows = spool.rows(plan.column)
        if rows < 2:
            raise InputError(f"{path}: found {rows} row{'' if rows == 1 else 's'} of data; expected a log")
        clock = read_clock(spool, plan.stamps, plan.time, rows, str(path))
        self.warnings += clock.warnings
        span = float(np.ptp(clock.time))
        if not OF_A_CLOCK[0] <= span <= OF_A_CLOCK[1]:
            raise InputError(f"{path}: its time stamps span {span:.3g} s; expected a log's: is their column a clock?")
        if span < SHORTEST_LOG:
            self.warnings.append(f"{path.name}: the whole log lasts {span:.3g} s: is the unit of its time right?")
        return clock

    def _fits(self, plan: Plan, stamps: int) -> None:
        """In formats of separate series a column and its time stamps may differ in length."""
        rows = self.spools[plan.file].rows(plan.column)
        if rows != stamps:
            where = f"{self.definition.folder / plan.file}, column {plan.spec.column!r} ({plan.spec.name})"
            raise InputError(f"{where}: {rows} readings on {stamps} time stamps; expected as many (state its own time)")

    def _samples(self, plan: Plan) -> Samples:
        return read_samples(plan, self.spools[plan.file], self.clocks[plan.clock], self.definition)

    def find_firing(self) -> FiringSpan | None:
        """When the log departs from rest; the engineer's t_open says so where it is given."""
        by_name = {plan.spec.name: plan for plan in self.plans}
        found = None
        for plan in (by_name[name] for name in REFERENCES if name in by_name):
            self.kept[plan.spec.name] = self._samples(plan)
            found = find_firing(plan.spec.name, self.kept[plan.spec.name].trace)
            if found:
                break
        stated = self.definition.segments.get("t_open")
        if stated is None:
            return found
        return replace(found, start=stated.value) if found else FiringSpan(stated.value, np.inf, "test.toml")

    def write(self, store: Store, firing: FiringSpan | None) -> None:
        """Clocks, then channel after channel."""
        names = {key: f"time_{i}" if i else "time" for i, key in enumerate(self.clocks)}
        for key, clock in self.clocks.items():
            store.clock(names[key], clock.time)
        found, said, lacking = [], [], []
        for plan, (channel, warnings) in self._channels(firing):
            found += [(channel.name, what) for what in flagged(plan.file, channel.flags)]
            said += warnings
            lacking.append((plan.file, channel.name, holes.not_excluded(channel)))
            store.channel(channel, names[plan.clock], LONG_NAMES.get(channel.name, channel.name))
        count = Counter(plan.file for plan in self.plans)
        files = {plan.clock: plan.file for plan in self.plans}
        leaps = [said for key, clock in self.clocks.items() for said in holes.leap_warnings(files[key], clock.time)]
        self.warnings += [*leaps, *flag_warnings(found, count), *holes.hole_warnings(lacking, count), *said]

    def _channels(self, firing: FiringSpan | None) -> Iterator[tuple[Plan, tuple[Channel, list[str]]]]:
        """Channels in order, a few of them at work."""

        def work(plan: Plan) -> tuple[Channel, list[str]]:
            samples = self.kept.pop(plan.spec.name, None) or self._samples(plan)
            return make_channel(plan, samples, firing, self.definition)

        waiting: deque[tuple[Plan, Future[tuple[Channel, list[str]]]]] = deque()
        for plan in self.plans:
            waiting.append((plan, self.pool.submit(work, plan)))
            if len(waiting) > WORKERS:
                first, future = waiting.popleft()
                yield first, future.result()
        for plan, future in waiting:
            yield plan, future.result()


def _provenance(definition: TestDefinition, raw: dict[str, str]) -> dict[str, Any]:
    return {
        "test": definition.test.id,
        "source": definition.test.source,
        "raw": raw,
        "test.toml": definition.sha256,
        "version": __version__,
    }
