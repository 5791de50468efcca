"""The other tests of a test's stand, and the one before it."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.record.definition import TestDefinition, load_definition
from hfanalysis.stages.base import Context

MOST = 4
"""Other tests that are looked at: the nearest in time. Evidence: a log is read for each, once."""


def others(context: Context) -> list[TestDefinition]:
    """The other tests of the stand, by name; a test.toml that cannot be read is left out.

    Measured tests, replicas and simulated tests are never compared with each other, whatever their stand.
    """
    stand, source = context.definition.test.stand, context.definition.test.source
    if stand is None:
        return []
    paths = sorted((context.root / "raw_tests").glob("*/test.toml"))
    found = [one for path in paths for one in _readable(path, stand)]
    return [one for one in found if one.test.id != context.id and one.test.source == source]


def before(context: Context) -> TestDefinition | None:
    """The stand's test before by date: "last time"; None where there is none."""
    day = context.definition.test.date
    if day is None:
        return None
    earlier = [one for one in others(context) if one.test.date is not None and one.test.date < day]
    return max(earlier, key=lambda one: (one.test.date, one.test.id), default=None)


LAST = ("calibration.json", "validation.json", "health.json", "flight.json")
"""Products of the test before that a page compares with its own."""


def of_before(context: Context) -> list[Path]:
    """Those of them that are there."""
    found = before(context)
    folder = context.out.parent / found.test.id if found is not None else None
    return [] if folder is None else [path for name in LAST if (path := folder / name).is_file()]


def _readable(path: Path, stand: str) -> Iterator[TestDefinition]:
    try:
        found = _as_it_is(path, stand, path.stat().st_mtime_ns, path.parent.stat().st_mtime_ns)
    except OSError:
        return
    if found is not None and found.test.stand == stand:
        yield found


@lru_cache(maxsize=4096)
def _as_it_is(path: Path, stand: str, _changed: int, _folder_changed: int) -> TestDefinition | None:
    """A definition of the stand as it is since it and its folder last changed; None where it cannot be read, or is
    another stand's. A campaign asks for all of them at every stage of every test."""
    try:
        # most tests are of other stands: their names tell quicker than the whole file does
        return load_definition(path) if stand in path.read_text(encoding="utf-8", errors="replace") else None
    except InputError:
        return None


def nearest(context: Context) -> list[TestDefinition]:
    """Of them the MOST nearest in time; those without a date come last."""
    day = context.definition.test.date

    def apart(other: TestDefinition) -> tuple[float, str]:
        known = day is not None and other.test.date is not None
        return (abs((other.test.date - day).days) if known else float("inf"), other.test.id)  # type: ignore[operator]

    return sorted(others(context), key=apart)[:MOST]
