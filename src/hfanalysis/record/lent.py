"""The test.toml of an earlier test of the stand, lent to a new log that has the same columns.

What belongs to the earlier test's own day is left out: its date, what was observed, events set by hand, stretches
excluded, and why a channel was trusted. What it states of masses stays, and has to be said beside every result.
"""

from __future__ import annotations

import datetime
import json
import re
from collections.abc import Iterator
from pathlib import Path

from hfanalysis.errors import InputError
from hfanalysis.record.definition import TestDefinition, load_definition
from hfanalysis.record.readers import open_log
from hfanalysis.record.readers.base import tidy

_TABLE = re.compile(r"\s*\[{1,2}\s*(?P<name>[\w.\"' -]+?)\s*\]{1,2}\s*(#.*)?$")
_OF_ITS_DAY = ("observed", "segments", "exclude")
"""Tables that speak of one firing."""
_LINES = {"test": ("date", "source", "description"), "channels": ("trust",), "log": ("firing",)}
"""Keys that do, by the first name of their table."""


def last_alike(root: Path, log: Path) -> TestDefinition | None:
    """The latest test (by its date, then by when its test.toml was written) whose one log has a log's very columns.

    None where there is none; tests that cannot be read are passed over.
    """
    found = (test for test in _tests(root) if len(test.log.files) == 1 and _alike(test, log))
    return max(found, key=_when, default=None)


def _tests(root: Path) -> Iterator[TestDefinition]:
    for path in (root / "raw_tests").glob("*/test.toml"):
        try:
            yield load_definition(path)
        except InputError:
            continue


def _when(test: TestDefinition) -> tuple[datetime.date, int]:
    return test.test.date or datetime.date.min, test.path.stat().st_mtime_ns


def _alike(test: TestDefinition, log: Path) -> bool:
    spec = test.log.files[0]
    try:
        theirs, ours = (open_log(path, spec).columns for path in (test.folder / spec.file, log))
    except (InputError, OSError):
        return False
    return list(map(tidy, theirs)) == list(map(tidy, ours))


def lend(test: TestDefinition, folder: Path, log: str) -> TestDefinition | None:
    """``folder``/test.toml for the ``log`` in it, of what a test states that is not of its own day.

    None where that cannot be told apart line by line; then no file is left.
    """
    path, old = folder / "test.toml", test.log.files[0].file
    path.write_text("".join(_lent(test, folder.name, old, log)), encoding="utf-8")
    try:
        made = load_definition(path)
    except InputError:
        made = None
    if made is not None and made.observed is None and not made.segments and not made.exclude:
        return made
    path.unlink()
    return None


def _lent(test: TestDefinition, name: str, old: str, new: str) -> Iterator[str]:
    table = ""
    for line in test.path.read_text(encoding="utf-8").splitlines(keepends=True):
        if header := _TABLE.match(line):
            table = header["name"].replace('"', "").replace("'", "").split(".")[0].strip()
        key = line.partition("=")[0].strip()
        if table in _OF_ITS_DAY or (not header and key in _LINES.get(table, ())):
            continue
        if table == "test" and key == "id":
            yield f"id = {json.dumps(name)}\n"
        else:
            for quote in "\"'":
                line = line.replace(f"{quote}{old}{quote}", json.dumps(new))
            yield line
