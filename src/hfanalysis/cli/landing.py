"""hfa watch FOLDER: a quick look at each log as it lands there."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from hfanalysis.cli.exit_status import tell
from hfanalysis.cli.quick import quick
from hfanalysis.cli.request import Request
from hfanalysis.errors import AnalysisError, InputError
from hfanalysis.record.definition import TestDefinition

if TYPE_CHECKING:
    from hfanalysis.performance.quick import Facts

POLL = 0.5
"""Between two looks into the folder [s]. Source: by choice: a log waits no longer than people do."""
SETTLED = 1.0
"""For how long a log has not grown that is taken for complete [s]. Evidence: loggers and copies that go on write many
times a second; one that pauses for longer is looked at again when it has grown."""
NO_LOGS = (".toml", ".part", ".tmp", ".crdownload", ".swp", ".md", ".html", ".png", ".jpg", ".pdf", ".tdms_index")
"""How the names of files end that are no logs, or not yet."""

State = tuple[int, int]
"""Size [B] and time of the last change [ns] of a file."""


def watch_folder(folder: Path, root: Path, once: bool, as_json: bool) -> None:
    """Look at each log that lands in ``folder``, until somebody stops it; ``once``: at those that are there."""
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; expected that into which the logger writes")
    done = {} if once else _files(folder)
    if not once:
        tell(f"{folder}: waiting for logs ({len(done)} files there already are passed over; Ctrl-C ends)")
    waiting: dict[Path, tuple[State, float]] = {}
    while True:
        for path in _complete(_files(folder), done, waiting, 0.0 if once else SETTLED):
            _look(path, root, as_json)
        if once:
            return
        time.sleep(POLL)


def _files(folder: Path) -> dict[Path, State]:
    """What may be logs, the oldest first."""
    with os.scandir(folder) as entries:
        found = [
            (Path(entry.path), entry.stat())
            for entry in entries
            if entry.is_file() and not entry.name.startswith((".", "~")) and not entry.name.lower().endswith(NO_LOGS)
        ]
    return {path: (stat.st_size, stat.st_mtime_ns) for path, stat in sorted(found, key=lambda one: one[1].st_mtime_ns)}


def _complete(
    there: dict[Path, State], done: dict[Path, State], waiting: dict[Path, tuple[State, float]], settled: float
) -> Iterator[Path]:
    """The files that are new or have changed, and have been as they are for long enough."""
    now = time.monotonic()
    for path, state in there.items():
        if done.get(path) == state or state[0] == 0:
            continue
        if waiting.get(path, (None, 0.0))[0] != state:
            waiting[path] = (state, now)
        if now - waiting[path][1] >= settled:
            done[path] = state
            del waiting[path]
            yield path


def _look(log: Path, root: Path, as_json: bool) -> None:
    """A quick look, in a folder of its own that is gone afterwards: what is only lent must not be found as a test."""
    with tempfile.TemporaryDirectory(prefix="hfa-watch-") as place:
        try:
            name, facts = _as_test(log, root, Path(place))
            tell(f"looking at {log}")
            quick(Request(name, Path(place), None, as_json, False, False), facts)
        except AnalysisError as error:
            tell(f"{log}: {error}")


def _as_test(log: Path, root: Path, place: Path) -> tuple[str, Facts]:
    """The log as a test in a root of its own: the test's name, and whose test.toml it has."""
    from hfanalysis.drafting.new import new_test
    from hfanalysis.performance.quick import Facts
    from hfanalysis.record.lent import last_alike, lend

    name = re.sub(r"[^\w.+-]+|\.\.+", "_", log.stem).lstrip(".+-_") or "log"
    folder = place / "raw_tests" / name
    folder.mkdir(parents=True)
    if (known := last_alike(root, log)) is not None:
        _bring(log, folder / log.name)
        if lend(known, folder, log.name) is not None:
            lender = known.test.id
            return name, Facts(f"that of {lender}, the last test with these columns{_load(known)}", lender)
    new_test(place, name, [log])
    return name, Facts(
        f"a draft, for no test here has these columns: no masses, no C_i (hfa new ID --log {shlex.quote(str(log))})"
    )


def _load(test: TestDefinition) -> str:
    """What it states of its own load, which this firing's may not have been."""
    stated = {
        "oxidizer": test.tank.oxidizer_mass if test.tank else None,
        "fuel": test.grain.mass if test.grain else None,
    }
    told = [f"{value.value:.3f} kg of {what}" for what, value in stated.items() if value is not None]
    return f", with its load ({' and '.join(told)})" if told else ""


def _bring(log: Path, to: Path) -> None:
    try:
        os.link(log, to)
    except OSError:  # another disk
        shutil.copyfile(log, to)
